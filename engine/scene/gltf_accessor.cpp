// Typed reading of accessors: every offset, length and type is checked here, before the first byte is touched.

#include "engine/scene/gltf_document.h"

#include <cstring>

namespace lambent::gltf {

namespace {

size_t componentSize(const Document& doc, int type, const std::string& place) {
  if (type < TINYGLTF_COMPONENT_TYPE_BYTE || type > TINYGLTF_COMPONENT_TYPE_FLOAT ||
      type == TINYGLTF_COMPONENT_TYPE_INT)
    doc.fail(place, "component type " + std::to_string(type) + " is not one of glTF's (5120 to 5123, 5125, 5126)");
  return size_t(tinygltf::GetComponentSizeInBytes(uint32_t(type)));
}

template <class T> T load(const uint8_t* p) {
  T value;
  std::memcpy(&value, p, sizeof(T)); // accessors need not be aligned in memory
  return value;
}

/// glTF 2.0, "Accessor data types": normalised signed values are clamped, so that -128 and -127 both mean -1.
template <class T> float toFloat(const uint8_t* p, bool normalized) {
  const float value = float(load<T>(p));
  if (!normalized) return value;
  return glm::max(value / float(std::numeric_limits<T>::max()), -1.0f);
}

float componentAsFloat(int type, const uint8_t* p, bool normalized) {
  switch (type) {
  case TINYGLTF_COMPONENT_TYPE_BYTE:
    return toFloat<int8_t>(p, normalized);
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
    return toFloat<uint8_t>(p, normalized);
  case TINYGLTF_COMPONENT_TYPE_SHORT:
    return toFloat<int16_t>(p, normalized);
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
    return toFloat<uint16_t>(p, normalized);
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    return float(load<uint32_t>(p));
  default:
    return load<float>(p);
  }
}

uint32_t componentAsIndex(int type, const uint8_t* p) {
  switch (type) {
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
    return *p;
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
    return load<uint16_t>(p);
  default:
    return load<uint32_t>(p);
  }
}

bool isIndexType(int type) {
  return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
         type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

/// `count` elements of `elementSize` bytes at `offset` in a view: the address of the first and the distance between
/// them.
struct Run {
  const uint8_t* data = nullptr;
  size_t stride = 0;
};
Run elementRun(const Document& doc, int view, size_t offset, size_t count, size_t elementSize,
               const std::string& place) {
  const Bytes bytes = viewBytes(doc, view, place);
  const size_t givenStride = doc.model.bufferViews[size_t(view)].byteStride;
  const size_t stride = givenStride ? givenStride : elementSize;
  if (count > 0 && (offset > bytes.size || elementSize > bytes.size - offset ||
                    count - 1 > (bytes.size - offset - elementSize) / stride))
    doc.fail(place, std::to_string(count) + " elements of " + std::to_string(elementSize) + " bytes, " +
                        std::to_string(stride) + " apart from byte " + std::to_string(offset) +
                        ", run past the end of buffer view " + std::to_string(view) + " (" +
                        std::to_string(bytes.size) + " bytes)");
  return {bytes.data + offset, stride};
}

/// Calls put(element, pointer to its components) for all elements, base first, then the sparse ones.
template <class Put>
void forElements(const Document& doc, const tinygltf::Accessor& a, const std::string& place, Put&& put) {
  const size_t components = size_t(componentsOf(a));
  const size_t elementSize = componentSize(doc, a.componentType, place) * components;
  if (a.count > std::numeric_limits<uint32_t>::max())
    doc.fail(place, "has " + std::to_string(a.count) + " elements, more than this program reads");
  doc.spend(a.count, sizeof(float) * components, place);
  if (a.bufferView >= 0) {
    const Run run = elementRun(doc, a.bufferView, a.byteOffset, a.count, elementSize, place);
    for (size_t i = 0; i < a.count; ++i) put(i, run.data + i * run.stride);
  }
  if (!a.sparse.isSparse) return;
  const auto& [count, isSparse, sparseIndices, sparseValues] = a.sparse;
  if (count < 0 || size_t(count) > a.count || sparseIndices.byteOffset < 0 || sparseValues.byteOffset < 0)
    doc.fail(place, "has more sparse values than elements, or a negative offset");
  const int type = sparseIndices.componentType;
  if (!isIndexType(type)) doc.fail(place, "the sparse indices are not unsigned integers");
  const Run indices = elementRun(doc, sparseIndices.bufferView, size_t(sparseIndices.byteOffset), size_t(count),
                                 componentSize(doc, type, place), place + ", sparse indices");
  const Run values = elementRun(doc, sparseValues.bufferView, size_t(sparseValues.byteOffset), size_t(count),
                                elementSize, place + ", sparse values");
  for (size_t i = 0; i < size_t(count); ++i) {
    const uint32_t element = componentAsIndex(type, indices.data + i * indices.stride);
    if (element >= a.count)
      doc.fail(place, "sparse index " + std::to_string(element) + " is beyond the last of " + std::to_string(a.count) +
                          " elements");
    put(element, values.data + i * values.stride);
  }
}

/// All components of all elements as `read` (a pointer to each) has them, zeros where the file gives none.
template <class V, class Read>
std::vector<V> readElements(const Document& doc, const tinygltf::Accessor& a, const std::string& place, Read&& read) {
  using Number = decltype(read(nullptr));
  const size_t components = size_t(componentsOf(a)), step = componentSize(doc, a.componentType, place);
  std::vector<V> values;
  const auto grow = [&] {
    if (values.empty()) values.assign(a.count * components * sizeof(Number) / sizeof(V), V(Number(0)));
  };
  forElements(doc, a, place, [&](size_t i, const uint8_t* element) {
    grow(); // only now: forElements has checked the count
    auto* to = reinterpret_cast<Number*>(values.data()) + i * components;
    for (size_t c = 0; c < components; ++c) to[c] = read(element + c * step);
  });
  grow();
  return values;
}

std::string accessorPlace(const std::string& place, int accessor) {
  return place + ", accessor " + std::to_string(accessor);
}

} // namespace

Bytes viewBytes(const Document& doc, int view, const std::string& place) {
  const tinygltf::BufferView& v = doc.at(doc.model.bufferViews, view, "buffer view", place);
  if (const auto defect = doc.viewDefects.find(view); defect != doc.viewDefects.end())
    throw InputError(doc.file.string(), place + ": " + defect->second);
  const auto& buffer =
      doc.at(doc.model.buffers, v.buffer, "buffer", place + ", buffer view " + std::to_string(view)).data;
  if (v.byteOffset > buffer.size() || v.byteLength > buffer.size() - v.byteOffset)
    doc.fail(place, "buffer view " + std::to_string(view) + " runs past the end of buffer " + std::to_string(v.buffer) +
                        " (" + std::to_string(buffer.size()) + " bytes)");
  return {buffer.data() + v.byteOffset, v.byteLength};
}

template <class V> std::vector<V> readAccessor(const Document& doc, int accessor, const std::string& outerPlace) {
  const tinygltf::Accessor& a = doc.at(doc.model.accessors, accessor, "accessor", outerPlace);
  const std::string place = accessorPlace(outerPlace, accessor);
  constexpr int kComponents = int(sizeof(V) / sizeof(float));
  if (componentsOf(a) != kComponents)
    doc.fail(place,
             "has " + std::to_string(componentsOf(a)) + " components (" + std::to_string(kComponents) + " expected)");
  return readElements<V>(doc, a, place,
                         [&](const uint8_t* p) { return componentAsFloat(a.componentType, p, a.normalized); });
}

template std::vector<float> readAccessor<float>(const Document&, int, const std::string&);
template std::vector<vec2> readAccessor<vec2>(const Document&, int, const std::string&);
template std::vector<vec3> readAccessor<vec3>(const Document&, int, const std::string&);
template std::vector<vec4> readAccessor<vec4>(const Document&, int, const std::string&);
template std::vector<mat4> readAccessor<mat4>(const Document&, int, const std::string&);

std::vector<uint32_t> readIndices(const Document& doc, int accessor, int components, const std::string& outerPlace) {
  const tinygltf::Accessor& a = doc.at(doc.model.accessors, accessor, "accessor", outerPlace);
  const std::string place = accessorPlace(outerPlace, accessor);
  if (componentsOf(a) != components || !isIndexType(a.componentType))
    doc.fail(place, "is not of unsigned integers, " + std::to_string(components) + " to an element");
  return readElements<uint32_t>(doc, a, place, [&](const uint8_t* p) { return componentAsIndex(a.componentType, p); });
}

} // namespace lambent::gltf

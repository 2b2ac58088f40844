// Typed reading of accessors: every offset, length and type is checked here, before the first byte is touched.

#include "engine/scene/gltf_document.h"

#include <cstring>

namespace lambent::gltf {

namespace {

size_t componentSize(const Document& doc, int type, const std::string& place) {
  switch (ComponentType(type)) {
  case ComponentType::Int8:
  case ComponentType::UInt8:
    return 1;
  case ComponentType::Int16:
  case ComponentType::UInt16:
    return 2;
  case ComponentType::UInt32:
  case ComponentType::Float32:
    return 4;
  }
  doc.fail(place, "component type " + std::to_string(type) + " is not one of glTF's (5120 to 5123, 5125, 5126)");
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

float componentAsFloat(ComponentType type, const uint8_t* p, bool normalized) {
  switch (type) {
  case ComponentType::Int8:
    return toFloat<int8_t>(p, normalized);
  case ComponentType::UInt8:
    return toFloat<uint8_t>(p, normalized);
  case ComponentType::Int16:
    return toFloat<int16_t>(p, normalized);
  case ComponentType::UInt16:
    return toFloat<uint16_t>(p, normalized);
  case ComponentType::UInt32:
    return float(load<uint32_t>(p));
  case ComponentType::Float32:
    break;
  }
  return load<float>(p);
}

uint32_t componentAsIndex(ComponentType type, const uint8_t* p) {
  switch (type) {
  case ComponentType::UInt8:
    return *p;
  case ComponentType::UInt16:
    return load<uint16_t>(p);
  default:
    return load<uint32_t>(p);
  }
}

bool isIndexType(int type) {
  return type == int(ComponentType::UInt8) || type == int(ComponentType::UInt16) || type == int(ComponentType::UInt32);
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
  const size_t givenStride = doc.bufferViews[size_t(view)].byteStride;
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
template <class Put> void forElements(const Document& doc, const Accessor& a, const std::string& place, Put&& put) {
  const size_t elementSize = componentSize(doc, a.componentType, place) * size_t(a.components);
  if (a.count > std::numeric_limits<uint32_t>::max())
    doc.fail(place, "has " + std::to_string(a.count) + " elements, more than this program reads");
  doc.spend(a.count, sizeof(float) * size_t(a.components), place);
  if (a.bufferView >= 0) {
    const Run run = elementRun(doc, a.bufferView, a.byteOffset, a.count, elementSize, place);
    for (size_t i = 0; i < a.count; ++i) put(i, run.data + i * run.stride);
  }
  if (!a.sparse) return;
  if (a.sparseCount < 0 || size_t(a.sparseCount) > a.count || a.sparseIndicesOffset < 0 || a.sparseValuesOffset < 0)
    doc.fail(place, "has more sparse values than elements, or a negative offset");
  if (!isIndexType(a.sparseIndicesType)) doc.fail(place, "the sparse indices are not unsigned integers");
  const size_t n = size_t(a.sparseCount);
  const Run indices = elementRun(doc, a.sparseIndicesView, size_t(a.sparseIndicesOffset), n,
                                 componentSize(doc, a.sparseIndicesType, place), place + ", sparse indices");
  const Run values =
      elementRun(doc, a.sparseValuesView, size_t(a.sparseValuesOffset), n, elementSize, place + ", sparse values");
  for (size_t i = 0; i < n; ++i) {
    const uint32_t element = componentAsIndex(ComponentType(a.sparseIndicesType), indices.data + i * indices.stride);
    if (element >= a.count)
      doc.fail(place, "sparse index " + std::to_string(element) + " is beyond the last of " + std::to_string(a.count) +
                          " elements");
    put(element, values.data + i * values.stride);
  }
}

std::string accessorPlace(const std::string& place, int accessor) {
  return place + ", accessor " + std::to_string(accessor);
}

} // namespace

Bytes viewBytes(const Document& doc, int view, const std::string& place) {
  const BufferView& v = doc.at(doc.bufferViews, view, "buffer view", place);
  const auto& buffer = doc.at(doc.buffers, v.buffer, "buffer", place + ", buffer view " + std::to_string(view));
  if (v.byteOffset > buffer.size() || v.byteLength > buffer.size() - v.byteOffset)
    doc.fail(place, "buffer view " + std::to_string(view) + " runs past the end of buffer " + std::to_string(v.buffer) +
                        " (" + std::to_string(buffer.size()) + " bytes)");
  return {buffer.data() + v.byteOffset, v.byteLength};
}

template <class V> std::vector<V> readAccessor(const Document& doc, int accessor, const std::string& outerPlace) {
  const Accessor& a = doc.at(doc.accessors, accessor, "accessor", outerPlace);
  const std::string place = accessorPlace(outerPlace, accessor);
  constexpr int kComponents = int(sizeof(V) / sizeof(float));
  if (a.components != kComponents)
    doc.fail(place,
             "has " + std::to_string(a.components) + " components (" + std::to_string(kComponents) + " expected)");
  const auto type = ComponentType(a.componentType);
  const size_t step = componentSize(doc, a.componentType, place);
  std::vector<V> values;
  const auto grow = [&] {
    if (values.empty()) values.assign(a.count, V(0.0f));
  };
  forElements(doc, a, place, [&](size_t i, const uint8_t* element) {
    grow(); // only now: forElements has checked the count
    float components[kComponents];
    if (type == ComponentType::Float32)
      std::memcpy(components, element, sizeof(V));
    else
      for (int c = 0; c < kComponents; ++c)
        components[c] = componentAsFloat(type, element + size_t(c) * step, a.normalized);
    std::memcpy(&values[i], components, sizeof(V));
  });
  grow();
  return values;
}

template std::vector<float> readAccessor<float>(const Document&, int, const std::string&);
template std::vector<vec2> readAccessor<vec2>(const Document&, int, const std::string&);
template std::vector<vec3> readAccessor<vec3>(const Document&, int, const std::string&);
template std::vector<vec4> readAccessor<vec4>(const Document&, int, const std::string&);
template std::vector<mat4> readAccessor<mat4>(const Document&, int, const std::string&);

std::vector<uint32_t> readIndices(const Document& doc, int accessor, int components, const std::string& outerPlace) {
  const Accessor& a = doc.at(doc.accessors, accessor, "accessor", outerPlace);
  const std::string place = accessorPlace(outerPlace, accessor);
  if (a.components != components || !isIndexType(a.componentType))
    doc.fail(place, "is not of unsigned integers, " + std::to_string(components) + " to an element");
  const size_t step = componentSize(doc, a.componentType, place);
  std::vector<uint32_t> values;
  const auto grow = [&] {
    if (values.empty()) values.assign(a.count * size_t(components), 0);
  };
  forElements(doc, a, place, [&](size_t i, const uint8_t* element) {
    grow();
    for (size_t c = 0; c < size_t(components); ++c)
      values[i * size_t(components) + c] = componentAsIndex(ComponentType(a.componentType), element + c * step);
  });
  grow();
  return values;
}

} // namespace lambent::gltf

// Decoders of meshopt and Draco behind checks of what their data claim: both libraries are safe with damaged bytes, but
// take the memory that these name.
#include "engine/scene/gltf_compression.h"

#include "engine/core/free_memory.h"

#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <meshoptimizer.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <span>

namespace lambent::gltf {

namespace {

constexpr const char* kMeshopt[] = {"EXT_meshopt_compression", "KHR_meshopt_compression"};
constexpr const char* kDraco = "KHR_draco_mesh_compression";

const tinygltf::Value* extensionOf(const tinygltf::ExtensionMap& extensions, std::span<const char* const> names) {
  for (const char* name : names)
    if (const auto found = extensions.find(name); found != extensions.end()) return &found->second;
  return nullptr;
}

/// A whole number of at least 0, or `otherwise` where it is absent. Throws where it is neither.
size_t wholeOf(const Document& doc, const tinygltf::Value& object, const char* key, size_t otherwise,
               const std::string& place) {
  if (!object.Has(key)) return otherwise;
  const tinygltf::Value& value = object.Get(key);
  const double number = value.IsNumber() ? value.GetNumberAsDouble() : -1;
  constexpr double kMost = 4294967295.0;
  if (!(number >= 0) || number > kMost || number != std::floor(number))
    doc.fail(place, std::string(key) + " is no whole number from 0 to 4294967295");
  return size_t(number);
}

std::string textOf(const tinygltf::Value& object, const char* key, const char* otherwise) {
  return object.Has(key) && object.Get(key).IsString() ? object.Get(key).Get<std::string>() : otherwise;
}

/// New data at the end of the file's buffers; returns the view that holds all of it.
int addView(Document& doc, std::vector<uint8_t> data) {
  tinygltf::BufferView view;
  view.buffer = int(doc.model.buffers.size());
  view.byteLength = data.size();
  doc.model.buffers.emplace_back().data = std::move(data);
  doc.model.bufferViews.push_back(view);
  return int(doc.model.bufferViews.size()) - 1;
}

// meshopt -------------------------------------------------------------------------------------------------------------

/// What a compressed view holds, decoded. EXT_meshopt_compression, "Compression modes and filters".
std::vector<uint8_t> decodeMeshopt(const Document& doc, const tinygltf::Value& packed, const std::string& place) {
  const size_t buffer = wholeOf(doc, packed, "buffer", SIZE_MAX, place);
  const size_t offset = wholeOf(doc, packed, "byteOffset", 0, place),
               length = wholeOf(doc, packed, "byteLength", 0, place);
  const size_t stride = wholeOf(doc, packed, "byteStride", 0, place), count = wholeOf(doc, packed, "count", 0, place);
  const std::string mode = textOf(packed, "mode", ""), filter = textOf(packed, "filter", "NONE");
  if (buffer >= doc.model.buffers.size()) doc.fail(place, "refers to a buffer that the file has not");
  const std::vector<unsigned char>& from = doc.model.buffers[buffer].data;
  if (offset > from.size() || length > from.size() - offset) doc.fail(place, "runs past the end of its buffer");
  const bool vertices = mode == "ATTRIBUTES", triangles = mode == "TRIANGLES", indices = mode == "INDICES";
  if (!vertices && !triangles && !indices) doc.fail(place, "mode '" + mode + "' is not one of the extension's");
  if (vertices ? stride == 0 || stride > 256 || stride % 4 != 0 : stride != 2 && stride != 4)
    doc.fail(place, "byteStride " + std::to_string(stride) + " is none that mode " + mode + " has");
  if (triangles && count % 3 != 0) doc.fail(place, "holds triangles, but its count is no multiple of 3");
  const bool oct = filter == "OCTAHEDRAL", quaternions = filter == "QUATERNION", exponents = filter == "EXPONENTIAL";
  if (filter != "NONE" && (!vertices || (!oct && !quaternions && !exponents)))
    doc.fail(place, "filter '" + filter + "' is none that mode " + mode + " has");
  if ((oct && stride != 4 && stride != 8) || (quaternions && stride != 8))
    doc.fail(place, "byteStride " + std::to_string(stride) + " is none that filter " + filter + " has");
  doc.spend(count, stride, place);
  std::vector<uint8_t> out(count * stride);
  const unsigned char* data = from.data() + offset;
  const int error = vertices    ? meshopt_decodeVertexBuffer(out.data(), count, stride, data, length)
                    : triangles ? meshopt_decodeIndexBuffer(out.data(), count, stride, data, length)
                                : meshopt_decodeIndexSequence(out.data(), count, stride, data, length);
  if (error != 0) doc.fail(place, "is damaged: its data are not what meshopt wrote");
  if (oct) meshopt_decodeFilterOct(out.data(), count, stride);
  if (quaternions) meshopt_decodeFilterQuat(out.data(), count, stride);
  if (exponents) meshopt_decodeFilterExp(out.data(), count, stride);
  return out;
}

// Draco ---------------------------------------------------------------------------------------------------------------

/// Reads the head of a Draco stream as far as the numbers of vertices and faces (bitstream 2.2, sections 2 to 4): the
/// library takes memory for them before it looks at the rest.
struct DracoHead {
  uint64_t faces = 0, points = 0;
  uint64_t tables = 0;     // of corners: edgebreaker has one for each decoder of attributes
  bool sequential = false; // else edgebreaker
  bool known = false;
};
DracoHead dracoHead(Bytes bytes) {
  size_t at = 0;
  const auto byte = [&]() -> uint64_t { return at < bytes.size ? bytes.data[at++] : (at = SIZE_MAX, 0); };
  const auto varint = [&] {
    uint64_t value = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      const uint64_t b = byte();
      value |= (b & 127) << shift;
      if (b < 128) break;
    }
    return value;
  };
  DracoHead head;
  if (bytes.size < 11 || std::memcmp(bytes.data, "DRACO", 5) != 0) return head;
  const unsigned version = bytes.data[5] * 256u + bytes.data[6], type = bytes.data[7], method = bytes.data[8];
  const unsigned flags = bytes.data[9] + 256u * bytes.data[10];
  constexpr unsigned kMetadata = 0x8000;
  if (type != 1 || version != 0x0202 || (flags & kMetadata)) return head;
  at = 11;
  head.sequential = method == 0;
  if (head.sequential) {
    head.faces = varint();
    head.points = varint();
  } else { // edgebreaker
    byte();
    head.points = varint();
    head.faces = varint();
    head.tables = byte();
  }
  head.known = at != SIZE_MAX;
  return head;
}

using Spend = std::function<void(size_t attributes, size_t bytesOfPoint)>;

/// A decoder of the library's that asks before it takes memory for the stream's attributes, which may be many and wide,
/// and none of them the file's. `spend` is called with their number and bytes of each point, and throws where these are
/// too many.
template <class Method> class AskingDecoder : public Method {
 public:
  explicit AskingDecoder(Spend spend) : spend_(std::move(spend)) {}

 protected:
  bool DecodeAllAttributes() override {
    constexpr size_t kOfValue = 2 * sizeof(int32_t); // as it is stored, and as it is predicted
    size_t bytes = 0;
    for (int32_t i = 0; i < this->point_cloud()->num_attributes(); ++i) {
      const draco::PointAttribute& a = *this->point_cloud()->attribute(i);
      bytes += size_t(a.num_components()) * (size_t(draco::DataTypeLength(a.data_type())) + kOfValue);
    }
    spend_(size_t(this->point_cloud()->num_attributes()), bytes);
    return Method::DecodeAllAttributes();
  }

 private:
  Spend spend_;
};

/// The mesh of a stream whose head is known.
template <class Method> std::unique_ptr<draco::Mesh> decodeMesh(Bytes bytes, const Spend& spend, std::string& defect) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data), bytes.size);
  auto mesh = std::make_unique<draco::Mesh>();
  AskingDecoder<Method> decoder(spend);
  const draco::Status status = decoder.Decode(draco::DecoderOptions(), &buffer, mesh.get());
  if (!status.ok()) defect = status.error_msg();
  return mesh;
}

template <class T>
bool valuesOf(const draco::PointAttribute& a, size_t points, int components, std::vector<uint8_t>& out) {
  for (size_t i = 0; i < points; ++i) {
    T value[4]; // accessors of primitives have four components at most
    if (!a.ConvertValue<T>(a.mapped_index(draco::PointIndex(uint32_t(i))), int8_t(components), value)) return false;
    std::memcpy(out.data() + i * size_t(components) * sizeof(T), value, size_t(components) * sizeof(T));
  }
  return true;
}

bool valuesOf(const draco::PointAttribute& a, size_t points, int components, int type, std::vector<uint8_t>& out) {
  switch (type) {
  case TINYGLTF_COMPONENT_TYPE_BYTE:
    return valuesOf<int8_t>(a, points, components, out);
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
    return valuesOf<uint8_t>(a, points, components, out);
  case TINYGLTF_COMPONENT_TYPE_SHORT:
    return valuesOf<int16_t>(a, points, components, out);
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
    return valuesOf<uint16_t>(a, points, components, out);
  case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    return valuesOf<uint32_t>(a, points, components, out);
  case TINYGLTF_COMPONENT_TYPE_FLOAT:
    return valuesOf<float>(a, points, components, out);
  default:
    return false;
  }
}

/// Whether the accessor has no data of its own, so that those of the compressed primitive are its.
bool empty(const Document& doc, int accessor, const std::string& place) {
  return doc.at(doc.model.accessors, accessor, "accessor", place).bufferView < 0;
}

// What the parser does not let pass -----------------------------------------------------------------------------------

/// Objects of a list of the file; none where there is no such list.
std::vector<nlohmann::json*> objectsIn(nlohmann::json& parent, const char* list) {
  std::vector<nlohmann::json*> objects;
  if (!parent.is_object() || !parent.contains(list) || !parent[list].is_array()) return objects;
  for (nlohmann::json& object : parent[list])
    if (object.is_object()) objects.push_back(&object);
  return objects;
}

bool hasExtension(const nlohmann::json& object, const char* name) {
  return object.contains("extensions") && object["extensions"].is_object() && object["extensions"].contains(name);
}

/// Buffers that are only there for who cannot decompress have neither data nor an address: they get a byte.
bool hideFallbacks(nlohmann::json& json) {
  bool changed = false;
  for (nlohmann::json* buffer : objectsIn(json, "buffers"))
    for (const char* name : kMeshopt)
      if (!buffer->contains("uri") && hasExtension(*buffer, name)) {
        (*buffer)["uri"] = "data:application/octet-stream;base64,AA==";
        (*buffer)["byteLength"] = 1;
        changed = true;
      }
  return changed;
}

/// Indices without data, which Draco brings.
bool hideIndices(nlohmann::json& json) {
  bool changed = false;
  const std::vector<nlohmann::json*> accessors = objectsIn(json, "accessors");
  for (nlohmann::json* mesh : objectsIn(json, "meshes"))
    for (nlohmann::json* primitive : objectsIn(*mesh, "primitives")) {
      if (!hasExtension(*primitive, kDraco) || !primitive->contains("indices")) continue;
      const nlohmann::json& indices = (*primitive)["indices"];
      if (!indices.is_number_unsigned() || indices.get<size_t>() >= accessors.size()) continue;
      if (accessors[indices.get<size_t>()]->contains("bufferView")) continue;
      primitive->erase("indices");
      changed = true;
    }
  return changed;
}

} // namespace

std::vector<uint8_t> asParsed(const std::filesystem::path& file, const std::vector<uint8_t>& bytes) {
  constexpr size_t kHeader = 12, kChunkHeader = 8;
  const bool binary = bytes.size() >= kHeader + kChunkHeader && std::memcmp(bytes.data(), "glTF", 4) == 0;
  size_t begin = 0, size = bytes.size();
  if (binary) {
    uint32_t chunk = 0;
    std::memcpy(&chunk, &bytes[kHeader], 4);
    begin = kHeader + kChunkHeader, size = chunk;
  }
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()) + begin, size);
  const auto names = [&](const char* extension) { return text.find(extension) != std::string_view::npos; };
  if (!names(kDraco) && std::none_of(std::begin(kMeshopt), std::end(kMeshopt), names)) return {};
  nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (json.is_discarded()) return {}; // the parser's to say
  const bool buffers = hideFallbacks(json), indices = hideIndices(json);
  if (!buffers && !indices) return {};
  std::string out = json.dump();
  if (!binary) return {out.begin(), out.end()};
  out.resize((out.size() + 3) / 4 * 4, ' ');
  std::vector<uint8_t> glb(bytes.begin(), bytes.begin() + kHeader + kChunkHeader);
  glb.insert(glb.end(), out.begin(), out.end());
  glb.insert(glb.end(), bytes.begin() + std::ptrdiff_t(begin + size), bytes.end());
  if (glb.size() > std::numeric_limits<uint32_t>::max()) throw InputError(file.string(), "is larger than 4 GB");
  const uint32_t total = uint32_t(glb.size()), chunk = uint32_t(out.size());
  std::memcpy(&glb[8], &total, 4);
  std::memcpy(&glb[kHeader], &chunk, 4);
  return glb;
}

void decodeViews(Document& doc) {
  for (size_t i = 0; i < doc.model.bufferViews.size(); ++i) {
    const tinygltf::Value* packed = extensionOf(doc.model.bufferViews[i].extensions, kMeshopt);
    if (!packed || !packed->IsObject()) continue;
    const std::string place = "buffer view " + std::to_string(i);
    try {
      std::vector<uint8_t> data = decodeMeshopt(doc, *packed, place);
      tinygltf::BufferView& view = doc.model.bufferViews[i];
      view.buffer = int(doc.model.buffers.size());
      view.byteOffset = 0;
      view.byteLength = data.size();
      doc.model.buffers.emplace_back().data = std::move(data);
    } catch (const InputError& e) {
      if (doc.budget.overdrawn()) throw;
      const std::string said = e.what(), own = doc.file.string() + ": "; // it is named again where it is used
      doc.viewDefects[int(i)] = said.starts_with(own) ? said.substr(own.size()) : said;
    }
  }
}

void decodePrimitive(Document& doc, tinygltf::Primitive& primitive, const std::string& outerPlace) {
  const tinygltf::Value* packed = extensionOf(primitive.extensions, std::span(&kDraco, 1));
  if (!packed || !packed->IsObject()) return;
  const std::string place = outerPlace + ", Draco";
  const auto positions = primitive.attributes.find("POSITION");
  if (positions == primitive.attributes.end()) return;
  const std::pair source(int(wholeOf(doc, *packed, "bufferView", SIZE_MAX, place)), positions->second);
  if (const auto known = doc.dracoIndices.find(source); known != doc.dracoIndices.end() && primitive.indices < 0)
    primitive.indices = known->second;               // of another primitive, with the rest
  if (!empty(doc, positions->second, place)) return; // it has both, or was decoded
  if (primitive.mode != TINYGLTF_MODE_TRIANGLES) doc.fail(place, "holds other than triangles, which are not decoded");
  const Bytes bytes = viewBytes(doc, source.first, place);
  const size_t count = doc.model.accessors[size_t(positions->second)].count;
  const DracoHead head = dracoHead(bytes);
  if (!head.known) doc.fail(place, "is no mesh of Draco's bitstream 2.2 without metadata");
  // Vertices of an edgebreaker's faces; points that share them, as along a seam, may be three times the faces.
  const uint64_t most = std::max<uint64_t>(head.points, 3 * head.faces);
  if (head.points > 3 * std::max<uint64_t>(count, 1) || head.faces > std::numeric_limits<uint32_t>::max() / 3)
    doc.fail(place, "names " + std::to_string(head.points) + " vertices and " + std::to_string(head.faces) +
                        " faces, but its accessors have " + std::to_string(count) + " elements");
  // What the decoder takes for a corner and a vertex, by measurement.
  constexpr size_t kBytesPerCorner = 64, kBytesPerTable = 8;
  const size_t ofCorner = kBytesPerCorner + kBytesPerTable * size_t(head.tables);
  doc.spend(most, ofCorner, place);

  const Spend spend = [&](size_t attributes, size_t bytesOfPoint) {
    doc.budget.decoded += attributes;
    if (doc.budget.decodesTooMuch())
      doc.fail(place, "brings the attributes that are decoded to " + std::to_string(doc.budget.decoded) +
                          ": more than a file of " + std::to_string(doc.budget.read) + " bytes may ask for (" +
                          std::to_string(doc.budget.decodedLimit()) + "; --allow-large lets it)");
    doc.spend(most, bytesOfPoint, place);
  };
  std::string defect;
  std::unique_ptr<draco::Mesh> mesh;
  try {
    // Symbols of which no value is made: up to 64 for each byte of the stream, before any is looked at.
    constexpr size_t kBytesOfSymbols = 64 * 12;
    std::optional<AllocationLimit> limit;
    if (bytes.size > doc.budget.left() / kBytesOfSymbols)
      limit.emplace(doc.budget.left() + size_t(most) * ofCorner); // charged, not yet taken
    mesh = head.sequential ? decodeMesh<draco::MeshSequentialDecoder>(bytes, spend, defect)
                           : decodeMesh<draco::MeshEdgebreakerDecoder>(bytes, spend, defect);
  } catch (const std::bad_alloc&) {
    doc.fail(place, doc.budget.trusted ? std::string("needs more memory than is left")
                                       : "needs more memory than a file of " + std::to_string(doc.budget.read) +
                                             " bytes may ask for (--allow-large lets it)");
  }
  if (!defect.empty()) doc.fail(place, "is damaged: " + defect);
  const size_t points = mesh->num_points();

  if (primitive.indices < 0) {
    std::vector<uint8_t> data(size_t(mesh->num_faces()) * 3 * sizeof(uint32_t));
    for (uint32_t i = 0; i < mesh->num_faces(); ++i)
      for (uint32_t c = 0; c < 3; ++c) {
        const uint32_t corner = mesh->face(draco::FaceIndex(i))[int(c)].value();
        std::memcpy(data.data() + (size_t(i) * 3 + c) * sizeof corner, &corner, sizeof corner);
      }
    tinygltf::Accessor a;
    a.type = TINYGLTF_TYPE_SCALAR;
    a.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    a.count = size_t(mesh->num_faces()) * 3;
    a.bufferView = addView(doc, std::move(data));
    primitive.indices = doc.dracoIndices[source] = int(doc.model.accessors.size());
    doc.model.accessors.push_back(std::move(a));
  }
  const tinygltf::Value none;
  const tinygltf::Value& attributes = packed->Has("attributes") ? packed->Get("attributes") : none;
  for (const auto& [name, accessor] : primitive.attributes) {
    if (!attributes.IsObject() || !attributes.Has(name) || !empty(doc, accessor, place)) continue;
    const std::string attributePlace = place + ", " + name;
    const size_t id = wholeOf(doc, attributes, name.c_str(), 0, attributePlace);
    const draco::PointAttribute* from = mesh->GetAttributeByUniqueId(uint32_t(id));
    if (!from) doc.fail(attributePlace, "there is no attribute " + std::to_string(id));
    tinygltf::Accessor& a = doc.model.accessors[size_t(accessor)];
    const int components = componentsOf(a), size = tinygltf::GetComponentSizeInBytes(uint32_t(a.componentType));
    if (a.count != points)
      doc.fail(attributePlace, "its accessor has " + std::to_string(a.count) + " elements, the mesh " +
                                   std::to_string(points) + " vertices");
    if (components < 1 || components > 4 || components != from->num_components() || size < 1)
      doc.fail(attributePlace, "has " + std::to_string(from->num_components()) + " components, its accessor " +
                                   std::to_string(components));
    std::vector<uint8_t> data(points * size_t(components) * size_t(size));
    if (!valuesOf(*from, points, components, a.componentType, data))
      doc.fail(attributePlace, "holds values that its accessor cannot");
    a.byteOffset = 0;
    a.bufferView = addView(doc, std::move(data));
  }
}

} // namespace lambent::gltf

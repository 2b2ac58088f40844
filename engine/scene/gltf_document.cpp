// Files parsed by tinygltf, and checks of what it takes as it comes.

#include "engine/scene/gltf_document.h"

#include "engine/core/free_memory.h"
#include "engine/core/open_watch.h"
#include "engine/scene/gltf_compression.h"
#include "engine/scene/json_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <unordered_map>

namespace lambent::gltf {

namespace fs = std::filesystem;

namespace {

/// Extensions that a file may require because it is shown as meant (unlit: as a Lambert surface of its colour).
constexpr std::array<const char*, 13> kSupportedExtensions = {
    "KHR_lights_punctual",    "KHR_materials_emissive_strength", "KHR_texture_transform",   "KHR_mesh_quantization",
    "KHR_materials_unlit",    "KHR_draco_mesh_compression",      "EXT_meshopt_compression", "KHR_meshopt_compression",
    "EXT_texture_webp",       "EXT_mesh_gpu_instancing",         "KHR_materials_ior",       "KHR_materials_specular",
    "KHR_materials_clearcoat"};

/// Reads the bytes of a file. Throws InputError when it cannot be read.
std::vector<uint8_t> readFileBytes(const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error)) throw InputError(file.string(), "no such file");
  if (!fs::is_regular_file(file, error)) throw InputError(file.string(), "is not a file (a .gltf or .glb expected)");
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  if (!in) throw InputError(file.string(), "cannot be opened for reading");
  std::vector<uint8_t> bytes(size_t(std::streamoff(in.tellg())));
  in.seekg(0);
  in.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(bytes.size()));
  if (!in) throw InputError(file.string(), "cannot be read to its end");
  return bytes;
}

struct Container {
  bool binary = false;
  JsonText json; // what was seen of it
};

uint32_t littleEndian32(const uint8_t* p) {
  return uint32_t(p[0]) | uint32_t(p[1]) << 8 | uint32_t(p[2]) << 16 | uint32_t(p[3]) << 24;
}

/// Checks what the parser takes on trust: a .glb's chunk sizes, JSON nested so deeply that a parser may run out of
/// stack, keys given twice.
Container checkContainer(const fs::path& file, const std::vector<uint8_t>& bytes) {
  const auto fail = [&](const std::string& reason) { throw InputError(file.string(), reason); };
  if (bytes.size() < 4) fail("is empty (glTF JSON or a .glb expected)");
  if (std::memcmp(bytes.data(), "glTF", 4) != 0) {
    return {false, checkJson(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()})};
  }

  constexpr size_t kHeader = 12, kChunkHeader = 8;
  if (bytes.size() < kHeader + kChunkHeader) fail("the .glb is cut off within its header");
  const uint32_t version = littleEndian32(&bytes[4]), length = littleEndian32(&bytes[8]);
  if (version != 2) fail("is binary glTF version " + std::to_string(version) + " (2 expected)");
  if (length > bytes.size())
    fail("the .glb is cut off: its header says " + std::to_string(length) + " bytes, the file has " +
         std::to_string(bytes.size()));
  if (length < kHeader + kChunkHeader)
    fail("the .glb is cut off: its header says " + std::to_string(length) + " bytes, too few for a chunk");
  Container out{true, {}};
  for (size_t at = kHeader, chunk = 0; at < length; ++chunk) {
    if (length - at < kChunkHeader) fail("the .glb is cut off within the header of chunk " + std::to_string(chunk));
    const size_t size = littleEndian32(&bytes[at]);
    if (size > length - at - kChunkHeader)
      fail("chunk " + std::to_string(chunk) + " of the .glb says " + std::to_string(size) + " bytes, but only " +
           std::to_string(length - at - kChunkHeader) + " follow");
    if (chunk == 0) {
      if (std::memcmp(&bytes[at + 4], "JSON", 4) != 0) fail("the first chunk of the .glb is not JSON");
      out.json = checkJson(file, {reinterpret_cast<const char*>(&bytes[at + kChunkHeader]), size});
    }
    at += kChunkHeader + size;
  }
  return out;
}

/// What the callbacks know of the file that is read.
struct Reading {
  Budget* budget;
  fs::path folder;
  bool mayOutside;
  bool outside;                                        // it names files that lie elsewhere, and are not read
  std::map<std::string, std::string> uris;             // decoded as the parser does → as RFC 3986 says
  std::set<std::string> files;                         // read before
  std::unordered_map<std::string, bool> known;         // whether what was asked for may be read
  std::unordered_map<std::string, std::string> places; // where it lies

  bool may(const std::string& file) {
    const auto [found, added] = known.try_emplace(file, false);
    if (added) found->second = mayRead(folder, file, mayOutside);
    return found->second;
  }
};

/// As the parser takes addresses: + as a space, as in forms on the web.
std::string asInForms(std::string uri) {
  std::ranges::replace(uri, '+', ' ');
  return pathOfUri(uri);
}

// File access of tinygltf. Its own expands paths through the shell's rules, command substitution included, which no
// file from elsewhere may reach, and looks in the working directory too.
bool fileExists(const std::string& file, void* data) {
  Reading& reading = *static_cast<Reading*>(data);
  const bool before = reading.known.contains(file);
  if (reading.may(file)) return true;
  if (before) return false;
  // Which paths there are to look in is the parser's: this file's folder, and the working directory.
  reading.outside = reading.outside || (!reading.mayOutside && file.starts_with(reading.folder.string()) &&
                                        leadsOutside(reading.folder, file));
  return false;
}

std::string rightPath(const std::string& file, void* data) {
  const Reading& reading = *static_cast<Reading*>(data);
  if (reading.uris.empty()) return file;
  for (const std::string& folder :
       {reading.folder.string() + "/", std::string("./")}) { // those that the parser looks in
    if (!file.starts_with(folder)) continue;
    if (const auto uri = reading.uris.find(file.substr(folder.size())); uri != reading.uris.end())
      return folder + uri->second;
  }
  return file;
}
bool readWholeFile(std::vector<unsigned char>* out, std::string* error, const std::string& file, void* data) {
  Reading& reading = *static_cast<Reading*>(data);
  try {
    const HeldFile held(reading.folder, file, reading.mayOutside);
    if (!held) throw InputError(file, held.why()); // also for who does not ask before
    constexpr size_t kOfItself = 2048;             // what a reading takes of time beside what is read, in bytes
    std::error_code none;
    const size_t size = fs::file_size(held.opened(), none);
    const auto [real, added] = reading.places.try_emplace(file);
    if (added) real->second = fs::weakly_canonical(held.opened(), none).string();
    if (reading.files.insert(real->second).second) {
      reading.budget->read += size;
      OpenWatch::read(size);
    } else if (!reading.budget->take(size + kOfItself, 1)) {
      throw InputError(file,
                       "is read so often that it needs more memory than the scene may ask for (--allow-large lets it)");
    }
    *out = readFileBytes(held.opened());
    return true;
  } catch (const std::exception& e) {
    if (error) *error += e.what();
    return false;
  }
}

/// Keeps the encoded bytes: only images in use are decoded, and several at a time (gltf_image.cpp).
bool keepEncoded(tinygltf::Image* image, const int, std::string*, std::string*, int, int, const unsigned char* bytes,
                 int size, void*) {
  if (image->bufferView < 0) image->image.assign(bytes, bytes + size);
  return true;
}

/// First line of what a parser says is wrong.
std::string firstLine(std::string text) {
  text = reasonOf(std::move(text));
  return text.substr(0, text.find('\n'));
}

/// `values` as numbers of exactly N components, the default when absent.
template <int N, class Number>
glm::vec<N, Number> numbers(const Document& doc, const std::vector<double>& values, const std::string& place,
                            const char* what, glm::vec<N, Number> otherwise) {
  if (values.empty()) return otherwise;
  if (values.size() != size_t(N))
    doc.fail(place, std::string(what) + " has " + std::to_string(values.size()) + " numbers (" + std::to_string(N) +
                        " expected)");
  glm::vec<N, Number> v;
  for (int i = 0; i < N; ++i) {
    v[i] = Number(values[size_t(i)]);
    if (!std::isfinite(float(v[i]))) doc.fail(place, std::string(what) + " holds a number beyond single precision");
  }
  return v;
}

void checkMaterials(Document& doc) {
  const tinygltf::Model& model = doc.model;
  for (size_t i = 0; i < model.textures.size(); ++i)
    if (const int sampler = model.textures[i].sampler; sampler >= 0)
      doc.checkIndex(sampler, model.samplers.size(), "sampler", "texture " + std::to_string(i));
  for (const auto& m : model.materials) {
    const std::string place = label("material", doc.materialFactors.size(), m.name);
    doc.materialFactors.push_back(
        {numbers<4>(doc, m.pbrMetallicRoughness.baseColorFactor, place, "baseColorFactor", vec4(1)),
         numbers<3>(doc, m.emissiveFactor, place, "emissiveFactor", vec3(0))});
  }
}

void checkWeights(const Document& doc, const std::vector<double>& weights, const std::string& place) {
  for (const double w : weights)
    if (!std::isfinite(float(w))) doc.fail(place, "weights hold a number beyond single precision");
}

Transform transformOf(Document& doc, const tinygltf::Node& n, const std::string& place) {
  Transform t;
  t.translation = numbers<3>(doc, n.translation, place, "translation", dvec3(0));
  t.scale = numbers<3>(doc, n.scale, place, "scale", vec3(1));
  const vec4 q = numbers<4>(doc, n.rotation, place, "rotation", vec4(0, 0, 0, 1));
  if (const float length = glm::length(q); length > 1e-12f)
    t.rotation = quat(q.w / length, q.x / length, q.y / length, q.z / length);
  else
    doc.warn(place + ": the rotation is no unit quaternion; taken as no rotation");
  if (!n.matrix.empty()) {
    if (n.matrix.size() != 16)
      doc.fail(place, "matrix has " + std::to_string(n.matrix.size()) + " numbers (16 expected)");
    dmat4 m;
    for (int i = 0; i < 16; ++i) {
      m[i / 4][i % 4] = n.matrix[size_t(i)];
      if (!std::isfinite(float(m[i / 4][i % 4]))) doc.fail(place, "matrix holds a number beyond single precision");
    }
    if (!isAffine(mat4(m))) doc.fail(place, "matrix is not affine (its last row is 0, 0, 0, 1)");
    m[0][3] = m[1][3] = m[2][3] = 0, m[3][3] = 1;
    t.matrix = m;
  }
  return t;
}

void checkNodes(Document& doc) {
  for (const auto& n : doc.model.nodes) {
    const std::string place = label("node", doc.transforms.size(), n.name);
    checkWeights(doc, n.weights, place);
    doc.transforms.push_back(transformOf(doc, n, place));
  }
  for (size_t i = 0; i < doc.model.meshes.size(); ++i)
    checkWeights(doc, doc.model.meshes[i].weights, label("mesh", i, doc.model.meshes[i].name));
}

void checkCamerasAndLights(Document& doc) {
  for (const auto& c : doc.model.cameras) {
    const std::string place = label("camera", doc.lenses.size(), c.name);
    CameraLens lens;
    const bool ortho = c.type == "orthographic";
    constexpr double kNearest = 1e-9, kFarthest = 1e12, kNarrowest = 0.001, kWidest = 179.9 / 180 * double(kPi);
    const double near = ortho ? c.orthographic.znear : c.perspective.znear;
    if (ortho && std::abs(c.orthographic.ymag) >= kNearest && std::abs(c.orthographic.ymag) <= kFarthest)
      lens.orthoHalfHeight = float(std::abs(c.orthographic.ymag));
    else if (!ortho && c.perspective.yfov >= kNarrowest && c.perspective.yfov <= kWidest)
      lens.fovY = float(c.perspective.yfov);
    else
      doc.warn(place + ": the size of its view is out of range; taken as a perspective view of 57 degrees");
    if ((near >= kNearest || (lens.orthoHalfHeight > 0 && near == 0)) && near <= kFarthest)
      lens.near = float(near);
    else
      doc.warn(place + ": the near plane is out of range; taken as 0.05 m");
    doc.lenses.push_back(lens);
  }
  for (const auto& l : doc.model.lights) {
    const std::string place = label("light", doc.lights.size(), l.name);
    PunctualLight light;
    const vec3 intensity = numbers<3>(doc, l.color, place, "color", vec3(1)) * float(l.intensity);
    light.intensity = glm::max(intensity, vec3(0));
    if (!(maxComponent(glm::abs(intensity)) <= kMostLight)) // NaN too
      doc.fail(place, "the intensity is beyond what pictures can hold (1e30)");
    if (light.intensity != intensity) doc.warn(place + ": negative light is left out");
    if (l.range > 0) light.range = float(l.range);
    const double outer = std::clamp(l.spot.outerConeAngle, 0.0, double(kPi) / 2);
    light.outerConeCos = float(std::cos(outer));
    light.innerConeCos = float(std::cos(std::clamp(l.spot.innerConeAngle, 0.0, outer)));
    doc.lights.push_back(light);
  }
}

void checkExtensions(const Document& doc) {
  for (const std::string& required : doc.model.extensionsRequired) {
    if (required == "KHR_texture_basisu")
      throw InputError(
          doc.file.string(),
          "requires the glTF extension KHR_texture_basisu, whose KTX2 images are not decoded here; convert "
          "it first: gltf-transform ktxdecompress IN OUT");
    if (std::find(kSupportedExtensions.begin(), kSupportedExtensions.end(), required) == kSupportedExtensions.end())
      throw InputError(doc.file.string(), "requires the glTF extension " + required + ", which is not supported");
  }
}

} // namespace

void Document::fail(const std::string& place, const std::string& reason) const {
  throw InputError(file.string(), place + ": " + reason);
}

void Document::spend(size_t count, size_t each, const std::string& place) const {
  if (budget.take(count, each)) return;
  const auto mebibytes = [](size_t bytes) { return std::to_string(bytes >> 20) + " MiB"; };
  if (budget.trusted || budget.free < budget.bySize())
    fail(place, "needs more memory than is left for it (" + mebibytes(budget.free) + ")");
  fail(place, "needs more memory than a file of " + std::to_string(budget.read) + " bytes may ask for (" +
                  mebibytes(budget.bySize()) + " in all; --allow-large lets it)");
}

void Document::show(size_t triangles, const std::string& place) const {
  budget.shown += triangles;
  if (budget.showsTooMuch())
    fail(place, "brings the triangles that nodes show to " + std::to_string(budget.shown) + ": more than a file of " +
                    std::to_string(budget.read) + " bytes may ask for (" + std::to_string(budget.shownLimit()) +
                    "; --allow-large lets it)");
}

void Document::checkIndex(int index, size_t size, const char* what, const std::string& place) const {
  if (index < 0 || size_t(index) >= size)
    fail(place, std::string("refers to ") + what + " " + std::to_string(index) + ", but the file has " +
                    (size == 0 ? "none" : std::to_string(size) + " (0 to " + std::to_string(size - 1) + ")"));
}

std::string label(const char* what, size_t index, const std::string& name) {
  return std::string(what) + " " + std::to_string(index) + (name.empty() ? "" : " '" + name + "'");
}

float number(const tinygltf::Value& object, const char* key, float otherwise) {
  if (!object.IsObject() || !object.Has(key) || !object.Get(key).IsNumber()) return otherwise;
  return float(object.Get(key).GetNumberAsDouble());
}

/// Of what a file takes, how much is counted: 1.3 GB of textures that are counted took 1.7 GB.
constexpr double kShareCounted = 0.75;

Document readDocument(const fs::path& file, FileTrust trust) {
  Document doc;
  doc.file = file;
  std::vector<uint8_t> bytes = readFileBytes(file);
  const auto [binary, json] = checkContainer(file, bytes);
  doc.budget.read = bytes.size();
  OpenWatch::read(bytes.size());
  if (std::vector<uint8_t> readable = asParsed(file, bytes); !readable.empty()) bytes = std::move(readable);
  doc.budget.free = size_t(kShareCounted * double(freeMemory()));
  doc.budget.trusted = trust.large;
  constexpr size_t kBytesPerMaterial = 2400; // of the parser's and ours
  doc.spend(json.materials, kBytesPerMaterial, std::to_string(json.materials) + " materials");
  constexpr size_t kBytesPerPicture = 420;
  doc.spend(json.textureParts, kBytesPerPicture, std::to_string(json.textureParts) + " samplers, textures and images");
  Reading reading{&doc.budget, file.parent_path(), trust.outside, false, {}, {}, {}, {}};
  for (const std::string& uri : json.uris)
    if (uri.find('+') != std::string::npos) reading.uris[asInForms(uri)] = pathOfUri(uri);

  tinygltf::TinyGLTF parser;
  parser.SetImageLoader(keepEncoded, nullptr);
  parser.SetFsCallbacks({fileExists, rightPath, readWholeFile, nullptr, &reading});
  std::string error, warning; // warnings only concern images that could not be read: reported where they are used
  const std::string folder = file.parent_path().empty() ? "." : file.parent_path().string();
  bool parsed = false;
  try {
    const auto size = unsigned(bytes.size());
    parsed = binary ? parser.LoadBinaryFromMemory(&doc.model, &error, &warning, bytes.data(), size, folder)
                    : parser.LoadASCIIFromString(&doc.model, &error, &warning,
                                                 reinterpret_cast<const char*>(bytes.data()), size, folder);
  } catch (const std::bad_alloc&) {
    throw; // loadScene names it
  } catch (const std::exception& e) {
    error = e.what();
  }
  if (!parsed && error.empty()) error = "it departs from glTF";
  checkExtensions(doc); // before the parser's own errors, which such an extension may be the cause of
  const bool outside = reading.outside;
  const char* hint =
      outside ? " (it names files outside of its folder, or through links, which --allow-outside lets it read)" : "";
  if (!parsed) throw InputError(file.string(), "is not a usable glTF file: " + firstLine(error) + hint);
  if (outside) doc.warn(std::string("what cannot be read is left out") + hint);
  if (!error.empty()) doc.warn("the file departs from glTF: " + firstLine(error));
  if (doc.model.asset.version.rfind("2.", 0) != 0)
    throw InputError(file.string(), "is glTF version '" + doc.model.asset.version + "' (2.0 expected)");

  doc.files.assign(reading.files.begin(), reading.files.end());
  doc.files.push_back(file);
  decodeViews(doc);
  checkMaterials(doc);
  checkNodes(doc);
  checkCamerasAndLights(doc);
  return doc;
}

} // namespace lambent::gltf

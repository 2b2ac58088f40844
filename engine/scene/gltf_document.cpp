// tinygltf's model to plain data. The only file that includes tinygltf.

#include "engine/scene/gltf_document.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include <tiny_gltf.h>

namespace lambent::gltf {

namespace fs = std::filesystem;

namespace {

/// Extensions that a file may require because it is shown as meant (unlit: as a Lambert surface of its colour).
constexpr std::array<const char*, 5> kSupportedExtensions = {"KHR_lights_punctual", "KHR_materials_emissive_strength",
                                                             "KHR_texture_transform", "KHR_mesh_quantization",
                                                             "KHR_materials_unlit"};

// File access of tinygltf. Its own expands paths through the shell's rules, command substitution included, which no
// file from elsewhere may reach.
bool fileExists(const std::string& file, void*) {
  std::error_code error;
  return fs::is_regular_file(file, error);
}

/// What the callbacks know of the file that is read.
struct Reading {
  Budget* budget;
  std::map<std::string, std::string> uris; // decoded as the parser does → as RFC 3986 says
  std::set<std::string> files;             // read before
};

/// %XX as bytes; `spaces`: also + as a space, as in forms on the web, which the parser takes uris for.
std::string decoded(const std::string& uri, bool spaces) {
  const auto digit = [&](size_t i) {
    const char c = i < uri.size() ? uri[i] : 'x';
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
  };
  std::string out;
  for (size_t i = 0; i < uri.size(); ++i) {
    const bool escape = uri[i] == '%' && digit(i + 1) >= 0 && digit(i + 2) >= 0;
    out += escape ? char(16 * digit(i + 1) + digit(i + 2)) : spaces && uri[i] == '+' ? ' ' : uri[i];
    if (escape) i += 2;
  }
  return out;
}

std::string rightPath(const std::string& file, void* data) {
  for (const auto& [wrong, right] : static_cast<Reading*>(data)->uris)
    if (file.ends_with(wrong)) return file.substr(0, file.size() - wrong.size()) + right;
  return file;
}
bool readWholeFile(std::vector<unsigned char>* out, std::string* error, const std::string& file, void* data) {
  auto& [budget, uris, files] = *static_cast<Reading*>(data);
  try {
    std::error_code none;
    const size_t size = fs::file_size(file, none);
    if (files.insert(fs::weakly_canonical(file, none).string()).second) {
      budget->read += size;
    } else if (!budget->take(size, 1)) {
      throw InputError(file, "is read so often that it needs more memory than the scene may ask for");
    }
    *out = readFileBytes(file);
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

/// First line of a parser's message, without the library's own tag in front.
std::string firstLine(std::string text) {
  if (!text.empty() && text.front() == '[')
    if (const size_t end = text.find("] "); end != std::string::npos) text.erase(0, end + 2);
  return text.substr(0, text.find('\n'));
}

float number(const tinygltf::Value& object, const char* key, float otherwise) {
  if (!object.IsObject() || !object.Has(key) || !object.Get(key).IsNumber()) return otherwise;
  return float(object.Get(key).GetNumberAsDouble());
}

vec2 pair(const tinygltf::Value& object, const char* key, vec2 otherwise) {
  if (!object.IsObject() || !object.Has(key) || object.Get(key).ArrayLen() < 2) return otherwise;
  const tinygltf::Value &x = object.Get(key).Get(0), &y = object.Get(key).Get(1);
  return x.IsNumber() && y.IsNumber() ? vec2(x.GetNumberAsDouble(), y.GetNumberAsDouble()) : otherwise;
}

template <class Info> TextureUse textureUse(const Info& info) {
  TextureUse use;
  use.texture = info.index;
  use.texCoord = info.texCoord;
  const auto found = info.extensions.find("KHR_texture_transform");
  if (found == info.extensions.end()) return use;
  const tinygltf::Value& t = found->second;
  use.texCoord = int(number(t, "texCoord", float(use.texCoord)));
  const vec2 offset = pair(t, "offset", vec2(0)), scale = pair(t, "scale", vec2(1));
  const float angle = number(t, "rotation", 0), c = std::cos(angle), s = std::sin(angle);
  // Translation × rotation × scale as the extension writes it: positive angles turn counter-clockwise in a uv space
  // whose v points down.
  use.uvTransform = mat3(c * scale.x, -s * scale.x, 0, s * scale.y, c * scale.y, 0, offset.x, offset.y, 1);
  return use;
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

Wrap wrapMode(int mode) {
  return mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? Wrap::ClampToEdge
         : mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Wrap::MirroredRepeat
                                                         : Wrap::Repeat;
}

void takeBuffers(Document& doc, tinygltf::Model& model) {
  for (auto& b : model.buffers) doc.buffers.push_back(std::move(b.data));
  for (const auto& v : model.bufferViews)
    doc.bufferViews.push_back({v.buffer, v.byteOffset, v.byteLength, v.byteStride});
  for (const auto& a : model.accessors) {
    Accessor out;
    out.bufferView = a.bufferView;
    out.byteOffset = a.byteOffset;
    out.count = a.count;
    out.componentType = a.componentType;
    out.components = tinygltf::GetNumComponentsInType(uint32_t(a.type));
    out.normalized = a.normalized;
    if (a.sparse.isSparse) {
      out.sparse = true;
      out.sparseCount = a.sparse.count;
      out.sparseIndicesView = a.sparse.indices.bufferView;
      out.sparseIndicesOffset = a.sparse.indices.byteOffset;
      out.sparseIndicesType = a.sparse.indices.componentType;
      out.sparseValuesView = a.sparse.values.bufferView;
      out.sparseValuesOffset = a.sparse.values.byteOffset;
    }
    doc.accessors.push_back(out);
  }
  for (auto& i : model.images) doc.images.push_back({i.name, i.uri, i.bufferView, std::move(i.image)});
}

void takeMaterials(Document& doc, const tinygltf::Model& model) {
  for (const auto& t : model.textures) {
    Texture out;
    out.image = t.source;
    if (t.sampler >= 0) {
      const auto place = "texture " + std::to_string(doc.textures.size());
      const auto& s = doc.at(model.samplers, t.sampler, "sampler", place);
      out.wrapU = wrapMode(s.wrapS);
      out.wrapV = wrapMode(s.wrapT);
      out.nearest = s.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
    }
    doc.textures.push_back(out);
  }
  for (const auto& m : model.materials) {
    const std::string place = label("material", doc.materials.size(), m.name);
    Material out;
    out.name = m.name;
    out.alphaMode = m.alphaMode;
    out.alphaCutoff = float(m.alphaCutoff);
    out.doubleSided = m.doubleSided;
    const auto& pbr = m.pbrMetallicRoughness;
    out.baseColor = numbers<4>(doc, pbr.baseColorFactor, place, "baseColorFactor", vec4(1));
    out.emissive = numbers<3>(doc, m.emissiveFactor, place, "emissiveFactor", vec3(0));
    out.baseColorTexture = textureUse(pbr.baseColorTexture);
    out.roughness = float(pbr.roughnessFactor);
    out.metalness = float(pbr.metallicFactor);
    out.roughnessMetalnessTexture = textureUse(pbr.metallicRoughnessTexture);
    out.emissiveTexture = textureUse(m.emissiveTexture);
    for (const auto& [name, value] : m.extensions) {
      if (name == "KHR_materials_emissive_strength") out.emissiveStrength = number(value, "emissiveStrength", 1);
      out.extensions.push_back(name);
    }
    doc.materials.push_back(out);
  }
}

std::vector<float> morphWeights(const Document& doc, const std::vector<double>& given, const std::string& place) {
  const std::vector<float> weights(given.begin(), given.end());
  for (const float w : weights)
    if (!std::isfinite(w)) doc.fail(place, "weights hold a number beyond single precision");
  return weights;
}

Node takeNode(Document& doc, const tinygltf::Node& n, size_t index) {
  const std::string place = label("node", index, n.name);
  Node out;
  out.name = n.name;
  out.children = n.children;
  out.mesh = n.mesh;
  out.skin = n.skin;
  out.camera = n.camera;
  if (const auto l = n.extensions.find("KHR_lights_punctual"); l != n.extensions.end())
    out.light = int(number(l->second, "light", -1));
  out.weights = morphWeights(doc, n.weights, place);
  Transform& t = out.transform;
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
  return out;
}

void takeNodes(Document& doc, tinygltf::Model& model) {
  for (const auto& n : model.nodes) doc.nodes.push_back(takeNode(doc, n, doc.nodes.size()));
  for (auto& m : model.meshes) {
    Mesh out{m.name, {}, morphWeights(doc, m.weights, label("mesh", doc.meshes.size(), m.name))};
    for (auto& p : m.primitives)
      out.primitives.push_back({std::move(p.attributes), p.indices, p.material, p.mode, std::move(p.targets)});
    doc.meshes.push_back(std::move(out));
  }
  for (const auto& s : model.skins) doc.skins.push_back({s.name, s.joints, s.inverseBindMatrices});
  for (const auto& s : model.scenes) doc.scenes.push_back({s.name, s.nodes});
  doc.defaultScene = model.defaultScene;
}

void takeCamerasAndLights(Document& doc, const tinygltf::Model& model) {
  for (const auto& c : model.cameras) {
    const std::string place = label("camera", doc.cameras.size(), c.name);
    Camera out{c.name, {}};
    const bool ortho = c.type == "orthographic";
    constexpr double kNearest = 1e-9, kFarthest = 1e12, kNarrowest = 0.001, kWidest = 179.9 / 180 * double(kPi);
    const double near = ortho ? c.orthographic.znear : c.perspective.znear;
    if (ortho && std::abs(c.orthographic.ymag) >= kNearest && std::abs(c.orthographic.ymag) <= kFarthest)
      out.lens.orthoHalfHeight = float(std::abs(c.orthographic.ymag));
    else if (!ortho && c.perspective.yfov >= kNarrowest && c.perspective.yfov <= kWidest)
      out.lens.fovY = float(c.perspective.yfov);
    else
      doc.warn(place + ": the size of its view is out of range; taken as a perspective view of 57 degrees");
    if ((near >= kNearest || (ortho && near == 0)) && near <= kFarthest)
      out.lens.near = float(near);
    else
      doc.warn(place + ": the near plane is out of range; taken as 0.05 m");
    doc.cameras.push_back(out);
  }
  for (const auto& l : model.lights) {
    const std::string place = label("light", doc.lights.size(), l.name);
    Light out{l.name, l.type, {}};
    const vec3 intensity = numbers<3>(doc, l.color, place, "color", vec3(1)) * float(l.intensity);
    out.light.intensity = glm::max(intensity, vec3(0));
    if (!(maxComponent(glm::abs(intensity)) <= kMostLight)) // NaN too
      doc.fail(place, "the intensity is beyond what pictures can hold (1e30)");
    if (out.light.intensity != intensity) doc.warn(place + ": negative light is left out");
    if (l.range > 0) out.light.range = float(l.range);
    const double outer = std::clamp(l.spot.outerConeAngle, 0.0, double(kPi) / 2);
    out.light.outerConeCos = float(std::cos(outer));
    out.light.innerConeCos = float(std::cos(std::clamp(l.spot.innerConeAngle, 0.0, outer)));
    doc.lights.push_back(out);
  }
}

void takeAnimations(Document& doc, const tinygltf::Model& model) {
  for (const auto& a : model.animations) {
    Animation out{a.name, {}, {}};
    for (const auto& c : a.channels) out.channels.push_back({c.sampler, c.target_node, c.target_path});
    for (const auto& s : a.samplers) out.samplers.push_back({s.input, s.output, s.interpolation});
    doc.animations.push_back(std::move(out));
  }
}

void checkExtensions(const Document& doc, const tinygltf::Model& model) {
  for (const std::string& required : model.extensionsRequired)
    if (std::find(kSupportedExtensions.begin(), kSupportedExtensions.end(), required) == kSupportedExtensions.end())
      throw InputError(doc.file.string(), "requires the glTF extension " + required + ", which is not supported");
}

} // namespace

Document readDocument(const fs::path& file) {
  Document doc;
  doc.file = file;
  const std::vector<uint8_t> bytes = readFileBytes(file);
  const auto [binary, json] = checkContainer(file, bytes);
  doc.budget.read = bytes.size();
  Reading reading{&doc.budget, {}, {}};
  for (const std::string& uri : json.uris)
    if (uri.find('+') != std::string::npos) reading.uris[decoded(uri, true)] = decoded(uri, false);

  tinygltf::TinyGLTF parser;
  parser.SetImageLoader(keepEncoded, nullptr);
  parser.SetFsCallbacks({fileExists, rightPath, readWholeFile, nullptr, &reading});
  tinygltf::Model model;
  std::string error, warning; // warnings only concern images that could not be read: reported where they are used
  const std::string folder = file.parent_path().empty() ? "." : file.parent_path().string();
  bool parsed = false;
  try {
    const auto size = unsigned(bytes.size());
    parsed = binary ? parser.LoadBinaryFromMemory(&model, &error, &warning, bytes.data(), size, folder)
                    : parser.LoadASCIIFromString(&model, &error, &warning, reinterpret_cast<const char*>(bytes.data()),
                                                 size, folder);
  } catch (const std::exception& e) {
    error = e.what();
  }
  checkExtensions(doc, model); // before the parser's own errors, which such an extension may be the cause of
  if (!parsed) throw InputError(file.string(), "is not a usable glTF file: " + firstLine(error));
  if (!error.empty()) doc.warn("the file departs from glTF: " + firstLine(error));
  if (model.asset.version.rfind("2.", 0) != 0)
    throw InputError(file.string(), "is glTF version '" + model.asset.version + "' (2.0 expected)");

  takeBuffers(doc, model);
  takeMaterials(doc, model);
  takeNodes(doc, model);
  takeCamerasAndLights(doc, model);
  takeAnimations(doc, model);
  return doc;
}

} // namespace lambent::gltf

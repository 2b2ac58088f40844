#include "tools/content/gltf_writer.h"

#include "engine/core/error.h"
#include "engine/core/image.h"

#include <glm/gtc/quaternion.hpp>
#include <stb/stb_image_write.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>

namespace lambent::content {

using nlohmann::json;

namespace {

// Constants of the glTF 2.0 specification (those of OpenGL).
constexpr uint32_t kFloat = 5126, kUnsignedShort = 5123, kUnsignedInt = 5125;
constexpr uint32_t kVertexBuffer = 34962, kIndexBuffer = 34963;
constexpr uint32_t kLinear = 9729, kLinearMipmapLinear = 9987;

/// Rounded to a millionth: no digits that differ between maths libraries, and short numbers in the JSON.
double rounded(double v) {
  const double r = std::round(v * 1e6) / 1e6;
  return r == 0 ? 0.0 : r; // no negative zero
}

json array(const dvec3& v) { return {rounded(v.x), rounded(v.y), rounded(v.z)}; }
json array(const glm::dquat& q) { return {rounded(q.x), rounded(q.y), rounded(q.z), rounded(q.w)}; }

template <class Vector> std::vector<float> flattened(const std::vector<Vector>& values) {
  std::vector<float> out;
  for (const Vector& v : values)
    for (glm::length_t i = 0; i < Vector::length(); ++i) out.push_back(float(rounded(v[i])));
  return out;
}

void writeBytes(const std::filesystem::path& file, const void* data, size_t bytes) {
  writeAtomically(file, [&](const std::filesystem::path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out.write(static_cast<const char*>(data), std::streamsize(bytes));
    out.flush();
    if (!out) throw RunError(file.string() + ": cannot write (is the disk full?)");
  });
}

void appendBytes(void* context, void* data, int size) {
  const auto* bytes = static_cast<const uint8_t*>(data);
  auto& out = *static_cast<std::vector<uint8_t>*>(context);
  out.insert(out.end(), bytes, bytes + size);
}

std::vector<uint8_t> encodePng(const Texture& t) {
  std::vector<uint8_t> png;
  const int width = int(t.width), height = int(t.height);
  if (!stbi_write_png_to_func(appendBytes, &png, width, height, 4, t.rgba.data(), 4 * width))
    throw RunError(t.name + ".png: cannot encode");
  return png;
}

} // namespace

glm::dquat facing(const dvec3& direction) {
  const dvec3 d = glm::normalize(direction);
  const dvec3 up = std::abs(d.y) < 0.999 ? dvec3(0, 1, 0) : dvec3(0, 0, 1);
  return glm::quatLookAt(d, up);
}

Index GltfWriter::addView(const void* data, size_t bytes, Target target) {
  json view{{"buffer", 0}, {"byteOffset", buffer_.size()}, {"byteLength", bytes}};
  if (target != Target::None) view["target"] = target == Target::Vertices ? kVertexBuffer : kIndexBuffer;
  const auto* first = static_cast<const uint8_t*>(data);
  buffer_.insert(buffer_.end(), first, first + bytes);
  buffer_.resize((buffer_.size() + 3) & ~size_t(3)); // accessors start at multiples of their component size
  views_.push_back(std::move(view));
  return Index(views_.size() - 1);
}

Index GltfWriter::addAccessor(const std::vector<float>& values, uint32_t components, Target target, bool bounds) {
  static constexpr const char* kTypes[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
  json accessor{{"bufferView", addView(values.data(), values.size() * sizeof(float), target)},
                {"componentType", kFloat},
                {"count", values.size() / components},
                {"type", kTypes[components]}};
  if (bounds) {
    std::vector<float> lo(values.begin(), values.begin() + components), hi = lo;
    for (size_t i = 0; i < values.size(); ++i) {
      lo[i % components] = std::min(lo[i % components], values[i]);
      hi[i % components] = std::max(hi[i % components], values[i]);
    }
    accessor["min"] = lo;
    accessor["max"] = hi;
  }
  accessors_.push_back(std::move(accessor));
  return Index(accessors_.size() - 1);
}

Index GltfWriter::addIndexAccessor(const std::vector<uint32_t>& indices) {
  CHECK_LT(0u, indices.size());
  const bool fit = *std::max_element(indices.begin(), indices.end()) < 65535; // 65535 restarts a primitive
  Index view = kAbsent;
  if (fit) {
    const std::vector<uint16_t> narrow(indices.begin(), indices.end());
    view = addView(narrow.data(), narrow.size() * sizeof(uint16_t), Target::Indices);
  } else {
    view = addView(indices.data(), indices.size() * sizeof(uint32_t), Target::Indices);
  }
  accessors_.push_back({{"bufferView", view},
                        {"componentType", fit ? kUnsignedShort : kUnsignedInt},
                        {"count", indices.size()},
                        {"type", "SCALAR"}});
  return Index(accessors_.size() - 1);
}

Index GltfWriter::addTexture(Texture texture) {
  CHECK_EQ(texture.rgba.size(), size_t(4) * texture.width * texture.height);
  textures_.push_back(std::move(texture));
  return Index(textures_.size() - 1);
}

Index GltfWriter::addMaterial(const MaterialSpec& m) {
  const auto whole = [](double v) { return v == std::round(v) ? json(int(v)) : json(rounded(v)); };
  json surface{{"metallicFactor", whole(m.metalness)}, {"roughnessFactor", whole(m.roughness)}};
  json factor = array(m.albedo);
  factor.push_back(1);
  surface["baseColorFactor"] = std::move(factor);
  if (m.texture != kAbsent) surface["baseColorTexture"] = {{"index", m.texture}};
  if (m.roughnessMetalnessTexture != kAbsent)
    surface["metallicRoughnessTexture"] = {{"index", m.roughnessMetalnessTexture}};
  json material{{"name", m.name}, {"pbrMetallicRoughness", std::move(surface)}};
  if (m.alphaMask) material["alphaMode"] = "MASK";
  if (m.doubleSided) material["doubleSided"] = true;
  if (m.emissionRadiance > 0) {
    emissiveStrength_ = true;
    material["emissiveFactor"] = array(m.emissionColor);
    material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = rounded(m.emissionRadiance);
  }
  materials_.push_back(std::move(material));
  return Index(materials_.size() - 1);
}

Index GltfWriter::addMesh(const std::string& name, const Geometry& geometry, Index material) {
  json attributes{{"POSITION", addAccessor(flattened(geometry.positions), 3, Target::Vertices, true)},
                  {"NORMAL", addAccessor(flattened(geometry.normals), 3, Target::Vertices, false)}};
  if (!geometry.uvs.empty())
    attributes["TEXCOORD_0"] = addAccessor(flattened(geometry.uvs), 2, Target::Vertices, false);
  json primitive{
      {"attributes", std::move(attributes)}, {"indices", addIndexAccessor(geometry.indices)}, {"material", material}};
  meshes_.push_back({{"name", name}, {"primitives", json::array({std::move(primitive)})}});
  meshTriangles_.push_back(geometry.indices.size() / 3);
  return Index(meshes_.size() - 1);
}

Index GltfWriter::addMeshVariant(const std::string& name, Index mesh, Index material) {
  json copy = meshes_.at(mesh);
  copy["name"] = name;
  copy["primitives"][0]["material"] = material;
  meshes_.push_back(std::move(copy));
  meshTriangles_.push_back(meshTriangles_[mesh]);
  return Index(meshes_.size() - 1);
}

Index GltfWriter::addPerspectiveCamera(const std::string& name, double fovYDegrees) {
  cameras_.push_back({{"name", name},
                      {"type", "perspective"},
                      {"perspective", {{"yfov", rounded(glm::radians(fovYDegrees))}, {"znear", 0.05}}}});
  return Index(cameras_.size() - 1);
}

Index GltfWriter::addLight(const std::string& name, const char* type, const dvec3& color, double intensity) {
  lights_.push_back({{"name", name}, {"type", type}, {"color", array(color)}, {"intensity", rounded(intensity)}});
  return Index(lights_.size() - 1);
}

Index GltfWriter::addDirectionalLight(const std::string& name, const dvec3& color, double irradiance) {
  return addLight(name, "directional", color, irradiance);
}

Index GltfWriter::addPointLight(const std::string& name, const dvec3& color, double intensity) {
  return addLight(name, "point", color, intensity);
}

Index GltfWriter::addSpotLight(const std::string& name, const dvec3& color, double intensity, double innerDegrees,
                               double outerDegrees) {
  const Index light = addLight(name, "spot", color, intensity);
  lights_[light]["spot"] = {{"innerConeAngle", rounded(glm::radians(innerDegrees))},
                            {"outerConeAngle", rounded(glm::radians(outerDegrees))}};
  return light;
}

Index GltfWriter::addNode(const NodeSpec& spec) {
  json node{{"name", spec.name}};
  if (spec.translation != dvec3(0)) node["translation"] = array(spec.translation);
  if (spec.rotation != glm::dquat(1, 0, 0, 0)) node["rotation"] = array(spec.rotation);
  if (spec.camera != kAbsent) node["camera"] = spec.camera;
  if (spec.light != kAbsent) node["extensions"]["KHR_lights_punctual"]["light"] = spec.light;
  if (spec.mesh != kAbsent) {
    node["mesh"] = spec.mesh;
    placedTriangles_ += meshTriangles_.at(spec.mesh);
  }
  nodes_.push_back(std::move(node));
  return Index(nodes_.size() - 1);
}

void GltfWriter::animateTranslation(Index node, const std::vector<double>& times,
                                    const std::vector<dvec3>& translations) {
  CHECK_EQ(times.size(), translations.size());
  std::vector<float> seconds;
  for (const double t : times) seconds.push_back(float(rounded(t)));
  samplers_.push_back({{"input", addAccessor(seconds, 1, Target::None, true)},
                       {"output", addAccessor(flattened(translations), 3, Target::None, false)},
                       {"interpolation", "LINEAR"}});
  channels_.push_back({{"sampler", samplers_.size() - 1}, {"target", {{"node", node}, {"path", "translation"}}}});
}

GeneratedScene GltfWriter::write(const std::filesystem::path& folder, const std::string& stem) const {
  json gltf{{"asset", {{"version", "2.0"}, {"generator", "lambent content"}}},
            {"scene", 0},
            {"accessors", accessors_},
            {"bufferViews", views_},
            {"buffers", json::array({{{"uri", stem + ".bin"}, {"byteLength", buffer_.size()}}})},
            {"materials", materials_},
            {"meshes", meshes_},
            {"nodes", nodes_}};
  std::vector<Index> roots(nodes_.size());
  for (Index i = 0; i < roots.size(); ++i) roots[i] = i;
  gltf["scenes"] = json::array({{{"name", stem}, {"nodes", roots}}});

  std::vector<std::string> extensions;
  if (emissiveStrength_) extensions.push_back("KHR_materials_emissive_strength");
  if (!lights_.empty()) {
    extensions.push_back("KHR_lights_punctual");
    gltf["extensions"]["KHR_lights_punctual"]["lights"] = lights_;
  }
  if (!extensions.empty()) gltf["extensionsUsed"] = extensions;
  if (!cameras_.empty()) gltf["cameras"] = cameras_;
  if (!channels_.empty())
    gltf["animations"] = json::array({{{"name", stem}, {"channels", channels_}, {"samplers", samplers_}}});
  if (!textures_.empty()) {
    gltf["samplers"] = json::array({{{"magFilter", kLinear}, {"minFilter", kLinearMipmapLinear}}});
    gltf["images"] = gltf["textures"] = json::array();
    for (const Texture& t : textures_) {
      gltf["textures"].push_back({{"sampler", 0}, {"source", gltf["images"].size()}});
      gltf["images"].push_back({{"uri", t.name + ".png"}, {"name", t.name}});
    }
  }

  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) throw RunError(folder.string() + ": cannot make this folder (" + failure.message() + ")");
  GeneratedScene scene{folder / (stem + ".gltf"), placedTriangles_, 0, {}};
  const auto put = [&](const std::string& name, const void* data, size_t bytes) {
    writeBytes(folder / name, data, bytes);
    scene.written.push_back(name);
    scene.bytes += bytes;
  };
  for (const Texture& t : textures_) {
    const std::vector<uint8_t> png = encodePng(t);
    put(t.name + ".png", png.data(), png.size());
  }
  put(stem + ".bin", buffer_.data(), buffer_.size());
  const std::string text = gltf.dump(1) + "\n"; // the file that refers to the others comes last
  put(stem + ".gltf", text.data(), text.size());
  return scene;
}

} // namespace lambent::content

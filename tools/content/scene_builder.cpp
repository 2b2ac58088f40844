#include "tools/content/scene_builder.h"

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/rng.h"

#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>
#include <stb/stb_image_write.h>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace lambent::content {

using nlohmann::json;

namespace {

// Constants of the glTF 2.0 specification (those of OpenGL).
template <class T> constexpr uint32_t kComponentType = std::is_same_v<T, float> ? 5126 : sizeof(T) == 2 ? 5123 : 5125;
constexpr const char* kTypes[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"}; // by number of components
constexpr uint32_t kVertexBuffer = 34962, kIndexBuffer = 34963;
constexpr uint32_t kLinear = 9729, kLinearMipmapLinear = 9987;

const glm::dquat kUpright(1, 0, 0, 0);

/// Rounded to a millionth: no digits that differ between maths libraries, and short numbers in the JSON.
double rounded(double v) {
  const double r = std::round(v * 1e6) / 1e6;
  return r == 0 ? 0.0 : r; // no negative zero
}

json array(const dvec3& v) { return {rounded(v.x), rounded(v.y), rounded(v.z)}; }
json array(const glm::dquat& q) { return {rounded(q.x), rounded(q.y), rounded(q.z), rounded(q.w)}; }

Index added(json& list, json item) {
  list.push_back(std::move(item));
  return Index(list.size() - 1);
}

template <class Vector> std::vector<float> flattened(const std::vector<Vector>& values) {
  std::vector<float> out;
  for (const Vector& v : values)
    for (glm::length_t i = 0; i < Vector::length(); ++i) out.push_back(float(rounded(v[i])));
  return out;
}

std::string encodePng(const Texture& t) {
  std::string png;
  const auto append = [](void* out, void* data, int size) {
    static_cast<std::string*>(out)->append(static_cast<const char*>(data), size_t(size));
  };
  const int width = int(t.width), height = int(t.height);
  if (!stbi_write_png_to_func(append, &png, width, height, 4, t.rgba.data(), 4 * width))
    throw RunError(t.name + ".png: cannot encode");
  return png;
}

/// Rotation that turns -Z, the axis of glTF cameras and lights, into `direction`.
glm::dquat facing(const dvec3& direction) {
  const dvec3 d = glm::normalize(direction);
  const dvec3 up = std::abs(d.y) < 0.999 ? dvec3(0, 1, 0) : dvec3(0, 0, 1);
  return glm::quatLookAt(d, up);
}

} // namespace

struct SceneBuilder::Lists {
  json accessors = json::array(), views = json::array(), materials = json::array(), meshes = json::array();
  json nodes = json::array(), cameras = json::array(), lights = json::array();
  json channels = json::array(), samplers = json::array();
};

SceneBuilder::SceneBuilder(const Order& order) : order_(order), lists_(std::make_unique<Lists>()) {}
SceneBuilder::~SceneBuilder() = default;

template <class T>
Index SceneBuilder::accessor(const std::vector<T>& values, size_t components, uint32_t target, bool bounds) {
  const size_t bytes = values.size() * sizeof(T);
  json view{{"buffer", 0}, {"byteOffset", buffer_.size()}, {"byteLength", bytes}};
  if (target) view["target"] = target;
  buffer_.append(reinterpret_cast<const char*>(values.data()), bytes);
  buffer_.resize((buffer_.size() + 3) & ~size_t(3)); // accessors start at multiples of their component size
  json accessor{{"bufferView", added(lists_->views, std::move(view))},
                {"componentType", kComponentType<T>},
                {"count", values.size() / components},
                {"type", kTypes[components]}};
  if (bounds) {
    std::vector<T> lo(values.begin(), values.begin() + components), hi = lo;
    for (size_t i = 0; i < values.size(); ++i) {
      lo[i % components] = std::min(lo[i % components], values[i]);
      hi[i % components] = std::max(hi[i % components], values[i]);
    }
    accessor["min"] = lo;
    accessor["max"] = hi;
  }
  return added(lists_->accessors, std::move(accessor));
}

Index SceneBuilder::texture(Texture texture) {
  CHECK_EQ(texture.rgba.size(), size_t(4) * texture.width * texture.height);
  textures_.push_back(std::move(texture));
  return Index(textures_.size() - 1);
}

Index SceneBuilder::material(const MaterialSpec& m) {
  json surface{{"metallicFactor", 0}, {"roughnessFactor", m.roughness == 1 ? json(1) : json(rounded(m.roughness))}};
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
  return added(lists_->materials, std::move(material));
}

Index SceneBuilder::mesh(const std::string& name, const Geometry& geometry, Index material) {
  CHECK_LT(0u, geometry.indices.size());
  json attributes{{"POSITION", accessor(flattened(geometry.positions), 3, kVertexBuffer, true)},
                  {"NORMAL", accessor(flattened(geometry.normals), 3, kVertexBuffer)}};
  if (!geometry.uvs.empty()) attributes["TEXCOORD_0"] = accessor(flattened(geometry.uvs), 2, kVertexBuffer);
  const bool narrow = *std::ranges::max_element(geometry.indices) < 65535; // 65535 restarts a primitive
  const Index indices =
      narrow ? accessor(std::vector<uint16_t>(geometry.indices.begin(), geometry.indices.end()), 1, kIndexBuffer)
             : accessor(geometry.indices, 1, kIndexBuffer);
  json primitive{{"attributes", std::move(attributes)}, {"indices", indices}, {"material", material}};
  meshTriangles_.push_back(geometry.indices.size() / 3);
  return added(lists_->meshes, {{"name", name}, {"primitives", json::array({std::move(primitive)})}});
}

Index SceneBuilder::variant(const std::string& name, Index mesh, Index material) {
  json copy = lists_->meshes.at(mesh);
  copy["name"] = name;
  copy["primitives"][0]["material"] = material;
  meshTriangles_.push_back(meshTriangles_[mesh]);
  return added(lists_->meshes, std::move(copy));
}

Index SceneBuilder::addNode(const std::string& name, const dvec3& at, const glm::dquat& rotation, json what) {
  what["name"] = name;
  if (at != dvec3(0)) what["translation"] = array(at);
  if (rotation != kUpright) what["rotation"] = array(rotation);
  return added(lists_->nodes, std::move(what));
}

Index SceneBuilder::place(const std::string& name, Index mesh, const dvec3& at, double turn) {
  placedTriangles_ += meshTriangles_.at(mesh);
  const glm::dquat rotation = turn == 0 ? kUpright : glm::angleAxis(glm::radians(turn), dvec3(0, 1, 0));
  return addNode(name, at, rotation, {{"mesh", mesh}});
}

Index SceneBuilder::place(const std::string& name, const Geometry& geometry, Index material, const dvec3& at) {
  return place(name, mesh(name, geometry, material), at);
}

Index SceneBuilder::addLight(const std::string& name, const char* type, const dvec3& color, double intensity,
                             const dvec3& at, const glm::dquat& rotation) {
  const Index light = added(
      lists_->lights, {{"name", name}, {"type", type}, {"color", array(color)}, {"intensity", rounded(intensity)}});
  return addNode(name, at, rotation, {{"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}});
}

Index SceneBuilder::lamp(const std::string& name, const dvec3& color, double intensity, const dvec3& at) {
  return addLight(name, "point", color, intensity, at, kUpright);
}

Index SceneBuilder::spot(const std::string& name, const dvec3& color, double intensity, const dvec3& at,
                         const dvec3& direction, double innerDegrees, double outerDegrees) {
  const Index node = addLight(name, "spot", color, intensity, at, facing(direction));
  lists_->lights.back()["spot"] = {{"innerConeAngle", rounded(glm::radians(innerDegrees))},
                                   {"outerConeAngle", rounded(glm::radians(outerDegrees))}};
  return node;
}

void SceneBuilder::sun(const dvec3& direction, const dvec3& color, double irradiance, double height,
                       const std::string& name) {
  addLight(name, "directional", color, irradiance, {0, height, 0}, facing(direction));
}

void SceneBuilder::camera(const std::string& name, const dvec3& eye, const dvec3& target, double fovYDegrees) {
  const Index camera =
      added(lists_->cameras, {{"name", name},
                              {"type", "perspective"},
                              {"perspective", {{"yfov", rounded(glm::radians(fovYDegrees))}, {"znear", 0.05}}}});
  addNode(name, eye, facing(target - eye), {{"camera", camera}});
}

void SceneBuilder::animate(Index node, double seconds, const std::function<dvec3(double)>& path) {
  constexpr int kKeys = 24;
  std::vector<float> times;
  std::vector<dvec3> places;
  for (int i = 0; i <= kKeys; ++i) {
    times.push_back(float(rounded(seconds * i / kKeys)));
    places.push_back(path(2 * glm::pi<double>() * i / kKeys));
  }
  const Index sampler = added(lists_->samplers, {{"input", accessor(times, 1, 0, true)},
                                                 {"output", accessor(flattened(places), 3)},
                                                 {"interpolation", "LINEAR"}});
  lists_->channels.push_back({{"sampler", sampler}, {"target", {{"node", node}, {"path", "translation"}}}});
}

GeneratedScene SceneBuilder::write() const {
  const auto& [folder, stem, size] = order_;
  json gltf{{"asset", {{"version", "2.0"}, {"generator", "lambent content"}}},
            {"scene", 0},
            {"accessors", lists_->accessors},
            {"bufferViews", lists_->views},
            {"buffers", json::array({{{"uri", stem + ".bin"}, {"byteLength", buffer_.size()}}})},
            {"materials", lists_->materials},
            {"meshes", lists_->meshes},
            {"nodes", lists_->nodes}};
  std::vector<Index> roots(lists_->nodes.size());
  for (Index i = 0; i < roots.size(); ++i) roots[i] = i;
  gltf["scenes"] = json::array({{{"name", stem}, {"nodes", roots}}});

  std::vector<std::string> extensions;
  if (emissiveStrength_) extensions.push_back("KHR_materials_emissive_strength");
  if (!lists_->lights.empty()) {
    extensions.push_back("KHR_lights_punctual");
    gltf["extensions"]["KHR_lights_punctual"]["lights"] = lists_->lights;
  }
  if (!extensions.empty()) gltf["extensionsUsed"] = extensions;
  if (!lists_->cameras.empty()) gltf["cameras"] = lists_->cameras;
  if (!lists_->channels.empty())
    gltf["animations"] =
        json::array({{{"name", stem}, {"channels", lists_->channels}, {"samplers", lists_->samplers}}});
  if (!textures_.empty()) {
    gltf["samplers"] = json::array({{{"magFilter", kLinear}, {"minFilter", kLinearMipmapLinear}}});
    gltf["images"] = gltf["textures"] = json::array();
    for (const Texture& t : textures_) {
      gltf["textures"].push_back({{"sampler", 0}, {"source", gltf["images"].size()}});
      gltf["images"].push_back({{"uri", t.name + ".png"}, {"name", t.name}});
    }
  }

  makeFolder(folder);
  refuseLinksIn(folder);
  GeneratedScene scene{folder / (stem + ".gltf"), placedTriangles_, 0, {}};
  const auto put = [&](const std::string& name, const std::string& bytes) {
    const std::filesystem::path file = folder / name;
    writeAtomically(file, [&](const std::filesystem::path& temporary) {
      if (!(std::ofstream(temporary, std::ios::binary) << bytes << std::flush))
        throw RunError(file.string() + ": cannot write (is the disk full?)");
    });
    scene.written.push_back(name);
    scene.bytes += bytes.size();
  };
  for (const Texture& t : textures_) put(t.name + ".png", encodePng(t));
  put(stem + ".bin", buffer_);
  put(stem + ".gltf", gltf.dump(1) + "\n"); // the file that refers to the others comes last
  return scene;
}

double hashed(uint32_t a, uint32_t b) { return double(mix64((uint64_t(b) << 32 | a) + 1) >> 11) * 0x1p-53; }

} // namespace lambent::content

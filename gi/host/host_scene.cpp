#include "gi/host/host_scene.h"

#include "engine/core/error.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

constexpr float kMostSide = 1e12f;      // of a mesh's box, m: products of two stay finite
constexpr int kMostTexels = 32768;      // a side
constexpr float kMostIntensity = 1e30f; // sums of light must stay finite
constexpr float kLeastVolume = 1e-12f;  // of a placement, over that of a box of its axes: less is flat

void refuse(const std::string& what, const std::string& why) { throw InputError(what, why); }

void requireFinite(const std::string& what, std::span<const vec3> values, float most) {
  for (size_t i = 0; i < values.size(); ++i)
    if (!isFinite(values[i]) || maxComponent(glm::abs(values[i])) > most)
      refuse(what, "number " + std::to_string(i) + " is not finite, or beyond " + std::to_string(most));
}

/// One unit normal a vertex: those given, where they have a length, else the mean of the triangles around, by area.
std::vector<vec3> normalsOf(std::span<const vec3> positions, std::span<const uvec3> triangles,
                            std::span<const vec3> given) {
  std::vector<vec3> normals(positions.size(), vec3(0));
  bool all = given.size() == positions.size();
  for (size_t i = 0; i < given.size(); ++i) {
    normals[i] = unitOr(given[i], vec3(0));
    all = all && normals[i] != vec3(0);
  }
  if (all) return normals;
  std::vector<vec3> sums(positions.size(), vec3(0));
  for (const uvec3& t : triangles) {
    const vec3 a = positions[t.x], cross = glm::cross(positions[t.y] - a, positions[t.z] - a);
    if (!isFinite(cross)) continue;
    for (int c = 0; c < 3; ++c) sums[t[c]] += cross;
  }
  for (size_t i = 0; i < normals.size(); ++i) {
    if (normals[i] == vec3(0)) normals[i] = unitOr(sums[i], {0, 1, 0});
  }
  return normals;
}

void requirePlacement(const mat4& m) {
  if (!isFinite(m) || m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0 || m[3][3] != 1)
    refuse("world_from_object", "is not finite and affine (columns one after the other, the last row 0 0 0 1)");
  const float box = glm::length(vec3(m[0])) * glm::length(vec3(m[1])) * glm::length(vec3(m[2]));
  if (!(std::abs(glm::determinant(mat3(m))) > kLeastVolume * box))
    refuse("world_from_object", "flattens its object, which then has no normals");
}

} // namespace

HostScene::HostScene() {
  Material& grey = assets_.materials.emplace_back(); // of meshes that name none
  grey.name = "grey";
  grey.baseColor = vec3(0.8f);
  materials_.push_back(true);
}

uint32_t HostScene::addTexture(TextureImage image) {
  if (image.width < 1 || image.height < 1 || image.width > kMostTexels || image.height > kMostTexels)
    refuse("texture", "has " + std::to_string(image.width) + "x" + std::to_string(image.height) + " texels (1 to " +
                          std::to_string(kMostTexels) + " each way)");
  CHECK_EQ(image.texels.size(), size_t(image.width) * size_t(image.height));
  measureTexels(image);
  assets_.readers.wait();
  assets_.images.push_back(std::move(image));
  textures_.push_back(true);
  ++assets_.revision;
  return uint32_t(assets_.images.size() - 1);
}

void HostScene::removeTexture(uint32_t texture) {
  if (!hasTexture(texture)) refuse("texture", "is not there");
  for (size_t i = 0; i < materials_.size(); ++i) {
    const Material& m = assets_.materials[i];
    if (materials_[i] && (m.baseColorTexture.image == texture || m.emissiveTexture.image == texture))
      refuse("texture", "is used by a material (destroy that first, or set another)");
  }
  assets_.readers.wait();
  assets_.images[texture] = {};
  textures_[texture] = false;
  ++assets_.revision;
  ++version_;
}

void HostScene::require(const Material& material) const {
  for (const TextureRef* t : {&material.baseColorTexture, &material.emissiveTexture})
    if (t->image != kNone && !hasTexture(t->image)) refuse("material", "names a texture that is not there");
  const auto within = [](const vec3& v, float most) {
    return isFinite(v) && std::min({v.x, v.y, v.z}) >= 0 && maxComponent(v) <= most;
  };
  if (!within(material.baseColor, 1)) refuse("material", "base_color is not within 0 and 1");
  if (!within(material.emission, kMostIntensity)) refuse("material", "emission is below 0, or not finite");
  if (!(material.alphaCutoff >= 0)) refuse("material", "alpha_cutoff is not a number above 0");
  if (!(material.alpha >= 0 && material.alpha <= 1)) refuse("material", "alpha is not within 0 and 1");
  for (const TextureRef* t : {&material.baseColorTexture, &material.emissiveTexture})
    for (int column = 0; column < 3; ++column)
      if (t->uvSet > 1 || !isFinite(t->uvTransform[column]))
        refuse("material", "base_uv or emission_uv is not finite, or names a set beyond 1");
}

uint32_t HostScene::addMaterial(const Material& material) {
  require(material);
  assets_.readers.wait();
  assets_.materials.push_back(material);
  materials_.push_back(true);
  ++assets_.revision;
  return uint32_t(assets_.materials.size() - 1);
}

void HostScene::setMaterial(uint32_t material, const Material& as) {
  if (!hasMaterial(material)) refuse("material", "is not there");
  require(as);
  assets_.readers.wait();
  assets_.materials[material] = as;
  assetsChanged();
}

void HostScene::removeMaterial(uint32_t material) {
  if (!hasMaterial(material)) refuse("material", "is not there");
  for (const Mesh& mesh : assets_.meshes)
    for (const Primitive& p : mesh.primitives)
      if (p.material == material) refuse("material", "is that of a mesh (destroy that first)");
  assets_.readers.wait();
  assets_.materials[material] = {};
  materials_[material] = false;
  ++assets_.revision;
  ++version_;
}

uint32_t HostScene::addMesh(const HostMesh& in) {
  const std::string which = in.name.empty() ? "mesh" : "mesh " + in.name;
  if (in.positions.empty() || in.triangles.empty()) refuse(which, "has no vertices, or no triangles");
  requireFinite(which + ", position", in.positions, kMostSide);
  for (size_t i = 0; i < in.triangles.size(); ++i)
    if (std::max({in.triangles[i].x, in.triangles[i].y, in.triangles[i].z}) >= in.positions.size())
      refuse(which, "triangle " + std::to_string(i) + " names a vertex beyond the last (" +
                        std::to_string(in.positions.size() - 1) + ")");
  Mesh mesh;
  mesh.name = in.name;
  mesh.positions.assign(in.positions.begin(), in.positions.end());
  mesh.triangles.assign(in.triangles.begin(), in.triangles.end());
  mesh.normals = normalsOf(in.positions, in.triangles, in.normals);
  mesh.uv0.assign(in.uvs.begin(), in.uvs.end());
  mesh.uv1.assign(in.uvs1.begin(), in.uvs1.end());
  mesh.colors.assign(in.colors.begin(), in.colors.end());
  for (const vec4& c : mesh.colors)
    if (!isFinite(vec3(c)) || !(std::min({c.x, c.y, c.z, c.w}) >= 0) || !(maxComponent(vec3(c)) <= 1))
      refuse(which, "a vertex colour is not within 0 and 1");
  const HostMesh::Part whole{0, uint32_t(in.triangles.size()), in.material};
  uint64_t covered = 0;
  for (const HostMesh::Part& part : in.parts.empty() ? std::span(&whole, 1) : in.parts) {
    if (part.firstTriangle != covered || part.triangleCount > in.triangles.size() - covered)
      refuse(which, "parts do not follow one another within its triangles");
    if (!hasMaterial(part.material)) refuse(which, "names a material that is not there");
    covered += part.triangleCount;
    Primitive& primitive = mesh.primitives.emplace_back();
    primitive.firstTriangle = part.firstTriangle;
    primitive.triangleCount = part.triangleCount;
    primitive.material = part.material;
    for (uint32_t t = 0; t < part.triangleCount; ++t)
      for (int c = 0; c < 3; ++c) primitive.boundsObject.add(mesh.positions[mesh.triangles[part.firstTriangle + t][c]]);
    mesh.boundsObject.add(primitive.boundsObject);
  }
  if (covered != in.triangles.size()) refuse(which, "has triangles that are of no part");
  constexpr float kFar = 64; // diameters
  if (maxComponent(glm::abs(mesh.boundsObject.centre())) > kFar * mesh.boundsObject.diameter()) countFromMiddle(mesh);
  assets_.readers.wait();
  assets_.meshes.push_back(std::move(mesh));
  meshes_.push_back(true);
  meshesCameOrWent();
  return uint32_t(assets_.meshes.size() - 1);
}

void HostScene::removeMesh(uint32_t mesh) {
  if (!hasMesh(mesh)) refuse("mesh", "is not there");
  for (const auto& [id, instance] : instances_)
    if (instance.mesh == mesh)
      refuse("mesh " + assets_.meshes[mesh].name, "is shown by an instance (destroy that first)");
  assets_.readers.wait();
  assets_.meshes[mesh] = {};
  meshes_[mesh] = false;
  meshesCameOrWent();
  ++version_;
}

uint32_t HostScene::addInstance(uint32_t mesh, const mat4& worldFromObject) {
  if (!hasMesh(mesh)) refuse("instance", "names a mesh that is not there");
  requirePlacement(worldFromObject);
  InstanceView v;
  v.id = nextInstance_;
  v.mesh = mesh;
  v.worldFromObject = mat4(placeFor(assets_.meshes[mesh], dmat4(worldFromObject)));
  instances_.emplace(nextInstance_, v);
  return nextInstance_++;
}

InstanceView& HostScene::at(uint32_t instance) {
  const auto found = instances_.find(instance);
  if (found == instances_.end()) refuse("instance", "is not there");
  return found->second;
}

void HostScene::moveInstance(uint32_t instance, const mat4& worldFromObject) {
  requirePlacement(worldFromObject);
  InstanceView& v = at(instance);
  v.worldFromObject = mat4(placeFor(assets_.meshes[v.mesh], dmat4(worldFromObject)));
}

void HostScene::deformInstance(uint32_t instance, std::span<const vec3> positions, std::span<const vec3> normals) {
  InstanceView& v = at(instance);
  if (positions.empty()) {
    v.deformed = nullptr;
    return;
  }
  const Mesh& mesh = assets_.meshes[v.mesh];
  const std::string which = "instance of mesh " + mesh.name;
  if (positions.size() != mesh.positions.size() || (!normals.empty() && normals.size() != positions.size()))
    refuse(which, "has " + std::to_string(positions.size()) + " vertices (" + std::to_string(mesh.positions.size()) +
                      ", as its mesh)");
  requireFinite(which + ", position", positions, kMostSide);
  const std::shared_ptr<DeformedMesh> shape = newShape();
  for (const vec3& p : positions) shape->positions.push_back(vec3(dvec3(p) - mesh.centre));
  shape->normals = normalsOf(positions, mesh.triangles, normals);
  for (const Primitive& primitive : mesh.primitives) {
    Aabb& box = shape->primitiveBoundsObject.emplace_back();
    for (uint32_t t = 0; t < primitive.triangleCount; ++t)
      for (int c = 0; c < 3; ++c) box.add(shape->positions[mesh.triangles[primitive.firstTriangle + t][c]]);
    shape->boundsObject.add(box);
  }
  v.deformed = shape;
}

void HostScene::removeInstance(uint32_t instance) {
  at(instance);
  instances_.erase(instance);
}

uint32_t HostScene::addLight(const LightView& light) {
  lights_.emplace(nextLight_, LightView());
  try {
    setLight(nextLight_, light);
  } catch (...) {
    lights_.erase(nextLight_);
    throw;
  }
  return nextLight_++;
}

void HostScene::setLight(uint32_t light, const LightView& as) {
  if (!isFinite(as.intensity) || std::min({as.intensity.x, as.intensity.y, as.intensity.z}) < 0 ||
      maxComponent(as.intensity) > kMostIntensity)
    refuse("light", "intensity is below 0, or not finite");
  if (!isNear(as.position)) refuse("light", "stands at no place within 1e12 m");
  if (!(as.range > 0)) refuse("light", "range is not above 0");
  vec3 direction = unitOr(as.direction, vec3(0));
  if (direction == vec3(0) && as.type != LightType::Point) refuse("light", "direction has no length");
  if (direction == vec3(0)) direction = {0, -1, 0};
  if (!(as.outerConeCos <= as.innerConeCos) || !(as.outerConeCos >= -1 && as.innerConeCos <= 1))
    refuse("light", "inner_cone_angle is not within 0 and outer_cone_angle, or that beyond π");
  if (!(as.angularRadius >= 0 && as.angularRadius <= 0.5f)) refuse("light", "angular_radius is not within 0 and 0.5");
  const auto found = lights_.find(light);
  if (found == lights_.end()) refuse("light", "is not there");
  found->second = as;
  found->second.direction = direction;
  found->second.id = light;
  found->second.changed = false;
}

void HostScene::removeLight(uint32_t light) {
  if (lights_.erase(light) == 0) refuse("light", "is not there");
}

SceneView HostScene::view(ViewChanges& changes, const CameraView& camera, double time) const {
  std::vector<InstanceView> instances;
  std::vector<LightView> lights;
  for (const auto& [id, instance] : instances_) instances.push_back(instance);
  for (const auto& [id, light] : lights_) lights.push_back(light);
  return changes.take(assets_, std::move(instances), std::move(lights), sky_, camera, time);
}

uint64_t HostScene::bytes() const {
  uint64_t sum = bytesOf(assets_);
  for (const auto& [id, v] : instances_) {
    sum += sizeof(InstanceView);
    if (v.deformed) sum += 2 * v.deformed->positions.size() * sizeof(vec3);
  }
  return sum;
}

} // namespace lambent

#include "tests/support/hand_scene.h"

#include <algorithm>

namespace lambent::test {

uint32_t HandScene::material(const vec3& albedo, const vec3& emission, bool doubleSided) {
  Material& m = assets.materials.emplace_back();
  m.baseColor = albedo;
  m.emission = emission;
  m.doubleSided = doubleSided;
  return uint32_t(assets.materials.size() - 1);
}

uint32_t HandScene::glossyMaterial(const vec3& albedo, float roughness, float metalness) {
  const uint32_t index = material(albedo);
  assets.materials[index].roughness = roughness;
  assets.materials[index].metalness = metalness;
  return index;
}

uint32_t HandScene::lattice() {
  const uint32_t index = material(vec3(1));
  assets.materials[index].alphaMode = AlphaMode::Mask;
  assets.materials[index].baseColorTexture = texture(2, {{255, 0, 0, 0}, {0, 255, 0, 255}});
  return index;
}

TextureRef HandScene::texture(int width, std::vector<u8vec4> texels, bool srgb) {
  TextureImage& image = assets.images.emplace_back();
  image.width = width;
  image.height = int(texels.size()) / width;
  image.srgb = srgb;
  image.texels = std::move(texels);
  measureTexels(image);
  return {.image = uint32_t(assets.images.size() - 1), .nearest = true};
}

void HandScene::normalMap(uint32_t materialIndex, const vec3& local) {
  const vec3 texel = glm::round((glm::normalize(local) * 0.5f + 0.5f) * 255.0f);
  assets.materials[materialIndex].normalTexture = texture(1, {u8vec4(vec4(texel, 255))}, false);
}

bool HandScene::normalMapped() const {
  return std::ranges::any_of(assets.materials, [](const Material& m) { return m.normalTexture.image != kNone; });
}

uint32_t HandScene::quad(const vec3& corner, const vec3& e1, const vec3& e2, uint32_t materialIndex) {
  Mesh mesh;
  const vec3 n = glm::normalize(glm::cross(e1, e2));
  mesh.positions = {corner, corner + e1, corner + e1 + e2, corner + e2};
  mesh.normals.assign(4, n);
  mesh.uv0 = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  // v runs downwards in a texture, here along e2: the bitangent is against that.
  if (assets.materials[materialIndex].normalTexture.image != kNone)
    mesh.tangents.assign(4, vec4(glm::normalize(e1), -1));
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  for (const vec3& p : mesh.positions) mesh.boundsObject.add(p);
  mesh.primitives.push_back({0, 2, materialIndex, mesh.boundsObject});
  return add(std::move(mesh));
}

void HandScene::box(const vec3& lo, const vec3& hi, uint32_t materialIndex, bool inward) {
  const vec3 d = hi - lo, x(d.x, 0, 0), y(0, d.y, 0), z(0, 0, d.z);
  const auto face = [&](const vec3& c, const vec3& a, const vec3& b) {
    inward ? quad(c, b, a, materialIndex) : quad(c, a, b, materialIndex);
  };
  face(lo, z, y);     // −x
  face(lo + x, y, z); // +x
  face(lo, x, z);     // −y
  face(lo + y, z, x); // +y
  face(lo, y, x);     // −z
  face(lo + z, x, y); // +z
}

uint32_t HandScene::add(Mesh mesh, const mat4& worldFromObject) {
  assets.meshes.push_back(std::move(mesh));
  return instance(uint32_t(assets.meshes.size() - 1), worldFromObject);
}

uint32_t HandScene::instance(uint32_t mesh, const mat4& worldFromObject) {
  InstanceView& i = instances.emplace_back();
  i.id = uint32_t(instances.size() - 1);
  i.mesh = mesh;
  i.worldFromObject = i.worldFromObjectBefore = worldFromObject;
  i.boundsWorld = transformed(assets.meshes[mesh].boundsObject, worldFromObject);
  return i.id;
}

void HandScene::place(uint32_t index, const mat4& worldFromObject) {
  InstanceView& i = instances[index];
  i.worldFromObjectBefore = i.worldFromObject;
  i.boundsWorldBefore = i.boundsWorld;
  i.worldFromObject = worldFromObject;
  i.boundsWorld = transformed(assets.meshes[i.mesh].boundsObject, worldFromObject);
  i.moved = true;
}

void HandScene::move(uint32_t first, const vec3& by, uint32_t end) {
  for (InstanceView& i : instances) i.moved = false;
  for (uint32_t k = first; k < std::min(end, uint32_t(instances.size())); ++k) {
    mat4 to = instances[k].worldFromObject;
    to[3] += vec4(by, 0);
    place(k, to);
  }
}

void HandScene::turn(const mat4& turned) {
  for (InstanceView& i : instances) {
    i.worldFromObject = i.worldFromObjectBefore = turned * i.worldFromObject;
    i.boundsWorld = transformed(assets.meshes[i.mesh].boundsObject, i.worldFromObject);
  }
}

void HandScene::reshape(uint32_t index, std::vector<vec3> positions) {
  InstanceView& i = instances[index];
  const Mesh& mesh = assets.meshes[i.mesh];
  const auto made = std::make_shared<DeformedMesh>();
  DeformedMesh& shape = *made;
  shape.revision = ++lastRevision_;
  shape.positions = std::move(positions);
  shape.normals.assign(shape.positions.size(), vec3(0));
  for (const Primitive& primitive : mesh.primitives) {
    Aabb& box = shape.primitiveBoundsObject.emplace_back();
    for (uint32_t t = 0; t < primitive.triangleCount; ++t) {
      const uvec3 v = mesh.triangles[primitive.firstTriangle + t];
      const std::vector<vec3>& p = shape.positions;
      for (int c = 0; c < 3; ++c) box.add(p[v[c]]), shape.normals[v[c]] += glm::cross(p[v.y] - p[v.x], p[v.z] - p[v.x]);
    }
    shape.boundsObject.add(box);
  }
  for (vec3& n : shape.normals) n = glm::normalize(n);
  i.reshaped = i.moved = true;
  i.deformed = made;
  i.boundsWorldBefore = i.boundsWorld;
  i.boundsWorld = transformed(shape.boundsObject, i.worldFromObject);
}

LightView& HandScene::lamp(const vec3& position, const vec3& intensity) {
  LightView& light = lights.emplace_back();
  light.position = position;
  light.intensity = intensity;
  return light;
}

SceneView HandScene::view(const SceneChanges& changes) const {
  SceneView v;
  v.assets = &assets;
  v.instances = instances;
  v.lights = lights;
  v.sky = sky;
  v.camera = camera;
  v.changes = changes;
  for (const InstanceView& i : instances) v.boundsWorld.add(i.boundsWorld);
  return v;
}

Mesh sheet(uint32_t n, uint32_t material) {
  Mesh mesh;
  for (uint32_t y = 0; y <= n; ++y)
    for (uint32_t x = 0; x <= n; ++x) {
      mesh.positions.push_back(vec3(vec2(x, y) * (2.0f / float(n)) - 1.0f, 0));
      mesh.uv0.push_back(vec2(x, y) / float(n));
    }
  mesh.normals.assign(mesh.positions.size(), vec3(0, 0, 1));
  for (uint32_t y = 0; y < n; ++y)
    for (uint32_t x = 0; x < n; ++x) {
      const uint32_t a = y * (n + 1) + x, b = a + n + 1;
      mesh.triangles.insert(mesh.triangles.end(), {uvec3(a, a + 1, b + 1), uvec3(a, b + 1, b)});
    }
  for (const vec3& p : mesh.positions) mesh.boundsObject.add(p);
  mesh.primitives.push_back({0, uint32_t(mesh.triangles.size()), material, mesh.boundsObject});
  return mesh;
}

Mesh block(const vec3& halfSize, uint32_t material) {
  Mesh mesh;
  for (int face = 0; face < 6; ++face) {
    vec3 out(0), s(0), t(0);
    const int a = face / 2;
    out[a] = face % 2 ? 1.0f : -1.0f;
    s[(a + 1) % 3] = 1;
    t = glm::cross(out, s);
    const uint32_t first = uint32_t(mesh.positions.size());
    for (const vec3& p : {out - s - t, out + s - t, out + s + t, out - s + t}) mesh.positions.push_back(p * halfSize);
    mesh.normals.insert(mesh.normals.end(), 4, out);
    mesh.uv0.insert(mesh.uv0.end(), {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
    mesh.triangles.insert(mesh.triangles.end(),
                          {uvec3(first, first + 1, first + 2), uvec3(first, first + 2, first + 3)});
  }
  mesh.boundsObject = {-halfSize, halfSize};
  mesh.primitives.push_back({0, 12, material, mesh.boundsObject, true});
  return mesh;
}

std::vector<vec3> waves(const Mesh& sheet, float height, float phase) {
  std::vector<vec3> positions = sheet.positions;
  for (vec3& p : positions) {
    const vec2 at(p);
    p.z += height * std::sin(4 * at.x + 2 * at.y + phase);
    p.x += 0.3f * height * std::cos(5 * at.y + phase);
  }
  return positions;
}

CameraView cameraAt(const vec3& eye, const vec3& target, float fovY, int width, int height) {
  CameraView camera;
  const vec3 back = glm::normalize(eye - target);
  const vec3 right = glm::normalize(glm::cross(std::abs(back.y) > 0.999f ? vec3(0, 0, -1) : vec3(0, 1, 0), back));
  camera.worldFromView = mat4(vec4(right, 0), vec4(glm::cross(back, right), 0), vec4(back, 0), vec4(eye, 1));
  camera.fovY = fovY;
  camera.width = width;
  camera.height = height;
  return camera;
}

} // namespace lambent::test

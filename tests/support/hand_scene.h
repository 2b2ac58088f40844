// Small scenes made by hand: quads with a material each, one mesh and one instance per quad or group.
#pragma once

#include "engine/scene/scene_view.h"

#include <vector>

namespace lambent::test {

/// Owns what a SceneView points to.
class HandScene {
 public:
  HandScene() = default;
  HandScene(const HandScene&) = delete;

  uint32_t material(const vec3& albedo, const vec3& emission = vec3(0), bool doubleSided = false) {
    Material m;
    m.baseColor = albedo;
    m.emission = emission;
    m.doubleSided = doubleSided;
    assets.materials.push_back(m);
    return uint32_t(assets.materials.size() - 1);
  }

  /// Parallelogram with front side cross(e1, e2); returns the instance.
  uint32_t quad(const vec3& corner, const vec3& e1, const vec3& e2, uint32_t materialIndex) {
    Mesh mesh;
    const vec3 n = glm::normalize(glm::cross(e1, e2));
    mesh.positions = {corner, corner + e1, corner + e1 + e2, corner + e2};
    mesh.normals.assign(4, n);
    mesh.uv0 = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    for (const vec3& p : mesh.positions) mesh.boundsObject.add(p);
    mesh.primitives.push_back({0, 2, materialIndex, mesh.boundsObject});
    assets.meshes.push_back(std::move(mesh));
    return instance(uint32_t(assets.meshes.size() - 1), mat4(1));
  }

  /// Box seen from inside when `inward`: the front sides face in. One quad (instance) per face.
  void box(const vec3& lo, const vec3& hi, uint32_t materialIndex, bool inward) {
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

  uint32_t instance(uint32_t mesh, const mat4& worldFromObject) {
    InstanceView i;
    i.id = uint32_t(instances.size());
    i.mesh = mesh;
    i.worldFromObject = i.worldFromObjectBefore = worldFromObject;
    i.boundsWorld = transformed(assets.meshes[mesh].boundsObject, worldFromObject);
    instances.push_back(i);
    return uint32_t(instances.size() - 1);
  }

  SceneView view() const {
    SceneView v;
    v.assets = &assets;
    v.instances = instances;
    v.lights = lights;
    v.skyRadiance = sky;
    v.camera = camera;
    for (const InstanceView& i : instances) v.boundsWorld.add(i.boundsWorld);
    return v;
  }

  SceneAssets assets;
  std::vector<InstanceView> instances;
  std::vector<LightView> lights;
  vec3 sky{0};
  CameraView camera;
};

} // namespace lambent::test

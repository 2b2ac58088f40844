// Small scenes made by hand: quads with a material each, one mesh and one instance per quad or group.
#pragma once

#include "engine/scene/scene_view.h"

#include <cmath>
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

  /// Gives the instance vertices of its own; normals are the means of the triangles around them.
  void reshape(uint32_t index, std::vector<vec3> positions) {
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
        for (int c = 0; c < 3; ++c)
          box.add(p[v[c]]), shape.normals[v[c]] += glm::cross(p[v.y] - p[v.x], p[v.z] - p[v.x]);
      }
      shape.boundsObject.add(box);
    }
    for (vec3& n : shape.normals) n = glm::normalize(n);
    i.reshaped = i.moved = true;
    i.deformed = made;
    i.boundsWorldBefore = i.boundsWorld;
    i.boundsWorld = transformed(shape.boundsObject, i.worldFromObject);
  }

  SceneView view() const {
    SceneView v;
    v.assets = &assets;
    v.instances = instances;
    v.lights = lights;
    v.sky = sky;
    v.camera = camera;
    for (const InstanceView& i : instances) v.boundsWorld.add(i.boundsWorld);
    return v;
  }

  SceneAssets assets;
  std::vector<InstanceView> instances;
  std::vector<LightView> lights;
  Sky sky;
  CameraView camera;

 private:
  uint64_t lastRevision_ = 0;
};

/// A sheet of n × n quads over [-1,1]² at z = 0, front +z.
inline Mesh sheet(uint32_t n, uint32_t material) {
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

/// A closed box around the origin, front sides out, each face with vertices of its own.
inline Mesh block(const vec3& halfSize, uint32_t material) {
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

/// The sheet's vertices with waves of `height` across them, and `phase` along these, radians.
inline std::vector<vec3> waves(const Mesh& sheet, float height, float phase) {
  std::vector<vec3> positions = sheet.positions;
  for (vec3& p : positions) {
    const vec2 at(p);
    p.z += height * std::sin(4 * at.x + 2 * at.y + phase);
    p.x += 0.3f * height * std::cos(5 * at.y + phase);
  }
  return positions;
}

} // namespace lambent::test

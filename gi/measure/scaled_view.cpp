#include "gi/measure/scaled_view.h"

#include "engine/core/error.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

namespace lambent {

namespace {

bool mayDeform(const Mesh& mesh) { return !mesh.jointSets.empty() || !mesh.morphTargets.empty(); }

/// The mesh's arrays of what a vertex has, each with each: fn(from's array, to's array).
template <class Fn> void eachAttribute(const Mesh& from, Mesh& to, Fn&& fn) {
  fn(from.positions, to.positions);
  fn(from.normals, to.normals);
  fn(from.uv0, to.uv0);
  fn(from.uv1, to.uv1);
  fn(from.colors, to.colors);
  fn(from.tangents, to.tangents);
}

/// One triangle's n² triangles, appended. A point of an edge is the same number for number from both sides of it: its
/// two terms are those of the ends, and addition commutes.
void cut(const Mesh& from, const uvec3& corners, uint32_t n, Mesh& to) {
  const uint32_t first = uint32_t(to.positions.size());
  const auto index = [&](uint32_t i, uint32_t j) { return first + i * (i + 1) / 2 + j; }; // row i from the first corner
  for (uint32_t i = 0; i <= n; ++i)
    for (uint32_t j = 0; j <= i; ++j) {
      const float a = float(n - i), b = float(i - j), c = float(j);
      eachAttribute(from, to, [&](const auto& values, auto& out) {
        if (!values.empty())
          out.push_back((values[corners.x] * a + values[corners.y] * b + values[corners.z] * c) / float(n));
      });
      const vec3 normal = to.normals.back();
      const float length = glm::length(normal);
      to.normals.back() = length > 0 ? normal / length : from.normals[corners.x];
    }
  for (uint32_t i = 0; i < n; ++i)
    for (uint32_t j = 0; j <= i; ++j) {
      to.triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
      if (j < i) to.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
    }
}

Mesh tessellated(const Mesh& mesh, uint32_t n) {
  Mesh out;
  out.name = mesh.name;
  out.boundsObject = mesh.boundsObject;
  out.primitives = mesh.primitives;
  for (const uvec3& corners : mesh.triangles) cut(mesh, corners, n, out);
  for (Primitive& p : out.primitives) p.firstTriangle *= n * n, p.triangleCount *= n * n;
  return out;
}

/// Of each primitive the part'th of `parts` equal runs of its triangles in the order given; none where that is empty.
Mesh piece(const Mesh& mesh, const std::vector<uint32_t>& order, uint32_t part, uint32_t parts) {
  Mesh out;
  out.name = mesh.name;
  std::vector<uint32_t> places(mesh.positions.size(), kNone);
  for (const Primitive& primitive : mesh.primitives) {
    const auto bound = [&](uint32_t k) { return uint32_t(uint64_t(primitive.triangleCount) * k / parts); };
    Primitive run = primitive;
    run.firstTriangle = uint32_t(out.triangles.size());
    run.triangleCount = bound(part + 1) - bound(part);
    run.boundsObject = {};
    if (run.triangleCount == 0) continue;
    for (uint32_t t = bound(part); t < bound(part + 1); ++t) {
      uvec3 triangle = mesh.triangles[order[primitive.firstTriangle + t]];
      for (int c = 0; c < 3; ++c) {
        uint32_t& place = places[triangle[c]];
        if (place == kNone) {
          place = uint32_t(out.positions.size());
          eachAttribute(mesh, out, [&](const auto& values, auto& to) {
            if (!values.empty()) to.push_back(values[triangle[c]]);
          });
        }
        triangle[c] = place;
        run.boundsObject.add(out.positions[place]);
      }
      out.triangles.push_back(triangle);
    }
    out.boundsObject.add(run.boundsObject);
    out.primitives.push_back(run);
  }
  return out;
}

/// Triangles of each primitive along the mesh's longest side.
std::vector<uint32_t> orderOf(const Mesh& mesh) {
  const vec3 size = mesh.boundsObject.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::vector<float> at;
  for (const uvec3& t : mesh.triangles)
    at.push_back(mesh.positions[t.x][axis] + mesh.positions[t.y][axis] + mesh.positions[t.z][axis]);
  std::vector<uint32_t> order(mesh.triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  for (const Primitive& p : mesh.primitives)
    std::stable_sort(order.begin() + p.firstTriangle, order.begin() + p.firstTriangle + p.triangleCount,
                     [&](uint32_t a, uint32_t b) { return at[a] < at[b]; });
  return order;
}

SceneAssets withoutMeshes(const SceneAssets& assets) {
  SceneAssets out;
  out.materials = assets.materials;
  out.images = assets.images;
  return out;
}

} // namespace

SceneAssets tessellated(const SceneAssets& assets, uint32_t n) {
  CHECK(n > 0);
  SceneAssets out = withoutMeshes(assets);
  for (const Mesh& mesh : assets.meshes) out.meshes.push_back(n == 1 || mayDeform(mesh) ? mesh : tessellated(mesh, n));
  return out;
}

Pieces inPieces(const SceneAssets& assets, uint32_t parts) {
  CHECK(parts > 0);
  Pieces out{withoutMeshes(assets), {}};
  for (const Mesh& mesh : assets.meshes) {
    std::vector<uint32_t>& of = out.of.emplace_back();
    const auto add = [&](Mesh part) {
      of.push_back(uint32_t(out.assets.meshes.size()));
      out.assets.meshes.push_back(std::move(part));
    };
    if (parts == 1 || mayDeform(mesh)) {
      add(mesh);
      continue;
    }
    const std::vector<uint32_t> order = orderOf(mesh);
    for (uint32_t k = 0; k < parts; ++k)
      if (Mesh part = piece(mesh, order, k, parts); !part.triangles.empty()) add(std::move(part));
  }
  return out;
}

size_t trianglesOf(const SceneView& view) {
  size_t count = 0;
  for (const InstanceView& i : view.instances) count += view.assets->meshes[i.mesh].triangles.size();
  return count;
}

ScaledView splitLights(uint32_t count) {
  return [count, lights = std::vector<LightView>()](SceneView view) mutable {
    lights.clear();
    for (const LightView& light : view.lights)
      for (uint32_t k = 0; k < count; ++k) {
        LightView& part = lights.emplace_back(light);
        part.id = uint32_t(lights.size());
        part.intensity = light.intensity / float(count);
      }
    view.lights = lights;
    return view;
  };
}

ScaledView splitInstances(const SceneAssets& assets, uint32_t parts) {
  const auto pieces = std::make_shared<const Pieces>(inPieces(assets, parts));
  return [pieces, instances = std::vector<InstanceView>()](SceneView view) mutable {
    instances.clear();
    for (const InstanceView& whole : view.instances)
      for (uint32_t mesh : pieces->of[whole.mesh]) {
        InstanceView& part = instances.emplace_back(whole);
        part.id = uint32_t(instances.size());
        part.mesh = mesh;
        if (whole.deformed) continue;
        const Aabb& box = pieces->assets.meshes[mesh].boundsObject;
        part.boundsWorld = transformed(box, whole.worldFromObject);
        part.boundsWorldBefore = transformed(box, whole.worldFromObjectBefore);
      }
    view.instances = instances;
    view.assets = &pieces->assets;
    return view;
  };
}

ScaledView splitTriangles(const SceneAssets& assets, uint32_t n) {
  return [cut = std::make_shared<const SceneAssets>(tessellated(assets, n))](SceneView view) {
    view.assets = cut.get();
    return view;
  };
}

ScaledView resizedImage(float side) {
  return [side](SceneView view) {
    view.camera = view.camera.scaled(side);
    return view;
  };
}

SceneView unsteady(SceneView view, int frame, std::vector<LightView>& lights) {
  constexpr float kShare = 1e-4f;
  lights.assign(view.lights.begin(), view.lights.end());
  for (LightView& light : lights) {
    const vec3 aside = frame % 2 == 0 ? vec3(0) : vec3(kShare, 0, kShare);
    light.position += view.boundsWorld.diameter() * aside;
    if (light.type == LightType::Directional) light.direction = glm::normalize(light.direction + aside);
    light.changed = true;
  }
  view.lights = lights;
  view.changes.lights = true;
  return view;
}

} // namespace lambent

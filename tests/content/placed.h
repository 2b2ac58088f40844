// A generated scene as a list of triangles in world space, double precision, and rays against all of them. Small enough
// that no acceleration structure is needed.
#pragma once

#include "engine/scene/scene.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <vector>

namespace lambent {

using glm::dvec2;
using glm::dvec3;

struct PlacedTriangle {
  std::array<dvec3, 3> corner;
  dvec3 normal{0};       // unit, outwards
  uint32_t material = 0; // index into SceneAssets::materials
  uint32_t mesh = 0;
  bool sheet = false; // of an open surface: cloth, lattice or emitter
};

/// Distance to the triangle's plane crossing in units of `direction`, infinite when the ray passes by.
inline double meets(const PlacedTriangle& t, const dvec3& origin, const dvec3& direction) {
  // Möller and Trumbore: solves origin + s·direction = corner0 + u·e1 + v·e2.
  constexpr double kNothing = std::numeric_limits<double>::infinity();
  const dvec3 e1 = t.corner[1] - t.corner[0], e2 = t.corner[2] - t.corner[0];
  const dvec3 p = glm::cross(direction, e2);
  const double determinant = glm::dot(e1, p);
  if (determinant == 0) return kNothing;
  const dvec3 from = origin - t.corner[0];
  const double u = glm::dot(from, p) / determinant;
  if (u < 0 || u > 1) return kNothing;
  const dvec3 q = glm::cross(from, e1);
  const double v = glm::dot(direction, q) / determinant;
  if (v < 0 || u + v > 1) return kNothing;
  const double s = glm::dot(e2, q) / determinant;
  return s > 0 ? s : kNothing;
}

class PlacedScene {
 public:
  /// Meshes at their present transforms.
  explicit PlacedScene(const Scene& scene) {
    for (const Mesh& m : scene.assets.meshes) meshNames_.push_back(m.name);
    SceneExtractor extractor;
    const SceneView view = extractor.extract(scene, {}, 0);
    for (const InstanceView& instance : view.instances) {
      const Mesh& mesh = scene.assets.meshes[instance.mesh];
      for (const Primitive& primitive : mesh.primitives) {
        const Material& material = scene.assets.materials[primitive.material];
        const bool sheet = material.doubleSided || material.emits();
        for (uint32_t i = 0; i < primitive.triangleCount; ++i) {
          PlacedTriangle t{{}, dvec3(0), primitive.material, instance.mesh, sheet};
          for (int k = 0; k < 3; ++k) {
            const vec3& p = mesh.positions[mesh.triangles[primitive.firstTriangle + i][k]];
            t.corner[size_t(k)] = dvec3(glm::dmat4(instance.worldFromObject) * glm::dvec4(p, 1));
          }
          t.normal = glm::normalize(glm::cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]));
          triangles_.push_back(t);
        }
      }
    }
  }

  const std::vector<PlacedTriangle>& triangles() const { return triangles_; }
  const std::string& meshName(const PlacedTriangle& t) const { return meshNames_[t.mesh]; }

  /// To the first surface along the ray, in units of its direction; infinite when there is none.
  double distance(const dvec3& origin, const dvec3& direction) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const PlacedTriangle& t : triangles_) nearest = std::min(nearest, meets(t, origin, direction));
    return nearest;
  }
  /// Nothing lies between the two points.
  bool see(const dvec3& a, const dvec3& b) const { return distance(a, b - a) > 1; }
  /// The point lies in a solid. Counts how many more solids a ray from it leaves than enters, so solids may overlap.
  bool inSolid(const dvec3& point) const {
    // In no plane and through no edge that the recipes make: they are axis-parallel or at simple fractions of a turn.
    const dvec3 direction(0.2763914, 0.8371265, 0.4719283);
    int left = 0; // minus entered
    for (const PlacedTriangle& t : triangles_)
      if (!t.sheet && meets(t, point, direction) < std::numeric_limits<double>::infinity())
        left += glm::dot(t.normal, direction) > 0 ? 1 : -1;
    return left > 0;
  }

 private:
  std::vector<PlacedTriangle> triangles_;
  std::vector<std::string> meshNames_;
};

} // namespace lambent

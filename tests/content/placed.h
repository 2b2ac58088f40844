// A generated scene as a list of triangles in world space, double precision, and rays against all of them. Small enough
// that no acceleration structure is needed.
#pragma once

#include "engine/scene/scene.h"

#include <array>
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

class PlacedScene {
 public:
  /// Meshes at their present transforms.
  explicit PlacedScene(const Scene& scene);

  const std::vector<PlacedTriangle>& triangles() const { return triangles_; }
  const std::string& meshName(const PlacedTriangle& t) const { return meshNames_[t.mesh]; }

  /// To the first surface along the ray, in units of its direction; infinite when there is none.
  double distance(const dvec3& origin, const dvec3& direction) const;
  /// Nothing lies between the two points.
  bool see(const dvec3& a, const dvec3& b) const { return distance(a, b - a) > 1; }
  /// The point lies in a solid. Counts how many more solids a ray from it leaves than enters, so solids may overlap.
  bool inSolid(const dvec3& point) const;

 private:
  std::vector<PlacedTriangle> triangles_;
  std::vector<std::string> meshNames_;
};

} // namespace lambent

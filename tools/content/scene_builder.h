// What the larger recipes share: placing meshes, lamps and cameras by name.
#pragma once

#include "tools/content/gltf_writer.h"

namespace lambent::content {

/// Every large scene comes in two sizes of one plan: Full, 250 000 to 550 000 placed triangles (60 000 to 120 000 where
/// they are mostly thin sheets), and Small, at most 30 000, with fewer parts and coarser meshes, for tests.
enum class SceneSize { Full, Small };

class SceneBuilder {
 public:
  Index mesh(const std::string& name, const Geometry& geometry, Index material) {
    return gltf.addMesh(name, geometry, material);
  }
  /// Places a mesh, turned around the vertical axis first (degrees, counter-clockwise from above).
  Index place(const std::string& name, Index mesh, const dvec3& at, double turn = 0);
  /// Places a mesh of its own.
  Index place(const std::string& name, const Geometry& geometry, Index material, const dvec3& at = dvec3(0));
  Index paint(const std::string& name, const dvec3& albedo) {
    return gltf.addMaterial({.name = name, .albedo = albedo});
  }
  Index fabric(const std::string& name, const dvec3& albedo) {
    return gltf.addMaterial({.name = name, .albedo = albedo, .doubleSided = true});
  }
  /// `intensity` in W/sr where the colour is 1.
  Index lamp(const std::string& name, const dvec3& color, double intensity, const dvec3& at);
  /// A spot of 90° full opening, its edge softened over the last 5° of the half angle; `intensity` as for `lamp`.
  Index spot(const std::string& name, const dvec3& color, double intensity, const dvec3& at, const dvec3& direction);
  void sun(const dvec3& direction, const dvec3& color, double irradiance);
  void camera(const std::string& name, const dvec3& eye, const dvec3& target, double fovYDegrees = 60);

  GltfWriter gltf;
};

/// Uniform in [0, 1), a function of its arguments alone: stands in for chance, so that every run gives the same scene.
double hashed(uint32_t a, uint32_t b = 0);

} // namespace lambent::content

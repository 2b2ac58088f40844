// RayQuery over boxes, spheres and planes with closed-form intersections: for tests that need neither Embree nor files.
#pragma once

#include "engine/trace/ray_query.h"

namespace lambent {

class AnalyticQuery final : public RayQuery {
 public:
  /// What a shape looks like; `emission` leaves its outer side, or its inner side when `inward`.
  struct Look {
    vec3 albedo{0.5f};
    vec3 emission{0};
    bool inward = false; // emission on the inside (closed rooms)
  };

  /// Each returns the shape's index, which hits carry as `instance`. Triangle numbers: 0, or the face (−x,+x,−y,…) of a
  /// box.
  uint32_t addBox(const vec3& lo, const vec3& hi, const Look& look) { return add({Kind::Box, lo, hi, look}); }
  uint32_t addSphere(const vec3& centre, float radius, const Look& look) {
    return add({Kind::Sphere, centre, vec3(radius), look});
  }
  /// The plane through `point` with unit `normal`; emission on the normal's side.
  uint32_t addPlane(const vec3& point, const vec3& normal, const Look& look) {
    return add({Kind::Plane, point, normal, look});
  }

  void closest(std::span<const Ray> rays, std::span<SurfaceHit> hits) const override;
  void seen(std::span<const Ray> rays, std::span<SurfaceHit> hits) const override { closest(rays, hits); }
  void distances(std::span<const Ray> rays, std::span<float> t) const override;
  void occluded(std::span<const Ray> rays, std::span<uint8_t> blocked) const override;
  using RayQuery::closest;
  using RayQuery::occluded;
  using RayQuery::seen;

 private:
  enum class Kind { Box, Sphere, Plane };
  struct Shape {
    Kind kind;
    vec3 a, b; // box: corners; sphere: centre and (radius,·,·); plane: point and normal
    Look look;
  };
  struct Meeting {
    float t = kInfinity;
    vec3 outward{0};
    uint32_t face = 0;
  };
  uint32_t add(const Shape& shape);
  static Meeting meet(const Shape& shape, const Ray& ray);

  std::vector<Shape> shapes_;
};

} // namespace lambent

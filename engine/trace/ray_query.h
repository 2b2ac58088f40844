// Rays against the scene. One abstract type, two makers: Embree (embree_query.h) and analytic shapes for
// tests (analytic_query.h). All calls are const, thread-safe, serial inside (callers run blocks in parallel) and
// deterministic.
#pragma once

#include "engine/core/math.h"
#include "engine/view/scene_view.h"

#include <span>
#include <vector>

namespace lambent {

/// A half line or segment, world space; direction need not be unit when tMax bounds it (t is in units of direction).
struct Ray {
  vec3 origin{0};
  vec3 direction{0, 0, 1};
  float tMax = kInfinity;
  uint32_t key = 0; // of chances of meeting what is blended (shaders/shared/coverage.h); 0: by its own bits
};

/// Says whether a ray can be traced: others meet nothing.
inline bool traceable(const Ray& r) { return isFinite(r.origin) && isFinite(r.direction) && r.tMax > 0; }

/// What a ray met. `normal` is the shading normal and `geometricNormal` the triangle's, both unit and both turned to
/// the side the ray came from. `emission` is what this side emits (zero on the back of a single-sided emitter).
struct SurfaceHit {
  float t = kInfinity; // kInfinity: nothing met, the rest is unset
  vec3 position{0};
  vec3 normal{0};
  vec3 geometricNormal{0};
  vec3 albedo{0};
  vec3 emission{0};
  uint32_t instance = kNone; // index into SceneView::instances
  uint32_t primitive = 0;    // of the instance's mesh
  uint32_t triangle = 0;     // within the primitive
  vec2 barycentric{0};       // weights of the triangle's second and third corner
  float share = 1;           // of rays that meet the surface here: below 1 where it blends

  bool valid() const { return t < kInfinity; }
};

/// Rays of one stage, for the frame log.
struct RayCounts {
  uint64_t closest = 0, occlusion = 0;
  RayCounts& operator+=(const RayCounts& o) {
    closest += o.closest;
    occlusion += o.occlusion;
    return *this;
  }
};

class RayQuery {
 public:
  virtual ~RayQuery() = default;

  /// Finds closest hits; hits.size() == rays.size(). Coherent neighbours are traced faster. NaN rays count as misses.
  virtual void closest(std::span<const Ray> rays, std::span<SurfaceHit> hits) const = 0;
  /// Finds what an eye sees along rays: as closest(), but through the backs of materials that hide theirs.
  virtual void seen(std::span<const Ray> rays, std::span<SurfaceHit> hits) const = 0;
  /// Finds distances only, in units of each ray's direction, kInfinity where nothing is met.
  virtual void distances(std::span<const Ray> rays, std::span<float> t) const = 0;
  /// Sets `blocked` to 1 where something lies on the segment (0, tMax), else to 0.
  virtual void occluded(std::span<const Ray> rays, std::span<uint8_t> blocked) const = 0;

  /// Finds what part of the light along each segment passes: 0 where something solid lies on it, else the product of
  /// what blended surfaces let through. A query may answer by chance: 0 or 1, with that mean (this one does).
  virtual void transmittance(std::span<const Ray> rays, std::span<float> passes) const {
    std::vector<uint8_t> blocked(rays.size());
    occluded(rays, blocked);
    for (size_t i = 0; i < rays.size(); ++i) passes[i] = blocked[i] ? 0.0f : 1.0f;
  }

  /// Says whether only the thread that made the query may use it; such a query answers long lists best.
  virtual bool ownThread() const { return false; }

  SurfaceHit closest(const Ray& ray) const {
    SurfaceHit h;
    closest({&ray, 1}, {&h, 1});
    return h;
  }
  SurfaceHit seen(const Ray& ray) const {
    SurfaceHit h;
    seen({&ray, 1}, {&h, 1});
    return h;
  }
  bool occluded(const Ray& ray) const {
    uint8_t b;
    occluded({&ray, 1}, {&b, 1});
    return b != 0;
  }
  /// Metres by which hits may lie off their surfaces, whatever their own coordinates: those of the geometry's corners
  /// round off. Stays the same while the scene does.
  float rayEpsilon() const { return rayEpsilon_; }
  /// Metres from its start within which a ray passes what blends, but for those of eyes: a decal does not shade what it
  /// lies on, which is seen through the same holes as light comes by. 1 cm in a room of 10 m, 2 cm at most.
  float blendedFrom() const { return glm::min(1024 * rayEpsilon_, 0.02f); }

 protected:
  /// Finds the rayEpsilon of a scene of triangles by the bounds of the first view that has any.
  void measure(const Aabb& b) {
    if (measured_ || b.empty()) return;
    rayEpsilon_ = 0x1p-19f * glm::max(maxComponent(glm::abs(b.lo)), maxComponent(glm::abs(b.hi)));
    measured_ = true;
  }

 private:
  float rayEpsilon_ = 1e-4f;
  bool measured_ = false;
};

/// Point just off a surface on the side of `geometricNormal`, so that a ray from it does not meet the surface again:
/// the query's rayEpsilon, and 2^-16 of the position's own coordinates. (16 float steps would do for rays; virtual
/// lights then stand in gaps that their maps of 16 bits cannot see: relMSE of living-room-2 0.26 instead of 0.22.)
inline vec3 offsetPoint(const vec3& position, const vec3& geometricNormal, float rayEpsilon) {
  return position + geometricNormal * (rayEpsilon + 0x1p-16f * maxComponent(glm::abs(position)));
}

/// Shadow segment from a to b, both already off their surfaces: blocked where `occluded` says so.
inline Ray segment(const vec3& a, const vec3& b) { return {a, b - a, 1.0f - 1e-4f}; }

} // namespace lambent

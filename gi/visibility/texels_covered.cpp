// Where a box appears in a paraboloid map. The map is a stereographic projection, which takes great circles to circles:
// an edge of the box becomes an arc, and the arcs' extremes bound the box's image. The part of the box that no texel
// looks at is cut off first, because it would project to infinity.
#include "engine/trace/ray_query.h"
#include "gi/visibility/map_schedule.h"
#include "shaders/shared/paraboloid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace lambent {

namespace {

/// Map coordinates of the points of an edge, relative to the map's centre and twice as large: the hemisphere fills the
/// unit disc.
struct Bounds {
  vec2 lo{kInfinity}, hi{-kInfinity};

  /// Adds the image of the edge from `a` to `b`, in the light's frame. Neither end may lie straight behind the light.
  void addEdge(const vec3& a, const vec3& b) {
    add(a);
    add(b);
    // The plane of the edge and the light meets the unit sphere in a great circle, whose image is a circle around
    // n.xy / n.z of radius |n| / n.z. It is extreme where it touches lines parallel to the axes.
    const vec3 n = glm::cross(a, b);
    const float length = glm::length(n);
    if (!(std::abs(n.z) > 0)) return; // a straight line
    for (int axis = 0; axis < 2; ++axis) {
      // (n[axis] ± length) / n.z; the smaller root without cancellation
      const float sum = n[axis] + std::copysign(length, n[axis]);
      for (const float extreme : {sum / n.z, (n[axis] * n[axis] - length * length) / (sum * n.z)}) {
        vec2 p;
        p[axis] = extreme;
        p[1 - axis] = n[1 - axis] / n.z;
        const vec3 d(2.0f * p, 1.0f - glm::dot(p, p));
        if (glm::dot(glm::cross(a, d), n) >= 0 && glm::dot(glm::cross(d, b), n) >= 0) add(d);
      }
    }
  }

 private:
  void add(const vec3& direction) {
    const float length = glm::length(direction);
    const vec2 p = vec2(direction) / std::max(length + direction.z, 1e-12f * length);
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
};

/// The part of the edge from `a` to `b` with z ≥ floor; nothing if there is none.
std::optional<std::array<vec3, 2>> above(const vec3& a, const vec3& b, float floor) {
  const bool in = a.z >= floor, other = b.z >= floor;
  if (!in && !other) return {};
  if (in && other) return std::array{a, b};
  vec3 cut = glm::mix(a, b, (floor - a.z) / (b.z - a.z));
  cut.z = floor;
  return in ? std::array{a, cut} : std::array{cut, b};
}

} // namespace

TexelRect texelsCovered(const MapPose& pose, const Aabb& box, int resolution) {
  if (box.empty()) return {};
  const vec3 origin = pose.origin();
  const float margin = pose.rayEpsilon + 1e-5f * std::max(maxComponent(glm::abs(origin)), box.diameter());
  const Aabb grown{box.lo - margin, box.hi + margin};
  // Texels are drawn down to a cosine of -2 / resolution (castMap, map_resample.frag), and so see nothing below this.
  const vec3 toCentre = grown.centre() - origin, half = 0.5f * grown.size();
  const float floor = -2.1f / float(resolution) * (glm::length(toCentre) + glm::length(half));
  if (glm::dot(toCentre, pose.normal) + glm::dot(half, glm::abs(pose.normal)) < floor) return {};
  // In the box, or so close above it that what is left of it surrounds the map.
  if (crosses(Ray{origin, -pose.normal, -floor}, grown)) return TexelRect::whole(resolution);

  vec3 tangent, bitangent;
  basisAround(pose.normal, tangent, bitangent);
  std::array<vec3, 8> corners; // bits of the index: on the far side in x, y, z
  for (int i = 0; i < 8; ++i) {
    const vec3 d =
        vec3(i & 1 ? grown.hi.x : grown.lo.x, i & 2 ? grown.hi.y : grown.lo.y, i & 4 ? grown.hi.z : grown.lo.z) -
        origin;
    corners[i] = vec3(glm::dot(d, tangent), glm::dot(d, bitangent), glm::dot(d, pose.normal));
  }

  Bounds bounds;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = 1 << axis, v = 1 << (axis + 1) % 3, w = 1 << (axis + 2) % 3;
    for (const int at : {0, v, w, v | w})
      if (const auto edge = above(corners[at], corners[at | u], floor)) bounds.addEdge((*edge)[0], (*edge)[1]);
    // Where the floor cuts the two faces across this axis.
    for (const int face : {0, u}) {
      const std::array<int, 5> around{face, face | v, face | v | w, face | w, face};
      std::array<vec3, 2> cut;
      int cuts = 0;
      for (int i = 0; i < 4; ++i) {
        const vec3 &a = corners[around[i]], &b = corners[around[i + 1]];
        if ((a.z >= floor) == (b.z >= floor)) continue;
        const auto part = *above(a, b, floor);
        cut[cuts++] = a.z >= floor ? part[1] : part[0];
        if (cuts == 2) bounds.addEdge(cut[0], cut[1]), cuts = 0;
      }
    }
  }
  const auto texel = [resolution](float p) {
    return glm::clamp((0.5f + 0.5f * p) * float(resolution), -2.0f, float(resolution) + 2.0f);
  };
  const auto bound = [resolution](float t) { return std::clamp(int(t), 0, resolution); };
  // A texel looks through its centre; some of a texel is left for rounding.
  constexpr float kCentre = 0.5f, kMargin = 0.1f;
  const TexelRect rect{bound(std::ceil(texel(bounds.lo.x) - kCentre - kMargin)),
                       bound(std::ceil(texel(bounds.lo.y) - kCentre - kMargin)),
                       bound(std::floor(texel(bounds.hi.x) + kCentre + kMargin)),
                       bound(std::floor(texel(bounds.hi.y) + kCentre + kMargin))};
  return rect.empty() ? TexelRect{} : rect;
}

} // namespace lambent

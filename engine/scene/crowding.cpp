#include "engine/scene/crowding.h"

#include "engine/core/rng.h"
#include "engine/scene/deform.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lambent {

namespace {

constexpr uint64_t kMostPlaces = 1024;
constexpr int kCrowded = 2; // of these: fewer are a spot that few rays meet

using Corners = std::array<vec3, 3>;

struct PlaceOnTriangle {
  vec3 at;
  int triangles = 0;
};

/// Calls f(corners) for triangles of `wanted` (in order; all, where it is empty) as they stand in the world.
template <class F> void forEachTriangle(const Scene& scene, std::span<const uint64_t> wanted, F&& f) {
  const bool all = wanted.empty();
  uint64_t first = 0; // of the instance
  forEachPosed(scene, [&](const Mesh& mesh, const DeformedMesh* deformed, const mat4& worldFromObject) {
    const std::vector<vec3>& positions = deformed ? deformed->positions : mesh.positions;
    const auto visit = [&](size_t triangle) {
      Corners corners;
      for (int c = 0; c < 3; ++c)
        corners[size_t(c)] = vec3(worldFromObject * vec4(positions[mesh.triangles[triangle][c]], 1));
      f(corners);
    };
    if (all)
      for (size_t i = 0; i < mesh.triangles.size(); ++i) visit(i);
    for (; !wanted.empty() && wanted[0] < first + mesh.triangles.size(); wanted = wanted.subspan(1))
      visit(size_t(wanted[0] - first));
    first += mesh.triangles.size();
  });
}

/// In the order of their coordinates on `axis`, the one on which they lie farthest apart.
std::vector<PlaceOnTriangle> somePlaces(const Scene& scene, int& axis) {
  uint64_t all = 0;
  forEachPosed(scene, [&](const Mesh& mesh, const DeformedMesh*, const mat4&) { all += mesh.triangles.size(); });
  if (all == 0) return {};
  std::vector<uint64_t> drawn(size_t(std::min(all, kMostPlaces)));
  Rng random(1, Stream::Crowding, 0);
  for (size_t i = 0; i < drawn.size(); ++i)
    drawn[i] = all <= kMostPlaces ? i : (uint64_t(random.nextUint()) << 32 | random.nextUint()) % all;
  std::ranges::sort(drawn);

  std::vector<PlaceOnTriangle> places;
  Aabb extent;
  forEachTriangle(scene, drawn, [&](const Corners& t) {
    extent.add(places.emplace_back(PlaceOnTriangle{(t[0] + t[1] + t[2]) / 3.0f}).at);
  });
  const vec3 size = extent.size();
  axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::ranges::sort(places, {}, [&](const PlaceOnTriangle& p) { return p.at[axis]; });
  return places;
}

/// Whether a place lies within `near` of a triangle: in front of it, and inside its edges grown by as much. Not of one
/// that is a point or a line, which rays seldom meet.
bool liesOn(const Corners& t, const vec3& place, float near) {
  const vec3 across = glm::cross(t[1] - t[0], t[2] - t[0]);
  const float doubleArea = glm::length(across);
  if (!(doubleArea > 0)) return false;
  const vec3 normal = across / doubleArea;
  if (!(std::abs(glm::dot(place - t[0], normal)) <= near)) return false;
  for (size_t c = 0; c < 3; ++c) {
    const vec3 edge = t[(c + 1) % 3] - t[c];
    if (glm::dot(glm::cross(normal, edge), place - t[c]) < -near * glm::length(edge)) return false;
  }
  return true;
}

} // namespace

std::optional<vec3> crowdedPlace(const Scene& scene, int most) {
  int axis = 0, crowded = 0;
  std::vector<PlaceOnTriangle> places = somePlaces(scene, axis);
  std::optional<vec3> found;
  forEachTriangle(scene, {}, [&](const Corners& t) {
    if (found) return;
    Aabb box;
    for (const vec3& corner : t) box.add(corner);
    const vec3 size = box.size();
    const float near = 0.01f * glm::max(glm::max(size.x, size.y), size.z); // layers a hair apart are in one place
    const Aabb around{box.lo - near, box.hi + near};
    auto place =
        std::ranges::lower_bound(places, around.lo[axis], {}, [&](const PlaceOnTriangle& p) { return p.at[axis]; });
    for (; place != places.end() && place->at[axis] <= around.hi[axis]; ++place)
      if (around.contains(place->at) && liesOn(t, place->at, near) && ++place->triangles == most + 1 &&
          ++crowded == kCrowded)
        found = place->at;
  });
  return found;
}

} // namespace lambent

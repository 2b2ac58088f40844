#include "engine/scene/crowding.h"

#include "engine/core/rng.h"
#include "engine/scene/deform.h"

#include <algorithm>

namespace lambent {

namespace {

constexpr uint64_t kMostPlaces = 4096;
constexpr int kCrowded = 8; // of these: fewer are a spot that few rays meet

struct PlaceOnTriangle {
  vec3 at;
  int boxes = 0;
};

/// Calls f(box) for triangles of `wanted` (in order; all, where it is empty) as they stand in the world.
template <class F> void forEachBox(const Scene& scene, std::span<const uint64_t> wanted, F&& f) {
  const bool all = wanted.empty();
  uint64_t first = 0; // of the instance
  forEachPosed(scene, [&](const Mesh& mesh, const DeformedMesh* deformed, const mat4& worldFromObject) {
    const std::vector<vec3>& positions = deformed ? deformed->positions : mesh.positions;
    const auto visit = [&](size_t triangle) {
      Aabb box;
      for (int c = 0; c < 3; ++c) box.add(vec3(worldFromObject * vec4(positions[mesh.triangles[triangle][c]], 1)));
      f(box);
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
  forEachBox(scene, drawn, [&](const Aabb& box) { extent.add(places.emplace_back(PlaceOnTriangle{box.centre()}).at); });
  const vec3 size = extent.size();
  axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::ranges::sort(places, {}, [&](const PlaceOnTriangle& p) { return p.at[axis]; });
  return places;
}

/// Rays seldom meet points and lines.
bool hasAnArea(const Aabb& box) {
  const vec3 size = box.size();
  return (size.x > 0) + (size.y > 0) + (size.z > 0) >= 2;
}

} // namespace

std::optional<vec3> crowdedPlace(const Scene& scene, int most) {
  int axis = 0, crowded = 0;
  std::vector<PlaceOnTriangle> places = somePlaces(scene, axis);
  std::optional<vec3> found;
  forEachBox(scene, {}, [&](const Aabb& box) {
    if (found || !hasAnArea(box)) return;
    const vec3 size = box.size();
    const vec3 near(0.01f * glm::max(glm::max(size.x, size.y), size.z)); // layers a hair apart are in one place
    const Aabb around{box.lo - near, box.hi + near};
    auto place =
        std::ranges::lower_bound(places, around.lo[axis], {}, [&](const PlaceOnTriangle& p) { return p.at[axis]; });
    for (; place != places.end() && place->at[axis] <= around.hi[axis]; ++place)
      if (around.contains(place->at) && ++place->boxes == most + 1 && ++crowded == kCrowded) found = place->at;
  });
  return found;
}

} // namespace lambent

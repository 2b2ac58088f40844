#include "engine/scene/crowding.h"

#include "engine/scene/placed_triangles.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lambent {

namespace {

constexpr uint64_t kMostPlaces = 1024;
constexpr int kCrowded = 2;    // of these: fewer are a spot that few rays meet
constexpr float kNear = 0.01f; // of a triangle's height: layers a hair apart are in one place

using Corners = std::array<vec3, 3>;

/// The middles of triangles that are drawn at random.
std::vector<vec3> somePlaces(const Scene& scene) {
  uint64_t all = 0;
  forEachPosed(scene, [&](const Mesh& mesh, const DeformedMesh*, const mat4&) { all += mesh.triangles.size(); });
  if (all == 0) return {};
  std::vector<uint64_t> drawn(size_t(std::min(all, kMostPlaces)));
  Rng random(1, Stream::Crowding, 0);
  for (size_t i = 0; i < drawn.size(); ++i) drawn[i] = all <= kMostPlaces ? i : drawnBelow(all, random);
  std::ranges::sort(drawn);
  drawn.erase(std::ranges::unique(drawn).begin(), drawn.end());
  std::vector<vec3> places;
  uint64_t first = 0; // of the instance
  forEachPosed(scene, [&](const Mesh& mesh, const DeformedMesh* deformed, const mat4& worldFromObject) {
    while (places.size() < drawn.size() && drawn[places.size()] < first + mesh.triangles.size()) {
      const size_t triangle = size_t(drawn[places.size()] - first);
      const Corners t = TriangleBlock{mesh, deformed, worldFromObject, triangle, triangle + 1, {}}.corners(triangle);
      places.push_back((t[0] + t[1] + t[2]) / 3.0f);
    }
    first += mesh.triangles.size();
  });
  return places;
}

bool overlap(const Aabb& a, const Aabb& b) {
  return glm::all(glm::lessThanEqual(a.lo, b.hi)) && glm::all(glm::lessThanEqual(b.lo, a.hi));
}

Aabb grown(const Aabb& box, float by) { return {box.lo - by, box.hi + by}; }

/// Where a place lies on a triangle: no farther than `near` in front or behind, and inside its edges grown by as much.
struct Prism {
  float near = 0;
  Aabb box;
  vec3 corner{0}, normal{0};        // unit
  std::array<vec3, 3> from, inward; // of the edges; unit

  /// Whether some of a box may lie in it; exact for a box that is a point.
  bool meets(const Aabb& b) const {
    if (!overlap(b, box)) return false;
    const vec3 middle = b.centre(), half = 0.5f * b.size();
    if (std::abs(glm::dot(middle - corner, normal)) > near + glm::dot(half, glm::abs(normal))) return false;
    for (size_t c = 0; c < 3; ++c)
      if (glm::dot(middle - from[c], inward[c]) < -near - glm::dot(half, glm::abs(inward[c]))) return false;
    return true;
  }
};

/// Nothing for a triangle that is a point or a line, which rays seldom meet.
std::optional<Prism> prismAround(const Corners& t) {
  const vec3 across = glm::cross(t[1] - t[0], t[2] - t[0]);
  const float doubleArea = glm::length(across);
  if (!(doubleArea > 0)) return {};
  Prism prism;
  for (const vec3& c : t) prism.box.add(c);
  float longest = 0;
  for (size_t c = 0; c < 3; ++c) longest = std::max(longest, glm::distance(t[c], t[(c + 1) % 3]));
  prism.near = kNear * doubleArea / longest + 1e-6f * longest; // the rest: what rounds off
  prism.box = grown(prism.box, prism.near);
  prism.corner = t[0];
  prism.normal = across / doubleArea;
  for (size_t c = 0; c < 3; ++c) {
    prism.from[c] = t[c];
    prism.inward[c] = unitOr(glm::cross(prism.normal, t[(c + 1) % 3] - t[c]), vec3(0));
  }
  return prism;
}

/// Places in a tree of boxes, each halved along its longest side down to single places: what a triangle lies on is then
/// found without a look at the others, however long and slanted it is.
class CountedPlaces {
 public:
  explicit CountedPlaces(std::vector<vec3> places) {
    if (!places.empty()) build(places);
  }
  /// Calls f(place, count) for each place that `meets(box)` says yes to, and so all boxes around it; counted once more.
  template <class Meets, class F> void count(const Meets& meets, const F& f) {
    if (!nodes_.empty()) count(0, meets, f);
  }
  /// Whether `meets` says yes to a place.
  template <class Meets> bool any(const Meets& meets) const { return !nodes_.empty() && any(0, meets); }

 private:
  struct Node {
    Aabb box;
    uint32_t second = 0; // half; the first follows its parent; 0: a single place
    int triangles = 0;   // on a single place
  };
  void build(std::span<vec3> places) {
    const size_t node = nodes_.size();
    nodes_.emplace_back();
    for (const vec3& p : places) nodes_[node].box.add(p);
    if (places.size() == 1) return;
    const vec3 size = nodes_[node].box.size();
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const size_t half = places.size() / 2;
    std::ranges::nth_element(places, places.begin() + std::ptrdiff_t(half), {}, [&](const vec3& p) { return p[axis]; });
    build(places.first(half));
    nodes_[node].second = uint32_t(nodes_.size());
    build(places.subspan(half));
  }
  template <class Meets, class F> void count(uint32_t index, const Meets& meets, const F& f) {
    Node& node = nodes_[index];
    if (!meets(node.box)) return;
    if (node.second == 0) return f(node.box.lo, ++node.triangles);
    count(index + 1, meets, f);
    count(node.second, meets, f);
  }
  template <class Meets> bool any(uint32_t index, const Meets& meets) const {
    const Node& node = nodes_[index];
    return meets(node.box) && (node.second == 0 || any(index + 1, meets) || any(node.second, meets));
  }
  std::vector<Node> nodes_; // the root first
};

} // namespace

std::optional<vec3> crowdedPlace(const Scene& scene, int most) {
  CountedPlaces places(somePlaces(scene));
  int crowded = 0;
  std::optional<vec3> found;
  const auto holdsPlaces = [&](const Aabb& box) {
    const Aabb around = grown(box, kNear * maxComponent(box.size()));
    return !found && places.any([&](const Aabb& b) { return overlap(around, b); });
  };
  PlacedTriangles(scene).forEachBlock(holdsPlaces, [&](const TriangleBlock& block) {
    for (size_t i = block.begin; i < block.end && !found; ++i) {
      const std::optional<Prism> prism = prismAround(block.corners(i));
      if (!prism) continue;
      places.count([&](const Aabb& b) { return prism->meets(b); },
                   [&](const vec3& place, int triangles) {
                     if (triangles == most + 1 && ++crowded == kCrowded) found = place;
                   });
    }
  });
  return found;
}

} // namespace lambent

// The first image of a file that has no camera. The rule:
//
// 1. Stand on each of 3x3 places spread over the plan, at eye height (1.6 m above the floor found there, or half of the
//    room above it where that is lower) and look in 26 directions. A place is *inside* when at least 70 % of these
//    looks meet the front of a surface: seen from within a closed object they meet the backs, and over open ground the
//    upper half meets nothing.
// 2. No place inside: an object. View it from outside: from the front, a little to the right and above, so near that
//    it fills nine tenths of the image's height or width.
// 3. Inside, but exactly one of the four sides is open (a stage, a Cornell box): view it straight through that side.
// 4. Else stand at the inside place that sees farthest in the (geometric) mean, take the longer of its two lines
//    along the plan's axes, step back almost to the wall behind, and look level along that line.
//
// Rays are tried against all triangles in boxes that they meet, of a few that follow each other in the file: there is
// no tree that nothing else here needs, and the tracer belongs to a later layer.

#include "engine/core/parallel.h"
#include "engine/scene/placed_triangles.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lambent {

namespace {

constexpr float kFovY = 50.0f / 180 * kPi;
constexpr float kEyeHeight = 1.6f;   // metres
constexpr float kInsideShare = 0.7f; // of looks that must meet a front
constexpr int kPlaces = 3;           // along each side of the plan
constexpr float kOwnRadius = 0.3f;   // metres kept between the eye and the wall behind it
constexpr float kFilled = 0.9f;      // of the image's height or width, by an object or an open side

struct Triangle {
  vec3 a, edge1, edge2;
};

/// Triangles that follow one another, and the box around them.
struct Box {
  vec3 lo, hi;
  size_t begin, end;
};

struct Look {
  vec3 origin, direction;
  float distance = kInfinity; // to what it meets
  bool front = false;
};

/// Möller and Trumbore, "Fast, minimum storage ray/triangle intersection" (1997), both sides.
void meet(Look& look, const Triangle& t) {
  const vec3 p = glm::cross(look.direction, t.edge2);
  const float det = glm::dot(t.edge1, p);
  if (det == 0) return;
  const vec3 s = look.origin - t.a;
  const float inv = 1 / det, u = inv * glm::dot(s, p);
  if (!(u >= 0 && u <= 1)) return;
  const vec3 q = glm::cross(s, t.edge1);
  const float v = inv * glm::dot(look.direction, q);
  if (!(v >= 0 && u + v <= 1)) return;
  const float distance = inv * glm::dot(t.edge2, q);
  if (!(distance > 1e-4f && distance < look.distance)) return;
  look.distance = distance;
  look.front = det > 0;
}

/// Whether it may meet something in there that is nearer than what it met.
bool mayMeet(const Look& look, const Box& box) {
  return entry({box.lo, box.hi}, look.origin, look.direction, 0, look.distance).has_value();
}

void meetSome(std::vector<Look>& looks, const std::vector<Triangle>& triangles, const std::vector<Box>& boxes) {
  parallelFor(looks.size(), 4, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      for (const Box& box : boxes)
        if (mayMeet(looks[i], box))
          for (size_t t = box.begin; t < box.end; ++t) meet(looks[i], triangles[t]);
  });
}

/// Tries the triangles that may be met, wound so that the cross product of the edges is the front; so many at a time
/// that memory does not grow with how often a mesh is shown.
void meetAll(std::vector<Look>& looks, PlacedTriangles& placed, float diameter) {
  constexpr size_t kAtOnce = 1 << 16;
  const vec3 more(1e-5f * diameter); // than what rounds off
  std::vector<Triangle> triangles;
  std::vector<Box> boxes;
  const auto mayBeMet = [&](const Aabb& b) {
    const Box box{b.lo - more, b.hi + more, 0, 0};
    return std::ranges::any_of(looks, [&](const Look& look) { return mayMeet(look, box); });
  };
  placed.forEachBlock(mayBeMet, [&](const TriangleBlock& block) {
    const size_t begin = triangles.size();
    const bool mirrored = glm::determinant(mat3(block.worldFromObject)) < 0;
    for (const uint32_t t : block.triangles) {
      std::array<vec3, 3> p = block.corners(t);
      if (mirrored) std::swap(p[1], p[2]);
      triangles.push_back({p[0], p[1] - p[0], p[2] - p[0]});
    }
    boxes.push_back({block.box.lo - more, block.box.hi + more, begin, triangles.size()});
    if (triangles.size() < kAtOnce) return;
    meetSome(looks, triangles, boxes);
    triangles.clear(), boxes.clear();
  });
  meetSome(looks, triangles, boxes);
}

/// Towards the faces, edges and corners of a cube, four of them level along the axes first: +X, -X, +Z, -Z.
std::array<vec3, 26> lookDirections() {
  std::array<vec3, 26> directions = {vec3(1, 0, 0), vec3(-1, 0, 0), vec3(0, 0, 1), vec3(0, 0, -1)};
  size_t n = 4;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z)
        if (y != 0 || (x != 0 && z != 0)) directions[n++] = glm::normalize(vec3(x, y, z));
  return directions;
}

struct Place {
  vec3 eye{0};
  float height = 0;    // from floor to ceiling, metres
  bool roofed = false; // else the ceiling is the scene's own top
  bool inside = false;
  float openness = 0;  // geometric mean of the looks' distances, metres
  float reach[4] = {}; // level along +X, -X, +Z, -Z
};

std::vector<Place> tryPlaces(PlacedTriangles& placed, const Aabb& bounds) {
  // Down and up from the middle of the height, to find floor and ceiling.
  std::vector<Look> vertical;
  for (int i = 0; i < kPlaces * kPlaces; ++i) {
    const vec2 plan((float(i % kPlaces) + 1) / (kPlaces + 1), (float(i / kPlaces) + 1) / (kPlaces + 1));
    const vec3 middle = bounds.lo + bounds.size() * vec3(plan.x, 0.5f, plan.y);
    vertical.push_back({middle, vec3(0, -1, 0)});
    vertical.push_back({middle, vec3(0, 1, 0)});
  }
  meetAll(vertical, placed, bounds.diameter());

  const auto directions = lookDirections();
  std::vector<Place> places;
  std::vector<Look> looks;
  for (size_t i = 0; i < vertical.size(); i += 2) {
    const float middle = vertical[i].origin.y;
    const float floor = std::max(middle - vertical[i].distance, bounds.lo.y);
    const float ceiling = std::min(middle + vertical[i + 1].distance, bounds.hi.y);
    Place place;
    place.eye = vertical[i].origin;
    place.height = ceiling - floor;
    place.roofed = vertical[i + 1].distance < kInfinity;
    place.eye.y = floor + std::min(kEyeHeight, 0.5f * place.height);
    places.push_back(place);
    for (const vec3& d : directions) looks.push_back({place.eye, d});
  }
  meetAll(looks, placed, bounds.diameter());
  for (size_t i = 0; i < places.size(); ++i) {
    const Look* own = &looks[i * directions.size()];
    size_t fronts = 0;
    float sumOfLogs = 0;
    for (size_t k = 0; k < directions.size(); ++k) {
      fronts += own[k].front;
      sumOfLogs += std::log(std::clamp(own[k].distance, 1e-3f * bounds.diameter(), bounds.diameter()));
    }
    places[i].inside = float(fronts) >= kInsideShare * float(directions.size());
    places[i].openness = std::exp(sumOfLogs / float(directions.size()));
    for (int k = 0; k < 4; ++k) places[i].reach[k] = own[k].distance;
  }
  return places;
}

/// The outward normal of the only side of the plan where more than half of the inside places see out, if it is one.
std::optional<vec3> onlyOpenSide(const std::vector<Place>& places) {
  const vec3 sides[4] = {{1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}};
  const auto inside = std::count_if(places.begin(), places.end(), [](const Place& p) { return p.inside; });
  std::optional<vec3> open;
  for (int s = 0; s < 4; ++s) {
    const auto seeOut = std::count_if(places.begin(), places.end(),
                                      [&](const Place& p) { return p.inside && p.reach[s] == kInfinity; });
    if (2 * seeOut <= inside) continue;
    if (open) return {};
    open = sides[s];
  }
  return open;
}

/// How far the scene reaches along each direction, from `centre`. Looks only where one may be exceeded.
template <size_t N>
std::array<float, N> reachAlong(const std::array<vec3, N>& directions, PlacedTriangles& placed, const vec3& centre) {
  std::array<float, N> reach;
  reach.fill(-kInfinity);
  const auto mayExceed = [&](const Aabb& box) {
    for (size_t i = 0; i < N; ++i)
      if (glm::dot(box.centre() - centre, directions[i]) + glm::dot(0.5f * box.size(), glm::abs(directions[i])) >
          reach[i])
        return true;
    return false;
  };
  placed.forEachBlock(mayExceed, [&](const TriangleBlock& block) {
    for (const uint32_t t : block.triangles)
      for (const vec3& p : block.corners(t))
        for (size_t i = 0; i < N; ++i) reach[i] = std::max(reach[i], glm::dot(p - centre, directions[i]));
  });
  return reach;
}

/// A point at (x, y, z) along the camera's axes is below the image's upper edge, which rises by `up` over a length,
/// where y / up + z is no more than the camera's own: so the farthest along four directions say where it may stand.
CameraView viewFromOutside(PlacedTriangles& placed, const Aabb& bounds, float aspect) {
  const float radius = std::max(0.5f * bounds.diameter(), 1e-12f), up = kFilled * std::tan(0.5f * kFovY);
  const vec3 centre = bounds.centre(), direction = glm::normalize(vec3(0.5f, 0.4f, 1));
  const mat3 axes(lookAt(centre + direction * radius, centre, kFovY).worldFromView);
  const vec3 x = axes[0] / (aspect * up), y = axes[1] / up, z = axes[2];
  const std::array<float, 5> reach = reachAlong<5>({z + x, z - x, z + y, z - y, z}, placed, centre);
  const float distance =
      std::max({0.5f * (reach[0] + reach[1]), 0.5f * (reach[2] + reach[3]), reach[4] + 0.02f * radius});
  const vec3 target =
      centre + 0.5f * (reach[0] - reach[1]) * aspect * up * axes[0] + 0.5f * (reach[2] - reach[3]) * up * axes[1];
  CameraView view = lookAt(target + direction * distance, target, kFovY);
  view.near = 0.01f * radius;
  return view;
}

CameraView viewThroughSide(const Aabb& bounds, const vec3& side, float aspect) {
  const float depth = std::abs(glm::dot(bounds.size(), side));
  const float width = std::abs(glm::dot(bounds.size(), vec3(side.z, 0, side.x)));
  const float height = std::max(bounds.size().y, width / aspect) / kFilled;
  const float distance = 0.5f * depth + 0.5f * height / std::tan(0.5f * kFovY);
  CameraView view = lookAt(bounds.centre() + distance * side, bounds.centre(), kFovY);
  view.near = 0.01f * distance;
  return view;
}

CameraView viewFromInside(const std::vector<Place>& places, const Aabb& bounds) {
  const Place* best = nullptr;
  for (const Place& place : places)
    if (place.inside && (!best || place.openness > best->openness)) best = &place;
  CHECK(best != nullptr);

  struct Line {
    vec3 along;
    float ahead, behind; // an opening counts up to the scene's own end
  };
  const vec3 toHigh = bounds.hi - best->eye, toLow = best->eye - bounds.lo;
  const Line x{vec3(1, 0, 0), std::min(best->reach[0], toHigh.x), std::min(best->reach[1], toLow.x)};
  const Line z{vec3(0, 0, 1), std::min(best->reach[2], toHigh.z), std::min(best->reach[3], toLow.z)};
  const Line& line = x.ahead + x.behind > z.ahead + z.behind ? x : z;
  const float length = line.ahead + line.behind;
  const vec3 eye = best->eye - line.along * std::max(line.behind - std::max(kOwnRadius, 0.08f * length), 0.0f);
  CameraView view = lookAt(eye, eye + line.along, kFovY);
  view.near = std::clamp(0.002f * length, 0.005f, 0.1f);
  return view;
}

} // namespace

CameraView defaultView(const Scene& scene, float aspect) {
  const Aabb bounds = worldBounds(scene);
  if (bounds.empty()) return lookAt(vec3(0, 0, 2), vec3(0), kFovY);
  PlacedTriangles placed(scene);
  const std::vector<Place> places = tryPlaces(placed, bounds);
  if (std::none_of(places.begin(), places.end(), [](const Place& p) { return p.inside; }))
    return viewFromOutside(placed, bounds, aspect);
  if (const auto side = onlyOpenSide(places)) return viewThroughSide(bounds, *side, aspect);
  return viewFromInside(places, bounds);
}

std::optional<float> roomHeight(const Scene& scene) {
  const Aabb bounds = worldBounds(scene);
  if (bounds.empty()) return {};
  PlacedTriangles placed(scene);
  std::vector<float> heights;
  for (const Place& place : tryPlaces(placed, bounds))
    if (place.inside && place.roofed) heights.push_back(place.height);
  if (heights.empty()) return {};
  const auto middle = heights.begin() + std::ptrdiff_t(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  return *middle;
}

} // namespace lambent

#include "engine/scene/see_through.h"

#include "engine/scene/placed_triangles.h"
#include "engine/view/surface_point.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

/// A line across the middle of a triangle, and how far it is free on either side of that.
struct LineAcross {
  vec3 middle{0}, direction{0}; // unit
  float from = -kInfinity, to = kInfinity;
  uint64_t layers = 0;
};

/// Where a line meets a triangle, and the weights of its second and third corner.
struct Crossing {
  float t;
  vec2 barycentric;
};
std::optional<Crossing> crossingOf(const LineAcross& line, const std::array<vec3, 3>& corners) {
  const vec3 edge1 = corners[1] - corners[0], edge2 = corners[2] - corners[0];
  const vec3 p = glm::cross(line.direction, edge2);
  const float det = glm::dot(edge1, p);
  if (det == 0) return {};
  const vec3 s = line.middle - corners[0];
  const float u = glm::dot(s, p) / det;
  if (!(u >= 0 && u <= 1)) return {};
  const vec3 q = glm::cross(s, edge1);
  const float v = glm::dot(line.direction, q) / det;
  if (!(v >= 0 && u + v <= 1)) return {};
  return Crossing{glm::dot(edge2, q) / det, {u, v}};
}

bool isMasked(const Scene& scene, const Primitive& primitive) {
  return scene.assets.materials[primitive.material].alphaMode == AlphaMode::Mask;
}

/// Calls f(corners) for the masked triangles of these numbers, counted over all instances; in order.
template <class F> void forEachMasked(const Scene& scene, std::span<const uint64_t> numbers, F&& f) {
  uint64_t first = 0;
  forEachPosed(scene, [&](const Mesh& mesh, const DeformedMesh* deformed, const mat4& worldFromObject) {
    for (const Primitive& p : mesh.primitives) {
      if (!isMasked(scene, p)) continue;
      for (; !numbers.empty() && numbers[0] < first + p.triangleCount; numbers = numbers.subspan(1)) {
        const size_t triangle = p.firstTriangle + size_t(numbers[0] - first);
        f(TriangleBlock{mesh, deformed, worldFromObject, triangle, triangle + 1, {}}.corners(triangle));
      }
      first += p.triangleCount;
    }
  });
}

std::vector<LineAcross> drawnLines(const Scene& scene) {
  uint64_t masked = 0;
  forEachPosed(scene, [&](const Mesh& mesh, const DeformedMesh*, const mat4&) {
    for (const Primitive& p : mesh.primitives)
      if (isMasked(scene, p)) masked += p.triangleCount;
  });
  if (masked == 0) return {};
  std::vector<uint64_t> drawn(size_t(std::clamp<uint64_t>((uint64_t(1) << 24) / masked, 4, 64)));
  Rng random(1, Stream::Crowding, 1);
  for (uint64_t& number : drawn) number = drawnBelow(masked, random);
  std::ranges::sort(drawn);
  std::vector<LineAcross> lines;
  forEachMasked(scene, drawn, [&](const std::array<vec3, 3>& t) {
    lines.push_back({.middle = (t[0] + t[1] + t[2]) / 3.0f,
                     .direction = unitOr(glm::cross(t[1] - t[0], t[2] - t[0]), vec3(0, 1, 0))});
  });
  return lines;
}

/// Calls f(line, t, cutOut) where lines meet masked triangles, until it returns false.
template <class F>
void forEachCrossing(PlacedTriangles& placed, const Scene& scene, std::vector<LineAcross>& lines, F&& f) {
  bool more = true;
  const auto wanted = [&](const Aabb& box) {
    return more && std::ranges::any_of(lines, [&](const LineAcross& line) {
             return crosses(box, line.middle, line.direction, -kInfinity, kInfinity);
           });
  };
  placed.forEachBlock(wanted, [&](const TriangleBlock& block) {
    const std::vector<Primitive>& all = block.mesh.primitives; // in the order of their triangles
    auto at = std::ranges::partition_point(
        all, [&](const Primitive& p) { return size_t(p.firstTriangle) + p.triangleCount <= block.begin; });
    for (; at != all.end() && at->firstTriangle < block.end; ++at) {
      const Primitive& p = *at;
      if (!isMasked(scene, p)) continue;
      const size_t begin = std::max<size_t>(block.begin, p.firstTriangle);
      const size_t end = std::min<size_t>(block.end, size_t(p.firstTriangle) + p.triangleCount);
      for (size_t i = begin; i < end; ++i) {
        const std::array<vec3, 3> corners = block.corners(i);
        for (LineAcross& line : lines) {
          const std::optional<Crossing> met = crossingOf(line, corners);
          if (!met || !more) continue;
          const Material& material = scene.assets.materials[p.material];
          const TrianglePlace place = trianglePlace(block.mesh, p, uint32_t(i - p.firstTriangle), met->barycentric);
          const bool cutOut = baseColourAt(scene.assets, block.mesh, material, place).w < material.alphaCutoff;
          more = f(line, met->t, cutOut);
        }
      }
    }
  });
}

} // namespace

SeeThrough seeThrough(const Scene& scene, float enough) {
  std::vector<LineAcross> lines = drawnLines(scene);
  if (lines.empty()) return {};
  PlacedTriangles placed(scene);
  forEachCrossing(placed, scene, lines, [](LineAcross& line, float t, bool cutOut) {
    if (!cutOut && t < 0) line.from = std::max(line.from, t);
    if (!cutOut && t >= 0) line.to = std::min(line.to, t);
    return true;
  });
  const uint64_t most = uint64_t(std::ceil(enough * float(lines.size())));
  uint64_t all = 0;
  forEachCrossing(placed, scene, lines, [&](LineAcross& line, float t, bool cutOut) {
    const bool passed = cutOut && t >= line.from && t <= line.to;
    line.layers += passed, all += passed;
    return all <= most;
  });
  const LineAcross& fullest = *std::ranges::max_element(lines, {}, &LineAcross::layers);
  return {float(all) / float(lines.size()), fullest.middle};
}

} // namespace lambent

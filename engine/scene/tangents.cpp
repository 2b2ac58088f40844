#include "engine/scene/tangents.h"

#include "shaders/shared/paraboloid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <limits>
#include <numeric>

namespace lambent {

namespace {

constexpr uint32_t kNoTriangle = 0xffffffffu;

bool notZero(float x) { return std::abs(x) > std::numeric_limits<float>::min(); }

/// Gives every vertex the first one that is like it.
std::vector<uint32_t> welded(std::span<const vec3> positions, std::span<const vec3> normals,
                             std::span<const vec2> uvs) {
  std::vector<uint32_t> order(positions.size()), first(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](uint32_t i) {
    const vec3 &p = positions[i], &n = normals[i];
    return std::array{p.x, p.y, p.z, n.x, n.y, n.z, uvs[i].x, uvs[i].y};
  };
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    const auto ka = key(a), kb = key(b);
    return ka != kb ? ka < kb : a < b;
  });
  for (size_t k = 0; k < order.size(); ++k)
    first[order[k]] = k > 0 && key(order[k]) == key(order[k - 1]) ? first[order[k - 1]] : order[k];
  return first;
}

struct MappedTriangle {
  uvec3 vertices; // welded
  vec3 along{0};  // unit, towards greater u; 0: its texture has no area, and it is of any group
  bool mirrored = false;
  uvec3 beyond{kNoTriangle}; // the triangle at each edge, from corner i to the next
  bool ofAnyGroup() const { return along == vec3(0); }
};

/// Finds the triangle on the other side of each edge. One that more than two share is joined in pairs.
void joinEdges(std::vector<MappedTriangle>& triangles) {
  struct Edge {
    uint32_t lo, hi, triangle;
    auto operator<=>(const Edge&) const = default;
  };
  std::vector<Edge> edges;
  for (uint32_t t = 0; t < triangles.size(); ++t)
    for (int c = 0; c < 3; ++c) {
      const uint32_t a = triangles[t].vertices[c], b = triangles[t].vertices[(c + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), t});
    }
  std::sort(edges.begin(), edges.end());
  /// The edge of a triangle that has no other side yet and leads so; 3: none.
  const auto open = [&](uint32_t triangle, uint32_t from, uint32_t to) {
    const MappedTriangle& m = triangles[triangle];
    for (int c = 0; c < 3; ++c)
      if (m.vertices[c] == from && m.vertices[(c + 1) % 3] == to && m.beyond[c] == kNoTriangle) return c;
    return 3;
  };
  for (size_t i = 0, end = 0; i < edges.size(); i = end) {
    for (end = i + 1; end < edges.size() && edges[end].lo == edges[i].lo && edges[end].hi == edges[i].hi;) ++end;
    // Those that lead one way, and the other, in order: each pair is joined once.
    size_t back = i;
    for (size_t k = i; k < end; ++k) {
      const int c = open(edges[k].triangle, edges[k].lo, edges[k].hi);
      if (c == 3) continue;
      for (; back < end; ++back) {
        const int other = open(edges[back].triangle, edges[k].hi, edges[k].lo);
        if (other == 3 || edges[back].triangle == edges[k].triangle) continue;
        triangles[edges[k].triangle].beyond[c] = edges[back].triangle;
        triangles[edges[back].triangle].beyond[other] = edges[k].triangle;
        break;
      }
    }
  }
}

int cornerOf(const MappedTriangle& triangle, uint32_t vertex) {
  return triangle.vertices.x == vertex ? 0 : triangle.vertices.y == vertex ? 1 : triangle.vertices.z == vertex ? 2 : 3;
}

vec3 inPlane(const vec3& v, const vec3& normal) { return unitOr(v - normal * glm::dot(normal, v), vec3(0)); }

} // namespace

std::vector<CornerTangent> cornerTangents(std::span<const vec3> positions, std::span<const vec3> normals,
                                          std::span<const vec2> uvs, std::span<const uvec3> triangles) {
  const std::vector<uint32_t> first = welded(positions, normals, uvs);
  std::vector<MappedTriangle> mapped;
  mapped.reserve(triangles.size());
  for (const uvec3& t : triangles) {
    MappedTriangle m{.vertices = {first[t.x], first[t.y], first[t.z]}};
    const vec2 u1 = uvs[t.y] - uvs[t.x], u2 = uvs[t.z] - uvs[t.x];
    const vec3 p1 = positions[t.y] - positions[t.x], p2 = positions[t.z] - positions[t.x];
    const float area = u1.x * u2.y - u1.y * u2.x;
    const vec3 s = u2.y * p1 - u1.y * p2, down = u1.x * p2 - u2.x * p1;
    m.mirrored = area > 0; // v runs downwards
    if (notZero(area) && notZero(glm::length(s)) && notZero(glm::length(down)))
      m.along = unitOr(area > 0 ? s : -s, vec3(0));
    mapped.push_back(m);
  }
  joinEdges(mapped);

  constexpr uint32_t kNoGroup = 0xffffffffu;
  std::vector<CornerTangent> corners(3 * triangles.size(), {.group = kNoGroup});
  std::vector<uint32_t> group, reached; // triangles
  uint32_t groups = 0;
  for (uint32_t t = 0; t < mapped.size(); ++t)
    for (int c = 0; c < 3; ++c) {
      if (corners[3 * t + uint32_t(c)].group != kNoGroup || mapped[t].ofAnyGroup()) continue;
      const uint32_t vertex = mapped[t].vertices[c];
      const bool mirrored = mapped[t].mirrored;
      group.clear();
      reached.assign(1, t);
      while (!reached.empty()) {
        const uint32_t at = reached.back();
        reached.pop_back();
        MappedTriangle& m = mapped[at];
        const int corner = cornerOf(m, vertex);
        if (corner == 3 || corners[3 * at + uint32_t(corner)].group != kNoGroup) continue;
        const bool untouched = corners[3 * at].group == kNoGroup && corners[3 * at + 1].group == kNoGroup &&
                               corners[3 * at + 2].group == kNoGroup;
        if (m.ofAnyGroup() && untouched) m.mirrored = mirrored; // it takes the side of the first that meets it
        if (m.mirrored != mirrored) continue;
        corners[3 * at + uint32_t(corner)].group = groups;
        group.push_back(at);
        for (const int edge : {corner, (corner + 2) % 3})
          if (m.beyond[edge] != kNoTriangle) reached.push_back(m.beyond[edge]);
      }
      const vec3 normal = normals[vertex];
      vec3 sum(0);
      for (const uint32_t at : group) {
        const MappedTriangle& m = mapped[at];
        if (m.ofAnyGroup()) continue;
        const int corner = cornerOf(m, vertex);
        const uvec3& v = triangles[at];
        const vec3 here = positions[v[corner]];
        const vec3 before = inPlane(positions[v[(corner + 2) % 3]] - here, normal),
                   after = inPlane(positions[v[(corner + 1) % 3]] - here, normal);
        sum += inPlane(m.along, normal) * std::acos(glm::clamp(glm::dot(before, after), -1.0f, 1.0f));
      }
      vec3 tangent, unused;
      basisAround(normal, tangent, unused); // where the mean has no direction
      const vec4 found(unitOr(sum, tangent), mirrored ? -1 : 1);
      for (const uint32_t at : group) corners[3 * at + uint32_t(cornerOf(mapped[at], vertex))].tangent = found;
      ++groups;
    }

  // Corners that no group has reached, of triangles whose texture has no area: as another at their vertex.
  std::vector<uint32_t> other(positions.size(), kNoGroup);
  for (uint32_t i = 0; i < corners.size(); ++i)
    if (corners[i].group != kNoGroup) other[mapped[i / 3].vertices[int(i % 3)]] = i;
  for (uint32_t i = 0; i < corners.size(); ++i) {
    if (corners[i].group != kNoGroup) continue;
    const uint32_t vertex = mapped[i / 3].vertices[int(i % 3)];
    if (other[vertex] != kNoGroup) {
      corners[i] = corners[other[vertex]];
      continue;
    }
    vec3 tangent, unused;
    basisAround(normals[vertex], tangent, unused);
    corners[i] = {groups++, vec4(tangent, 1)};
    other[vertex] = i;
  }
  return corners;
}

} // namespace lambent

#include "gi/cube/depth_cube.h"

#include "engine/core/parallel.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lambent {

namespace {

constexpr size_t kBlock = 64;                      // columns cast as one
constexpr int kMostSurfaces = 256;                 // that a ray goes through
constexpr float kSamePlane = 0.3f, kNextPlane = 1; // texels
constexpr float kAbove = 0.01f;                    // texels
constexpr vec2 kWithin[] = {{0.5f, 0.5f}, {0.25f, 0.25f}, {0.75f, 0.25f}, {0.25f, 0.75f}, {0.75f, 0.75f}};

/// Off the surface as far as its curvature may hide neighbours from one another.
vec3 lifted(const CubeEntry& e, float texel, float rayEpsilon) {
  return offsetPoint(e.position, e.normal, rayEpsilon) + e.normal * (0.1f * texel);
}

struct Column {
  std::vector<CubeEntry> found;
  bool cut = false; // there are more
};

/// A surface that a column's rays met, and what lies over it so closely that texels do not tell both apart.
struct Met {
  CubeEntry entry, over = {};
  int covered = 0, ray = -1; // rays that found it covered; the last of these
};

/// A ray through the middle of a column, then four around it, which find what the first misses. Of surfaces merged, as
/// a floor and slabs on it, the upper one stands for both where most rays meet it: most pixels show that.
Column castColumn(const CubeGrid& grid, const CubeGrid::Place& at, const RayQuery& rays, RayCounts& counts) {
  constexpr int kMost = int(std::size(kWithin)) / 2;
  Column column;
  std::vector<Met> found;
  const float length = grid.edge(), epsilon = rays.rayEpsilon();
  const auto sees = [&](const vec3& from, const vec3& to) {
    ++counts.occlusion;
    return !rays.occluded(segment(from, to));
  };
  const auto height = [](const CubeEntry& over, const CubeEntry& e) {
    return glm::dot(over.position - e.position, e.normal);
  };
  const auto merge = [&](const CubeEntry& e, int ray) {
    const vec3 lift = lifted(e, grid.texel, epsilon);
    for (Met& f : found) {
      if (!matches(f.entry, e.position, e.normal, kSamePlane * grid.texel)) continue;
      if (!sees(lifted(f.entry, grid.texel, epsilon), lift)) continue;
      if (height(e, f.entry) > kAbove * grid.texel &&
          !sees(offsetPoint(f.entry.position, f.entry.normal, epsilon), lift)) {
        if (f.covered == 0 || (f.ray == ray && height(e, f.over) > 0)) f.over = e;
        f.covered += f.ray != ray;
        f.ray = ray;
      }
      return;
    }
    found.push_back({e});
  };
  vec3 along(0);
  along[at.axis] = 1;
  for (int r = 0; r < int(std::size(kWithin)); ++r) {
    Ray ray{grid.pointOf(at, kWithin[r]), along, length};
    for (int i = 0;; ++i) {
      ++counts.closest;
      const SurfaceHit h = rays.closest(ray);
      if (!h.valid() || !isFinite(h.position)) break;
      if (i == kMostSurfaces) {
        column.cut = true;
        break;
      }
      const float gone = h.position[at.axis] - ray.origin[at.axis];
      if (axesOf(h.geometricNormal) >> at.axis & 1)
        for (const float side : {1.0f, -1.0f}) merge({h.position, side * h.geometricNormal, side * h.normal}, r);
      ray.origin = offsetPoint(h.position, -h.geometricNormal, epsilon);
      ray.origin[at.axis] = std::max(ray.origin[at.axis], h.position[at.axis]);
      for (const int other : {(at.axis + 1) % 3, (at.axis + 2) % 3}) ray.origin[other] = h.position[other];
      ray.tMax -= std::max(gone, 0.0f);
      if (!(ray.tMax > 0)) break;
    }
  }
  for (const Met& f : found) column.found.push_back(f.covered > kMost ? f.over : f.entry);
  return column;
}

std::vector<uint32_t> allColumns(const CubeGrid& grid) {
  std::vector<uint32_t> all(grid.columns());
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

} // namespace

bool matches(const CubeEntry& entry, const vec3& position, const vec3& normal, float within) {
  constexpr float kLeastCos = 0.8f;
  return std::abs(glm::dot(position - entry.position, entry.normal)) < within &&
         glm::dot(normal, entry.normal) > kLeastCos;
}

int axesOf(const vec3& normal) {
  constexpr float kNearly = 0.9f;
  const vec3 a = glm::abs(normal);
  const float most = maxComponent(a);
  int axes = 0;
  for (int i = 0; i < 3; ++i)
    if (a[i] >= kNearly * most) axes |= 1 << i;
  return axes;
}

CubeGrid CubeGrid::over(const vec3& lo, float edge, int resolution) {
  const float texel = edge / float(resolution - 2);
  return {lo - texel, texel, resolution};
}

CubeGrid::Place CubeGrid::placeOf(size_t column) const {
  const int blocks = resolution / 8, block = int(column / 64), in = int(column % 64);
  return {block / (blocks * blocks), block % blocks * 8 + in % 8, block / blocks % blocks * 8 + in / 8};
}

vec3 CubeGrid::pointOf(const Place& at, vec2 within) const {
  vec3 p = corner;
  p[(at.axis + 1) % 3] += (float(at.u) + within.x) * texel;
  p[(at.axis + 2) % 3] += (float(at.v) + within.y) * texel;
  return p;
}

DepthCube DepthCube::cast(const CubeGrid& grid, const RayQuery& rays, RayCounts& counts) {
  DepthCube cube{.grid = grid, .firsts = std::vector<uint32_t>(grid.columns() + 1, 0)};
  const std::vector<uint32_t> all = allColumns(grid);
  cube.castAll(all, rays, counts);
  cube.linkAll(all, rays, counts);
  return cube;
}

void DepthCube::refresh(const DirtyRegion& moved, const RayQuery& rays, RayCounts& counts) {
  std::vector<uint32_t> stale, near;
  for (size_t c = 0; c < grid.columns(); c += kBlock) { // whole blocks: few are next to one that is touched
    const CubeGrid::Place at = grid.placeOf(c);
    const auto touched = [&](float texels) {
      Aabb box;
      vec3 lo = grid.pointOf(at, vec2(-texels)), hi = grid.pointOf(at, vec2(8 + texels));
      hi[at.axis] += grid.edge();
      box.add(lo), box.add(hi);
      return moved.touches(box);
    };
    if (touched(0))
      for (size_t i = 0; i < kBlock; ++i) stale.push_back(uint32_t(c + i));
    if (touched(2))
      for (size_t i = 0; i < kBlock; ++i) near.push_back(uint32_t(c + i));
  }
  castAll(stale, rays, counts);
  linkAll(near, rays, counts);
}

float DepthCube::atEdges() const {
  size_t asked = 0, edges = 0;
  for (size_t c = 0; c < grid.columns(); ++c) {
    const CubeGrid::Place at = grid.placeOf(c);
    if (std::min(at.u, at.v) < 1 || std::max(at.u, at.v) > grid.resolution - 2) continue;
    for (uint32_t e = firsts[c]; e < firsts[c + 1]; ++e, ++asked) edges += (entries[e].neighbours & 15u) != 15u;
  }
  return asked > 0 ? float(edges) / float(asked) : 0;
}

void DepthCube::castAll(std::span<const uint32_t> columns, const RayQuery& rays, RayCounts& counts) {
  std::vector<Column> found(columns.size());
  parallelCount(columns.size(), kBlock, counts, [&](size_t begin, size_t end, RayCounts& count) {
    for (size_t i = begin; i < end; ++i) found[i] = castColumn(grid, grid.placeOf(columns[i]), rays, count);
  });
  cut += uint32_t(std::ranges::count_if(found, &Column::cut));
  std::vector<CubeEntry> all;
  std::vector<uint32_t> begins(firsts.size(), 0);
  size_t next = 0; // of `columns`, which ascend
  for (size_t c = 0; c + 1 < firsts.size(); ++c) {
    begins[c] = uint32_t(all.size());
    if (next < columns.size() && columns[next] == c) {
      all.insert(all.end(), found[next].found.begin(), found[next].found.end());
      ++next;
    } else {
      all.insert(all.end(), entries.begin() + firsts[c], entries.begin() + firsts[c + 1]);
    }
  }
  begins.back() = uint32_t(all.size());
  firsts = std::move(begins);
  entries = std::move(all);
}

/// Light is mixed from neighbours that see one another, so that none comes through a wall.
void DepthCube::linkAll(std::span<const uint32_t> columns, const RayQuery& rays, RayCounts& counts) {
  parallelCount(columns.size(), kBlock, counts, [&](size_t begin, size_t end, RayCounts& count) {
    std::vector<Ray> asked;
    std::vector<std::pair<uint32_t, int>> of;
    for (size_t i = begin; i < end; ++i) {
      const CubeGrid::Place at = grid.placeOf(columns[i]);
      for (uint32_t e = firsts[columns[i]]; e < firsts[columns[i] + 1]; ++e) {
        CubeEntry& entry = entries[e];
        entry.neighbours = 0;
        for (int k = 0; k < 8; ++k) {
          const int u = at.u + kCubeNeighbours[k][0], v = at.v + kCubeNeighbours[k][1];
          if (u < 0 || v < 0 || u >= grid.resolution || v >= grid.resolution) continue;
          const size_t c = grid.column(at.axis, u, v);
          for (uint32_t o = firsts[c]; o < firsts[c + 1]; ++o) {
            const CubeEntry& other = entries[o];
            if (!matches(other, entry.position, entry.normal, kNextPlane * grid.texel)) continue;
            asked.push_back(
                segment(lifted(entry, grid.texel, rays.rayEpsilon()), lifted(other, grid.texel, rays.rayEpsilon())));
            of.emplace_back(e, k);
          }
        }
      }
    }
    std::vector<uint8_t> blocked(asked.size());
    rays.occluded(asked, blocked);
    count.occlusion += asked.size();
    for (size_t j = 0; j < of.size(); ++j)
      if (!blocked[j]) entries[of[j].first].neighbours |= 1u << of[j].second;
  });
}

} // namespace lambent

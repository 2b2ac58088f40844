#include "gi/cube/cube_surfaces.h"

#include "engine/core/parallel.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

constexpr size_t kBlock = 64;                      // columns cast as one
constexpr int kMostSurfaces = 64;                  // that a ray goes through
constexpr float kSamePlane = 0.3f, kNextPlane = 1; // texels
constexpr vec2 kWithin[] = {{0.5f, 0.5f}, {0.25f, 0.25f}, {0.75f, 0.25f}, {0.25f, 0.75f}, {0.75f, 0.75f}};

/// Off the surface as far as its curvature may hide neighbours from one another.
vec3 lifted(const CubeEntry& e, float texel, float grain) {
  return offsetPoint(e.position, e.normal, grain) + e.normal * (0.1f * texel);
}

} // namespace

bool CubeSurfaces::matches(const CubeEntry& entry, const vec3& position, const vec3& normal, float within) {
  constexpr float kLeastCos = 0.8f;
  return std::abs(glm::dot(position - entry.position, entry.normal)) < within &&
         glm::dot(normal, entry.normal) > kLeastCos;
}

int CubeSurfaces::axesOf(const vec3& normal) {
  constexpr float kNearly = 0.9f;
  const vec3 a = glm::abs(normal);
  const float most = maxComponent(a);
  int axes = 0;
  for (int i = 0; i < 3; ++i)
    if (a[i] >= kNearly * most) axes |= 1 << i;
  return axes;
}

bool CubeSurfaces::holds(const Aabb& boundsWorld) const {
  const vec3 hi = corner_ + float(resolution_) * texel_;
  return !empty() && glm::all(glm::greaterThanEqual(boundsWorld.lo, corner_)) &&
         glm::all(glm::lessThanEqual(boundsWorld.hi, hi)) &&
         maxComponent(boundsWorld.size()) > 0.5f * float(resolution_) * texel_;
}

CubeSurfaces::Place CubeSurfaces::placeOf(size_t column) const {
  const int blocks = resolution_ / 8, block = int(column / 64), in = int(column % 64);
  return {block / (blocks * blocks), block % blocks * 8 + in % 8, block / blocks % blocks * 8 + in / 8};
}

vec3 CubeSurfaces::pointOf(const Place& at, vec2 within) const {
  vec3 p = corner_;
  p[(at.axis + 1) % 3] += (float(at.u) + within.x) * texel_;
  p[(at.axis + 2) % 3] += (float(at.v) + within.y) * texel_;
  return p;
}

/// A ray through the middle, then four around it, which find what the first misses.
std::vector<CubeEntry> CubeSurfaces::cast(const Place& at, const RayQuery& rays, RayCounts& counts) const {
  std::vector<CubeEntry> found;
  const auto known = [&](const CubeEntry& e) {
    return std::any_of(found.begin(), found.end(), [&](const CubeEntry& f) {
      if (!matches(f, e.position, e.normal, kSamePlane * texel_)) return false;
      ++counts.occlusion;
      return !rays.occluded(segment(lifted(f, texel_, rays.grain()), lifted(e, texel_, rays.grain())));
    });
  };
  vec3 along(0);
  along[at.axis] = 1;
  for (const vec2 within : kWithin) {
    Ray ray{pointOf(at, within), along, float(resolution_) * texel_};
    for (int i = 0; i < kMostSurfaces; ++i) {
      ++counts.closest;
      const SurfaceHit h = rays.closest(ray);
      if (!h.valid() || !isFinite(h.position)) break;
      const float gone = h.position[at.axis] - ray.origin[at.axis];
      if (axesOf(h.geometricNormal) >> at.axis & 1)
        for (const float side : {1.0f, -1.0f}) {
          const CubeEntry e{h.position, side * h.geometricNormal, side * h.normal};
          if (!known(e)) found.push_back(e);
        }
      ray.origin = offsetPoint(h.position, -h.geometricNormal, rays.grain());
      ray.origin[at.axis] = std::max(ray.origin[at.axis], h.position[at.axis]);
      for (const int other : {(at.axis + 1) % 3, (at.axis + 2) % 3}) ray.origin[other] = h.position[other];
      ray.tMax -= std::max(gone, 0.0f);
      if (!(ray.tMax > 0)) break;
    }
  }
  return found;
}

void CubeSurfaces::build(const Aabb& boundsWorld, const CubeSettings& settings, const RayQuery& rays,
                         RayCounts& counts) {
  resolution_ = settings.resolution;
  // A texel more on every side: rays start outside of everything, and what moves a little stays inside.
  const float edge = std::max(maxComponent(boundsWorld.size()), 1e-20f);
  texel_ = edge / float(resolution_ - 2);
  corner_ = boundsWorld.centre() - 0.5f * float(resolution_) * texel_;
  first_.assign(3 * size_t(resolution_) * resolution_ + 1, 0);
  entries_.clear();
  std::vector<uint32_t> all(columns());
  for (size_t i = 0; i < all.size(); ++i) all[i] = uint32_t(i);
  castAll(all, rays, counts);
  linkAll(all, rays, counts);
}

std::vector<uint32_t> CubeSurfaces::update(const Disturbance& moved, const RayQuery& rays, RayCounts& counts) {
  std::vector<uint32_t> stale, near;
  const float length = float(resolution_) * texel_;
  for (size_t c = 0; c < columns(); c += kBlock) { // whole blocks: few are beside one that is touched
    const Place at = placeOf(c);
    const auto touched = [&](float texels) {
      Aabb box;
      vec3 lo = pointOf(at, vec2(-texels)), hi = pointOf(at, vec2(8 + texels));
      hi[at.axis] += length;
      box.add(lo), box.add(hi);
      return std::any_of(moved.boxes().begin(), moved.boxes().end(), [&](const Aabb& b) {
        return glm::all(glm::lessThanEqual(b.lo, box.hi)) && glm::all(glm::lessThanEqual(box.lo, b.hi));
      });
    };
    if (touched(0))
      for (size_t i = 0; i < kBlock; ++i) stale.push_back(uint32_t(c + i));
    if (touched(2))
      for (size_t i = 0; i < kBlock; ++i) near.push_back(uint32_t(c + i));
  }
  const std::vector<CubeEntry> before = entries_;
  const std::vector<uint32_t> firstBefore = first_;
  castAll(stale, rays, counts);
  linkAll(near, rays, counts);
  std::vector<uint32_t> from(entries_.size(), kNone);
  for (size_t c = 0; c < columns(); ++c)
    for (uint32_t e = first_[c]; e < first_[c + 1]; ++e)
      for (uint32_t b = firstBefore[c]; b < firstBefore[c + 1]; ++b)
        if (before[b].position == entries_[e].position && before[b].normal == entries_[e].normal &&
            before[b].shading == entries_[e].shading)
          from[e] = b;
  return from;
}

void CubeSurfaces::castAll(std::span<const uint32_t> columns, const RayQuery& rays, RayCounts& counts) {
  std::vector<std::vector<CubeEntry>> found(columns.size());
  std::vector<RayCounts> perBlock((columns.size() + kBlock - 1) / kBlock);
  parallelFor(columns.size(), kBlock, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) found[i] = cast(placeOf(columns[i]), rays, perBlock[begin / kBlock]);
  });
  for (const RayCounts& c : perBlock) counts += c;
  std::vector<CubeEntry> entries;
  std::vector<uint32_t> first(first_.size(), 0);
  size_t next = 0; // of `columns`, which ascend
  for (size_t c = 0; c + 1 < first_.size(); ++c) {
    first[c] = uint32_t(entries.size());
    if (next < columns.size() && columns[next] == c) {
      entries.insert(entries.end(), found[next].begin(), found[next].end());
      ++next;
    } else {
      entries.insert(entries.end(), entries_.begin() + first_[c], entries_.begin() + first_[c + 1]);
    }
  }
  first.back() = uint32_t(entries.size());
  first_ = std::move(first);
  entries_ = std::move(entries);
}

/// Light is mixed from neighbours that see one another, so that none comes through a wall.
void CubeSurfaces::linkAll(std::span<const uint32_t> columns, const RayQuery& rays, RayCounts& counts) {
  std::vector<RayCounts> perBlock((columns.size() + kBlock - 1) / kBlock);
  parallelFor(columns.size(), kBlock, [&](size_t begin, size_t end) {
    std::vector<Ray> asked;
    std::vector<std::pair<uint32_t, int>> of;
    for (size_t i = begin; i < end; ++i) {
      const Place at = placeOf(columns[i]);
      for (uint32_t e = first_[columns[i]]; e < first_[columns[i] + 1]; ++e) {
        CubeEntry& entry = entries_[e];
        entry.neighbours = 0;
        for (int k = 0; k < 8; ++k) {
          const int u = at.u + kCubeNeighbours[k][0], v = at.v + kCubeNeighbours[k][1];
          if (u < 0 || v < 0 || u >= resolution_ || v >= resolution_) continue;
          const size_t c = column(at.axis, u, v);
          for (uint32_t o = first_[c]; o < first_[c + 1]; ++o) {
            const CubeEntry& other = entries_[o];
            if (!matches(other, entry.position, entry.normal, kNextPlane * texel_)) continue;
            asked.push_back(segment(lifted(entry, texel_, rays.grain()), lifted(other, texel_, rays.grain())));
            of.emplace_back(e, k);
          }
        }
      }
    }
    std::vector<uint8_t> blocked(asked.size());
    rays.occluded(asked, blocked);
    perBlock[begin / kBlock].occlusion += asked.size();
    for (size_t j = 0; j < of.size(); ++j)
      if (!blocked[j]) entries_[of[j].first].neighbours |= 1u << of[j].second;
  });
  for (const RayCounts& c : perBlock) counts += c;
}

} // namespace lambent

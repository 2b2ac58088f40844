#include "gi/volume/volume_visibility.h"

#include "engine/core/parallel.h"
#include "gi/lighting/dirty_region.h"
#include "shaders/shared/light_volume.h"

#include <bit>
#include <cmath>
#include <utility>

namespace lambent {

namespace {

constexpr float kAllOfIt = 1.001f;  // width of a grid over the scene's
constexpr float kMoving = 1.25f;    // where that has been seen to grow: every new grid is a visible step
constexpr float kLeastCell = 1e-5f; // of the scene's width, which floats still tell apart
constexpr size_t kAtOnce = 1 << 14; // cells whose rays are listed together: 34 MB

const ivec3 kAxes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

ivec3 cellAt(size_t index, int cells) {
  return {int(index % cells), int(index / cells % cells), int(index / cells / cells)};
}

/// A little longer at both ends: what a centre lies on stops light on both sides.
Ray between(const vec3& a, const vec3& b) { return {a - 0.01f * (b - a), b - a, 1.02f}; }

/// occluded() for blocks of cells side by side.
void blockedBy(const RayQuery& rays, std::span<const Ray> asked, std::span<uint8_t> blocked) {
  parallelFor(asked.size(), 4096, [&](size_t begin, size_t end) {
    rays.occluded(asked.subspan(begin, end - begin), blocked.subspan(begin, end - begin));
  });
}

} // namespace

VolumeGrid volumeGrid(const VolumeSettings& settings, const SceneView& view, const VolumeGrid& before) {
  VolumeGrid grid;
  grid.cells = settings.cells;
  const Aabb& bounds = view.boundsWorld;
  const float widest = std::max(maxComponent(bounds.size()), 1e-20f);
  if (settings.size > 0) {
    const float farthest = std::max(widest, maxComponent(glm::abs(view.camera.position())));
    grid.cell = std::max(settings.size / float(settings.cells), kLeastCell * farthest);
    grid.first = ivec3(glm::floor(view.camera.position() / grid.cell)) - settings.cells / 2;
    return grid;
  }
  float slack = kAllOfIt;
  if (before.cells == grid.cells && before.cell > 0) {
    const vec3 lo = before.corner(), hi = lo + float(before.cells) * before.cell;
    const bool inside = glm::all(glm::greaterThanEqual(bounds.lo, lo)) && glm::all(glm::lessThanEqual(bounds.hi, hi));
    if (inside && widest > 0.5f * before.cell * float(before.cells)) return before;
    slack = kMoving;
  }
  grid.cell = widest * slack / float(settings.cells);
  grid.offset = bounds.centre() - 0.5f * float(settings.cells) * grid.cell;
  return grid;
}

bool VolumeVisibility::barred(const ivec3& at, int axis) const {
  return !grid_.holds(at) || !grid_.holds(at + kAxes[axis]) || (blocked_[grid_.index(at)][size_t(axis)] & 1) != 0;
}

bool VolumeVisibility::update(const VolumeGrid& grid, const World& world, bool occlusion, RayCounts& counts) {
  const bool sameLattice = grid.cells == grid_.cells && grid.cell == grid_.cell && grid.offset == grid_.offset &&
                           occlusion == occlusion_ && !world.view.changes.first;
  const bool moved = grid.first != grid_.first;
  if (sameLattice && !moved && (!occlusion || world.moved.empty())) return false;
  const VolumeGrid before = grid_;
  grid_ = grid;
  occlusion_ = occlusion;
  const size_t size = grid.size();
  open_.assign(size, vec4(1));
  if (!occlusion) {
    sights_.assign(size, glm::uvec2(~0u));
    blocked_.clear();
    return true;
  }
  const auto oldBlocked = std::exchange(blocked_, {});
  const auto oldKnown = std::exchange(sightsKnown_, {});
  const auto oldSights = std::exchange(sights_, {});
  blocked_.assign(size, {});
  sightsKnown_.assign(size, 0);
  sights_.assign(size, glm::uvec2(~0u));
  std::vector<uint32_t> stale;
  for (size_t i = 0; i < size; ++i) {
    const ivec3 at = cellAt(i, grid.cells), was = at + grid.first - before.first;
    if (!sameLattice || !before.holds(was) || world.moved.touches(grid.centre(at), 1.8f * grid.cell)) {
      stale.push_back(uint32_t(i));
      continue;
    }
    const size_t from = before.index(was);
    blocked_[i] = oldBlocked[from];
    sightsKnown_[i] = oldKnown[from];
    sights_[i] = oldSights[from];
  }
  traceFaces(stale, world.rays, counts);
  closeWalls();
  traceSights(world.rays, counts);
  return true;
}

void VolumeVisibility::traceFaces(const std::vector<uint32_t>& stale, const RayQuery& rays, RayCounts& counts) {
  static const vec2 kPlaces[kTests] = {{0, 0}, {-0.25f, -0.25f}, {0.25f, -0.25f}, {-0.25f, 0.25f}, {0.25f, 0.25f}};
  for (size_t first = 0; first < stale.size(); first += kAtOnce) {
    const std::span some = std::span(stale).subspan(first, std::min(kAtOnce, stale.size() - first));
    std::vector<Ray> asked;
    asked.reserve(some.size() * 3 * kTests);
    for (uint32_t i : some) {
      const vec3 centre = grid_.centre(cellAt(i, grid_.cells));
      for (int axis = 0; axis < 3; ++axis)
        for (const vec2& place : kPlaces) {
          vec3 aside(0);
          aside[(axis + 1) % 3] = place.x;
          aside[(axis + 2) % 3] = place.y;
          const vec3 from = centre + aside * grid_.cell;
          asked.push_back(between(from, from + vec3(kAxes[axis]) * grid_.cell));
        }
    }
    std::vector<uint8_t> blocked(asked.size());
    blockedBy(rays, asked, blocked);
    counts.occlusion += asked.size();
    size_t next = 0;
    for (uint32_t i : some)
      for (int axis = 0; axis < 3; ++axis)
        for (int k = 0; k < kTests; ++k) blocked_[i][size_t(axis)] |= uint8_t(blocked[next++] << k);
  }
}

/// Openness from the tests. A wall bars the straight way and every way around: all ways along centres would have to
/// cross it somewhere.
void VolumeVisibility::closeWalls() {
  for (size_t i = 0; i < open_.size(); ++i) {
    const ivec3 at = cellAt(i, grid_.cells);
    for (int axis = 0; axis < 3; ++axis) {
      const uint8_t bits = blocked_[i][size_t(axis)];
      open_[i][axis] = 1 - float(std::popcount(bits)) / kTests;
      if (!(bits & 1)) continue;
      bool around = false;
      for (int turn = 0; turn < 4 && !around; ++turn) {
        const int aside = (axis + 1 + turn % 2) % 3;
        const ivec3 step = turn < 2 ? kAxes[aside] : -kAxes[aside], low = turn < 2 ? at : at + step;
        around = !barred(low, aside) && !barred(at + step, axis) && !barred(low + kAxes[axis], aside);
      }
      if (!around) open_[i][axis] = 0;
    }
  }
}

/// Whether anything is in the way between any two neighbours of the 27 centres around.
bool VolumeVisibility::nearWall(const ivec3& at) const {
  for (int z = -1; z <= 1; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x) {
        const ivec3 other = at + ivec3(x, y, z);
        if (!grid_.holds(other)) continue;
        const auto& bits = blocked_[grid_.index(other)];
        if ((x < 1 && bits[0]) || (y < 1 && bits[1]) || (z < 1 && bits[2])) return true;
      }
  return false;
}

void VolumeVisibility::traceSights(const RayQuery& rays, RayCounts& counts) {
  std::vector<uint32_t> cells;
  for (size_t i = 0; i < sights_.size(); ++i)
    if (!sightsKnown_[i] && nearWall(cellAt(i, grid_.cells))) cells.push_back(uint32_t(i));
  for (size_t first = 0; first < cells.size(); first += kAtOnce) {
    const std::span some = std::span(cells).subspan(first, std::min(kAtOnce, cells.size() - first));
    std::vector<Ray> asked;
    asked.reserve(some.size() * 64);
    for (uint32_t i : some) {
      const vec3 centre = grid_.centre(cellAt(i, grid_.cells));
      for (int part = 0; part < 64; ++part) {
        const vec3 to = (vec3(part & 3, part >> 2 & 3, part >> 4) - 1.5f) * 0.5f;
        asked.push_back({centre, to * grid_.cell, 1});
      }
    }
    std::vector<uint8_t> blocked(asked.size());
    blockedBy(rays, asked, blocked);
    counts.occlusion += asked.size();
    for (size_t n = 0; n < some.size(); ++n) {
      glm::uvec2& sees = sights_[some[n]];
      sees = glm::uvec2(0);
      for (int part = 0; part < 64; ++part)
        if (!blocked[n * 64 + size_t(part)]) sees[part / 32] |= 1u << (part % 32);
      sightsKnown_[some[n]] = 1;
    }
  }
}

} // namespace lambent

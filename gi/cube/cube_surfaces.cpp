#include "gi/cube/cube_surfaces.h"

#include "engine/core/error.h"

#include <algorithm>
#include <iterator>

namespace lambent {

/// Leaf by leaf in the order of octants, so that a tree that was kept has its entries where a new one has them.
struct CubeSurfaces::Growth {
  const CubeSurfaces& before;
  const DirtyRegion* moved; // null: nothing is kept
  const RayQuery& rays;
  RayCounts& counts;
  size_t memory = ~size_t(0); // bytes that it may take
  size_t taken = 0;
  std::vector<CubeNode> nodes = {};
  std::vector<DepthCube> cubes = {};
  std::vector<uint32_t> from = {}; // by cube: the one it was, or kNone

  bool touched(const CubeGrid& grid) const {
    constexpr float kAround = 2; // texels: links reach as far
    const Aabb box = grid.box();
    return moved->touches(Aabb{box.lo - kAround * grid.texel, box.hi + kAround * grid.texel});
  }
  void addLeaf(uint32_t node, DepthCube cube, uint32_t was) {
    constexpr size_t kMostColumns = size_t(1) << 30;
    if ((cubes.size() + 1) * before.columns() > kMostColumns)
      throw RunError("the tree of layered depth cubes has too many columns (lower cube.levels or raise cube.split)");
    constexpr size_t kTwice = 2; // parts, and all of them together
    taken += kTwice * (cube.firsts.size() * sizeof(uint32_t) + cube.entries.size() * sizeof(CubeEntry));
    if (taken > memory)
      throw RunError("the tree of layered depth cubes needs more memory than is left (lower cube.levels or "
                     "cube.resolution, or raise cube.split)");
    nodes[node].firstColumn = uint32_t(cubes.size() * before.columns());
    cubes.push_back(std::move(cube));
    from.push_back(was);
  }
  uint32_t addChildren(uint32_t node) {
    const uint32_t first = uint32_t(nodes.size());
    nodes.resize(nodes.size() + 8);
    nodes[node].children = first;
    return first;
  }
  /// `was`: the node that stood here, or kNone.
  void grow(uint32_t node, const vec3& lo, float edge, int level, uint32_t was) {
    const CubeGrid grid = CubeGrid::over(lo, edge, before.resolution_);
    nodes[node] = {grid.corner, grid.texel, 0, 0, 0, 0};
    const CubeNode* old = was == kNone ? nullptr : &before.nodes_[was];
    const bool wasLeaf = old && old->children == 0;
    const uint32_t oldCube = wasLeaf ? uint32_t(old->firstColumn / before.columns()) : kNone;
    const bool same = old && !touched(grid);
    bool split = same && !wasLeaf;
    if (!split) {
      DepthCube cube = wasLeaf ? before.cubeOf(oldCube) : DepthCube::cast(grid, rays, counts);
      if (wasLeaf && !same) cube.refresh(*moved, rays, counts);
      split = !(same && wasLeaf) && level < before.levels_ && cube.atEdges() > before.split_;
      if (!split) return addLeaf(node, std::move(cube), oldCube);
    }
    const uint32_t children = addChildren(node);
    for (uint32_t octant = 0; octant < 8; ++octant) {
      const vec3 at = lo + 0.5f * edge * vec3(octant & 1, octant >> 1 & 1, octant >> 2);
      grow(children + octant, at, 0.5f * edge, level + 1, old && !wasLeaf ? old->children + octant : kNone);
    }
  }
};

namespace {
constexpr float kLeastEdge = 1e-20f; // metres
float edgeOver(const Aabb& boundsWorld) { return std::max(maxComponent(boundsWorld.size()), kLeastEdge); }
} // namespace

bool CubeSurfaces::holds(const Aabb& boundsWorld) const {
  // Narrow cubes of a tree reach less far: as far as rounding puts the box beside what it was built over.
  const float rounding = 8e-7f * (edge_ + maxComponent(glm::max(glm::abs(boundsWorld.lo), glm::abs(boundsWorld.hi))));
  const float around = levels_ > 0 ? rounding : texel() + rounding;
  return !empty() && glm::all(glm::greaterThanEqual(boundsWorld.lo, lo_ - around)) &&
         glm::all(glm::lessThanEqual(boundsWorld.hi, lo_ + edge_ + around)) && edgeOver(boundsWorld) > 0.5f * edge_;
}

DepthCube CubeSurfaces::cubeOf(uint32_t index) const {
  const auto first = firsts_.begin() + std::ptrdiff_t(index * columns());
  DepthCube cube{cubes_[index], {first, first + std::ptrdiff_t(columns()) + 1}, {}};
  const uint32_t begin = cube.firsts.front();
  cube.entries.assign(entries_.begin() + begin, entries_.begin() + cube.firsts.back());
  for (uint32_t& f : cube.firsts) f -= begin;
  return cube;
}

CubeSurfaces::Growth CubeSurfaces::grow(const DirtyRegion* moved, const RayQuery& rays, RayCounts& counts,
                                        size_t memory) const {
  Growth growth{*this, moved, rays, counts, memory};
  growth.nodes.resize(1);
  growth.grow(0, lo_, edge_, 0, moved ? 0 : kNone);
  return growth;
}

void CubeSurfaces::adopt(Growth& growth) {
  nodes_ = std::move(growth.nodes);
  cubes_.clear();
  firsts_.assign(1, 0);
  entries_.clear();
  for (DepthCube& cube : growth.cubes) {
    cut_ += cube.cut;
    cubes_.push_back(cube.grid);
    const uint32_t begin = uint32_t(entries_.size());
    std::transform(cube.firsts.begin() + 1, cube.firsts.end(), std::back_inserter(firsts_),
                   [&](uint32_t f) { return begin + f; });
    if (entries_.empty())
      entries_ = std::move(cube.entries);
    else
      entries_.insert(entries_.end(), cube.entries.begin(), cube.entries.end());
    cube = {};
  }
}

void CubeSurfaces::build(const Aabb& boundsWorld, const CubeSettings& settings, const RayQuery& rays, RayCounts& counts,
                         size_t memory) {
  edge_ = edgeOver(boundsWorld);
  lo_ = boundsWorld.centre() - 0.5f * edge_;
  resolution_ = settings.resolution;
  levels_ = settings.levels;
  split_ = settings.split;
  cut_ = 0;
  Growth growth = grow(nullptr, rays, counts, memory);
  adopt(growth);
}

std::vector<uint32_t> CubeSurfaces::update(const DirtyRegion& moved, const RayQuery& rays, RayCounts& counts,
                                           size_t memory) {
  Growth growth = grow(&moved, rays, counts, memory);
  const std::vector<CubeEntry> before = std::move(entries_);
  const std::vector<uint32_t> firstsBefore = std::move(firsts_);
  adopt(growth);
  std::vector<uint32_t> from(entries_.size(), kNone);
  for (size_t cube = 0; cube < cubes_.size(); ++cube) {
    if (growth.from[cube] == kNone) continue;
    for (size_t c = 0; c < columns(); ++c) {
      const size_t now = cube * columns() + c, was = growth.from[cube] * columns() + c;
      for (uint32_t e = firsts_[now]; e < firsts_[now + 1]; ++e)
        for (uint32_t b = firstsBefore[was]; b < firstsBefore[was + 1]; ++b)
          if (before[b].position == entries_[e].position && before[b].normal == entries_[e].normal &&
              before[b].shading == entries_[e].shading)
            from[e] = b;
    }
  }
  return from;
}

} // namespace lambent

// Values in the order of CubeFile::each, as engine/core/checked_file.h stores them.
#include "gi/cube/cube_file.h"

#include "engine/core/checked_file.h"
#include "engine/core/parallel.h"
#include "engine/view/scene_hash.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>

namespace lambent {

namespace {

constexpr uint32_t kVersion = 4; // counts up when the file or the meaning of its numbers changes
constexpr uint32_t kBytes = uint32_t((sizeof(CubeEntry) * 1000 + sizeof(VirtualLight)) * 1000 + sizeof(GatherSettings));

const FileKind kKind{{'L', 'A', 'M', 'B', 'C', 'U', 'B', '\n'},
                     kVersion,
                     kBytes,
                     "a layered depth cube",
                     "--cube-file wants a new name, or what it wrote before"};
const ByteLayout kOfGather{offsetof(GatherSettings, glossy) + 1,
                           offsetof(GatherSettings, spread),
                           {offsetof(GatherSettings, checks), offsetof(GatherSettings, glossy)}};
const ByteLayout kOfLight{offsetof(VirtualLight, alive) + 1, sizeof(VirtualLight), {offsetof(VirtualLight, alive)}};

bool isUnit(const vec3& v) { return std::abs(glm::dot(v, v) - 1) < 1e-3f; }

} // namespace

/// What the file holds of a cube, and what each value must be for the rest to rely on it.
struct CubeFile {
  template <class Stream, class Cube> static void each(Stream& stream, Cube& cube) {
    auto& s = cube.surfaces_;
    stream.value(s.lo_);
    stream.value(s.edge_);
    stream.value(s.resolution_);
    stream.value(s.levels_);
    stream.value(s.split_);
    stream.value(s.cut_);
    stream.value(cube.settings_);
    stream.value(cube.gather_, kOfGather);
    stream.vector(s.nodes_);
    stream.vector(s.cubes_);
    stream.vector(s.firsts_);
    stream.vector(s.entries_);
    stream.vector(cube.in_, kOfLight);
    stream.vector(cube.seen_);
    stream.vector(cube.sums_);
  }

  /// Walks the tree as CubeSurfaces::Growth grows it: every node where it must lie, leaves in the order of octants.
  struct Walk {
    const CubeSurfaces& s;
    size_t nodes = 0, leaves = 0;
    bool right(size_t at, const vec3& lo, float edge, int level) {
      const CubeGrid grid = CubeGrid::over(lo, edge, s.resolution_);
      const CubeNode& node = s.nodes_[at];
      ++nodes;
      if (node.corner != grid.corner || node.texel != grid.texel) return false;
      if (node.children == 0)
        return leaves < s.cubes_.size() && s.cubes_[leaves] == grid && node.firstColumn == leaves++ * s.columns();
      if (level >= s.levels_ || node.children <= at || size_t(node.children) + 8 > s.nodes_.size()) return false;
      for (uint32_t octant = 0; octant < 8; ++octant)
        if (!right(node.children + octant, lo + 0.5f * edge * vec3(octant & 1, octant >> 1 & 1, octant >> 2),
                   0.5f * edge, level + 1))
          return false;
      return true;
    }
  };
  static bool surfacesRight(const LayeredCube& cube) {
    constexpr int kMostTexels = 16384, kMostLevels = 24; // so that no product overflows
    const CubeSurfaces& s = cube.surfaces_;
    if (s.resolution_ != cube.settings_.resolution || s.levels_ != cube.settings_.levels ||
        s.split_ != cube.settings_.split)
      return false;
    if (s.resolution_ < 8 || s.resolution_ % 8 != 0 || s.resolution_ > kMostTexels) return false;
    if (s.levels_ < 0 || s.levels_ > kMostLevels) return false;
    if (!isFinite(s.lo_) || !std::isfinite(s.edge_) || !(s.edge_ > 0)) return false;
    Walk walk{s};
    if (s.nodes_.empty() || !walk.right(0, s.lo_, s.edge_, 0)) return false;
    if (walk.nodes != s.nodes_.size() || walk.leaves != s.cubes_.size()) return false;
    if (s.firsts_.size() != s.cubes_.size() * s.columns() + 1 || s.firsts_.front() != 0 ||
        s.firsts_.back() != s.entries_.size() || !std::is_sorted(s.firsts_.begin(), s.firsts_.end()))
      return false;
    return everyOf(s.firsts_.size() - 1, [&](size_t column) {
      const CubeGrid& grid = s.cubes_[column / s.columns()];
      const CubeGrid::Place at = grid.placeOf(column % s.columns());
      Aabb texel; // and one around it
      for (const float within : {-1.0f, 2.0f}) texel.add(grid.pointOf(at, vec2(within)));
      texel.lo[at.axis] = grid.corner[at.axis] - grid.texel;
      texel.hi[at.axis] = grid.corner[at.axis] + grid.edge() + grid.texel;
      return std::all_of(
          s.entries_.data() + s.firsts_[column], s.entries_.data() + s.firsts_[column + 1],
          [&](const CubeEntry& e) { return texel.contains(e.position) && isUnit(e.normal) && isUnit(e.shading); });
    });
  }
  /// Sums are what the lights bring that are seen, to the rounding that lights leave which came and went.
  static bool sumsRight(const LayeredCube& cube) {
    const size_t words = cube.words();
    if (cube.sums_.size() != cube.surfaces_.entries_.size() || cube.seen_.size() != cube.sums_.size() * words)
      return false;
    for (const VirtualLight& l : cube.in_)
      if (l.alive && !(isFinite(l.position) && isUnit(l.normal) && isUnit(l.geometricNormal) && isFinite(l.radiance) &&
                       std::isfinite(l.area) && l.area >= 0))
        return false;
    return everyOf(cube.sums_.size(), [&](size_t e) {
      dvec3 wanted(0);
      for (size_t w = 0; w < words; ++w)
        for (LayeredCube::Word left = cube.seen_[e * words + w]; left; left &= left - 1) {
          const size_t light = w * LayeredCube::kBatch + size_t(std::countr_zero(left));
          if (light >= cube.in_.size() || !cube.in_[light].alive) return false;
          wanted += cube.bring(cube.surfaces_.entries_[e], cube.in_[light]);
        }
      constexpr double kOtherBuild = 1e-4; // another compiler joins products and sums otherwise
      return glm::length(cube.sums_[e] - wanted) <= kOtherBuild * glm::length(wanted); // false for NaN
    });
  }
  template <class Holds> static bool everyOf(size_t count, const Holds& holds) {
    std::atomic<bool> all = true;
    parallelFor(count, 4096, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end && all; ++i)
        if (!holds(i)) all = false;
    });
    return all;
  }
};

uint64_t cubeKey(const SceneView& view) {
  Hash hash(kVersion);
  addGeometry(hash, view, false, false);
  return hash.result();
}

void saveCube(const std::filesystem::path& file, const LayeredCube& cube, uint64_t key) {
  writeChecked(file, kKind, key, [&](CheckedWriter& writer) { CubeFile::each(writer, cube); });
}

bool isCube(const std::filesystem::path& file) { return isChecked(file, kKind); }

LayeredCube loadCube(const std::filesystem::path& file, uint64_t key) {
  CheckedReader reader(file, kKind);
  if (reader.key() != key) reader.refuse("is a layered depth cube of another scene, or its objects stood elsewhere");
  LayeredCube cube;
  CubeFile::each(reader, cube);
  reader.end();
  if (!CubeFile::surfacesRight(cube) || !CubeFile::sumsRight(cube)) reader.damaged();
  return cube;
}

} // namespace lambent

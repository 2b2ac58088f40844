// The layered depth cube (paper 5, section 3): three orthogonal images over the scene's box whose texels hold, layer by
// layer, the surfaces behind them as planes with the irradiance they receive. It does not depend on the view, and stays
// as long as lights and objects stand still. Contents of this folder in data-flow order:
//   cube_surfaces   what lies behind each texel
//   hemicube        which entries a light sees, by five images around it (paper 5, sections 4.1 and 4.3)
//   layered_cube    lights put in and taken out, by these or by a ray for every entry and light
//   cube_file       the same on disk
// World space, metres.
#pragma once

#include "engine/trace/ray_query.h"
#include "gi/contract/virtual_lights.h"
#include "gi/cube/cube_surfaces.h"
#include "gi/cube/hemicube.h"
#include "gi/lighting/dirty_region.h"
#include "gi/plan/settings.h"

#include <array>

namespace lambent {

struct CubeInputs {
  const Aabb& boundsWorld; // of the scene
  const RayQuery& rays;
  const DirtyRegion& moved; // where geometry changed since the last call
  bool newScene = false;
  std::span<const VirtualLight> lights; // that do not depend on the view
  uint32_t firstLights = 0;             // slots of those that reflect direct light: their hemicubes are finer
  const CubeSettings& settings;
  const GatherSettings& gather;
  HemicubeMaker* hemicubes = nullptr; // null: cast
  size_t memory = 0;                  // bytes that it may take; 0: what this machine has left
};

/// What an update did.
struct CubeWork {
  uint32_t lightsIn = 0, lightsOut = 0; // put in, taken out: 64 that were lit again count in both
  uint32_t entriesAnew = 0;
  bool changed = false; // the irradiance of any entry may be other than before
  RayCounts rays;
};

/// The sums of an entry are doubles: a light taken out leaves what was there before, to rounding.
class LayeredCube {
 public:
  /// Brings surfaces up to date, and `lights` as far as `most` of them allow: the rest is put in by later calls.
  /// Done where pending() is 0. After lights and objects changed it equals one that was built from them. Throws
  /// RunError where memory is short; after whatever was thrown it is empty.
  CubeWork update(const CubeInputs& in, uint32_t most = ~0u);
  /// Says whether it is of such settings and as many lights, so that an update goes on from it.
  bool isOf(const CubeSettings& settings, const GatherSettings& gather, size_t lights) const {
    return settings_ == settings && gather_ == gather && in_.size() == lights;
  }
  /// Lights that the last update left to do.
  uint32_t pending() const { return pending_; }

  const CubeSurfaces& surfaces() const { return surfaces_; }
  /// Irradiance of an entry of surfaces(), W/m², under its shading normal.
  vec3 irradiance(size_t entry) const { return vec3(sums_[entry]); }
  /// Bytes of what keeps the cube up to date: entries, their sums, and who sees whom.
  size_t bytesKept() const;

 private:
  friend struct CubeFile; // gi/cube/cube_file.cpp
  using Word = uint64_t;
  static constexpr uint32_t kBatch = 64; // lights, a word's bits

  size_t words() const { return (in_.size() + kBatch - 1) / kBatch; }
  /// Of sums and sights, and of those that are looked at.
  double bytesOfEntry() const { return double((words() + 1) * sizeof(Word) + sizeof(dvec3)); }
  CubeWork advance(const CubeInputs& in, uint32_t most);
  void clear(size_t memory);
  void adoptSurfaces(const CubeInputs& in, CubeWork& work);
  void put(const CubeInputs& in, size_t word, Word which, CubeWork& work, const std::vector<uint8_t>* isNew);
  std::vector<Word> byRays(const CubeInputs& in, size_t word, Word which, RayCounts& counts,
                           const std::vector<uint8_t>* isNew) const;
  std::vector<Word> byHemicubes(const CubeInputs& in, size_t word, Word which, RayCounts& counts) const;
  dvec3 bring(const CubeEntry& entry, const VirtualLight& light) const;
  void take(size_t entry, const dvec3& light);

  CubeSettings settings_;
  GatherSettings gather_;
  CubeSurfaces surfaces_;
  std::vector<VirtualLight> in_; // that the sums hold, by slot; not alive: none
  std::vector<Word> seen_;       // entry by entry, a bit for each slot
  std::vector<dvec3> sums_;      // W/m²
  uint32_t pending_ = 0;
};

} // namespace lambent

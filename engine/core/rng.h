// Counter-based random numbers: a value is a hash of (seed, stream, id, frame, counter), so any thread may draw any
// number at any time and results never depend on scheduling.
#pragma once

#include "engine/core/math.h"

namespace lambent {

/// Finaliser of SplitMix64 (Steele et al. 2014): bijective, all output bits depend on all input bits.
inline uint64_t mix64(uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// One random purpose each, so that no two stages share numbers.
enum class Stream : uint32_t {
  VisiblePoints = 1,
  Validation,
  Candidates,
  Resample,
  LightPaths,
  SamplerPaths,
  Test,
  Emitters,
  Reference,
  Cells,
  Photons,
  Acceptance,
  MapTests,
  NearLight,
  Turns,
  SkyLight,
  SamplerSkyLight,
  SurfaceSamples,
  NearLightTurns,
  LightLists,
  RayWork,
  Mirrors
};

/// A sequence of numbers addressed by what they are for.
class Rng {
 public:
  Rng(uint32_t seed, Stream stream, uint32_t id, uint32_t frame = 0)
      : key_(mix64(mix64((uint64_t(seed) << 32 | uint32_t(stream)) + kStep) ^
                   mix64((uint64_t(frame) << 32 | id) + 1))) {}

  uint32_t nextUint() { return uint32_t(mix64(key_ += kStep) >> 32); }
  /// Skips `n` numbers.
  void skip(uint32_t n) { key_ += n * kStep; }
  /// Uniform in [0, 1).
  float next() { return float(nextUint() >> 8) * 0x1p-24f; }
  vec2 next2() {
    const float a = next();
    return {a, next()};
  }
  vec3 next3() {
    const vec2 a = next2();
    return {a, next()};
  }
  /// Uniform integer in [0, n), n > 0.
  uint32_t below(uint32_t n) { return uint32_t((uint64_t(nextUint()) * n) >> 32); }

 private:
  static constexpr uint64_t kStep = 0x9e3779b97f4a7c15ull;
  uint64_t key_;
};

} // namespace lambent

// Where a moving view casts near rays. The error of near light sits where surfaces are close to each other and where a
// surface has just come into sight, which is little of an image. So pixels remember how many of their rays brought
// light, and cast as many as that says: as the root of the share, for the variance of a pixel goes with it. Each ray
// counts 1 over the rays that its pixel was expected to cast, which only frames before decide. What it brings:
// docs/decisions.md, 2026-11-26, near light by lists. They also remember what their rays brought, by which outliers are
// told (near_mix.h).
#pragma once

#include "engine/trace/ray_query.h"
#include "engine/view/scene_view.h"

#include <optional>
#include <span>
#include <vector>

namespace lambent {

/// What frames before say of a pixel.
struct NearExpected {
  float rays;      // that it is expected to cast
  float near;      // share of its rays that brought light; a guess where it is not known
  float worthRays; // rays that this share is worth
  float light;     // luminance that its rays brought; 0 where it is not known
};

/// What the pixels of a frame found, row by row from the top. 32 bytes a pixel.
struct NearMemory {
  CameraView camera;
  std::vector<vec3> positions, normals; // world space, m; unit vectors; infinitely far: no surface
  std::vector<float> near;              // share of a pixel's rays that brought light
  std::vector<float> light;             // luminance of the irradiance that they brought: a moving mean over about 16
                                        // frames, from 0

  void forget() { positions.clear(); }
  void fit(const CameraView& seenBy);
  /// Keeps what a pixel was expected to find and found: of `cast` rays `brought` brought light, together irradiance of
  /// luminance `found`. Counts of what is no number only what was there before.
  void keep(size_t pixel, const NearExpected& before, uint32_t cast, uint32_t brought, float found);
};

class NearRates {
 public:
  /// `surfaces`: some that the frame sees, spread over the image; pixels like them cast `budget` rays on the mean.
  NearRates(const NearMemory& before, std::span<const SurfaceHit> surfaces, float budget);

  NearExpected at(const SurfaceHit& surface) const;

 private:
  /// The pixel that saw the place; none: none did.
  std::optional<size_t> pixelOf(const SurfaceHit& surface) const;
  float weightOf(std::optional<size_t> pixel) const;
  float raysOf(float weight) const;

  const NearMemory& before_;
  mat4 clipFromWorld_;
  float budget_, rate_; // rays: of a pixel on the mean; of one whose weight is 1
};

} // namespace lambent

// Where a moving view casts near rays. The error of near light sits where surfaces are close to each other and where a
// surface has just come into sight, which is little of an image. So pixels remember how many of their rays brought
// light, and cast as many as that says: as the root of the share, for the variance of a pixel goes with it. Each ray
// counts 1 over the rays that its pixel was expected to cast, which only frames before decide. What it brings:
// docs/decisions.md, 2026-11-26, near light by lists.
#pragma once

#include "engine/scene/scene_view.h"
#include "engine/trace/ray_query.h"

#include <optional>
#include <span>
#include <vector>

namespace lambent {

/// What the pixels of a frame found, row by row from the top. 32 bytes a pixel.
struct NearMemory {
  CameraView camera;
  std::vector<vec3> positions, normals; // world space, m; unit vectors; infinitely far: no surface
  std::vector<float> near;              // share of a pixel's rays that brought light
  std::vector<float> light;             // that they brought, luminance of the irradiance: a mean over frames

  void forget() { positions.clear(); }
  void fit(const CameraView& seenBy);
};

class NearRates {
 public:
  /// `surfaces`: some that the frame sees, spread over the image; pixels like them cast `budget` rays on the mean.
  NearRates(const NearMemory& before, std::span<const SurfaceHit> surfaces, float budget);

  struct Rate {
    float rays;  // of the pixel, expected
    float near;  // share that brought light before; a guess where it is not known
    float known; // rays that this share is worth
    float light; // luminance that its rays brought before; 0 where it is not known
  };
  Rate at(const SurfaceHit& surface) const;

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

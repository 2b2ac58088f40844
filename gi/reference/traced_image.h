// A path-traced image of a view under the settings of the frame: images drawn with these settings are compared with it.
#pragma once

#include "gi/plan/settings.h"
#include "gi/reference/path_tracer.h"

#include <filesystem>
#include <functional>
#include <span>

namespace lambent {

struct TracePlan {
  ReferenceBuffer buffer = ReferenceBuffer::Indirect;
  uint32_t samples = 64;                       // of each pixel
  double error = 0;                            // stop sooner at this ReferenceImage::relativeError
  bool clamped = false;                        // bound the geometry term as gather.clamp bounds virtual lights
  uint32_t seed = 1;                           // of all random numbers
  std::filesystem::path state = {};            // keep the sums in this file, and go on from it when it is there
  std::function<bool()> cancelled = {};        // asked about once a second; what was sampled so far is the image
  const std::atomic<bool>* stopped = nullptr;  // as ReferenceInputs: the pass that it breaks off does not count
  std::function<void(int, int)> progress = {}; // samples taken, samples expected
};

struct TracedImage {
  ReferenceImage image = {};
  uint32_t samples = 0; // 0: cancelled before the first
  int bounces = 0;
  float clamp = 0;    // 1/m²; 0 = none
  float exposure = 1; // as set, or as GiFrame would measure it
  RayCounts rays = {};
  double sampleSeconds =
      0; // that one sample of every pixel took, without what is made once; 0: none was taken in this run
};

/// Says whether the truth of a buffer reflects as glossy surfaces do: where the settings say so, but for irradiance,
/// which does not depend on how it is reflected.
bool tracesGlossy(const SceneView& view, const Settings& settings, ReferenceBuffer buffer);

/// Says whether samples mix what blended surfaces show; irradiance is of one surface, drawn by the pixel.
bool mixesBlended(const SceneView& view, ReferenceBuffer buffer);

/// Says whether the truth has the normals of normal maps where the camera looks.
bool tracesNormalMaps(const SceneView& view, const Settings& settings);

/// Traces a view. Throws InputError for a state file of another image.
TracedImage traceImage(const SceneView& view, const Settings& settings, const TracePlan& plan);

} // namespace lambent

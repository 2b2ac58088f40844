// Errors of a technique over time at tracked pixels (paper 1, 5.2 and eq. 10). Pure functions of recorded series.
#pragma once

#include "engine/view/scene_view.h"
#include "gi/measure/watched.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lambent {

/// Tone-mapped luminance of tracked pixels over time: [frame][pixel], NaN where the camera sees no surface.
using PixelSeries = std::vector<std::vector<float>>;

/// Reinhard's operator x/(1+x) on the luminance of radiance times exposure: what errors are measured on.
float toneMappedLuminance(const vec3& radiance, float exposure);
/// Variance of that where radiance has this standard error: by its derivative 1/(1+x)², as if channels were fully
/// correlated.
double toneMappedVariance(const vec3& radiance, const vec3& error, float exposure);

/// Of values at points, where `seen` says that the camera sees a surface: both [frame][point].
PixelSeries toneMappedSeries(std::span<const std::vector<TrackedValue>> values,
                             const std::vector<std::vector<bool>>& seen, float exposure);

/// E = technique − truth, averaged over frames and pixels; E' = E(t) − E(t−1), over pixels seen in both frames.
struct StabilityErrors {
  double error = 0;  // mean |E|
  double change = 0; // mean |E'|
  double bias = 0;   // mean E
  size_t count = 0;  // of values of E
};
/// Over the pixels listed. Both series have the same shape.
StabilityErrors stabilityErrors(const PixelSeries& technique, const PixelSeries& truth,
                                std::span<const uint32_t> pixels);

/// How soon a technique follows a step of the scene, in frames: L90 of one pixel is the number of frames after the one
/// in which the scene changed until 90 % of the technique's own change has been made for the first time; 0 = at once.
/// Its own change leads from its value before the step to its mean over the last quarter of the time until the next
/// step. Pixels whose truth changes by less than `least` are left out.
/// As a technique that hardly changes at all would be quick, `followed` says how much of the truth's change is made.
struct Latency {
  double median = 0, worstTenth = 0; // over pixels and steps; the worst tenth's best
  double followed = 0;               // sum of own changes, towards the truth's, over the sum of the truth's; 1 is all
  size_t count = 0;                  // of pixels and steps; 0: no step that shows
};
/// `steps`: frames in which the scene differs from the frame before by a step, ascending.
Latency latency90(const PixelSeries& technique, const PixelSeries& truth, std::span<const uint32_t> pixels,
                  std::span<const size_t> steps, float least = 0.02f);

/// Whether an object moved so far since the frame before that the light may follow it by a step: some corner of its
/// bounds by a quarter of their diagonal in world space or more. `boundsObject` are those of its mesh.
bool jumped(const InstanceView& instance, const Aabb& boundsObject);

/// Finds frames in which some light differs from the frame before by half or more, or some object jumps.
class StepFinder {
 public:
  /// Whether this frame is one; to be asked in every frame.
  bool step(const SceneView& view);

 private:
  std::vector<float> before_; // luminance of each light
};

} // namespace lambent

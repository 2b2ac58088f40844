// The truth that images are compared with: a path tracer over the same scene data, albedos and light units as the VPLs.
// Paths have exactly B indirect bounces (B = 1: light → y → x), next-event estimation at every vertex and multiple
// importance sampling for emissive surfaces and for a sky that is not constant; a constant one is met by the
// cosine-distributed rays. Pixel rays go through pixel
// centres, as the rasteriser's. Sample s of pixel p has its own random numbers, so sums do not depend on the number of
// threads, on how a run is cut into passes, or on being continued later.
#pragma once

#include "engine/image/image.h"
#include "gi/lighting/light_set.h"

#include <atomic>

namespace lambent {

struct ReferenceInputs {
  const RayQuery& rays;
  const LightSet& lights;
  const CameraView& camera;
  int bounces = 3;   // B; 0: emission and direct light only
  float clamp = 0;   // largest geometry term between primary hit and first bounce, 1/m² (as gather.clamp); 0 = none
  uint32_t seed = 1; // of all random numbers
  /// Primary hits reflect by the roughness and metalness of this view's materials, as with gather.glossy; null:
  /// Lambert.
  const SceneView* glossy = nullptr;
  const SceneView* normalMaps = nullptr; // primary hits have the normals of this view's maps; null: the meshes' own
  /// The view, where it has blended materials: each sample meets them by a chance of its own. Null: rays' own bits
  /// decide.
  const SceneView* blended = nullptr;
  /// So do the rays of pixels that show blended surfaces. Their sums hold the radiance that is seen, and do not give
  /// irradiance.
  bool mixes = false;
  /// Another thread sets it to make addSamples return soon; what was added is then part of a pass and of no use.
  const std::atomic<bool>* stopped = nullptr;
};

/// Sums over the samples of one pixel. `direct` and `indirect` are irradiance/π: what a white surface would reflect;
/// with ReferenceInputs::glossy the radiance that the surface does reflect; where ReferenceInputs::mixes applies the
/// radiance that is seen, `direct` with emission and sky.
struct PixelSums {
  glm::dvec3 direct{0}, directSquares{0};
  glm::dvec3 indirect{0}, indirectSquares{0};
  glm::dvec3 product{0}; // direct · indirect, for the variance of their sum
};

struct ReferenceSums {
  static constexpr uint32_t kMostSamples = 1u << 24; // of a pixel
  int width = 0, height = 0;
  uint32_t samples = 0; // of each pixel
  std::vector<PixelSums> pixels;

  ReferenceSums() = default;
  ReferenceSums(int w, int h) : width(w), height(h), pixels(size_t(w) * h) {}
};

/// Takes `count` more samples of every pixel. The sums have the camera's size.
void addSamples(ReferenceSums& sums, const ReferenceInputs& in, uint32_t count, RayCounts& counts);

/// Takes `samples` samples at each of some surfaces (surfacesAt), as at the pixels of an image. Random numbers belong
/// to the surface's index and the sample, not to a frame: when the camera moves a little the noise of a tracked pixel
/// stays nearly the same, so differences between consecutive frames are known far better than the values.
std::vector<PixelSums> sampleSurfaces(std::span<const SurfaceHit> surfaces, const ReferenceInputs& in, uint32_t samples,
                                      RayCounts& counts);

/// The same meanings as the buffers of GiFrame.
enum class ReferenceBuffer { Beauty, Direct, Indirect, Irradiance };

/// An image and how well it is known.
struct ReferenceImage {
  Image mean;
  Image error;                  // standard error of each pixel's mean; infinite for a single sample
  std::vector<uint8_t> surface; // 1 where the camera sees a surface, 0 where it sees the sky
  /// Root of the mean squared standard error over pixels and channels, over the mean of the image: the RMSE to expect
  /// against the exact image, relative.
  double relativeError = 0;
  /// Standard error of the image's mean over that mean, as if a pixel's channels were fully correlated (else less).
  double relativeErrorOfMean = 0;
};
/// Reads a buffer from the sums. Those of glossy and mixed pixels do not give irradiance.
ReferenceImage readReference(const ReferenceSums& sums, const ReferenceInputs& in, ReferenceBuffer buffer);

} // namespace lambent

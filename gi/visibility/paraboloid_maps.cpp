// Distance maps of VPLs and emissive samples: bookkeeping and the choice of the maker. Paper 1, section 4.4, draws them
// on the GPU; we also cast rays on the CPU, and keep whichever is faster on this machine and scene.
#include "gi/visibility/paraboloid_makers.h"

#include "engine/core/error.h"
#include "engine/gl/profiler.h"
#include "engine/gl/pulse.h"

#include <algorithm>

namespace lambent {

ParaboloidMaps ParaboloidMapPass::run(const ParaboloidMapInputs& in) {
  const gl::PassScope scope = context_.scope(stage_);
  mapsDrawn_ = 0;
  CHECK(in.farDistance > 0);
  std::vector<MapJob> all;
  std::span<const MapJob> jobs = in.jobs;
  if (redrawsAll(in)) {
    allocate(in);
    all.resize(in.poses.size());
    for (uint32_t i = 0; i < all.size(); ++i) all[i] = {i, TexelRect::whole(in.resolution)};
    jobs = all;
  }
  for (const MapJob& job : jobs) CHECK_LT(job.slot, in.poses.size());

  const ShadowMaker asked = in.rays ? in.maker : ShadowMaker::Raster;
  if (asked != ShadowMaker::Auto && !jobs.empty()) maker_.take(asked == ShadowMaker::Raster);
  if (asked == ShadowMaker::Auto && !maker_.measured() && !jobs.empty()) measureMakers(in, jobs);
  const bool raster = asked == ShadowMaker::Raster || (asked == ShadowMaker::Auto && maker_.gpu());
  raster ? drawRaster(in, jobs) : drawRays(in, jobs);
  mapsDrawn_ = uint32_t(jobs.size());
  return {arrays_, resolution_, in.farDistance};
}

bool ParaboloidMapPass::redrawsAll(const ParaboloidMapInputs& in) const {
  return resolution_ != in.resolution || farDistance_ != in.farDistance || slots_ != in.poses.size();
}

void ParaboloidMapPass::allocate(const ParaboloidMapInputs& in) {
  const size_t needed = (in.poses.size() + kLayersPerArray - 1) / kLayersPerArray;
  const int lastLayers = needed == 0 ? 0 : int(in.poses.size() - (needed - 1) * kLayersPerArray);
  arrays_.clear();
  for (size_t i = 0; i < needed; ++i)
    arrays_.emplace_back(name_ + "/array " + std::to_string(i),
                         gl::TextureDesc{.kind = gl::TextureKind::Array,
                                         .format = GL_DEPTH_COMPONENT16,
                                         .width = in.resolution,
                                         .height = in.resolution,
                                         .layers = i + 1 < needed ? kLayersPerArray : lastLayers});
  resolution_ = in.resolution;
  farDistance_ = in.farDistance;
  slots_ = in.poses.size();
}

void ParaboloidMapPass::measureMakers(const ParaboloidMapInputs& in, std::span<const MapJob> jobs) {
  // The first map of each maker pays for shaders and caches. Eight more, spread over the slots, are timed: enough to
  // even out where they stand, and the rays' worker threads get more than one map each.
  std::vector<MapJob> sample;
  for (size_t i = 0; i < std::min<size_t>(8, jobs.size()); ++i)
    sample.push_back({jobs[i * jobs.size() / std::min<size_t>(8, jobs.size())].slot, TexelRect::whole(in.resolution)});
  const std::span<const MapJob> one = std::span(sample).first(1);
  drawRaster(in, one);
  gl::pulse();
  drawRays(in, one);
  const auto msOfEach = [](std::span<const MapJob> maps, const auto& draw) {
    gl::pulse();
    return gl::secondsOf([&] { draw(maps); }) * 1e3 / double(maps.size());
  };
  const auto raster = [&](std::span<const MapJob> maps) { drawRaster(in, maps); };
  const double raysMs = msOfEach(sample, [&](std::span<const MapJob> maps) { drawRays(in, maps); });
  // Where one map says enough, eight would take as long as all of them take by rays: a second of Sponza's first
  // frame.
  constexpr double kHopeless = 4;
  double rasterMs = msOfEach(one, raster);
  if (rasterMs < kHopeless * raysMs) rasterMs = msOfEach(sample, raster);
  maker_.measure(raysMs, rasterMs, "a map");
}

std::vector<float> ParaboloidMapPass::readLayer(uint32_t slot) const {
  const size_t array = slot / kLayersPerArray;
  CHECK_LT(array, arrays_.size());
  return readMap(arrays_[array], int(slot % kLayersPerArray), farDistance_);
}

std::vector<float> readMap(const gl::Texture& array, int layer, float farDistance) {
  const int resolution = array.width();
  std::vector<uint16_t> values(size_t(resolution) * resolution);
  array.readLayer(layer, std::span(values), GL_DEPTH_COMPONENT, GL_UNSIGNED_SHORT);
  std::vector<float> distances(values.size());
  for (size_t i = 0; i < values.size(); ++i)
    distances[i] =
        values[i] == 65535 ? kInfinity : float(values[i]) * float(values[i]) / (65535.0f * 65535.0f) * farDistance;
  return distances;
}

MakerComparison ParaboloidMapPass::compareMakers(const ParaboloidMapInputs& in, const MapPose& pose) {
  const gl::PassScope scope = context_.scope(StageId::MapComparison);
  CHECK(in.rays != nullptr);
  const gl::Texture scratch(name_ + "/comparison", {.kind = gl::TextureKind::Array,
                                                    .format = GL_DEPTH_COMPONENT16,
                                                    .width = in.resolution,
                                                    .height = in.resolution,
                                                    .layers = 2});
  rasterInto(in, pose, scratch, 0);
  const std::vector<uint16_t> texels = castMap(in, pose, TexelRect::whole(in.resolution));
  glTextureSubImage3D(scratch.name(), 0, 0, 0, 1, in.resolution, in.resolution, 1, GL_DEPTH_COMPONENT,
                      GL_UNSIGNED_SHORT, texels.data());
  return {in.resolution, readMap(scratch, 0, in.farDistance), readMap(scratch, 1, in.farDistance)};
}

} // namespace lambent

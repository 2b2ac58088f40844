// Distance maps of VPLs and emissive samples: bookkeeping, the two makers and the choice between them. Paper 1, section
// 4.4, draws them on the GPU; we also cast rays on the CPU. Maps of both agree up to half a texel, which
// tests/gl/maps_test.cpp checks.
#include "gi/visibility/paraboloid_maps.h"

#include "engine/core/error.h"
#include "engine/core/free_memory.h"
#include "engine/core/memory.h"
#include "engine/core/parallel.h"
#include "engine/gl/profiler.h"
#include "engine/gl/pulse.h"
#include "engine/trace/ray_query.h"
#include "shaders/shared/coverage.h"
#include "shaders/shared/shadow_lookup.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

/// The light's frame, as VplLight stores it: columns tangent, bitangent, normal.
mat3 frameOf(const MapPose& pose) {
  mat3 frame;
  basisAround(pose.normal, frame[0], frame[1]);
  frame[2] = pose.normal;
  return frame;
}

/// Reads a layer as distances in metres, kInfinity where nothing is met.
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

/// Gives texels at odd multiples of `gap`, in columns or rows, a distance from their neighbours at even ones.
void fillBetween(std::vector<float>& distances, int width, int height, int gap) {
  // Along a plane 1/distance is nearly linear; where it jumps, two surfaces meet.
  const auto between = [](float a, float b) {
    constexpr float kJump = 1.5f;
    return std::max(a, b) < kJump * std::min(a, b) ? 2 * a * b / (a + b) : a;
  };
  for (int y = 0; y < height; y += 2 * gap)
    for (int x = gap; x < width; x += 2 * gap) {
      float* at = &distances[size_t(y) * width + x];
      *at = between(at[-gap], at[x + gap < width ? gap : -gap]);
    }
  const ptrdiff_t rows = ptrdiff_t(gap) * width;
  for (int y = gap; y < height; y += 2 * gap)
    for (int x = 0; x < width; x += gap) {
      float* at = &distances[size_t(y) * width + x];
      *at = between(at[-rows], at[y + gap < height ? rows : -rows]);
    }
}

/// Casts the texels of a part of one map on the CPU, row by row: paraboloidValue(distance / farDistance) in 16 bits,
/// 65535 where nothing is met. A step of 2 or 4: a ray for every so many texels and rows; texels between have the mean
/// of their neighbours on one surface, where these are nearly equal, else the nearest one's. Thread-safe.
std::vector<uint16_t> castMap(const ParaboloidMapInputs& in, const MapPose& pose, const TexelRect& texels,
                              int step = 1) {
  const int n = in.resolution, width = texels.x1 - texels.x0;
  const mat3 worldFromLight = frameOf(pose);
  const vec3 origin = pose.origin();
  std::vector<Ray> rays;
  std::vector<uint32_t> texelOfRay;
  rays.reserve(size_t(texelsTraced(texels, step)));
  texelOfRay.reserve(size_t(texelsTraced(texels, step)));
  // 8×8 blocks keep neighbouring rays neighbours in memory, for the ray tracer's packets.
  const int block = 8 * step;
  for (int by = texels.y0; by < texels.y1; by += block)
    for (int bx = texels.x0; bx < texels.x1; bx += block)
      for (int y = by; y < std::min(by + block, texels.y1); y += step)
        for (int x = bx; x < std::min(bx + block, texels.x1); x += step) {
          const vec3 d = directionFromParaboloid((vec2(x, y) + 0.5f) / float(n));
          if (d.z < -2.0f * float(step) / float(n)) continue; // as map_resample.frag
          Ray& ray =
              rays.emplace_back(); // made elsewhere and copied, each waits for its own stores: a third of all here
          ray.origin = origin;
          ray.direction = worldFromLight * d;
          ray.tMax = in.farDistance;
          if (in.checkered) ray.key = (x / step + y / step) % 2 ? kMeetsAll : kMeetsNone;
          texelOfRay.push_back(uint32_t((y - texels.y0) * width + x - texels.x0));
        }
  std::vector<float> met(rays.size());
  in.rays->distances(rays, met);
  std::vector<float> distances(size_t(texels.area()), kInfinity);
  for (size_t i = 0; i < rays.size(); ++i) distances[texelOfRay[i]] = met[i];
  for (int gap = step / 2; gap > 0; gap /= 2) fillBetween(distances, width, texels.y1 - texels.y0, gap);
  std::vector<uint16_t> values(distances.size(), 65535);
  for (size_t i = 0; i < distances.size(); ++i)
    if (distances[i] < in.farDistance)
      values[i] = uint16_t(paraboloidValue(distances[i] / in.farDistance) * 65535.0f + 0.5f);
  return values;
}

} // namespace

ParaboloidMaps ParaboloidMapPass::run(const ParaboloidMapInputs& in) {
  const gl::PassScope scope = context_.scope(stage_);
  mapsDrawn_ = 0;
  CHECK(in.farDistance > 0);
  std::vector<MapJob> all;
  std::span<const MapJob> jobs = in.jobs;
  if (redrawsAll(in)) {
    allocate(in);
    if (!in.jobsAreAll) {
      all.resize(in.poses.size());
      for (uint32_t i = 0; i < all.size(); ++i) all[i] = {i, TexelRect::whole(in.resolution)};
      jobs = all;
    }
  }
  for (const MapJob& job : jobs) CHECK_LT(job.slot, in.poses.size());

  const ShadowMaker asked = in.rays ? in.maker : ShadowMaker::Raster;
  if (!jobs.empty()) {
    maker_.take(asked == ShadowMaker::Auto ? std::nullopt : std::optional(asked == ShadowMaker::Raster),
                [&] { return timesOf(in, jobs); });
    draw(in, jobs, asked == ShadowMaker::Auto);
  }
  mapsDrawn_ = uint32_t(jobs.size());
  return {arrays_, resolution_, in.farDistance};
}

/// A map of which little changed costs the GPU as much as a whole one, and rays next to nothing: of a hall in motion
/// parts of 1300 maps are 0.2 million rays, and an H100's frame went from 976 to 694 ms.
void ParaboloidMapPass::draw(const ParaboloidMapInputs& in, std::span<const MapJob> jobs, bool partsByRays) {
  if (!maker_.gpu()) return drawRays(in, jobs);
  if (!partsByRays) return drawRaster(in, jobs);
  constexpr int kPart = 8; // of so many of a map's texels one
  const int64_t most = int64_t(in.resolution) * in.resolution / kPart;
  std::vector<MapJob> parts, whole;
  const TexelRect all = TexelRect::whole(in.resolution); // never a part, however coarse: nobody would make it whole
  for (const MapJob& job : jobs)
    (job.texels != all && texelsTraced(job.texels, job.step) <= most ? parts : whole).push_back(job);
  drawRays(in, parts);
  drawRaster(in, whole);
}

bool ParaboloidMapPass::redrawsAll(const ParaboloidMapInputs& in) const {
  return resolution_ != in.resolution || farDistance_ != in.farDistance || slots_ != in.poses.size() ||
         checkered_ != in.checkered;
}

void ParaboloidMapPass::allocate(const ParaboloidMapInputs& in) {
  const size_t needed = (in.poses.size() + kLayersPerArray - 1) / kLayersPerArray;
  const int lastLayers = needed == 0 ? 0 : int(in.poses.size() - (needed - 1) * kLayersPerArray);
  arrays_.clear();
  slots_ = 0, resolution_ = 0; // where they cannot be had, whoever goes on with less has them made
  // Each array alone may fit: together they are filled frame by frame, when it is too late to refuse.
  const double bytes = 2.0 * double(in.poses.size()) * in.resolution * in.resolution;
  const std::string asked = stage_ == StageId::EmitterMaps ? "shadow.emitterSamples, shadow.emitterResolution"
                                                           : "fewer lights, shadow.resolution";
  if (context_.drawnByCpu && bytes > double(freeMemory()))
    throw RunError("graphics memory: shadow maps of " + std::to_string(in.poses.size()) + " lights need " +
                   moreThanIsLeft(bytes, "lower " + asked));
  for (size_t i = 0; i < needed; ++i)
    arrays_.emplace_back(name_ + " (" + asked + ")/array " + std::to_string(i),
                         gl::TextureDesc{.kind = gl::TextureKind::Array,
                                         .format = GL_DEPTH_COMPONENT16,
                                         .width = in.resolution,
                                         .height = in.resolution,
                                         .layers = i + 1 < needed ? kLayersPerArray : lastLayers});
  resolution_ = in.resolution;
  farDistance_ = in.farDistance;
  checkered_ = in.checkered;
  slots_ = in.poses.size();
}

MakerTimes ParaboloidMapPass::timesOf(const ParaboloidMapInputs& in, std::span<const MapJob> jobs) {
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
  return {raysMs, rasterMs, "a map"};
}

std::vector<float> ParaboloidMapPass::readLayer(uint32_t slot) const {
  const size_t array = slot / kLayersPerArray;
  CHECK_LT(array, arrays_.size());
  return readMap(arrays_[array], int(slot % kLayersPerArray), farDistance_);
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

// Raster -------------------------------------------------------------------------------------------------------------
// Paper 1: a cube whose corner (1,1,1) points along the normal, so that three faces cover the hemisphere, with off-axis
// frusta that reach over [-2,1]² around each face's axis; then one pass brings the faces into the paraboloid map.

void ParaboloidMapPass::rasterInto(const ParaboloidMapInputs& in, const MapPose& pose, const gl::Texture& array,
                                   int layer) {
  // A map's texel takes the nearest of a face's, whose ray is up to 0.7 of those away: it should be less of its own.
  // With faces of half as many, corners lay up to 0.7 of a map's texel off, and more was dark that is seen than lit
  // that is not.
  const int faceResolution = in.resolution * 3;
  if (!faces_ || faces_.width() != faceResolution) {
    faces_ = gl::Texture(name_ + "/faces", {.kind = gl::TextureKind::Array,
                                            .format = GL_DEPTH_COMPONENT32F,
                                            .width = faceResolution,
                                            .height = faceResolution,
                                            .layers = 3});
    facesFramebuffer_ = gl::Framebuffer(name_ + "/faces");
    layerFramebuffer_ = gl::Framebuffer(name_ + "/layer");
  }
  // An orthonormal cube frame with (1,1,1)/√3 along z of the light's frame.
  const float a = std::sqrt(2.0f / 3), b = std::sqrt(1.0f / 6), c = std::sqrt(0.5f), h = std::sqrt(1.0f / 3);
  const vec3 axes[3] = {{a, 0, h}, {-b, c, h}, {-b, -c, h}};
  const mat3 worldFromLight = frameOf(pose);
  const vec3 origin = pose.origin();
  const float near = in.farDistance * 1e-5f;

  facesFramebuffer_.bind();
  gl::PipelineState{.depthTest = true, .depthWrite = true, .width = faceResolution, .height = faceResolution}.apply();
  for (int face = 0; face < 3; ++face) {
    const vec3 right = worldFromLight * axes[(face + 1) % 3], up = worldFromLight * axes[(face + 2) % 3],
               forward = worldFromLight * axes[face];
    // x' = (x/z + 2)·2/3 - 1: [-2,1] to [-1,1]; reversed depth near/z.
    const vec4 rows[4] = {vec4(right * (2.0f / 3) + forward * (1.0f / 3), 0),
                          vec4(up * (2.0f / 3) + forward * (1.0f / 3), 0), vec4(0, 0, 0, near), vec4(forward, 0)};
    mat4 clipFromRelative = glm::transpose(mat4(rows[0], rows[1], rows[2], rows[3]));
    mat4 relativeFromWorld(1);
    relativeFromWorld[3] = vec4(-origin, 1);
    facesFramebuffer_.attachDepthLayer(faces_, face);
    const float nothing = 0;
    glClearNamedFramebufferfv(facesFramebuffer_.name(), GL_DEPTH, 0, &nothing);
    in.scene.draw(DrawKind::Depth, clipFromRelative * relativeFromWorld);
  }

  const gl::Program& program = context_.programs.get({.fragment = "map_resample.frag"});
  program.set("resolution", float(in.resolution));
  program.set("nearDistance", near);
  program.set("farDistance", in.farDistance);
  program.set("axisX", axes[0]);
  program.set("axisY", axes[1]);
  program.set("axisZ", axes[2]);
  program.use();
  faces_.bind(0);
  layerFramebuffer_.attachDepthLayer(array, layer);
  layerFramebuffer_.bind();
  gl::PipelineState{
      .depthTest = true, .depthWrite = true, .depthFunc = GL_ALWAYS, .width = in.resolution, .height = in.resolution}
      .apply();
  gl::drawFullscreen();
}

/// Maps are drawn whole: a part costs the same three faces.
void ParaboloidMapPass::drawRaster(const ParaboloidMapInputs& in, std::span<const MapJob> jobs) {
  for (const MapJob& job : jobs)
    rasterInto(in, in.poses[job.slot], arrays_[job.slot / kLayersPerArray], int(job.slot % kLayersPerArray));
}

// Rays ---------------------------------------------------------------------------------------------------------------

void ParaboloidMapPass::drawRays(const ParaboloidMapInputs& in, std::span<const MapJob> jobs) {
  // In batches, so that the texels of 2048 maps need not wait in memory together (64 MiB at 128²).
  constexpr size_t kBatch = 64;
  std::vector<std::vector<uint16_t>> maps(std::min(kBatch, jobs.size()));
  for (size_t begin = 0; begin < jobs.size(); begin += kBatch) {
    gl::pulse();
    const std::span<const MapJob> batch = jobs.subspan(begin, std::min(kBatch, jobs.size() - begin));
    parallelFor(batch.size(), 1, [&](size_t from, size_t to) {
      for (size_t i = from; i < to; ++i) maps[i] = castMap(in, in.poses[batch[i].slot], batch[i].texels, batch[i].step);
    });
    for (size_t i = 0; i < batch.size(); ++i) {
      const auto& [slot, t, step] = batch[i];
      glTextureSubImage3D(arrays_[slot / kLayersPerArray].name(), 0, t.x0, t.y0, int(slot % kLayersPerArray),
                          t.x1 - t.x0, t.y1 - t.y0, 1, GL_DEPTH_COMPONENT, GL_UNSIGNED_SHORT, maps[i].data());
    }
  }
}

} // namespace lambent

#include "gi/gather/map_checks.h"

#include "engine/core/parallel.h"
#include "engine/trace/ray_query.h"
#include "gi/gather/draw_gather.h"
#include "gi/near/near_mix.h"
#include "shaders/shared/octahedral.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

/// A pixel and the light that it drew, as gather.frag writes it.
struct DrawnPair {
  uint32_t layer;        // the light's slot in its chunk
  float gain;            // times its power: irradiance for the pixel; negative where the map says shadowed, 0: none
  float viewDistance;    // m; 0 where nothing is seen
  int16_t octahedral[2]; // normal
};
static_assert(sizeof(DrawnPair) == 16);

/// Length of a side of the mean cell.
float cellOf(std::span<const VirtualLight> lights) {
  double area = 0, alive = 0;
  for (const VirtualLight& light : lights)
    if (light.alive) area += light.area, ++alive;
  return alive > 0 ? float(std::sqrt(area / alive)) : 0;
}

} // namespace

std::span<const gl::Framebuffer> MapChecks::begin(const GatherInputs& in, const LightTarget& target, bool subsets) {
  framebuffers_.clear();
  const bool known = in.lights.maps && !in.lights.list.slots.empty();
  if (!in.frame.settings.gather.checks || !subsets || in.lists || in.rest < 1 || !known) return {};
  const glm::ivec2 size = target.size();
  const size_t chunks = (in.lights.list.packed.count + kLightsPerChunk - 1) / kLightsPerChunk;
  if (chunks == 0) return {};
  if (drawn_.size() != chunks || drawn_[0].width() != size.x || drawn_[0].height() != size.y) {
    drawn_.clear();
    for (size_t i = 0; i < chunks; ++i)
      drawn_.emplace_back("map checks", gl::TextureDesc{.format = GL_RGBA32UI, .width = size.x, .height = size.y});
  }
  const SurfaceLighting light = target.light();
  for (const gl::Texture& drawn : drawn_)
    framebuffers_.push_back(light.glossy ? gl::Framebuffer("map checks", {light.irradiance, light.glossy, &drawn})
                                         : gl::Framebuffer("map checks", {light.irradiance, &drawn}));
  return framebuffers_;
}

void MapChecks::add(const GatherInputs& in, const LightTarget& target, FrameStats& stats) {
  const CameraView& camera = in.frame.world.view.camera;
  const RayQuery& rays = in.frame.world.rays;
  const vec3 forward = -vec3(camera.worldFromView[2]);
  const glm::ivec2 tile = tileSize(in.frame.surfaces), size = target.size();
  const size_t pixels = size_t(camera.width) * camera.height, grain = 512;
  std::vector<vec3> differences(pixels, vec3(0)), positions(pixels, vec3(kInfinity)), normals(pixels, vec3(0));
  std::vector<std::vector<DrawnPair>> drawn(drawn_.size(), std::vector<DrawnPair>(size_t(size.x) * size.y));
  for (size_t chunk = 0; chunk < drawn.size(); ++chunk) // waits for the GPU
    drawn_[chunk].read(std::span(drawn[chunk]), GL_RGBA_INTEGER, GL_UNSIGNED_INT);
  uint64_t count = 0; // rays
  {
    const CpuScope scope(stats.stages, key(StageId::MapChecks));
    for (uint32_t chunk = 0; chunk < drawn_.size(); ++chunk) {
      parallelCount(pixels, grain, count, [&](size_t begin, size_t end, uint64_t& ofBlock) {
        struct Asked {
          size_t pixel;
          vec3 light; // irradiance; negative where the map says shadowed
          bool lit;   // says the map
        };
        std::vector<Asked> asked;
        std::vector<Ray> segments;
        for (size_t i = begin; i < end; ++i) {
          const int x = int(i % camera.width), row = int(i / camera.width), y = camera.height - 1 - row;
          const glm::ivec2 at = glm::ivec2(x % 4, y % 4) * tile + glm::ivec2(x / 4, y / 4);
          const DrawnPair& pair = drawn[chunk][size_t(at.y) * size.x + at.x];
          if (pair.viewDistance == 0) continue;
          const CameraRay towards =
              cameraRay(camera, (float(x) + 0.5f) / float(camera.width), (float(row) + 0.5f) / float(camera.height));
          positions[i] =
              towards.origin + towards.direction * (pair.viewDistance / glm::dot(towards.direction, forward));
          normals[i] = unitFromOctahedral(glm::max(vec2(pair.octahedral[0], pair.octahedral[1]) / 32767.0f, vec2(-1)));
          if (pair.gain == 0 || !std::isfinite(pair.gain)) continue;
          const VirtualLight& light = in.lights.list.slots[size_t(chunk) * kLightsPerChunk + pair.layer];
          const float slack = placeSlack(in.frame.surfaces.block, pair.viewDistance);
          segments.push_back(segment(offsetPoint(positions[i], normals[i], rays.rayEpsilon() + slack),
                                     offsetPoint(light.position, light.geometricNormal, rays.rayEpsilon())));
          asked.push_back({i, light.radiance * (light.area * pair.gain), pair.gain > 0});
        }
        std::vector<uint8_t> blocked(segments.size());
        rays.occluded(segments, blocked);
        ofBlock += segments.size();
        for (size_t j = 0; j < asked.size(); ++j)
          if (asked[j].lit == bool(blocked[j])) differences[asked[j].pixel] -= asked[j].light;
      });
    }
    mixPixels(differences, {positions, normals, camera.width, cellOf(in.lights.list.slots)});
  }
  stats.raysChecks.occlusion += count;
  stats.of(EffectId::Indirect) += count;
  differences_.add(differences, {}, in.frame.surfaces, target, 4);
}

} // namespace lambent

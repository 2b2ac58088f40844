#include "gi/gather/near_light_pass.h"

#include "gi/gather/draw_gather.h"
#include "gi/vpl/near_light.h"

namespace lambent {

void NearLightPass::add(const IndirectInputs& in, const LightTarget& target, int grid, FrameStats& stats) {
  const GatherSettings& gather = in.settings.gather;
  const bool bounded = gather.disk > 0 || gather.clamp > 0;
  if (gather.near == 0 || !bounded || in.seen.lights.slots.empty()) return;
  NearLight light;
  {
    const CpuScope scope(stats.stages, key(StageId::NearLight));
    light = traceNearLight({.view = in.world.view,
                            .rays = in.world.rays,
                            .lights = in.world.lights,
                            .virtuals = in.seen.lights.slots,
                            .gather = gather,
                            .casts = gather.near * (in.changes ? 2 : 1),
                            .bounces = in.bounces,
                            .subsets = grid > 1,
                            .glossy = in.surfaces.finish != nullptr,
                            .seed = in.seed,
                            .picture = in.picture,
                            .pictures = in.averaged ? in.settings.history.frames : 1},
                           stats.raysNear);
    stats.of(EffectId::Indirect) += stats.raysNear.closest + stats.raysNear.occlusion;
  }
  const gl::PassScope scope = context_.scope(StageId::NearLight);
  traced_.fit(in.surfaces, target.size());
  const LightOnSurfaces traced = traced_.light();
  uploadPixels(*traced.irradiance, light.irradiance, in.surfaces, grid);
  traced.irradiance->bind(2);
  std::vector<std::string> defines;
  if (traced.glossy) {
    uploadPixels(*traced.glossy, light.glossy, in.surfaces, grid);
    traced.glossy->bind(3);
    defines.push_back("GLOSSY");
  }
  context_.programs.get({.fragment = "near_light.frag", .defines = std::move(defines)}).use();
  target.bind();
  gl::PipelineState{.add = true, .width = target.size().x, .height = target.size().y}.apply();
  gl::drawFullscreen();
}

void uploadPixels(const gl::Texture& texture, std::span<const vec3> pixels, const GBuffer& surfaces, int grid) {
  const int width = texture.width(), height = texture.height();
  const glm::ivec2 tile = grid > 1 ? tileSize(surfaces) : glm::ivec2(0);
  std::vector<vec3> placed(size_t(width) * height, vec3(0));
  for (int y = 0; y < surfaces.height; ++y) // GL's rows count from the bottom
    for (int x = 0; x < surfaces.width; ++x) {
      const glm::ivec2 at = glm::ivec2(x % grid, y % grid) * tile + glm::ivec2(x / grid, y / grid);
      placed[size_t(at.y) * width + at.x] = pixels[size_t(surfaces.height - 1 - y) * surfaces.width + x];
    }
  glTextureSubImage2D(texture.name(), 0, 0, 0, width, height, GL_RGB, GL_FLOAT, placed.data());
}

} // namespace lambent

#include "gi/gather/add_pixels.h"

#include "gi/gather/draw_gather.h"

namespace lambent {

void addLight(PassContext context, const SurfaceLighting& light, const LightTarget& target) {
  std::vector<std::string> defines;
  light.irradiance->bind(2);
  if (light.glossy) {
    light.glossy->bind(3);
    defines.push_back("GLOSSY");
  }
  context.programs.get({.fragment = "add_pixels.frag", .defines = std::move(defines)}).use();
  target.bind();
  gl::PipelineState{.add = true, .width = target.size().x, .height = target.size().y}.apply();
  gl::drawFullscreen();
}

void PixelAdder::add(std::span<const vec3> irradiance, std::span<const vec3> glossy, const GBuffer& surfaces,
                     const LightTarget& target, int grid) {
  const gl::PassScope scope = context_.scope(stage_);
  pixels_.fit(surfaces, target.size());
  const SurfaceLighting light = pixels_.light();
  uploadPixels(*light.irradiance, irradiance, surfaces, grid);
  if (light.glossy) glossy.empty() ? light.glossy->clear() : uploadPixels(*light.glossy, glossy, surfaces, grid);
  addLight(context_, light, target);
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

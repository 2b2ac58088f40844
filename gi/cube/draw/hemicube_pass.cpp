#include "gi/cube/draw/hemicube_pass.h"

#include "engine/core/parallel.h"
#include "engine/trace/ray_query.h"
#include "gi/surfaces/gpu_scene.h"

#include <algorithm>

namespace lambent {

static_assert(sizeof(HemicubeTexel) == 4 * sizeof(float)); // as distance_normal.frag writes it

void HemicubePass::prepare(const World& world, CubeMaker maker) {
  scene_ = &world.gpu;
  rays_ = &world.rays;
  // Lights stand farther off their surfaces, and no surface is known better. Reversed depth of floats is as precise
  // whatever it is.
  near_ = std::max(world.rays.rayEpsilon(), 1e-20f);
  asked_ = maker;
}

void HemicubePass::make(std::span<Hemicube> hemicubes) {
  if (hemicubes.empty()) return;
  maker_.take(asked_ == CubeMaker::Auto ? std::nullopt : std::optional(asked_ == CubeMaker::Raster),
              [&] { return timesOf(hemicubes); });
  maker_.gpu() ? draw(hemicubes) : cast(hemicubes);
}

void HemicubePass::tell(FrameStats& stats) {
  stats.raysCube += std::exchange(counts_, {});
  stats.cubeMakerTimes = maker_.report();
  stats.cubeMaker = maker_.maker();
}

MakerTimes HemicubePass::timesOf(std::span<const Hemicube> hemicubes) {
  // As ParaboloidMapPass does: the first of each pays for shaders and caches, eight more are timed.
  const size_t count = std::min<size_t>(8, hemicubes.size());
  std::vector<Hemicube> sample;
  for (size_t i = 0; i < count; ++i) sample.push_back(hemicubes[i * hemicubes.size() / count]);
  draw(std::span(sample).first(1));
  cast(std::span(sample).first(1));
  const double rasterMs = gl::secondsOf([&] { draw(sample); }) * 1e3 / double(count);
  const double raysMs = gl::secondsOf([&] { cast(sample); }) * 1e3 / double(count);
  return {raysMs, rasterMs, "a hemicube"};
}

void HemicubePass::cast(std::span<Hemicube> hemicubes) {
  parallelCount(hemicubes.size(), 1, counts_,
                [&](size_t i, size_t, RayCounts& count) { castHemicube(hemicubes[i], *rays_, count); });
}

/// As many as fit are drawn before the first is read back, straight to where it is kept: the GPU waits once.
void HemicubePass::draw(std::span<Hemicube> hemicubes) {
  constexpr size_t kTexels = size_t(4) << 20; // 64 MiB
  const gl::PassScope scope = context_.scope(StageId::Hemicubes);
  while (!hemicubes.empty()) {
    const int resolution = hemicubes.front().resolution;
    const size_t most = std::max<size_t>(1, kTexels / hemicubes.front().size());
    size_t count = 1;
    while (count < std::min(most, hemicubes.size()) && hemicubes[count].resolution == resolution) ++count;
    allocate(resolution, int(count));
    for (size_t i = 0; i < count; ++i) drawInto(int(i), hemicubes[i]);
    for (size_t i = 0; i < count; ++i) texels_.readLayer(int(i), std::span(hemicubes[i].texels), GL_RGBA, GL_FLOAT);
    hemicubes = hemicubes.subspan(count);
  }
}

void HemicubePass::allocate(int resolution, int layers) {
  if (texels_ && texels_.width() == resolution && texels_.desc().layers >= layers) return;
  texels_ = gl::Texture("hemicubes/texels", {.kind = gl::TextureKind::Array,
                                             .format = GL_RGBA32F,
                                             .width = resolution,
                                             .height = 3 * resolution,
                                             .layers = layers});
  depth_ = gl::Texture(
      "hemicubes/depth",
      {.kind = gl::TextureKind::Array, .format = GL_DEPTH_COMPONENT32F, .width = resolution, .height = 3 * resolution});
  framebuffer_ = gl::Framebuffer("hemicubes");
  framebuffer_.attachDepthLayer(depth_, 0);
}

void HemicubePass::drawInto(int layer, const Hemicube& hemicube) {
  const int n = hemicube.resolution;
  framebuffer_.attachColorLayer(texels_, layer);
  framebuffer_.bind();
  gl::PipelineState state{.depthTest = true, .depthWrite = true, .width = n, .height = 3 * n};
  state.apply();
  const float nothing[4] = {kInfinity, 0, 0, 0}, farthest = 0;
  glClearNamedFramebufferfv(framebuffer_.name(), GL_COLOR, 0, nothing);
  glClearNamedFramebufferfv(framebuffer_.name(), GL_DEPTH, 0, &farthest);
  mat4 relativeFromWorld(1);
  relativeFromWorld[3] = vec4(-hemicube.origin, 1);
  for (int face = 0; face < 5; ++face) {
    state.y = hemicube.firstRow(face);
    state.height = hemicube.rows(face);
    state.apply();
    const vec3 right = hemicube.frame * kHemicubeFaces[face].right, up = hemicube.frame * kHemicubeFaces[face].up,
               forward = hemicube.frame * kHemicubeFaces[face].forward;
    // y of the whole image from -1 to 1, of a half from its horizon; reversed depth near/z.
    const vec3 y = face == 0 ? up : up * (float(n) / float(state.height)) - forward;
    const vec4 rows[4] = {vec4(right, 0), vec4(y, 0), vec4(0, 0, 0, near_), vec4(forward, 0)};
    const vec3 column = right * (2 / float(n)), row = up * (2 / float(n));
    const vec3 corner = forward - right - (face == 0 ? up : vec3(0)) - row * float(state.y);
    scene_->draw(DrawKind::DistanceNormal, glm::transpose(mat4(rows[0], rows[1], rows[2], rows[3])) * relativeFromWorld,
                 hemicube.origin, Instances::All, mat3(column, row, corner));
  }
}

} // namespace lambent

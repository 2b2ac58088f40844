// Buffers as linear values on the CPU.
#include "gi/gather/draw_gather.h"
#include "gi/viewer/viewer.h"
#include "gi/viewer/viewer_stages.h"
#include "shaders/shared/ggx.h"

#include <algorithm>

namespace lambent {

namespace {

/// A texture's RGB, row 0 at the top; black of the wanted size when there is none.
Image rgbOf(const gl::Texture* texture, int width, int height) {
  Image image(width, height);
  if (!texture) return image;
  std::vector<vec3> bottomUp(size_t(texture->width()) * texture->height());
  texture->read(std::span(bottomUp), GL_RGB, GL_FLOAT);
  for (int y = 0; y < height; ++y)
    std::copy_n(&bottomUp[size_t(height - 1 - y) * texture->width()], width, &image.at(0, y));
  return image;
}

Image rawOf(const FrameResults& frame, int width, int height) {
  if (!frame.inside.gathered.irradiance) return rgbOf(frame.indirect.irradiance, width, height);
  if (!frame.inside.gathered.deinterleaved) return rgbOf(frame.inside.gathered.irradiance, width, height);
  const glm::ivec2 tile = tileSize(frame.surfaces);
  const Image tiles = rgbOf(frame.inside.gathered.irradiance, 4 * tile.x, 4 * tile.y);
  Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) { // y counts from the bottom here, as in the tiles
      const int tx = x % 4 * tile.x + x / 4, ty = y % 4 * tile.y + y / 4;
      image.at(x, height - 1 - y) = tiles.at(tx, 4 * tile.y - 1 - ty);
    }
  return image;
}

/// `y` counts from the top.
vec3 backgroundAt(const FrameResults& frame, int x, int y) {
  const CameraBlock& camera = frame.surfaces.block;
  const vec3 direction = viewDirectionFromPixel(camera, vec2(x, frame.surfaces.height - 1 - y) + 0.5f);
  return frame.sky.radiance(glm::normalize(mat3(camera.worldFromView) * direction));
}

Image depthOf(const FrameResults& frame) {
  const GBuffer& g = frame.surfaces;
  std::vector<float> bottomUp(size_t(g.width) * g.height);
  g.depth->read(std::span(bottomUp), GL_DEPTH_COMPONENT, GL_FLOAT);
  Image image(g.width, g.height);
  for (int y = 0; y < g.height; ++y)
    for (int x = 0; x < g.width; ++x) {
      const float depth = bottomUp[size_t(g.height - 1 - y) * g.width + x];
      image.at(x, y) = vec3(depth > 0 ? viewDistanceFromDepth(g.block, depth) : 0);
    }
  return image;
}

/// albedo/π · irradiance; with the receivers' lobes where the G-buffer has their finish, as
/// shaders/lib/receiver.glsl.
Image reflected(const FrameResults& frame, const gl::Texture* irradiance, const gl::Texture* glossyLight) {
  const GBuffer& g = frame.surfaces;
  Image image = rgbOf(irradiance, g.width, g.height);
  const Image albedo = rgbOf(g.albedo, g.width, g.height);
  if (!g.finish) {
    for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] *= albedo.pixels[i] / kPi;
    return image;
  }
  const Image glossy = rgbOf(glossyLight, g.width, g.height),
              normal = rgbOf(g.mappedNormal ? g.mappedNormal : g.normal, g.width, g.height), distance = depthOf(frame);
  std::vector<vec4> finish(size_t(g.width) * g.height); // row 0 at the bottom
  g.finish->read(std::span(finish), GL_RGBA, GL_FLOAT);
  const mat4& worldFromView = g.block.worldFromView;
  for (int y = 0; y < g.height; ++y)
    for (int x = 0; x < g.width; ++x) {
      if (distance.at(x, y).x == 0) continue;
      const vec2 ndc = (vec2(x, g.height - 1 - y) + 0.5f) * vec2(g.block.size.z, g.block.size.w) * 2.0f - 1.0f;
      const vec3 towardsView = g.block.lens.w > 0 ? vec3(0, 0, 1) : -vec3(ndc * vec2(g.block.lens), -1);
      const Receiver receiver =
          makeReceiver(normal.at(x, y), glm::normalize(mat3(worldFromView) * towardsView), albedo.at(x, y),
                       finish[size_t(g.height - 1 - y) * size_t(g.width) + size_t(x)]);
      image.at(x, y) = receiver.diffuse / kPi * image.at(x, y) + glossyTint(receiver) * glossy.at(x, y);
    }
  return image;
}

} // namespace

Image readBuffer(Buffer buffer, const FrameResults& frame) {
  const int width = frame.surfaces.width, height = frame.surfaces.height;
  switch (buffer) {
  case Buffer::Direct: {
    Image image = reflected(frame, frame.direct.irradiance, frame.direct.glossy);
    const Image emission = rgbOf(frame.surfaces.emission, width, height), depth = depthOf(frame);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        image.at(x, y) = depth.at(x, y).x > 0 ? image.at(x, y) + emission.at(x, y) : backgroundAt(frame, x, y);
    return image;
  }
  case Buffer::Indirect:
    return reflected(frame, frame.indirect.irradiance, frame.indirect.glossy);
  case Buffer::Irradiance:
    return rgbOf(frame.indirect.irradiance, width, height);
  case Buffer::Unfiltered:
    return rawOf(frame, width, height);
  case Buffer::Albedo:
    return rgbOf(frame.surfaces.albedo, width, height);
  case Buffer::Normal:
    return rgbOf(frame.surfaces.normal, width, height);
  case Buffer::Depth:
    return depthOf(frame);
  case Buffer::Emission:
    return rgbOf(frame.surfaces.emission, width, height);
  case Buffer::Beauty:
  case Buffer::Vpls:
  case Buffer::ShadowMaps:
  case Buffer::Patches:
  case Buffer::Fragments:
  case Buffer::Nan:
    break;
  }
  return rgbOf(frame.radiance, width, height);
}

} // namespace lambent

#include "gi/direct/frame_surfaces.h"

#include "engine/core/sampling.h"
#include "engine/gl/objects.h"

#include <algorithm>

namespace lambent {

vec3 FrameSurfaces::positionAt(const glm::ivec2& pixel) const {
  return vec3(camera.worldFromView * vec4(positionViewFromDepth(camera, vec2(pixel) + 0.5f, depth[at(pixel)]), 1));
}

vec3 FrameSurfaces::placeAt(const glm::ivec2& pixel) const {
  return positionAt(pixel) + normalAt(pixel) * placeSlack(camera, viewDistanceFromDepth(camera, depth[at(pixel)]));
}

std::vector<glm::ivec2> FrameSurfaces::some(size_t count) const {
  std::vector<glm::ivec2> pixels;
  for (uint32_t i = 0; i < count; ++i) {
    const vec3 at = additiveRecurrence3(i, vec3(0.5f));
    const glm::ivec2 pixel(std::min(int(at.x * float(width)), width - 1),
                           std::min(int(at.y * float(height)), height - 1));
    if (seen(pixel)) pixels.push_back(pixel);
  }
  return pixels;
}

FrameSurfaces SurfaceReader::read(const GBuffer& surfaces) {
  const size_t pixels = size_t(surfaces.width) * size_t(surfaces.height);
  depth_.resize(pixels);
  normal_.resize(pixels);
  surfaces.depth->read(std::span(depth_), surfaces.depth->isDepth() ? GL_DEPTH_COMPONENT : GL_RED, GL_FLOAT);
  surfaces.normal->read(std::span(normal_), GL_RGBA, GL_FLOAT);
  return {surfaces.width, surfaces.height, depth_, normal_, surfaces.block};
}

} // namespace lambent

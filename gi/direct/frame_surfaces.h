// An image's surfaces on the CPU, for who traces rays from them.
#pragma once

#include "engine/core/math.h"
#include "gi/contract/surfaces.h"

#include <span>
#include <vector>

namespace lambent {

/// Rows from the bottom. Positions are world space.
struct FrameSurfaces {
  int width = 0, height = 0;
  std::span<const float> depth; // as GBuffer
  std::span<const vec4> normal;
  CameraBlock camera;

  bool seen(const glm::ivec2& pixel) const { return depth[at(pixel)] > 0; }
  vec3 positionAt(const glm::ivec2& pixel) const;
  /// Above the surface by what its depth may be wrong by, for rays.
  vec3 placeAt(const glm::ivec2& pixel) const;
  vec3 normalAt(const glm::ivec2& pixel) const { return glm::normalize(vec3(normal[at(pixel)])); }
  /// Up to `count` pixels that show a surface, spread over the image.
  std::vector<glm::ivec2> some(size_t count) const;
  size_t at(const glm::ivec2& pixel) const { return size_t(pixel.y) * size_t(width) + size_t(pixel.x); }
};

/// Reads surfaces back from the GPU, and keeps them.
class SurfaceReader {
 public:
  /// Waits for the GPU. Valid until the next read.
  FrameSurfaces read(const GBuffer& surfaces);

 private:
  std::vector<float> depth_;
  std::vector<vec4> normal_;
};

} // namespace lambent

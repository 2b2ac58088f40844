// Which virtual lights the pixels of a tile gather, and how much each counts.
#pragma once

#include "engine/core/math.h"
#include "shaders/shared/vpl_light.h"

namespace lambent {

namespace gl {
class Texture;
} // namespace gl

/// One list for each tile of the image (rows from the bottom) and each class of its pixels of 4×4. The mean over
/// classes and over frames is all lights.
struct LightLists {
  /// R32UI: row: tile. Class c has the texels from c · (chunks + length) on: where the lights of each chunk of 2048
  /// end, then the lights: slot in its chunk, and in the upper 16 bits, as half float, how many times it counts.
  const gl::Texture* texture = nullptr;
  int tile = 4; // pixels along a side
  glm::ivec2 tiles{0};
  int chunks = 1; // of lights
};

} // namespace lambent

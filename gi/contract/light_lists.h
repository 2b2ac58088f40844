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
  int length = 0; // lights of a list, at most
  /// RG32F: by tile, share of its light that changed lately, halved in each frame; and what it gained in this one, of
  /// the larger of before and now. Without the noise of a gather. Null: not known.
  const gl::Texture* changed = nullptr;
};

} // namespace lambent

// By how much the light of the image's tiles changed.
#pragma once

namespace lambent {

namespace gl {
class Texture;
} // namespace gl

/// Told by lights, not by what pixels gathered: without its noise, and as if nothing stood between light and place.
struct LightChangeMap {
  /// RG32F, tiles of the image, rows from the bottom. r: share of the light that may have changed, the larger of this
  /// frame's and half of the last's; g: what the lights gained in this frame, of the larger of before and now.
  const gl::Texture* texture = nullptr;
  int tile = 4; // pixels along a side
};

} // namespace lambent

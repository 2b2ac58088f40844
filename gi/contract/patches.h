// Smooth patches of an image, or of maps side by side.
#pragma once

#include "engine/core/math.h"

#include <functional>
#include <optional>

namespace lambent {

namespace gl {
class Texture;
}

/// Level λ ≥ 1 has patches of 2^λ pixels and is mip level λ − 1 of the textures, which are padded so that all levels
/// divide evenly.
struct PatchPyramid {
  const gl::Texture* plane = nullptr;    // RGBA32F: see pyramid.frag
  const gl::Texture* normalLo = nullptr; // RGBA16F: least normal; a: above 0.5 where the patch is to be split
  const gl::Texture* normalHi = nullptr; // RGBA16F: largest normal
  int levels = 0;                        // 0: single pixels only, no textures
  int finest = 0;                        // level of the smallest patches: what they hold need not be smooth
  glm::ivec2 padded{0};                  // pixels
};

/// The pyramid of a frame's image: made when somebody first asks, the same for everybody who does.
class Patches {
 public:
  Patches() = default;
  explicit Patches(std::function<PatchPyramid()> make) : make_(std::move(make)) {}

  const PatchPyramid& pyramid() {
    if (!made_) made_ = make_();
    return *made_;
  }
  /// Returns the pyramid if anybody has asked for it.
  const std::optional<PatchPyramid>& made() const { return made_; }

 private:
  std::function<PatchPyramid()> make_;
  std::optional<PatchPyramid> made_;
};

} // namespace lambent

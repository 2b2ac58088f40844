// Light that surfaces of the image receive: what every stage of direct and indirect light gives.
#pragma once

#include "engine/gl/ring.h"
#include "gi/contract/surfaces.h"

namespace lambent {

/// Irradiance, W/m², albedo not included, and what the receivers' lobes reflect of it. De-interleaved: 16 sub-images in
/// a 4×4 grid of tiles of ⌈W/4⌉×⌈H/4⌉; tile (x mod 4, y mod 4) holds pixel (x, y) at (x/4, y/4), lit by the lights of
/// one class, times 16, or by a list (lightClassOf, gi/gather/draw_gather.h). Null textures: none.
struct SurfaceLighting {
  const gl::Texture* irradiance = nullptr; // RGBA32F
  const gl::Texture* glossy = nullptr;     // RGBA32F W/(m² sr) over glossyTint (shaders/shared/ggx.h)
  bool deinterleaved = false;
  bool subsets = deinterleaved;           // pixels side by side were lit by other classes
  const gl::Texture* fragments = nullptr; // R8: 1 + level of the smallest fragment that asked lamps (paper 4); 0: none
};

/// A stage's own textures for SurfaceLighting, and the framebuffer that draws into them.
class LightTarget {
 public:
  explicit LightTarget(std::string label) : label_(std::move(label)) {}

  /// Makes them again where size, or whether surfaces are glossy, changed.
  void fit(const GBuffer& surfaces, const glm::ivec2& size);
  void fit(const GBuffer& surfaces) { fit(surfaces, {surfaces.width, surfaces.height}); }
  /// Binds the framebuffer, sets the viewport, and makes everything black.
  void clear() const;
  void bind() const { framebuffer_.bind(); }
  const gl::Framebuffer& framebuffer() const { return framebuffer_; }
  glm::ivec2 size() const { return {irradiance_.width(), irradiance_.height()}; }
  SurfaceLighting light(bool deinterleaved = false) const {
    return {&irradiance_, glossy_ ? &glossy_ : nullptr, deinterleaved};
  }

 private:
  std::string label_;
  gl::Texture irradiance_, glossy_;
  gl::Framebuffer framebuffer_;
};

} // namespace lambent

// Light that was found elsewhere, on the CPU for one, added to what was gathered.
#pragma once

#include "gi/contract/pass_context.h"
#include "gi/contract/surface_lighting.h"

#include <span>

namespace lambent {

/// Adds light that lies as the target's does, texel by texel, without its glossy part where it has none.
void addLight(PassContext context, const SurfaceLighting& light, const LightTarget& target);

class PixelAdder {
 public:
  PixelAdder(PassContext context, StageId stage) : context_(context), stage_(stage), pixels_(key(stage).name) {}
  /// Adds pixels, row by row from the top; `glossy` may be empty. `grid`: sub-images per axis of the target, 4 or 1.
  void add(std::span<const vec3> irradiance, std::span<const vec3> glossy, const GBuffer& surfaces,
           const LightTarget& target, int grid);

 private:
  PassContext context_;
  StageId stage_;
  LightTarget pixels_;
};

/// Puts pixels (row by row from the top) where drawGather puts them.
void uploadPixels(const gl::Texture& texture, std::span<const vec3> pixels, const GBuffer& surfaces, int grid);

} // namespace lambent

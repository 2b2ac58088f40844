// The draw that the gather of VPLs and the direct pass's emissive samples share.
#pragma once

#include "gi/render/passes.h"

namespace lambent {

struct GatherDraw {
  const GBuffer& gbuffer;
  const VplLights& lights;
  const ParaboloidMaps* maps;       // null: no visibility
  const gl::Sampler* smoothShadows; // bilinear depth comparison; null: nearest texel
  bool deinterleaved;               // 16 draws, one per class, into their tiles
  bool addToTarget;                 // instead of overwriting it
  float biasTexels;
  float diskFactor; // GatherSettings::disk / π
  float largestG;   // 1/m², kInfinity for none
};

/// Size of one of the 16 sub-images of a de-interleaved picture.
glm::ivec2 tileSize(const GBuffer& gbuffer);

/// Gathers into the framebuffer, which covers the whole picture (or all tiles).
void drawGather(gl::ProgramCache& programs, const gl::Framebuffer& target, const GatherDraw& in);

} // namespace lambent

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
  float spread;     // GatherSettings::spread
};

/// Size of one of the 16 sub-images of a de-interleaved picture.
glm::ivec2 tileSize(const GBuffer& gbuffer);

/// Binds what shaders/lib/receiver.glsl reads. Gives the defines of a variant: "GLOSSY" when the G-buffer has finishes,
/// else none.
std::vector<std::string> bindReceivers(const GBuffer& gbuffer);

/// Makes `texture` one more target of RGBA32F of that size if the G-buffer has finishes, else empties it. Says whether
/// it changed.
bool fitGlossy(gl::Texture& texture, const char* label, const GBuffer& gbuffer, const glm::ivec2& size);

/// Framebuffer of one or, when `glossy` is there, two targets.
gl::Framebuffer framebufferOf(const char* label, const gl::Texture& irradiance, const gl::Texture& glossy);

/// The texture, null when it is empty.
const gl::Texture* orNull(const gl::Texture& texture);

/// Gathers into the framebuffer, which covers the whole picture (or all tiles). Its second target, wanted when the
/// G-buffer has finishes, gets the glossy light.
void drawGather(gl::ProgramCache& programs, const gl::Framebuffer& target, const GatherDraw& in);

} // namespace lambent

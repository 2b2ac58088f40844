// The draw that the gather of VPLs and the direct pass's emissive samples share.
#pragma once

#include "gi/contract/passes.h"

namespace lambent {

/// A rectangle of the target whose fragments are the pixels of one sub-image, or patches of it.
struct GatherArea {
  glm::ivec2 origin, size; // texels of the target
  glm::ivec2 subset{0};    // which sub-image, and of which class of lights; (0, 0) and every light if there is one only
  int level = 0;           // of the patches: see shaders/shared/patches.h
};

struct GatherDraw {
  const GBuffer& gbuffer;
  const VplLights& lights;
  const ParaboloidMaps* maps;       // null: no visibility
  const gl::Sampler* smoothShadows; // bilinear depth comparison; null: nearest texel
  std::span<const GatherArea> areas;
  int grid;         // sub-images per axis: 4 (each sees a sixteenth of the lights), or 1
  bool patches;     // fragments are patches; only those that the stencil marks are drawn
  bool addToTarget; // instead of overwriting it
  float biasTexels;
  float diskFactor;                  // GatherSettings::disk / π
  float largestG;                    // 1/m², kInfinity for none
  float spread;                      // GatherSettings::spread
  const LightTrees* trees = nullptr; // in place of `lights`
};

/// Size of one of the 16 sub-images of a de-interleaved picture.
glm::ivec2 tileSize(const GBuffer& gbuffer);

/// Pixels of the picture as they are, or as 16 tiles.
std::vector<GatherArea> gatherAreas(const GBuffer& gbuffer, int grid);

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

/// Gathers into the areas of the framebuffer. Its second target, wanted when the G-buffer has finishes, gets the glossy
/// light.
void drawGather(gl::ProgramCache& programs, const gl::Framebuffer& target, const GatherDraw& in);

/// The same from trees. Patches must be black before.
void drawTreeGather(gl::ProgramCache& programs, const gl::Framebuffer& target, const GatherDraw& in);

} // namespace lambent

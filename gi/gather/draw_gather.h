// The draw that all gathers of virtual lights share.
#pragma once

#include "gi/contract/light_lists.h"
#include "gi/contract/pass_context.h"
#include "gi/contract/surface_lighting.h"
#include "gi/contract/virtual_lights.h"
#include "gi/plan/settings.h"

namespace lambent {

/// A rectangle of the target whose fragments are the pixels of one sub-image, or patches of it.
struct GatherArea {
  glm::ivec2 origin, size; // texels of the target
  glm::ivec2 subset{0};    // which sub-image; (0, 0) if there is one only
  int lightClass = 0;      // that it gathers; every light if there is one sub-image only
  int level = 0;           // of the patches: see shaders/shared/patches.h
};

struct GatherDraw {
  const GBuffer& surfaces;
  ShadowedLights lights;
  std::span<const GatherArea> areas = {};
  int grid = 1;                      // sub-images per axis: 4 (each sees a sixteenth of the lights), or 1
  const LightLists* lists = nullptr; // which lights; null: all of an area's class
  bool patches = false;              // fragments are patches; only those that the stencil marks are drawn
  int finestPatch = 0;               // AtlasShape::finest
  bool addToTarget = false;          // instead of overwriting it
  float biasTexels = 1;
  std::span<const gl::Framebuffer> checks = {}; // MapChecks::begin
  uint32_t sample = 0;                          // of those that are averaged, for checks
  GatherSettings bounds = {};                   // of near lights, and of lobes; the mode is not read
};

/// Size of one of the 16 sub-images of a de-interleaved frame.
glm::ivec2 tileSize(const GBuffer& gbuffer);

/// The class of lights that a sub-image of 4×4 gathers in a frame: each in turn, within 16 frames.
int lightClassOf(const glm::ivec2& subset, uint32_t sample);

/// Returns the frame's pixels as one area, or as 16 tiles.
std::vector<GatherArea> gatherAreas(const GBuffer& gbuffer, int grid, uint32_t sample = 0);

/// The lights of each class in a chunk.
int lightsPerClass(const PackedLights& lights, uint32_t chunk);

/// Binds what shaders/lib/gbuffer.glsl and receiver.glsl read. Gives the defines of a variant: "GLOSSY" when the
/// G-buffer has roughness and metalness, else none.
std::vector<std::string> bindSurfaces(const GBuffer& gbuffer);

/// Sets the uniforms that shaders/lib/vpl_shading.glsl reads, apart from lights and surfaces.
void setShading(const gl::Program& program, const GatherDraw& draw);

/// Draws one area with a gathering program. `patches`: only those that the stencil marks.
void drawArea(const gl::Program& program, const GatherArea& area, bool patches, bool add);

/// Gathers into the areas of the framebuffer. Its second target, wanted when the G-buffer has roughness and metalness,
/// gets the glossy light. From trees patches must be black before.
void drawGather(gl::ProgramCache& programs, const gl::Framebuffer& target, const GatherDraw& in);

/// Draws the light of lights that are trees.
void drawTreeGather(gl::ProgramCache& programs, const gl::Framebuffer& target, const GatherDraw& in);

} // namespace lambent

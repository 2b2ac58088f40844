// Direct light: punctual lights and the sky with shadow maps of their own, emissive surfaces as shadowed samples. Where
// a map is in doubt, which is along the edges of shadows, a ray decides (ShadowSettings::rays).
#pragma once

#include "gi/contract/figures.h"
#include "gi/contract/surface_lighting.h"
#include "gi/contract/world.h"
#include "gi/direct/area_light_pass.h"
#include "gi/direct/emitter_shadows.h"
#include "gi/direct/light_shadows.h"
#include "gi/direct/shadow_ray_pass.h"

namespace lambent {

struct DirectInputs {
  const World& world;
  const GBuffer& surfaces;
  const EffectPlan& plan;
  const Settings& settings;
  Patches& patches;  // of the surfaces
  bool keep = false; // all of it is that of the last run
};

class DirectLight {
 public:
  explicit DirectLight(PassContext context, uint32_t mostDoubts = ShadowRayPass::kMost);
  SurfaceLighting run(const DirectInputs& in, FrameStats& stats);

  struct Area {
    int x = 0, y = 0, width = 0, height = 0; // pixels, from the lower left
  };

 private:
  /// Whether doubts are noted, and light is drawn.
  enum class Noting { Off, AlsoLight, Only };

  static bool byPatches(const DirectInputs& in);
  void lightByMaps(const DirectInputs& in, FrameStats& stats);
  void fitReceivers(const DirectInputs& in, FrameStats& stats);
  std::vector<LightBlock> shadowed(const DirectInputs& in, bool rays, FrameStats& stats);
  const gl::Program& programFor(const GBuffer& surfaces, const LightBlock& block, const char* vertex,
                                const char* variant) const;
  void drawBlock(const GBuffer& surfaces, const LightBlock& block, const Area& area, Noting noting) const;
  bool answer(const DirectInputs& in, std::span<const LightBlock> blocks, FrameStats& stats);
  void drawLit(const GBuffer& surfaces, std::span<const LightBlock> blocks);

  PassContext context_;
  LightShadowPass shadows_;
  EmitterShadowPass emitters_;
  AreaLightPass areas_;
  ShadowRayPass doubts_;
  Aabb receivers_;                       // everything the camera sees: what maps of the sky must cover
  Aabb mostReceivers_;                   // without the few that lie far off: what suns' must, where rays see the rest
  gl::Sampler depths_, smoothDistances_; // of maps: what they hold; bilinear comparison of emitters'
  LightTarget target_{"direct"};
};

} // namespace lambent

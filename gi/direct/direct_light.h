// Direct light: punctual lights and the sky with shadow maps of their own, emissive surfaces as shadowed samples. Where
// a map is in doubt, which is along the edges of shadows, a ray decides (ShadowSettings::rays).
#pragma once

#include "gi/contract/figures.h"
#include "gi/contract/light_provider.h"
#include "gi/direct/area_light_pass.h"
#include "gi/direct/emitter_shadows.h"
#include "gi/direct/light_shadows.h"
#include "gi/direct/shadow_ray_pass.h"

namespace lambent {

class DirectLight : public LightProvider {
 public:
  explicit DirectLight(PassContext context, uint32_t mostDoubts = ShadowRayPass::kMost);
  /// Returns the light of the last run where neither surfaces nor light can have changed.
  SurfaceLighting run(const Frame& frame, FrameStats& stats) override;
  /// Drops the last light. Call it also when this is not run for a while: changes are then not reported.
  void forget() override { stale_ = true; }

  struct Area {
    int x = 0, y = 0, width = 0, height = 0; // pixels, from the lower left
  };

 private:
  /// Says whether doubts are noted and whether light is drawn.
  enum class Noting { Off, AlsoLight, Only };

  static bool byPatches(const Frame& in);
  void lightByMaps(const Frame& in, FrameStats& stats);
  void fitReceivers(const Frame& in, FrameStats& stats);
  std::vector<LightBlock> shadowed(const Frame& in, bool rays, FrameStats& stats);
  const gl::Program& programFor(const GBuffer& surfaces, const LightBlock& block, const char* vertex,
                                const char* variant) const;
  void drawBlock(const GBuffer& surfaces, const LightBlock& block, const Area& area, Noting noting) const;
  bool answer(const Frame& in, std::span<const LightBlock> blocks, FrameStats& stats);
  void drawLit(const GBuffer& surfaces, std::span<const LightBlock> blocks);

  PassContext context_;
  LightShadowPass shadows_;
  EmitterShadowPass emitters_;
  AreaLightPass areas_;
  ShadowRayPass doubts_;
  Aabb receivers_;                       // everything the camera sees: what maps of the sky must cover
  Aabb mostReceivers_;                   // without the few that lie far off: what suns' must, where rays see the rest
  gl::Sampler depths_, smoothDistances_; // of maps: what they hold; bilinear comparison of emitters'
  bool stale_ = true;                    // nothing of the last run may be used
  bool unfinished_ = false;              // something was thrown out of it
  LightTarget target_{"direct"};
};

} // namespace lambent

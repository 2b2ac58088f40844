// Direct light. Points, spots and suns without a size have shadow maps; where a map is in doubt, which is along the
// edges of shadows, a ray decides (ShadowSettings::rays). What has a size is sampled by few rays from every pixel,
// averaged over frames (DirectSettings::soft). Or all have maps: the sky and emissive surfaces of points that stand for
// them.
#pragma once

#include "gi/contract/figures.h"
#include "gi/contract/light_provider.h"
#include "gi/direct/area_light_pass.h"
#include "gi/direct/emitter_shadows.h"
#include "gi/direct/light_shadows.h"
#include "gi/direct/shadow_ray_pass.h"
#include "gi/direct/soft_light.h"

namespace lambent {

class DirectLight : public LightProvider {
 public:
  explicit DirectLight(PassContext context, uint32_t mostDoubts = ShadowRayPass::kMost);
  /// Returns the light of the last run where neither surfaces nor light can have changed, and means are full.
  SurfaceLighting run(const Frame& frame, FrameStats& stats) override;
  /// Drops the last light. Call it also when this is not run for a while: changes are then not reported.
  void forget() override {
    stale_ = true;
    soft_.forget();
  }
  /// Says whether the light of a still view goes on getting better.
  bool pending() const { return soft_.pending(); }

  struct Area {
    int x = 0, y = 0, width = 0, height = 0; // pixels, from the lower left
  };

 private:
  /// Says whether doubts are noted and whether light is drawn.
  enum class Noting { Off, AlsoLight, Only };

  /// Who brings the light of emissive surfaces.
  enum class Emitters { None, Maps, Patches, Rays };
  static Emitters emittersBy(const Frame& in);
  static bool softByRays(const Frame& in);
  static bool skyByMaps(const Frame& in);
  static bool hasSkyOrSuns(const Frame& in); // that have a size
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
  SurfaceReader reader_;
  SoftLightPass soft_;
  ShadowRayPass doubts_;
  Aabb receivers_;                       // everything the camera sees: what maps of the sky must cover
  Aabb mostReceivers_;                   // without the few that lie far off: what suns' must, where rays see the rest
  gl::Sampler depths_, smoothDistances_; // of maps: what they hold; bilinear comparison of emitters'
  bool stale_ = true;                    // nothing of the last run may be used
  bool unfinished_ = false;              // something was thrown out of it
  std::vector<LightView> sharp_;         // lights without a size
  LightTarget mapped_{"direct/maps"};    // light of maps alone, kept while soft light goes on
  LightTarget target_{"direct"};
  SurfaceLighting light_; // of the last run
};

} // namespace lambent

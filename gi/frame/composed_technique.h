// A technique that is composed of the four axes (gi/plan/axes.h): virtual lights from a source, maps of who sees them,
// a gather, and what puts its light together.
#pragma once

#include "gi/contract/gather.h"
#include "gi/contract/light_source.h"
#include "gi/contract/pass_context.h"
#include "gi/gather/light_change_pass.h"
#include "gi/gather/list_pass.h"
#include "gi/reconstruct/reconstruct.h"
#include "gi/visibility/shadow_map_cache.h"

#include <memory>

namespace lambent {

// The parts that the axes name: compose.cpp, the only file that branches on them.
std::unique_ptr<LightSource> makeSource(const Axes& axes, PassContext context); // null: no virtual lights
std::unique_ptr<Gather> makeGather(const Axes& axes, PassContext context);
/// Says whether one source, or one gather, serves both.
bool sameSource(const Axes& a, const Axes& b);
bool sameGather(const Axes& a, const Axes& b);

/// Serves all settings whose axes go together: where these change, so do its parts, and the others stay.
class ComposedTechnique : public LightProvider {
 public:
  explicit ComposedTechnique(PassContext context) : context_(context) {}

  void wait() override;
  void begin(const SceneView& view, const Settings& settings) override;
  void forget() override;
  ProviderStatus status() const override;
  void update(const FrameWorld& in, FrameStats& stats) override;
  SurfaceLighting run(const Frame& frame, FrameStats& stats) override;
  ProviderInside inside() const override;

 private:
  SurfaceLighting reconstruct(const Frame& frame, const LightLists* lists, const LightChangeMap& change,
                              FrameStats& stats);

  PassContext context_;
  Axes axes_{.source = VplSource::None, .gather = GatherMode::Own};
  Needs needs_;
  std::unique_ptr<LightSource> source_;
  ShadowMapCache maps_{context_};
  ListPass lists_;
  LightChangePass change_;
  std::unique_ptr<Gather> gather_, shown_; // shown_: whose light the last frame still shows, until the next is there
  HistoryPass history_{context_};
  DenoisePass denoise_{context_, StageId::Filter};
  FilterPass filter_{context_};
  VirtualLights lights_;     // of this frame
  SurfaceLighting gathered_; // of the last run
  SurfaceLighting smooth_;   // of the last frame that was averaged
  int restless_ = 0;         // frames until a view counts as standing
  bool byLists_ = false;     // light of the last frame that was averaged
  int averaged_ = 0;         // samples in the history since anything changed
};

} // namespace lambent

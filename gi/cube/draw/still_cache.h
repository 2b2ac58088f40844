// A technique in a world that has stood still for long (cube.after): photons, which do not depend on the view, are put
// into a layered depth cube next to it, a few in every frame, and when all are in it the cube takes its place: a camera
// that moves then pays a look-up. As soon as light changes the technique is back. Either way one is mixed into the
// other over some frames, so that what they disagree about is no jump.
#pragma once

#include "gi/contract/gather.h"
#include "gi/contract/light_source.h"
#include "gi/contract/pass_context.h"

#include <memory>

namespace lambent {

/// Wraps a technique and replaces its light by the cube's where the world is still.
class StillCache : public LightProvider {
 public:
  StillCache(PassContext context, std::unique_ptr<LightProvider> technique)
      : context_(context), technique_(std::move(technique)) {}

  void wait() override { technique_->wait(); }
  void begin(const SceneView& view, const Settings& settings) override;
  void forget() override;
  ProviderStatus status() const override;
  void update(const FrameWorld& in, FrameStats& stats) override;
  SurfaceLighting run(const Frame& frame, FrameStats& stats) override;
  ProviderInside inside() const override { return technique_->inside(); }

 private:
  /// Says whether the cube shows all of the light: nothing else need be gathered.
  bool alone() const { return wanted_ && share_ >= 1; }
  SurfaceLighting lookUp(const Frame& frame, FrameStats& stats);
  SurfaceLighting mix(const Frame& frame, const SurfaceLighting& gathered, const SurfaceLighting& stored);
  /// Gives up the cube.
  void drop();

  PassContext context_;
  std::unique_ptr<LightProvider> technique_;
  std::unique_ptr<LightSource> photons_;
  std::unique_ptr<Gather> cube_, shown_; // shown_: given up, while the last frame may still show its light
  VirtualLights lights_; // of photons_
  std::unique_ptr<LightTarget> mixed_;
  Settings settings_; // that the cube was built for
  int still_ = 0;     // frames
  bool wanted_ = false;
  bool stale_ = false; // light changed after the cube was begun: it goes before another is built
  float share_ = 0;    // of the light that is shown
};

} // namespace lambent

// Lights that gi/vpl samples on the CPU: the sequential Monte Carlo set and the samplers it is compared with.
#pragma once

#include "engine/core/memory.h"
#include "gi/contract/light_source.h"
#include "gi/contract/pass_context.h"
#include "gi/sources/packed_lights.h"
#include "gi/vpl/sources.h"

#include <future>

namespace lambent {

/// What an update takes away and brings back: while it runs next to the GPU nobody else holds any of it.
struct VplWork {
  VplSet set;
  VplChanges changes; // with those of earlier updates that were not shown
  VplUpdateLog log;
};

class SampledSource : public LightSource {
 public:
  explicit SampledSource(PassContext context) : buffer_(context, StageId::Vpls) {}

  VirtualLights run(const FrameWorld& in, const Needs& needs, FrameStats& stats) override;
  void wait() override;
  bool arrived() const override { return arrived_; }
  bool settled() const override { return kept_.set.settling.settled(); }
  const VplSet* set() const override { return &kept_.set; }
  void forget() override { kept_ = {}; }

 private:
  void report(const EffectPlan& plan, FrameStats& stats);
  VirtualLights show(bool overlapped, const std::vector<uint32_t>& carried, bool onGpu);

  PackedLightBuffer buffer_;
  std::vector<VirtualLight> shown_;
  VplWork kept_;
  HeldMemory held_{"virtual lights"};
  bool arrived_ = false;
  std::future<VplWork> running_;
};

} // namespace lambent

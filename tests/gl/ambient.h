// A technique as CONTRIBUTING tells to add one: its provider in a file of its own, and a row. Irradiance 1 everywhere.
#pragma once

#include "gi/contract/light_provider.h"
#include "gi/contract/pass_context.h"
#include "gi/plan/techniques.h"

namespace lambent::test {

class Ambient : public LightProvider {
 public:
  SurfaceLighting run(const Frame& frame, FrameStats&) override {
    target_.fit(frame.surfaces);
    const float one[4] = {1, 1, 1, 1};
    glClearTexImage(target_.light().irradiance->name(), 0, GL_RGBA, GL_FLOAT, one);
    return target_.light();
  }

 private:
  LightTarget target_{"ambient"};
};

inline std::unique_ptr<LightProvider> makeAmbient(PassContext) { return std::make_unique<Ambient>(); }

constexpr Technique kAmbient{
    .name = "ambient",
    .help = "constant light",
    .axes = {VplSource::None, VplVisibility::None, GatherMode::Own, Reconstruction::None},
    .make = makeAmbient,
};

} // namespace lambent::test

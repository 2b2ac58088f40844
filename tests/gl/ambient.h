// A technique as CONTRIBUTING tells to add one: its stage in a file of its own, and a row. Irradiance 1 everywhere.
#pragma once

#include "gi/contract/indirect_stage.h"
#include "gi/contract/pass_context.h"
#include "gi/plan/techniques.h"

namespace lambent::test {

class Ambient : public IndirectStage {
 public:
  SurfaceLighting run(const IndirectInputs& in, FrameStats&) override {
    target_.fit(in.surfaces);
    const float one[4] = {1, 1, 1, 1};
    glClearTexImage(target_.light().irradiance->name(), 0, GL_RGBA, GL_FLOAT, one);
    return target_.light();
  }

 private:
  LightTarget target_{"ambient"};
};

inline std::unique_ptr<IndirectStage> makeAmbient(PassContext) { return std::make_unique<Ambient>(); }

constexpr Technique kAmbient{
    .name = "ambient",
    .help = "constant light",
    .axes = {VplSource::None, VplVisibility::None, GatherMode::Own, Reconstruction::None},
    .make = makeAmbient,
};

} // namespace lambent::test

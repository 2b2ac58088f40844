// Light of pixels from a light propagation volume.
#include "gi/contract/gather.h"
#include "gi/gather/draw_gather.h"
#include "gi/volume/light_volume.h"

namespace lambent {

namespace {

class VolumeGather : public Gather {
 public:
  explicit VolumeGather(PassContext context) : context_(context), volume_(context) {}

  SurfaceLighting run(const GatherInputs& in, FrameStats& stats) override {
    volume_.update({in.frame.world, in.lights.list.slots, in.frame.settings.lpv}, stats);
    const gl::PassScope scope = context_.scope(StageId::Gather);
    target_.fit(in.frame.surfaces);
    const gl::Program& program =
        context_.programs.get({.fragment = "volume_gather.frag", .defines = bindSurfaces(in.frame.surfaces)});
    program.use();
    volume_.bind(program);
    target_.bind();
    gl::PipelineState{.width = target_.size().x, .height = target_.size().y}.apply();
    gl::drawFullscreen();
    return target_.light();
  }

 private:
  PassContext context_;
  LightVolume volume_;
  LightTarget target_{"volume gather"};
};

} // namespace

std::unique_ptr<Gather> makeVolumeGather(PassContext context) { return std::make_unique<VolumeGather>(context); }

} // namespace lambent

// Gather at pixels: every light at each of them, or the 4×4 subsets side by side.
#include "gi/gather/draw_gather.h"
#include "gi/gather/stages.h"

namespace lambent {

namespace {

class PixelGather : public IndirectStage {
 public:
  explicit PixelGather(PassContext context) : context_(context) {}

  LightOnSurfaces run(const IndirectInputs& in, FrameStats&) override {
    const gl::PassScope scope = context_.scope(StageId::Gather);
    const bool subsets = rowOf(in.settings.gather.mode).subsets;
    target_.fit(in.surfaces, subsets ? 4 * tileSize(in.surfaces) : glm::ivec2(in.surfaces.width, in.surfaces.height));
    drawGather(context_.programs, target_.framebuffer(),
               {.surfaces = in.surfaces,
                .seen = in.seen,
                .areas = gatherAreas(in.surfaces, subsets ? 4 : 1),
                .grid = subsets ? 4 : 1,
                .biasTexels = in.settings.shadow.bias,
                .bounds = in.settings.gather});
    return target_.light(subsets);
  }

 private:
  PassContext context_;
  LightTarget target_{"gather"};
};

} // namespace

std::unique_ptr<IndirectStage> makePixelGather(PassContext context) { return std::make_unique<PixelGather>(context); }

} // namespace lambent

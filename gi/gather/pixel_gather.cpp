// Gather at pixels: every light at each of them, or the 4×4 subsets side by side.
#include "gi/gather/draw_gather.h"
#include "gi/gather/map_checks.h"
#include "gi/gather/near_light_pass.h"
#include "gi/gather/stages.h"

namespace lambent {

namespace {

class PixelGather : public IndirectStage {
 public:
  explicit PixelGather(PassContext context) : context_(context) {}

  SurfaceLighting run(const IndirectInputs& in, FrameStats& stats) override {
    const int grid = rowOf(in.settings.gather.mode).subsets ? 4 : 1;
    const std::span<const gl::Framebuffer> checks = gather(in, grid);
    if (!checks.empty()) checks_.add(in, target_, stats);
    near_.add(in, target_, grid, stats);
    return target_.light(grid > 1);
  }

 private:
  std::span<const gl::Framebuffer> gather(const IndirectInputs& in, int grid) {
    const gl::PassScope scope = context_.scope(StageId::Gather);
    target_.fit(in.surfaces, grid > 1 ? 4 * tileSize(in.surfaces) : glm::ivec2(in.surfaces.width, in.surfaces.height));
    const std::span<const gl::Framebuffer> checks = checks_.begin(in, target_, grid > 1);
    drawGather(context_.programs, target_.framebuffer(),
               {.surfaces = in.surfaces,
                .seen = in.seen,
                .areas = gatherAreas(in.surfaces, grid, in.picture),
                .grid = grid,
                .biasTexels = in.settings.shadow.bias,
                .checks = checks,
                .picture = in.picture,
                .bounds = in.settings.gather});
    return checks;
  }

  PassContext context_;
  MapChecks checks_{context_};
  NearLightPass near_{context_};
  LightTarget target_{"gather"};
};

} // namespace

std::unique_ptr<IndirectStage> makePixelGather(PassContext context) { return std::make_unique<PixelGather>(context); }

} // namespace lambent

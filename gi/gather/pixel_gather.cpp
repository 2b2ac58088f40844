// Gather at pixels: every light at each of them, or the 4×4 subsets side by side.
#include "gi/gather/draw_gather.h"
#include "gi/gather/gathers.h"
#include "gi/gather/map_checks.h"
#include "gi/gather/near_light_pass.h"

namespace lambent {

namespace {

class PixelGather : public Gather {
 public:
  PixelGather(PassContext context, bool subsets) : context_(context), grid_(subsets ? 4 : 1) {}

  SurfaceLighting run(const GatherInputs& in, FrameStats& stats) override {
    const std::span<const gl::Framebuffer> checks = gather(in);
    if (!checks.empty()) checks_.add(in, target_, stats);
    near_.add(in, target_, grid_, stats);
    return target_.light(grid_ > 1);
  }

 private:
  std::span<const gl::Framebuffer> gather(const GatherInputs& in) {
    const gl::PassScope scope = context_.scope(StageId::Gather);
    target_.fit(in.frame.surfaces, grid_ > 1 ? 4 * tileSize(in.frame.surfaces)
                                             : glm::ivec2(in.frame.surfaces.width, in.frame.surfaces.height));
    const std::span<const gl::Framebuffer> checks = checks_.begin(in, target_, grid_ > 1);
    drawGather(context_.programs, target_.framebuffer(),
               {.surfaces = in.frame.surfaces,
                .lights = in.lights,
                .areas = gatherAreas(in.frame.surfaces, grid_, in.sample),
                .grid = grid_,
                .lists = in.lists,
                .biasTexels = in.frame.settings.shadow.bias,
                .checks = checks,
                .sample = in.sample,
                .bounds = in.frame.settings.gather});
    return checks;
  }

  PassContext context_;
  int grid_; // sub-images per axis
  MapChecks checks_{context_};
  NearLightPass near_{context_};
  LightTarget target_{"gather"};
};

} // namespace

std::unique_ptr<Gather> makePixelGather(PassContext context, bool subsets) {
  return std::make_unique<PixelGather>(context, subsets);
}

} // namespace lambent

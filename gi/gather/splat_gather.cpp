// Lights splatted into patches (paper 2), all into the same, or each into patches of its own.
#include "gi/gather/gathers.h"
#include "gi/gather/near_light_pass.h"
#include "gi/gather/splat.h"

namespace lambent {

namespace {

class SplatGather : public Gather {
 public:
  SplatGather(PassContext context, bool perLight) : context_(context), perLight_(perLight) {}

  SurfaceLighting run(const GatherInputs& in, FrameStats& stats) override {
    const PatchPyramid& patches = in.frame.patches.pyramid();
    atlas_.fit(in.frame.surfaces, patches, false);
    const GatherDraw draw{.surfaces = in.frame.surfaces,
                          .lights = in.lights,
                          .finestPatch = atlas_.shape().finest,
                          .biasTexels = in.frame.settings.shadow.bias,
                          .bounds = in.frame.settings.gather};
    const SplatInputs splats{draw, patches, atlas_.shape(), in.frame.settings.multires.light};
    if (perLight_)
      splatEach(in, splats);
    else
      splatAll(in, splats);
    near_.add(in, atlas_.target(), 1, stats);
    return atlas_.light();
  }

 private:
  void splatAll(const GatherInputs& in, const SplatInputs& splats) {
    splat_.refine(splats);
    atlas_.clear();
    splat_.splat(splats, atlas_.framebuffer());
    const gl::PassScope scope = context_.scope(StageId::Upsample);
    atlas_.upsample(in.frame.surfaces, in.frame.settings);
  }

  /// Each light has patches of its own, so each is upsampled by itself before the next is added.
  void splatEach(const GatherInputs& in, const SplatInputs& splats) {
    const gl::PassScope scope = context_.scope(StageId::SplatPerVpl);
    atlas_.clearLight();
    for (uint32_t slot = 0; slot < in.lights.list.packed.count; ++slot) {
      splat_.refineFor(splats, slot);
      atlas_.clear();
      splat_.splatOne(splats, atlas_.framebuffer(), slot);
      atlas_.upsample(in.frame.surfaces, in.frame.settings, true);
    }
  }

  PassContext context_;
  bool perLight_;
  PatchAtlas atlas_{context_};
  NearLightPass near_{context_};
  SplatPass splat_{context_};
};

} // namespace

std::unique_ptr<Gather> makeSplatGather(PassContext context, bool perLight) {
  return std::make_unique<SplatGather>(context, perLight);
}

} // namespace lambent

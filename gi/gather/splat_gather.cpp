// Lights splatted into patches (paper 2), all into the same, or each into patches of its own.
#include "gi/gather/near_light_pass.h"
#include "gi/gather/splat.h"
#include "gi/gather/stages.h"

namespace lambent {

namespace {

class SplatGather : public IndirectStage {
 public:
  explicit SplatGather(PassContext context) : context_(context) {}

  SurfaceLighting run(const IndirectInputs& in, FrameStats& stats) override {
    const PatchPyramid& patches = in.patches.pyramid();
    atlas_.fit(in.surfaces, patches, false);
    const GatherDraw draw{.surfaces = in.surfaces,
                          .seen = in.seen,
                          .finestPatch = atlas_.shape().finest,
                          .biasTexels = in.settings.shadow.bias,
                          .bounds = in.settings.gather};
    const SplatInputs splats{draw, patches, atlas_.shape(), in.settings.multires.light};
    if (in.settings.gather.mode == GatherMode::SplatPerVpl)
      splatEach(in, splats);
    else
      splatAll(in, splats);
    near_.add(in, atlas_.target(), 1, stats);
    return atlas_.light();
  }

 private:
  void splatAll(const IndirectInputs& in, const SplatInputs& splats) {
    splat_.refine(splats);
    atlas_.clear();
    splat_.splat(splats, atlas_.framebuffer());
    const gl::PassScope scope = context_.scope(StageId::Upsample);
    atlas_.upsample(in.surfaces, in.settings);
  }

  /// Each light has patches of its own, so each is upsampled by itself before the next is added.
  void splatEach(const IndirectInputs& in, const SplatInputs& splats) {
    const gl::PassScope scope = context_.scope(StageId::SplatPerVpl);
    atlas_.clearLight();
    for (uint32_t slot = 0; slot < in.seen.lights.packed.count; ++slot) {
      splat_.refineFor(splats, slot);
      atlas_.clear();
      splat_.splatOne(splats, atlas_.framebuffer(), slot);
      atlas_.upsample(in.surfaces, in.settings, true);
    }
  }

  PassContext context_;
  PatchAtlas atlas_{context_};
  NearLightPass near_{context_};
  SplatPass splat_{context_};
};

} // namespace

std::unique_ptr<IndirectStage> makeSplatGather(PassContext context) { return std::make_unique<SplatGather>(context); }

} // namespace lambent

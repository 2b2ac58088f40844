// Indirect irradiance gathered at patches. Paper 3, section 3.2: one pass marks the patches in a stencil buffer, the
// gather runs on these only. Beyond the paper: neighbours differ by one level at most, any set of lights with its
// shadow maps, and subsets of interleaved sampling (paper 1, 4.5), each with a multiresolution buffer of its own over
// every fourth pixel; a patch of such a buffer lies within a smooth block of the image, so that all subsets have the
// same patches.
#include "engine/gl/query_ring.h"
#include "gi/gather/gathers.h"
#include "gi/gather/near_light_pass.h"
#include "gi/gather/patch_atlas.h"
#include "shaders/shared/patches.h"

namespace lambent {

namespace {

class PatchGather : public Gather {
 public:
  PatchGather(PassContext context, bool subsets) : context_(context), subsets_(subsets) {}

  SurfaceLighting run(const GatherInputs& in, FrameStats& stats) override {
    const PatchPyramid& patches = in.frame.patches.pyramid();
    atlas_.fit(in.frame.surfaces, patches, subsets_);
    mark(in.frame.surfaces, patches);
    gather(in);
    {
      const gl::PassScope scope = context_.scope(StageId::Upsample);
      atlas_.upsample(in.frame.surfaces, in.frame.settings);
    }
    near_.add(in, atlas_.target(), atlas_.shape().grid, stats);
    stats.patches = marks_.latest().value_or(0);
    return atlas_.light();
  }

 private:
  /// Sets the stencil where a patch gathers.
  void mark(const GBuffer& surfaces, const PatchPyramid& patches) {
    const gl::PassScope scope = context_.scope(StageId::Stencil);
    const AtlasShape& shape = atlas_.shape();
    const gl::Texture& stencil = atlas_.stencil();
    if (stencilOf_ != stencil.name()) {
      stencilFramebuffer_ = gl::Framebuffer("multires stencil", {}, &stencil);
      stencilOf_ = stencil.name();
    }
    stencilFramebuffer_.bind();
    gl::PipelineState{.stencil = gl::Stencil::Mark, .width = stencil.width(), .height = stencil.height()}.apply();
    const GLint zero = 0;
    glClearNamedFramebufferiv(stencilFramebuffer_.name(), GL_STENCIL, 0, &zero);
    const gl::Program& program = context_.programs.get({.fragment = "refine.frag"});
    program.use();
    program.set("base", shape.base);
    program.set("coarsest", shape.coarsest);
    program.set("grid", shape.grid);
    program.set("gridLevel", shape.gridLevel());
    program.set("size", glm::ivec2(surfaces.width, surfaces.height));
    surfaces.depth->bind(0);
    if (patches.plane) {
      patches.plane->bind(1);
      patches.normalLo->bind(2);
    }
    marks_.begin();
    gl::drawFullscreen();
    marks_.end();
  }

  void gather(const GatherInputs& in) {
    const gl::PassScope scope = context_.scope(StageId::Gather);
    const AtlasShape& shape = atlas_.shape();
    atlas_.clear();
    std::vector<GatherArea> areas;
    for (int level = 0; level <= shape.coarsest; ++level) {
      const glm::ivec2 sub = shape.sub(level);
      for (int c = 0; c < shape.grid * shape.grid; ++c) {
        const glm::ivec2 subset(c % shape.grid, c / shape.grid);
        areas.push_back({.origin = atlasOrigin(shape.base, level) + subset * sub,
                         .size = sub,
                         .subset = subset,
                         .lightClass = shape.grid > 1 ? lightClassOf(subset, in.sample) : 0,
                         .level = level});
      }
    }
    drawGather(context_.programs, atlas_.framebuffer(),
               {.surfaces = in.frame.surfaces,
                .lights = in.lights,
                .areas = areas,
                .grid = shape.grid,
                .patches = true,
                .finestPatch = shape.finest,
                .addToTarget = true,
                .biasTexels = in.frame.settings.shadow.bias,
                .bounds = in.frame.settings.gather});
  }

  PassContext context_;
  bool subsets_;
  PatchAtlas atlas_{context_};
  NearLightPass near_{context_};
  gl::Framebuffer stencilFramebuffer_;
  GLuint stencilOf_ = 0; // texture that it draws into
  gl::QueryRing marks_{GL_SAMPLES_PASSED};
};

} // namespace

std::unique_ptr<Gather> makePatchGather(PassContext context, bool subsets) {
  return std::make_unique<PatchGather>(context, subsets);
}

} // namespace lambent

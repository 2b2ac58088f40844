// From gathered subsets to irradiance at every pixel. Paper 1, section 4.5: cross-bilateral filter over normals and
// positions. Our kernel is a tent of 7×7 (theirs a box), so that all 16 subsets weigh the same at every pixel. By
// default it goes along rows, then columns: a bilateral kernel is not quite separable, so the whole one stays as a
// setting (costs and errors of both: gi/README.md).
#include "gi/gather/draw_gather.h"
#include "gi/reconstruct/reconstruct.h"

namespace lambent {

SurfaceLighting FilterPass::run(const FilterInputs& in) {
  const bool moves = in.gathered.deinterleaved;
  if (!moves && !(in.gathered.subsets && in.filter.on)) return in.gathered; // nothing to mix
  const gl::PassScope scope = context_.scope(StageId::Filter);
  target_.fit(in.surfaces);
  rows_.fit(in.surfaces);
  bindSurfaces(in.surfaces);
  const auto draw = [&](const SurfaceLighting& from, std::vector<std::string> defines, const glm::ivec2& reach,
                        const LightTarget& to) {
    if (from.glossy) {
      from.glossy->bind(3);
      defines.push_back("GLOSSY");
    }
    if (from.deinterleaved) defines.push_back("SUBSETS");
    const gl::Program& program = context_.programs.get({.fragment = "filter.frag", .defines = std::move(defines)});
    program.use();
    program.set("tileSize", tileSize(in.surfaces));
    program.set("reach", reach);
    program.set("fresh", in.worth == nullptr);
    if (in.worth) in.worth->bind(5);
    program.set("normalPower", in.filter.normalPower);
    program.set("distanceSigma", in.filter.distance);
    from.irradiance->bind(2);
    to.bind();
    gl::PipelineState{.width = in.surfaces.width, .height = in.surfaces.height}.apply();
    gl::drawFullscreen();
  };
  if (!in.filter.on) {
    draw(in.gathered, {}, {0, 0}, target_);
  } else if (in.filter.kernel == FilterKernel::Whole) {
    draw(in.gathered, {"FILTER"}, {3, 3}, target_);
  } else {
    draw(in.gathered, {"FILTER"}, {3, 0}, rows_);
    draw(rows_.light(), {"FILTER"}, {0, 3}, target_);
  }
  return target_.light();
}

} // namespace lambent

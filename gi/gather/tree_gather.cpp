// The gather that cuts light trees (hisr): paper 3, section 3.5.
#include "gi/lights/reflective_maps.h"

#include <algorithm>

namespace lambent {

namespace {
/// Software Mesa ends all loops of a fragment after 65 536 turns, whatever is left of them.
constexpr int kMostTurns = 60000;
} // namespace

void drawTreeGather(gl::ProgramCache& programs, const gl::Framebuffer& target, const GatherDraw& in) {
  const ReflectiveMaps& sheet = in.trees->maps;
  const RsmSettings& rsm = in.trees->rsm;
  const int coarsest = sheet.levels - 1, finest = std::min(sheet.levelOf(rsm.finest), coarsest);
  const int side = sheet.resolution >> coarsest, roots = side * side;
  const int nodes = 4 * (1 << (2 * (coarsest - finest))) / 3 + 1; // below a root, at most
  const int subsets = in.grid * in.grid;                          // each takes one root in so many
  const int rootsPerDraw = std::max(1, kMostTurns / nodes) * subsets;

  gl::ProgramDesc desc{.fragment = "tree_gather.frag", .defines = bindReceivers(in.gbuffer)};
  if (in.patches) desc.defines.push_back("PATCHES");
  const gl::Program& program = programs.get(desc);
  program.use();
  program.set("coarsest", coarsest);
  program.set("finest", finest);
  program.set("stride", in.grid);
  program.set("rootStep", subsets);
  program.set("diskFactor", in.diskFactor);
  program.set("largestG", in.largestG);
  program.set("spread", in.spread);
  in.gbuffer.camera->bindUniform(0);
  in.gbuffer.depth->bind(0);
  in.gbuffer.normal->bind(1);
  sheet.position->bind(2);
  sheet.normal->bind(3);
  sheet.flux->bind(4);
  target.bind();
  if (!in.addToTarget) {
    gl::PipelineState{.width = 1 << 14, .height = 1 << 14}.apply(); // clearing keeps to the scissor
    const float nothing[4] = {};
    for (int i = 0; i < (in.gbuffer.finish ? 2 : 1); ++i)
      glClearNamedFramebufferfv(target.name(), GL_COLOR, i, nothing);
  }
  // Paper 3, eq. 7: a cluster of area A brings at most C = I A/(π r² + A), where I is the light of its whole map over
  // that of the brightest. C ≥ τ where r² ≤ A (I/τ − 1)/π, its eq. 8. The paper's A is ω |V|² with all ω alike, so too
  // small at the middle of a wide map; ours is a bound whatever the texel (rsm_pyramid.frag). gather.disk widens r² by
  // more or less A.
  float brightest = 0;
  for (const ReflectiveMap& m : sheet.maps) brightest = std::max(brightest, m.power);
  for (size_t map = 0; map < sheet.maps.size(); ++map) {
    const ReflectiveMap& m = sheet.maps[map];
    const float t = rsm.tau > 0 ? std::max(0.0f, m.power / brightest / rsm.tau / kPi - in.diskFactor) : 1e30f;
    program.set("origin", sheet.origin(map));
    program.set("threshold", t);
    for (int first = 0; first < roots; first += rootsPerDraw) {
      program.set("endRoot", std::min(roots, first + rootsPerDraw));
      for (const GatherArea& area : in.areas) {
        program.set("firstRoot", first + area.subset.x + 4 * area.subset.y);
        program.set("subset", area.subset);
        program.set("tileOrigin", area.origin);
        program.set("level", area.level);
        gl::PipelineState{.add = true,
                          .stencil = in.patches ? gl::Stencil::Marked : gl::Stencil::Off,
                          .x = area.origin.x,
                          .y = area.origin.y,
                          .width = area.size.x,
                          .height = area.size.y}
            .apply();
        gl::drawFullscreen();
      }
    }
  }
}

} // namespace lambent

// The gather that cuts light trees (hisr): paper 3, section 3.5.
#include "gi/gather/draw_gather.h"
#include "gi/lights/reflective_maps.h"

#include <algorithm>

namespace lambent {

namespace {
/// Software Mesa ends all loops of a fragment after 65 536 turns, whatever is left of them.
constexpr int kMostTurns = 60000;
} // namespace

void drawTreeGather(gl::ProgramCache& programs, const gl::Framebuffer& target, const GatherDraw& in) {
  const ReflectiveMaps& sheet = in.seen.lights.trees->maps;
  const RsmSettings& rsm = in.seen.lights.trees->rsm;
  const int coarsest = sheet.levels - 1, finest = std::min(sheet.levelOf(rsm.finest), coarsest);
  const int side = sheet.resolution >> coarsest, roots = side * side;
  const int nodes = 4 * (1 << (2 * (coarsest - finest))) / 3 + 1; // below a root, at most
  const int subsets = in.grid * in.grid;                          // each takes one root in so many
  const int rootsPerDraw = std::max(1, kMostTurns / nodes) * subsets;

  gl::ProgramDesc desc{.fragment = "tree_gather.frag", .defines = bindSurfaces(in.gbuffer)};
  if (in.patches) desc.defines.push_back("PATCHES");
  const gl::Program& program = programs.get(desc);
  program.use();
  program.set("coarsest", coarsest);
  program.set("finest", finest);
  program.set("stride", in.grid);
  program.set("rootStep", subsets);
  setShading(program, in);
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
  // Paper 3, eq. 7: cluster j of solid angle ω brings at most C = I A/(π r² + A), A = ω |V|². C ≥ τ where
  // r² ≤ ω |V|² (I/τ − 1)/π, its eq. 8 with ω = 4π/(6 R²). I is the light of a whole map over that of the brightest.
  float brightest = 0;
  for (const ReflectiveMap& m : sheet.maps) brightest = std::max(brightest, m.power);
  for (size_t map = 0; map < sheet.maps.size(); ++map) {
    const ReflectiveMap& m = sheet.maps[map];
    const float t = rsm.tau > 0 ? m.patchArea * std::max(0.0f, m.power / brightest / rsm.tau - 1) / kPi : 1e30f;
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

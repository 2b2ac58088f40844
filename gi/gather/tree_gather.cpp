// The gather that cuts light trees (hisr): paper 3, section 3.5.
#include "gi/gather/draw_gather.h"
#include "gi/reflective/reflective_maps.h"

#include <algorithm>

namespace lambent {

namespace {

/// How a map's trees are shared out to draws.
struct TreeDraws {
  int roots;  // each takes so many trees
  int leaves; // and of each tree so many of the finest clusters, with what is coarser above them
};

/// `depth`: levels below a root.
TreeDraws treeDraws(int depth, int mostTurns) {
  const auto nodes = [](int levels) { return ((4 << (2 * levels)) - 1) / 3; };
  int part = depth; // levels below the largest cluster whose parts are in one draw
  while (part > 0 && nodes(part) + depth - part > mostTurns) --part;
  const int parts = std::max(1, mostTurns / (nodes(part) + depth - part));
  if (part == depth) return {parts, 1 << (2 * depth)};
  return {1, parts << (2 * part)};
}

int stepsFor(int count, int perStep) { return (count + perStep - 1) / perStep; }

} // namespace

void drawTreeGather(gl::ProgramCache& programs, const gl::Framebuffer& target, const GatherDraw& in) {
  const ReflectiveMaps& sheet = in.lights.list.trees->maps;
  const RsmSettings& rsm = in.lights.list.trees->rsm;
  const int coarsest = sheet.levels - 1, finest = std::min(sheet.levelOf(rsm.finest), coarsest);
  const int side = sheet.resolution >> coarsest, roots = side * side;
  const int leaves = 1 << (2 * (coarsest - finest)); // of a root
  const int subsets = in.grid * in.grid;             // each takes one root in so many
  const TreeDraws draws = treeDraws(coarsest - finest, in.lights.list.trees->mostTurns);

  gl::ProgramDesc desc{.fragment = "tree_gather.frag", .defines = bindSurfaces(in.surfaces)};
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
    for (int i = 0; i < (in.surfaces.finish ? 2 : 1); ++i)
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
    const float t = rsm.tau > 0 ? std::max(0.0f, m.power / brightest / rsm.tau / kPi - in.bounds.disk / kPi) : 1e30f;
    program.set("origin", sheet.origin(map));
    program.set("threshold", t);
    const int rootSteps = stepsFor(roots, draws.roots * subsets), leafSteps = stepsFor(leaves, draws.leaves);
    for (int step = 0; step < rootSteps * leafSteps; ++step) {
      const int first = step / leafSteps * draws.roots * subsets, firstLeaf = step % leafSteps * draws.leaves;
      program.set("endRoot", std::min(roots, first + draws.roots * subsets));
      program.set("firstLeaf", firstLeaf);
      program.set("endLeaf", std::min(leaves, firstLeaf + draws.leaves));
      for (const GatherArea& area : in.areas) {
        program.set("firstRoot", first + area.lightClass);
        drawArea(program, area, in.patches, true);
      }
    }
  }
}

} // namespace lambent

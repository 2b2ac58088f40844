#include "gi/contract/figures.h"

#include <algorithm>
#include <cstdio>

namespace lambent {

namespace {

using S = FrameStats;

constexpr FigureRow kRows[] = {
    {"frame", "number of the frame", [](const S& s) -> Figure { return uint64_t(s.frame); }},
    {"rays.points", "camera rays that found visible points", [](const S& s) -> Figure { return s.raysPoints; }},
    {"rays.validation", "from visible points to VPLs", [](const S& s) -> Figure { return s.raysValidation; }},
    {"rays.candidates", "that looked for places for VPLs", [](const S& s) -> Figure { return s.raysCandidates; }},
    {"rays.radiosity", "of light paths", [](const S& s) -> Figure { return s.raysRadiosity; }, true},
    {"rays.cells", "that found the surface around VPLs", [](const S& s) -> Figure { return s.raysCells; }},
    {"rays.map_tests", "from VPLs to objects that moved", [](const S& s) -> Figure { return s.raysMapTests; }},
    {"rays.shadows", "where maps of direct light are in doubt", [](const S& s) -> Figure { return s.raysShadows; }},
    {"rays.soft", "of soft direct light: from the camera, to lights and the sky, and by what surfaces reflect",
     [](const S& s) -> Figure { return s.raysSoft; }},
    {"rays.mirrors", "of what smooth surfaces mirror: from the camera, by lobes, and of light paths",
     [](const S& s) -> Figure { return s.raysMirrors; }},
    {"rays.lists", "from the camera, for lists of lights", [](const S& s) -> Figure { return s.raysLists; }},
    {"rays.volume", "between cells of a light propagation volume, and from lights to them",
     [](const S& s) -> Figure { return s.raysVolume; }},
    {"rays.cube", "into the layered depth cube, and between its entries and lights",
     [](const S& s) -> Figure { return s.raysCube; }},
    {"rays.area", "between emissive surfaces and patches", [](const S& s) -> Figure { return s.raysArea; }},
    {"rays.near", "for the light that bounds take from near VPLs", [](const S& s) -> Figure { return s.raysNear; }},
    {"rays.checks", "that check maps of VPLs", [](const S& s) -> Figure { return s.raysChecks; }},
    {"rays.gather", "between pixels and VPLs", [](const S& s) -> Figure { return s.raysGather; }},
    {"vpls.alive", "virtual lights that bring light", [](const S& s) -> Figure { return uint64_t(s.vplsAlive); }},
    {"vpls.kept", "that stayed", [](const S& s) -> Figure { return uint64_t(s.vplsKept); }},
    {"vpls.moved", "that stand elsewhere now", [](const S& s) -> Figure { return uint64_t(s.vplsMoved); }},
    {"vpls.invalid", "that no visible point sees", [](const S& s) -> Figure { return uint64_t(s.vplsInvalid); }},
    {"vpls.relit", "whose light was added up again", [](const S& s) -> Figure { return uint64_t(s.vplsRelit); }},
    {"paths.held", "light paths kept", [](const S& s) -> Figure { return s.pathsHeld; }},
    {"paths.traced", "light paths traced", [](const S& s) -> Figure { return s.pathsTraced; }},
    {"paths.retraced", "of these, paths that had been traced before",
     [](const S& s) -> Figure { return s.pathsRetraced; }},
    {"patches", "gathered at, as far as the GPU has reported", [](const S& s) -> Figure { return s.patches; }},
    {"area_fragments", "patches that asked rays about emissive surfaces, single pixels in them too",
     [](const S& s) -> Figure { return s.areaFragments; }},
    {"maps_drawn", "shadow maps of VPLs and lamps, in part or whole",
     [](const S& s) -> Figure { return uint64_t(s.mapsDrawn); }},
    {"map_texels_drawn", "of VPLs' maps", [](const S& s) -> Figure { return s.mapTexelsDrawn; }},
    {"maps_waiting", "shadow maps of VPLs that show where something was, or are coarse",
     [](const S& s) -> Figure { return uint64_t(s.mapsWaiting); }},
    {"light_maps_drawn", "shadow maps of punctual lights and of the sky",
     [](const S& s) -> Figure { return uint64_t(s.lightMapsDrawn); }},
    {"cube.cubes", "of the tree of layered depth cubes", [](const S& s) -> Figure { return s.cubes; }},
    {"cube.entries", "of the layered depth cube that light reaches",
     [](const S& s) -> Figure { return s.cubeEntries; }},
    {"cube.bytes", "that pixels look up", [](const S& s) -> Figure { return s.cubeBytes; }},
    {"cube.kept_bytes", "that bring these up to date", [](const S& s) -> Figure { return s.cubeKeptBytes; }},
    {"cube.maker", "who makes hemicubes", [](const S& s) -> Figure { return s.cubeMaker; }},
    {"draws", "draw calls", [](const S& s) -> Figure { return s.draws; }},
    {"waits", "of the CPU for something that the GPU had yet to say", [](const S& s) -> Figure { return s.waits; }},
    {"read_backs", "copies from the GPU's memory", [](const S& s) -> Figure { return s.readBacks; }},
    {"burst", "camera cut: any number of VPLs may be replaced", [](const S& s) -> Figure { return s.burst; }},
    {"shadow_maker", "who draws VPLs' maps", [](const S& s) -> Figure { return s.shadowMaker; }},
    {"plan", "effects that ran", [](const S& s) -> Figure { return s.plan.oneLine(); }},
    {"timing", "how GPU times were taken", [](const S& s) -> Figure { return s.timing; }},
    {"wall_ms", "the whole frame", [](const S& s) -> Figure { return s.wallMs; }},
    {"update_ms", "update of the VPLs, wherever it ran", [](const S& s) -> Figure { return s.updateMs; }},
};

std::string milliseconds(double ms) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", ms);
  return text;
}

std::string underscored(std::string name) {
  for (char& c : name)
    if (c == '.' || c == ' ') c = '_';
  return name;
}

} // namespace

double FrameStats::costMs() const {
  double gpuMs = 0;
  for (const StageTime& stage : stages) gpuMs += stage.gpuMs;
  return std::max(wallMs, gpuMs);
}

double FrameStats::ms(StageId stage) const {
  double ms = 0;
  for (const StageTime& t : stages)
    if (t.stage == key(stage)) ms += std::max(t.cpuMs, t.gpuMs);
  return ms;
}

std::span<const FigureRow> figureTable() { return kRows; }

std::vector<FigureColumn> columnsOf(const FrameStats& stats) {
  std::vector<FigureColumn> columns;
  for (const FigureRow& row : kRows) {
    const std::string name = underscored(row.name);
    const Figure figure = row.value(stats);
    if (const RayCounts* rays = std::get_if<RayCounts>(&figure)) {
      if (row.split) {
        columns.push_back({name + "_closest", std::to_string(rays->closest)});
        columns.push_back({name + "_occlusion", std::to_string(rays->occlusion)});
      } else {
        columns.push_back({name, std::to_string(rays->closest + rays->occlusion)});
      }
    } else if (const double* ms = std::get_if<double>(&figure)) {
      columns.push_back({name, milliseconds(*ms)});
    } else if (const bool* flag = std::get_if<bool>(&figure)) {
      columns.push_back({name, *flag ? "1" : "0"});
    } else {
      columns.push_back({name, figureText(figure)});
    }
  }
  for (size_t i = 0; i < kStages; ++i)
    columns.push_back({underscored(kStageNames[i]) + "_ms", milliseconds(stats.ms(StageId(i)))});
  return columns;
}

std::string figureText(const Figure& figure) {
  struct Text {
    std::string operator()(uint64_t n) const { return std::to_string(n); }
    std::string operator()(bool on) const { return on ? "on" : "off"; }
    std::string operator()(double ms) const { return milliseconds(ms) + " ms"; }
    std::string operator()(const RayCounts& rays) const { return std::to_string(rays.closest + rays.occlusion); }
    std::string operator()(const std::string& text) const { return text; }
  };
  return std::visit(Text(), figure);
}

} // namespace lambent

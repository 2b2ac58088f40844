// Figures of one frame, and the table of them that frames.csv, --json and the panel are made from.
#pragma once

#include "engine/core/profile.h"
#include "engine/trace/ray_query.h"
#include "gi/plan/effects.h"
#include "gi/plan/stages.h"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace lambent {

/// Figures of one frame. With frame.overlap, those of the VPL update are of the update that ended before this frame:
/// the last frame's.
struct FrameStats {
  uint32_t frame = 0;
  std::vector<StageTime> stages;   // CPU and GPU, in order
  double wallMs = 0, updateMs = 0; // of the whole frame, and of updating the VPLs, wherever that ran
  RayCounts raysPoints, raysValidation, raysCandidates, raysRadiosity, raysCells, raysGather, raysNear, raysChecks,
      raysMapTests, raysShadows, raysSoft, raysMirrors, raysLists, raysArea, raysVolume, raysCube;
  uint64_t patches = 0;                // of the multiresolution buffer that gathered, as far as the GPU has reported
  uint64_t areaFragments = 0;          // of area lights
  uint64_t cubes = 0, cubeEntries = 0; // layered depth cubes, and entries of these that light reaches
  uint64_t cubeBytes = 0, cubeKeptBytes = 0; // of these, and of what brings them up to date
  uint32_t vplsKept = 0, vplsMoved = 0, vplsInvalid = 0, vplsRelit = 0, vplsAlive = 0, vplsStrong = 0;
  uint64_t pathsHeld = 0, pathsTraced = 0, pathsRetraced = 0; // light paths kept; traced; of these, ones traced before
  uint32_t mapsDrawn = 0;                                     // paraboloid maps, in part or whole
  uint64_t mapTexelsDrawn = 0;                                // of VPLs' maps, a ray or a texel drawn each
  uint32_t mapsWaiting = 0;                                   // that show where a moved object was, or are coarse
  uint32_t lightMapsDrawn = 0;                                // of punctual lights and of the sky
  uint64_t draws = 0, waits = 0, readBacks = 0;               // of the GPU: see gl::Counts
  bool burst = false;
  EffectPlan plan;
  std::array<uint64_t, kEffects> work{}; // by effect, in the unit of its row
  std::string areaTracer;              // who traced rays from patches to emissive surfaces, and how fast each would be
  std::string shadowMaker, makerTimes; // who drew VPL maps last; both makers' times where they were measured
  std::string cubeMaker, cubeMakerTimes; // the same of hemicubes
  std::string timing;                    // how GPU times were taken
  std::string warning;                   // one line for whoever started the program; empty: nothing to say

  uint64_t& of(EffectId id) { return work[size_t(id)]; }
  /// Milliseconds that the machine worked on the frame: the longer of the frame's wall time and the GPU's passes.
  double costMs() const;
  /// Milliseconds of a stage, the longer of CPU and GPU; 0 if it did not run.
  double ms(StageId stage) const;
};

using Figure = std::variant<uint64_t, bool, double, RayCounts, std::string>; // double: milliseconds

/// One figure. Dots in a name are levels in --json; in frames.csv they are underscores. Rays are a column of their sum,
/// or two columns where `split` says so.
struct FigureRow {
  const char* name;
  const char* help;
  Figure (*value)(const FrameStats&);
  bool split = false;
};
std::span<const FigureRow> figureTable();

/// A column of frames.csv.
struct FigureColumn {
  std::string name, text;
};
/// All columns of a frame, times of stages last.
std::vector<FigureColumn> columnsOf(const FrameStats& stats);
/// One line of the panel: "1234", "on", "12.3 ms".
std::string figureText(const Figure& figure);

} // namespace lambent

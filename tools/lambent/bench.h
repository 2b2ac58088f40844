// What the forms of `lambent bench` share.
#pragma once

#include "tools/lambent/study.h"

namespace lambent {

struct BenchOptions : MeasureOptions {
  std::vector<std::string> techniques;
  std::vector<std::string> against; // NAME=VALUE
  std::vector<std::string> along;   // what --growth sweeps; empty: all
  int frames = 0, skip = 2;
  void (*form)(const BenchOptions&) = nullptr; // null: stages and counts, of one way or of several in turn
};

/// As the options say, of a scene `frames` where they say nothing. Throws InputError when no frame would be left.
RunPlan benchPlan(const BenchOptions& options, LaunchContext& opened, int frames = 0);
/// Throws InputError: the form measures techniques of its own.
void refuseTechnique(const BenchOptions& options, const std::string& why);

/// A line of a table: of time, or of what is counted.
struct Line {
  std::string name;
  std::function<Spread(const Measured&)> of;
};
/// Of each stage that ran on any side, of updating the virtual lights, and of the frame: milliseconds.
std::vector<Line> timeLines(const std::vector<Measured>& sides);

/// Median and quartiles of a line or column, for programs: KEY under median_ms, and under quartiles_ms.
void addSpread(Value& row, const std::string& key, const Spread& spread);
/// The same for people: "12.3 (11.9 to 13.0)".
std::string spreadText(double median, const Value& quartiles);

/// Techniques multires-gather and multires-splat, scene by scene (paper 3, table 1).
void benchMultires(const BenchOptions& options);
/// Where the time of sequences goes, as paper 1's table 2.
void benchTable2(const BenchOptions& options);
/// How time grows with virtual lights, pixels, lights, instances and triangles.
void benchGrowth(const BenchOptions& options);
/// Error of the presets, and path tracing's time to the same.
void benchEqualError(const BenchOptions& options);
/// Area lights at patches, their predecessor and every pixel, scene by scene (paper 4, table 1).
void benchArea(const BenchOptions& options);
/// The layered depth cube, scene by scene (paper 5, table 1).
void benchCube(const BenchOptions& options);
/// Rays on the GPU against Embree.
void benchRays(const BenchOptions& options);

} // namespace lambent

// What the forms of `lambent bench` share.
#pragma once

#include "tools/lambent/commands.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace lambent {

class GlContext;

struct BenchOptions {
  LaunchOptions launch; // its scene is empty where several are given
  OutputOptions output;
  std::vector<std::string> scenes, techniques;
  std::vector<std::string> against; // NAME=VALUE
  std::vector<std::string> along;   // what --growth sweeps; empty: all
  bool multires = false, table2 = false, growth = false, equalError = false, rays = false, area = false, cube = false,
       quick = false;
  int frames = 0, skip = 2;
  int seeds = 3, frame = 0;   // --equal-error; frame 0: 30, or the last
  std::optional<int> samples; // --equal-error, --area
};

/// As the options say, of a scene `frames` where they say nothing. Throws InputError when no frame would be left.
RunPlan benchPlan(const BenchOptions& options, LaunchContext& stage, Progress& progress, int frames = 0);

/// A line of a table: of time, or of what is counted.
struct Line {
  std::string name;
  std::function<Spread(const Measured&)> of;
};
/// Of each stage that ran on any side, of updating the virtual lights, and of the frame: milliseconds.
std::vector<Line> timeLines(const std::vector<Measured>& sides);

/// "12.3 (11.9 to 13.0)": median and quartiles.
std::string spreadText(const Spread& spread);

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

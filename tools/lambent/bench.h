// What the two forms of `lambent bench` share.
#pragma once

#include "tools/lambent/commands.h"

#include <string>
#include <vector>

namespace lambent {

struct BenchOptions {
  LaunchOptions launch; // its scene is empty where several are given
  OutputOptions output;
  std::vector<std::string> scenes;
  std::vector<std::string> against; // NAME=VALUE
  bool multires = false;
  int frames = 0, skip = 2;
};

/// The upper one of the two in the middle; 0 for none.
double median(std::vector<double> values);

/// Frames to run, those that do not count included. Throws InputError when none would be left.
int framesOf(const BenchOptions& options, const Stage& stage);

/// Techniques multires-gather and multires-splat, scene by scene.
void benchMultires(const BenchOptions& options);

} // namespace lambent

// What the two forms of `lambent bench` share.
#pragma once

#include "tools/lambent/commands.h"

#include <string>
#include <vector>

namespace lambent {

struct BenchOptions {
  LaunchOptions launch; // its scene is empty where several are given
  OutputOptions output;
  std::vector<std::string> scenes, techniques;
  std::vector<std::string> against; // NAME=VALUE
  bool multires = false, quick = false;
  int frames = 0, skip = 2;
};

/// As the options say. Throws InputError when no frame would be left.
RunPlan benchPlan(const BenchOptions& options, Stage& stage, Progress& progress);

/// The view with every punctual light a ten-thousandth of the scene aside in every other frame, so that no map is kept
/// and every stage runs in every frame. `lights` holds them.
SceneView unsteady(SceneView view, int frame, std::vector<LightView>& lights);

/// Techniques multires-gather and multires-splat, scene by scene.
void benchMultires(const BenchOptions& options);

} // namespace lambent

#include "gi/measure/error_parts.h"

#include "engine/core/error.h"
#include "gi/near/near_light.h"
#include "gi/plan/needs.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

constexpr double kNearRays = 48; // a pixel and frame: what lists cast of the largest gather.near while light changes

/// Near rays of a pixel for each of GatherSettings::near.
double raysForOne(const Settings& settings, bool lightChanges) {
  const Needs needs = needsOf(settings);
  const bool averaged = settings.history.frames > 1 && settings.effects[EffectId::History] != EffectMode::Off;
  return double(nearTimes(needs.lists, averaged, averaged && lightChanges)) / (needs.subsets ? 16 : 1);
}

void castNearRays(Settings& settings, double wanted, bool lightChanges) {
  const double near = std::round(wanted / raysForOne(settings, lightChanges));
  settings.gather.near = int(std::min(near, settingRow("gather.near").high));
}

} // namespace

double nearRaysOfPixel(const Settings& settings, bool lightChanges) {
  return settings.gather.near * raysForOne(settings, lightChanges);
}

std::vector<ExactStep> exactSteps(const Settings& asSet, bool lightChanges) {
  std::vector<ExactStep> steps;
  Settings s = asSet;
  double rays = kNearRays;
  const auto add = [&](const char* part, const char* by) {
    castNearRays(s, rays, lightChanges);
    rays = nearRaysOfPixel(s, lightChanges);
    steps.push_back({part, by, s});
  };
  // Near rays come first, as every light at every pixel brings near rays of its own.
  add("near light", "so many near rays that none are missed");
  // Pixels that gather every light have none: what it does must not count to the choice of lights.
  s.filter.on = false;
  add("reconstruction", "no filter and no denoiser: its blur less the noise that it takes away");
  s.gather.mode = GatherMode::Full;
  add("choice of lights", "every light at every pixel");
  s.vpl.visibility = VplVisibility::Rays;
  add("maps", "a ray for every pair");
  s.history.frames = 0;
  add("history", "one frame, without a mean over frames and its lag");
  return steps;
}

std::vector<ErrorPart> errorParts(std::span<const ExactStep> steps, std::span<const std::vector<double>> errors,
                                  double ofTruth) {
  CHECK_EQ(errors.size(), steps.size() + 1);
  std::vector<ErrorPart> parts;
  for (size_t i = 0; i < steps.size(); ++i) {
    CHECK_EQ(errors[i].size(), errors[i + 1].size());
    std::vector<double> lost; // paired: seeds differ more than steps do
    for (size_t seed = 0; seed < errors[i].size(); ++seed) lost.push_back(errors[i][seed] - errors[i + 1][seed]);
    parts.push_back({steps[i].part, steps[i].by, meanOver(lost)});
  }
  std::vector<double> left = errors.back();
  for (double& error : left) error -= ofTruth;
  parts.push_back({"set of lights", "what is left", meanOver(left)});
  parts.push_back({"truth", "its own noise", {.value = ofTruth}});
  return parts;
}

} // namespace lambent

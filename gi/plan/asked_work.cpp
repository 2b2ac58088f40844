#include "gi/plan/asked_work.h"

#include <cmath>
#include <span>

namespace lambent {

namespace {

/// A setting, and the power of it that a stage's time or memory grows with.
struct Factor {
  const char* name;
  double power;
  double standard = 0; // where its default is none
};

// Lights cost more than in proportion: neighbours of each are looked for.
constexpr Factor kSampling[] = {{"smc.vpls", 1.5},         {"smc.paths", 1},         {"smc.bounces", 1},
                                {"smc.warmup", 1},         {"smc.candidateRays", 1}, {"smc.points", 1},
                                {"smc.validationRays", 1}, {"vpl.mirCandidates", 1}, {"vpl.tcasIterations", 1}};
constexpr Factor kMaps[] = {{"smc.vpls", 1}, {"shadow.resolution", 2}};
constexpr Factor kGather[] = {{"smc.vpls", 1}, {"gather.lights", 1}, {"gather.near", 1}, {"gather.mirrors", 1}};
constexpr Factor kEmitters[] = {{"shadow.emitterSamples", 1}, {"shadow.emitterResolution", 2}};
constexpr Factor kSky[] = {{"shadow.skyMaps", 1}, {"shadow.skyResolution", 2}};
constexpr Factor kDirect[] = {{"direct.samples", 1}, {"direct.mostSamples", 1}, {"area.rays", 1}};
// 8192 texels are four times the automatic map of a picture 1920 wide.
constexpr Factor kLights[] = {
    {"shadow.sunResolution", 2, 8192}, {"shadow.pointResolution", 2, 4096}, {"shadow.spotResolution", 2, 4096}};
constexpr Factor kReflective[] = {{"rsm.vpls", 1}, {"rsm.resolution", 2}, {"rsm.finest", 2}};
constexpr Factor kCube[] = {{"cube.resolution", 2}, {"cube.levels", 2, 1}, {"cube.hemicube", 2}, {"smc.vpls", 1}};
constexpr Factor kVolume[] = {{"lpv.cells", 3}, {"lpv.steps", 1}};
constexpr std::span<const Factor> kStages[] = {kSampling, kMaps,       kGather, kEmitters, kSky,
                                               kDirect,   kReflective, kCube,   kVolume,   kLights};

} // namespace

AskedWork workOf(const Settings& settings) {
  AskedWork most;
  for (const std::span<const Factor> stage : kStages) {
    AskedWork asked;
    for (const Factor& f : stage) {
      const SettingRow row = settingRow(f.name, settings);
      const double more = row.get(settings) / (row.standard > 0 ? row.standard : f.standard);
      if (!(more > 1)) continue;
      asked.times *= std::pow(more, f.power);
      asked.names += (asked.names.empty() ? "" : ", ") + row.name;
    }
    if (asked.times > most.times) most = std::move(asked);
  }
  return most;
}

} // namespace lambent

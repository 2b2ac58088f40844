// Presets: points of the measured front of error against time (docs/measurements/presets.md).
#pragma once

#include "gi/plan/settings.h"

#include <string>
#include <utility>
#include <vector>

namespace lambent {

/// Settings by name, as on the command line.
using Assignments = std::vector<std::pair<std::string, std::string>>;

/// Numbers of virtual lights, what each is worth, near rays, and where light is gathered: what presets set.
Assignments worth(const char* vpls, const char* points, const char* paths, const char* resolution, const char* near,
                  const char* mode);

struct Preset {
  std::string name;
  Assignments set;
  /// Shares of the default's, as measured over the scenes of the report at 128×72: time of a frame in motion; relMSE of
  /// indirect light, moving and still (geometric mean). Near rays cost by the pixel, lights do not, so what casts more
  /// of these costs more in larger images.
  double time, error;
};
/// The presets, cheapest first. The rule that chose them: ladderOf, gi/measure/front.h. Without a preset the defaults
/// hold, whose cost lies between medium's and high's.
const std::vector<Preset>& presetTable();
const std::vector<std::string>& presetNames();
/// Sets what the preset is about (numbers of VPLs, paths, map texels, near rays; of a technique that samples its lights
/// also the gather) and leaves everything else. Throws InputError that names the presets.
void applyPreset(Settings& settings, const std::string& name);

} // namespace lambent

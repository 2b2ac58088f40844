#include "gi/plan/presets.h"

#include "engine/core/error.h"
#include "engine/core/text.h"
#include "gi/plan/needs.h"

#include <algorithm>

namespace lambent {

Assignments worth(const char* vpls, const char* points, const char* paths, const char* resolution, const char* near,
                  const char* mode) {
  return {{"smc.vpls", vpls},    {"smc.points", points}, {"smc.paths", paths}, {"shadow.resolution", resolution},
          {"gather.near", near}, {"gather.mode", mode}};
}

const std::vector<Preset>& presetTable() {
  static const std::vector<Preset> table{
      {"low", worth("256", "1024", "8", "64", "8", "lists"), 0.497, 1.716},
      {"medium", worth("1024", "2048", "16", "128", "8", "lists"), 0.767, 1.015},
      {"high", worth("2048", "4096", "32", "128", "32", "lists"), 1.275, 0.726},
  };
  return table;
}

const std::vector<std::string>& presetNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const Preset& preset : presetTable()) all.push_back(preset.name);
    return all;
  }();
  return names;
}

void applyPreset(Settings& settings, const std::string& name) {
  Assignments set;
  if (name == "default") {
    for (const auto& [setting, value] : presetTable().front().set) // what presets are about
      set.emplace_back(setting, settingText({}, setting));
  } else {
    const auto found = std::ranges::find(presetTable(), name, &Preset::name);
    if (found == presetTable().end())
      throw InputError("preset " + name, "no such preset (" + joined(presetNames()) + ", default)");
    set = found->set;
  }
  for (const auto& [setting, value] : set) // techniques from reflective maps have a gather of their own
    if (setting != "gather.mode" || needsOf(settings).freeGather) applySetting(settings, setting, value);
}

} // namespace lambent

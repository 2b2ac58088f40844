// lambent settings: every knob with default, range and cost.
#include "tools/lambent/commands.h"

#include <cstdio>

namespace lambent {

void declareSettings(CLI::App& app) {
  app.add_subcommand("settings", "every setting with default, range and cost")->callback([] {
    for (const SettingRow& r : settingsTable())
      std::printf("%-26s %-12s %-16s %-8s %s%s%s\n", r.name.c_str(), r.text(r.standard).c_str(), r.range().c_str(),
                  r.unit, r.help.c_str(), r.change == ChangeCost::Nothing ? "" : "; changed: ",
                  r.change == ChangeCost::Nothing ? "" : costText(r.change));
  });
}

} // namespace lambent

// What a person changed in the window, kept from one run to the next.
#pragma once

#include "gi/plan/settings.h"

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lambent {

/// Quality that the command line asks for: it stands.
struct AskedFor {
  bool presetOrTechnique = false;
  std::vector<std::string> settings; // names
};

struct Preferences {
  std::string preset, technique;          // empty: none was chosen
  std::map<std::string, std::string> set; // settings changed by themselves: name and value
  double exposure = 0; // EV brighter than a scene is shown by itself, which differs from scene to scene
  bool panel = true;
  std::optional<bool> folded = {}; // the panel; none: as the window's size suggests
  double speed = 1;
  std::optional<std::pair<int, int>> window = {}; // its size

  bool operator==(const Preferences&) const = default;

  /// A person changed single settings, or chose a preset or a technique, which then is what set the rest that it sets.
  void changed(const Settings& before, const Settings& after);
  void chosePreset(const std::string& name, const Settings& before, const Settings& after);
  void choseTechnique(const std::string& name, const Settings& before, const Settings& after);

  /// `settings` as the person left them, in all that was not asked for. As it was where this contradicts itself or
  /// knows no such name: `complaint` then says so. `apply`: applyTechnique.
  using ApplyTechnique = std::function<void(Settings&, const std::string&)>;
  Settings over(const Settings& settings, const AskedFor& asked, const ApplyTechnique& apply,
                std::string& complaint) const;
  /// These with what was changed between `before` and `after`, and with nothing else of either.
  Preferences with(const Preferences& before, const Preferences& after) const;
  /// Whether they say how good images are to be, so that nothing else chooses.
  bool chooseQuality() const;
};

/// Where they are kept: $XDG_CONFIG_HOME/lambent/walkthrough.json, else in ~/.config; empty where there is neither.
std::filesystem::path preferencesFile(const char* xdgConfigHome, const char* home);

/// Throws InputError for a file that is not one of preferences. No file: the defaults.
Preferences loadPreferences(const std::filesystem::path& file);
/// Makes the folder too. Throws RunError.
void savePreferences(const Preferences& preferences, const std::filesystem::path& file);

/// Those of a run.
class KeptPreferences {
 public:
  /// Loads them; an empty name keeps none. A bad file gives the defaults and a complaint; it stays as it is until
  /// something is changed, and then gives way.
  explicit KeptPreferences(std::filesystem::path file);

  Preferences now;

  /// `seconds` went by. Saves what has not changed for two of them.
  void passed(double seconds);
  /// Saves what has changed since the last time into what the file holds by now: another window's changes stay.
  void save();
  /// What went wrong since the last call, one line; empty: nothing.
  std::string takeComplaint() { return std::exchange(complaint_, {}); }

 private:
  std::filesystem::path file_;
  Preferences saved_, seen_;
  Preferences inFile_; // what of this window's the file holds
  double still_ = 0; // seconds that `now` has been as it was last seen
  std::string complaint_;
};

} // namespace lambent

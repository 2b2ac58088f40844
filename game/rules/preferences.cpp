#include "game/rules/preferences.h"

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/scene/json_text.h"
#include "gi/plan/presets.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <fstream>
#include <utility>

namespace lambent {

namespace fs = std::filesystem;

namespace {

constexpr const char* kKind = "lambent walkthrough"; // what the file says it is
constexpr const char* kExposure = "image.exposure";  // Preferences::exposure stands for it
constexpr double kSettles = 2;                       // seconds
constexpr size_t kLongest = 1 << 20;                 // bytes of a file
constexpr int kSmallest = 160, kLargest = 16384;     // sides of a window that is opened so again

template <class Action> void eachDifference(const Settings& a, const Settings& b, Action&& action) {
  if (a == b) return;
  for (const SettingRow& row : settingRows(b))
    if (row.name != kExposure && row.get(a) != row.get(b)) action(row.name);
}

std::string readAll(const fs::path& file) {
  std::error_code none;
  if (!fs::is_regular_file(file, none)) throw InputError(file.string(), "is not a file");
  std::ifstream in(file, std::ios::binary);
  std::string text(kLongest + 1, '\0');
  in.read(text.data(), std::streamsize(text.size()));
  if (!in.eof()) throw InputError(file.string(), in ? "is too long for settings" : "cannot be read");
  text.resize(size_t(in.gcount()));
  return text;
}

std::pair<int, int> windowOf(const nlohmann::json& j) {
  const std::array<int, 2> size = j.get<std::array<int, 2>>();
  return {std::clamp(size[0], kSmallest, kLargest), std::clamp(size[1], kSmallest, kLargest)};
}

/// What a file holds, and `instead` where it is none of preferences.
Preferences heldBy(const fs::path& file, const Preferences& instead) {
  try {
    return loadPreferences(file);
  } catch (const InputError&) {
    return instead;
  }
}

double between(double low, double value, double high) {
  if (!(value >= low && value <= high)) throw std::out_of_range("a number is out of range");
  return value;
}

} // namespace

void Preferences::changed(const Settings& before, const Settings& after) {
  eachDifference(before, after, [&](const std::string& name) { set[name] = settingText(after, name); });
}

void Preferences::chosePreset(const std::string& name, const Settings& before, const Settings& after) {
  preset = name;
  eachDifference(before, after, [&](const std::string& setting) { set.erase(setting); });
  for (const Preset& row : presetTable())
    if (row.name == name)
      for (const auto& [setting, value] : row.set) set.erase(setting);
}

void Preferences::choseTechnique(const std::string& name, const Settings& before, const Settings& after) {
  technique = name;
  for (const auto& [setting, value] : before.ownValues) set.erase(setting); // no other technique knows them
  eachDifference(before, after, [&](const std::string& setting) { set.erase(setting); });
}

Settings Preferences::over(const Settings& settings, const AskedFor& asked, const ApplyTechnique& apply,
                           std::string& complaint) const {
  Settings wanted = settings;
  const auto isAsked = [&](const std::string& name) { return std::ranges::count(asked.settings, name) > 0; };
  try {
    Settings chosen = settings;
    if (!asked.presetOrTechnique && !preset.empty()) applyPreset(chosen, preset);
    if (!asked.presetOrTechnique && !technique.empty()) apply(chosen, technique);
    wanted = chosen;
    for (const SettingRow& row : settingRows(settings))
      if (isAsked(row.name)) row.set(wanted, row.get(settings));
    for (const auto& [name, value] : set)
      if (!isAsked(name) && !(asked.presetOrTechnique && !name.starts_with("image.")))
        applySetting(wanted, name, value);
    const std::string reason = whyNot(wanted);
    if (reason.empty()) return wanted;
    complaint = "settings of the last time are left out: " + reason;
  } catch (const InputError& e) {
    complaint = std::string("settings of the last time are left out: ") + e.what();
  }
  return settings;
}

Preferences Preferences::with(const Preferences& before, const Preferences& after) const {
  Preferences p = *this;
  const auto take = [&](auto member) {
    if (before.*member != after.*member) p.*member = after.*member;
  };
  take(&Preferences::preset), take(&Preferences::technique), take(&Preferences::exposure), take(&Preferences::panel);
  take(&Preferences::folded), take(&Preferences::speed), take(&Preferences::window);
  for (const auto& [name, value] : before.set)
    if (!after.set.contains(name)) p.set.erase(name);
  for (const auto& [name, value] : after.set)
    if (const auto had = before.set.find(name); had == before.set.end() || had->second != value) p.set[name] = value;
  return p;
}

bool Preferences::chooseQuality() const {
  return !preset.empty() || !technique.empty() ||
         std::ranges::any_of(set, [](const auto& s) { return !s.first.starts_with("image."); });
}

fs::path preferencesFile(const char* xdgConfigHome, const char* home) {
  const fs::path own = "lambent/walkthrough.json";
  // The rule of the XDG folders: a path that is not absolute counts as none.
  if (xdgConfigHome && fs::path(xdgConfigHome).is_absolute()) return xdgConfigHome / own;
  if (home && fs::path(home).is_absolute()) return home / fs::path(".config") / own;
  return {};
}

Preferences loadPreferences(const fs::path& file) {
  Preferences p;
  std::error_code none;
  if (!fs::exists(fs::symlink_status(file, none))) return p;
  const std::string text = readAll(file);
  checkJson(file, text);
  try {
    const nlohmann::json j = nlohmann::json::parse(text);
    if (j.at("kind") != kKind) throw std::invalid_argument("another program's");
    p.preset = j.value("preset", "");
    p.technique = j.value("technique", "");
    p.set = j.value("set", p.set);
    p.exposure = between(-24, j.value("exposure", 0.0), 24);
    p.panel = j.value("panel", true);
    if (j.contains("folded")) p.folded = j["folded"].get<bool>();
    p.speed = between(0.1, j.value("speed", 1.0), 10);
    if (j.contains("window")) p.window = windowOf(j["window"]);
  } catch (const std::exception& e) {
    throw InputError(file.string(), "holds no settings of the walkthrough (" + reasonOf(e.what()) + ")");
  }
  return p;
}

void savePreferences(const Preferences& p, const fs::path& file) {
  nlohmann::json j{{"kind", kKind}, {"panel", p.panel}, {"speed", p.speed}, {"exposure", p.exposure}};
  if (!p.preset.empty()) j["preset"] = p.preset;
  if (!p.technique.empty()) j["technique"] = p.technique;
  if (!p.set.empty()) j["set"] = p.set;
  if (p.folded) j["folded"] = *p.folded;
  if (p.window) j["window"] = {p.window->first, p.window->second};
  makeFolder(file.parent_path());
  writeAtomically(file, [&](const fs::path& temporary) {
    std::ofstream out(temporary);
    out << j.dump(2) << "\n";
    if (!out.flush()) throw RunError(file.string() + ": cannot be written (is the folder writable, the disk full?)");
  });
}

KeptPreferences::KeptPreferences(fs::path file) : file_(std::move(file)) {
  try {
    if (!file_.empty()) now = loadPreferences(file_);
  } catch (const InputError& e) {
    complaint_ = std::string(e.what()) + ": begun without; what you change takes its place";
  }
  inFile_ = saved_ = seen_ = now;
}

void KeptPreferences::passed(double seconds) {
  still_ = now == seen_ ? still_ + seconds : 0;
  seen_ = now;
  if (still_ >= kSettles) save();
}

void KeptPreferences::save() {
  if (file_.empty() || now == saved_) return;
  saved_ = now; // also where it fails: reported once, tried again when something else changes
  try {
    makeFolder(file_.parent_path());
    const FolderLock alone(file_.parent_path(), true);
    savePreferences(heldBy(file_, now).with(inFile_, now), file_);
    inFile_ = now;
  } catch (const RunError& e) {
    complaint_ = std::string("settings are not kept: ") + e.what();
  }
}

} // namespace lambent

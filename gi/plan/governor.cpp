#include "gi/plan/governor.h"

#include "gi/plan/needs.h"

#include "engine/core/error.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace lambent {

namespace {

double medianOf(std::vector<double> values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Scale at which a frame that takes `ms` at this one would take `targetMs`, if all its cost were the pixels'.
double scaleFor(double scale, double ms, double targetMs) { return scale * std::sqrt(targetMs / ms); }

/// The same far over the target, where part of the cost is not the pixels': what is left of it at no scale at all, by
/// the scale before. (Of a small change noise would tell more than that.)
double scaleFromFar(const Governed& g, double ms, double targetMs) {
  const double now = double(g.scale) * g.scale, other = double(g.otherScale) * g.otherScale;
  const double perPixel = other > 0 && std::abs(now - other) > 0.2 * now ? (g.otherMs - ms) / (other - now) : 0;
  const double fixed = perPixel > 0 ? std::clamp(ms - perPixel * now, 0.0, 0.8 * std::min(ms, targetMs)) : 0;
  return scaleFor(g.scale, ms - fixed, targetMs - fixed);
}

/// Time of a frame, of the default's, where the settings are a preset's or the default's; none where somebody has set
/// them otherwise.
std::optional<double> timeOf(const Settings& settings) {
  for (const Preset& preset : presetTable()) {
    Settings same = settings;
    applyPreset(same, preset.name);
    if (same == settings) return preset.time;
  }
  const bool ownGather = !needsOf(settings).freeGather;
  for (const auto& [name, value] : presetTable().front().set) {
    const SettingRow& row = settingRow(name);
    if (row.get(settings) != row.standard && !(ownGather && name == "gather.mode")) return {};
  }
  return 1;
}

/// From settings of this time to the dearest preset whose image need not be too small for the target, else to the
/// cheapest.
void choosePreset(Governed& g, double time, double ms, double targetMs, const GovernorGains& gains) {
  const auto scaleOf = [&](const Preset& p) { return scaleFor(g.scale, ms * p.time / time, targetMs); };
  const Preset* chosen = &presetTable().front();
  for (const Preset& preset : presetTable())
    if (scaleOf(preset) >= double(gains.easy)) chosen = &preset;
  g.preset = chosen->name;
  g.scale = float(scaleOf(*chosen));
  applyPreset(g.settings, g.preset);
}

} // namespace

const char* paceText(Pace pace) {
  constexpr const char* texts[] = {"calibrating", "holding the target", "too slow at the least scale",
                                   "faster than the target"};
  return texts[int(pace)];
}

Governed governed(Governed g, double ms, double targetMs, const GovernorGains& gains) {
  CHECK(targetMs > 0 && ms >= 0);
  const size_t window = size_t(std::clamp(std::lround(1000 * gains.window / targetMs), 3l, 24l));
  if (++g.frames <= (g.calibrated ? gains.after : gains.warmup)) return g;
  g.ms.push_back(std::max(ms, 1e-3));
  if (g.ms.size() > window) g.ms.erase(g.ms.begin());

  const float before = g.scale;
  const Settings settingsBefore = g.settings;
  const double target = gains.aim * targetMs;
  if (!g.calibrated) {
    if (int(g.ms.size()) < std::min(gains.calibration, int(window))) return g;
    const double least = *std::ranges::min_element(g.ms);
    if (const std::optional<double> time = g.choosesPreset ? timeOf(g.settings) : std::nullopt)
      choosePreset(g, *time, least, target, gains);
    else
      g.scale = float(scaleFor(g.scale, least, target));
    g.calibrated = true;
    g.pace = Pace::Holding;
  } else {
    // A single slow frame is an accident; two that are far too slow are not.
    const double twice = g.ms.size() >= 2 ? std::min(g.ms.back(), g.ms[g.ms.size() - 2]) : 0;
    const bool full = g.ms.size() == window;
    const double cost = full ? medianOf(g.ms) : twice;
    const bool tooLong = twice > (1 + gains.urgent) * targetMs || (full && cost > (1 + gains.above) * targetMs);
    const bool tooShort = full && cost < (1 - gains.below) * targetMs;
    const double ms = tooLong ? std::max(cost, twice) : cost;
    if (tooLong || tooShort) {
      const bool far = ms > (1 + gains.urgent) * targetMs;
      g.scale = float(far ? scaleFromFar(g, ms, target) : scaleFor(g.scale, ms, target));
      g.otherScale = before;
      g.otherMs = ms;
    }
    if (full && !tooLong && !tooShort) g.otherScale = 0; // what it measured may be of another room
    if (full || tooLong)
      g.pace = tooLong && before <= gains.least ? Pace::TooSlow : tooShort && before >= 1 ? Pace::Idle : Pace::Holding;
  }
  g.scale = std::clamp(g.scale, gains.least, 1.0f);
  const bool end = g.scale == 1 || g.scale == gains.least; // is worth a small step
  if (std::abs(g.scale - before) < gains.step * before && !(end && g.scale != before)) g.scale = before;
  const bool changed = !(g.settings == settingsBefore); // as at the start, shaders and maps are prepared first
  if (changed) g.otherScale = 0;
  if (g.scale != before || changed) g.ms.clear(), g.frames = changed ? gains.after - gains.warmup : 0;
  return g;
}

Governed begun(Governed g, double ms, double targetMs, const GovernorGains& gains) {
  CHECK(targetMs > 0 && ms > 0);
  const double target = gains.aim * targetMs;
  if (const std::optional<double> time = g.choosesPreset && ms > target ? timeOf(g.settings) : std::nullopt)
    choosePreset(g, *time, ms, target, gains);
  else
    g.scale = float(scaleFor(g.scale, ms, target));
  g.scale = std::clamp(g.scale, gains.least, 1.0f);
  g.choosesPreset = false;
  return g;
}

} // namespace lambent

#include "game/pace.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace lambent {

Pacer::Pacer(std::optional<double> targetMs, bool choosesPreset) : targetMs_(targetMs.value_or(kUsable)) {
  governed_.choosesPreset = choosesPreset;
}

void Pacer::expect(double fullMs, Settings& settings) {
  governed_.settings = settings;
  governed_ = begun(std::move(governed_), fullMs, targetMs_);
  settings = governed_.settings;
}

void Pacer::took(const FrameStats& stats, double wholeMs, bool moved, Settings& settings) {
  const bool asGoverned = moving(); // else it was drawn at full scale
  stillFrames_ = moved ? 0 : stillFrames_ + 1;
  if (!governs_ || !asGoverned || !stats.plan[EffectId::Redraw].on) return;
  if (!moved) return; // cheaper than frames in motion will be
  const double ms = std::max(stats.costMs(), wholeMs);
  const double larger = std::sqrt(kHalfwayMs / std::max(ms, 1.0));
  halfway_ = std::clamp(governed_.scale * float(larger), governed_.scale, 1.0f);
  governed_.settings = settings;
  const std::string before = governed_.preset;
  governed_ = governed(std::move(governed_), ms, targetMs_);
  if (governed_.preset != before) settings = governed_.settings;
}

void Pacer::hold(float scale) {
  governs_ = false;
  governed_.scale = scale;
  governed_.otherScale = 0;
}

void Pacer::govern(double targetMs) {
  governs_ = true;
  targetMs_ = targetMs;
  governed_.ms.clear();
}

std::string Pacer::text() const {
  if (!governs_) return "scale as set";
  char text[96];
  std::snprintf(text, sizeof text, "%s: %.0f ms, scale %.2f%s%s", paceText(governed_.pace), targetMs_,
                double(governed_.scale), governed_.preset.empty() ? "" : ", preset ", governed_.preset.c_str());
  return text;
}

} // namespace lambent

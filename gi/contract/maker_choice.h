// Who does what two can do: the CPU's makers and tracers, or the GPU's.
#pragma once

#include "gi/contract/pass_context.h"

#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <utility>

namespace lambent {

/// What each takes for a `unit` ("a map"), milliseconds.
struct MakerTimes {
  double cpuMs, gpuMs;
  const char* unit;
};

/// Holds the choice and what made it. The two differ in a few texels or rays along edges, so what writes files must
/// not ask a clock which image it is: a rule says who, the CPU where OpenGL is drawn by it (software Mesa takes 5 to 13
/// times as long as rays do), else the GPU. What is only looked at may be measured: the GPU is taken where it is twice
/// as fast.
class MakerChoice {
 public:
  MakerChoice(const PassContext& context, const char* cpu, const char* gpu)
      : gpuByRule_(!context.drawnByCpu), measures_(context.makers == Makers::Measured), cpuName_(cpu), gpuName_(gpu) {}

  /// Takes what is asked for; where nothing is, what was measured, else what the rule says. Measures first where that
  /// would count and was not done; `measure` gives nothing where there is nothing to measure yet.
  void take(std::optional<bool> askedGpu, const std::function<std::optional<MakerTimes>()>& measure) {
    if (!askedGpu && measures_ && !gpuWins_)
      if (const std::optional<MakerTimes> times = measure()) compare(*times);
    gpu_ = askedGpu ? *askedGpu : gpuWins_ ? *gpuWins_ : gpuByRule_;
    maker_ = gpu_ ? gpuName_ : cpuName_;
    report_ = maker_ + (askedGpu ? "" : times_);
  }

  bool gpu() const { return gpu_; }
  const std::string& maker() const { return maker_; }   // "rays"; empty: nothing was done yet
  const std::string& report() const { return report_; } // "rays", measured "rays (2.10 ms a map, raster 14.00 ms)"

 private:
  void compare(const MakerTimes& of) {
    gpuWins_ = 2 * of.gpuMs < of.cpuMs;
    const auto [best, other] = *gpuWins_ ? std::pair(of.gpuMs, of.cpuMs) : std::pair(of.cpuMs, of.gpuMs);
    char text[80];
    std::snprintf(text, sizeof text, " (%.2f ms %s, %s %.2f ms)", best, of.unit, *gpuWins_ ? cpuName_ : gpuName_,
                  other);
    times_ = text;
  }

  bool gpuByRule_, measures_;
  const char *cpuName_, *gpuName_;
  std::optional<bool> gpuWins_; // as measured
  bool gpu_ = false;
  std::string maker_, report_, times_;
};

} // namespace lambent

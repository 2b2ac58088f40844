// Who does what two can do: the CPU's makers and tracers, or the GPU's.
#pragma once

#include "engine/gl/context.h"

#include <spdlog/fmt/fmt.h>

#include <optional>
#include <string>

namespace lambent {

/// Holds the choice and what made it. The two differ in a few texels or rays along edges, so what writes files must
/// not ask a clock which image it is: a rule says who, the CPU where OpenGL is drawn by it (software Mesa takes 5 to 13
/// times as long as rays do), else the GPU. What is only looked at may be measured: the GPU is taken where it is twice
/// as fast.
class FasterOf {
 public:
  FasterOf(const char* cpu, const char* gpu) : cpuName_(cpu), gpuName_(gpu) {}

  bool measured() const { return gpuWins_.has_value(); }
  bool gpu() const { return gpu_; }
  /// Chooses by the milliseconds that each took for a `unit` ("a map").
  void measure(double cpuMs, double gpuMs, const char* unit) {
    gpuWins_ = 2 * gpuMs < cpuMs;
    const auto [best, other] = *gpuWins_ ? std::pair(gpuMs, cpuMs) : std::pair(cpuMs, gpuMs);
    times_ = fmt::format(" ({:.2f} ms {}, {} {:.2f} ms)", best, unit, *gpuWins_ ? cpuName_ : gpuName_, other);
    take();
  }
  /// Takes what is asked for; where nothing is, what was measured, else what the rule says.
  void take(std::optional<bool> askedGpu = {}) {
    gpu_ = askedGpu ? *askedGpu : gpuWins_ ? *gpuWins_ : !gl::drawnByCpu();
    maker_ = gpu_ ? gpuName_ : cpuName_;
    report_ = maker_ + (askedGpu ? "" : times_);
  }

  const std::string& maker() const { return maker_; }   // "rays"; empty: nothing was done yet
  const std::string& report() const { return report_; } // "rays", measured "rays (2.10 ms a map, raster 14.00 ms)"

 private:
  const char *cpuName_, *gpuName_;
  std::optional<bool> gpuWins_;
  bool gpu_ = false;
  std::string maker_, report_, times_;
};

} // namespace lambent

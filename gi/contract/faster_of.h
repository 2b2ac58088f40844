// Who does what two can do: the CPU's makers and tracers, or the GPU's.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <optional>
#include <string>

namespace lambent {

/// Holds the choice and the measurement that made it. The two differ in a few texels or rays along edges, so a
/// machine's noise must not decide which image it is: the GPU is taken only where it is twice as fast. (Software Mesa
/// is 2 to 12 times on the one side, a GPU with a slow CPU as far on the other.)
class FasterOf {
 public:
  FasterOf(const char* cpu, const char* gpu) : cpu_(cpu), gpu_(gpu) {}

  bool measured() const { return gpuWins_.has_value(); }
  bool gpu() const { return gpuWins_.value_or(false); }
  /// Chooses by the milliseconds that each took for a `unit` ("a map").
  void measure(double cpuMs, double gpuMs, const char* unit) {
    gpuWins_ = 2 * gpuMs < cpuMs;
    const auto [best, other] = gpu() ? std::pair(gpuMs, cpuMs) : std::pair(cpuMs, gpuMs);
    take(gpu());
    report_ += fmt::format(" ({:.2f} ms {}, {} {:.2f} ms)", best, unit, gpu() ? cpu_ : gpu_, other);
  }
  /// Takes a choice that was made elsewhere, without a measurement.
  void take(bool gpu) { report_ = maker_ = gpu ? gpu_ : cpu_; }

  const std::string& maker() const { return maker_; }   // "rays"; empty: nothing was done yet
  const std::string& report() const { return report_; } // "rays (2.10 ms a map, raster 14.00 ms)"

 private:
  const char *cpu_, *gpu_;
  std::optional<bool> gpuWins_;
  std::string maker_, report_;
};

} // namespace lambent

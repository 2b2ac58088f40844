#include "engine/gl/profiler.h"

#include "engine/gl/pulse.h"

#include <algorithm>
#include <string_view>
#include <tuple>

namespace lambent::gl {

namespace {

double msSince(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

} // namespace

double secondsOf(const std::function<void()>& work) {
  const Pulse none(nullptr); // it would be measured, too
  finishToMeasure();
  const auto begin = std::chrono::steady_clock::now();
  work();
  finishToMeasure();
  return 1e-3 * msSince(begin);
}

Timing GpuProfiler::calibrate() {
  // Known to be wrong, and sometimes right by chance: in the second profiler of a process all three trials agreed.
  if (std::string_view(reinterpret_cast<const char*>(glGetString(GL_RENDERER))).find("llvmpipe") !=
      std::string_view::npos)
    return timing_ = Timing::Finish;
  const Texture from("timing/from", {.format = GL_RGBA32F, .width = 256, .height = 256});
  const Texture to("timing/to", {.format = GL_RGBA32F, .width = 512, .height = 512});
  from.clear();
  const Framebuffer source("timing/from", {&from}), target("timing/to", {&to});
  const Query begin(GL_TIMESTAMP), end(GL_TIMESTAMP);

  // Scaled blits are drawn as textured rectangles, so they go through the same bins and tiles as our passes (llvmpipe's
  // queries fail there, not for copies).
  struct Times {
    double wallMs, queryMs;
  };
  PipelineState{.width = 512, .height = 512}.apply(); // blits keep to the scissor
  const auto time = [&](int blits) -> Times {
    const double wallMs = 1e3 * secondsOf([&] {
                            glQueryCounter(begin.name(), GL_TIMESTAMP);
                            for (int i = 0; i < blits; ++i)
                              glBlitNamedFramebuffer(source.name(), target.name(), 0, 0, 256, 256, 0, 0, 512, 512,
                                                     GL_COLOR_BUFFER_BIT, GL_LINEAR);
                            glQueryCounter(end.name(), GL_TIMESTAMP);
                          });
    return {wallMs, double(end.known().value_or(0) - begin.known().value_or(0)) * 1e-6};
  };
  // As many as take 5 ms, so that the cost of waiting does not blur the answer; the first round pays for shaders.
  int blits = 4;
  time(blits);
  while (time(blits).wallMs < 5 && blits < 4096) blits *= 2;
  // On a busy machine a lying query is sometimes right by chance: all of three must be.
  timing_ = Timing::Queries;
  for (int trial = 0; trial < 3; ++trial) {
    const Times t = time(blits);
    if (t.queryMs < 0.5 * t.wallMs || t.queryMs > 2 * t.wallMs) timing_ = Timing::Finish;
  }
  return timing_;
}

std::vector<StageTime> GpuProfiler::takeRows() {
  collectFinishedQueries();
  if (timing_ == Timing::Queries)
    for (StageTime& row : rows_)
      if (const auto found = latestGpuMs_.find(row.stage.id); found != latestGpuMs_.end()) row.gpuMs = found->second;
  return std::exchange(rows_, {});
}

void GpuProfiler::collectFinishedQueries() {
  while (!pending_.empty()) {
    Pending& oldest = pending_.front();
    const std::optional<uint64_t> from = oldest.begin.known(), to = oldest.end.known();
    if (!from || !to) return;
    latestGpuMs_[oldest.stage.id] = double(*to - *from) * 1e-6;
    freeQueries_.emplace_back(std::move(oldest.begin), std::move(oldest.end));
    pending_.pop_front();
  }
}

PassScope::PassScope(GpuProfiler& profiler, StageKey stage) : profiler_(profiler), stage_(stage) {
  glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, -1, stage_.name);
  if (profiler_.timing_ == Timing::Finish) {
    finishToMeasure();
  } else {
    auto& free = profiler_.freeQueries_;
    if (free.empty()) free.emplace_back(GL_TIMESTAMP, GL_TIMESTAMP);
    std::tie(beginQuery_, endQuery_) = std::move(free.back());
    free.pop_back();
    glQueryCounter(beginQuery_.name(), GL_TIMESTAMP);
  }
  begin_ = std::chrono::steady_clock::now();
}

PassScope::~PassScope() {
  double cpuMs = 0, gpuMs = 0;
  if (beginQuery_) {
    glQueryCounter(endQuery_.name(), GL_TIMESTAMP);
    cpuMs = msSince(begin_);
    profiler_.pending_.push_back({stage_, std::move(beginQuery_), std::move(endQuery_)});
  } else {
    finishToMeasure();
    cpuMs = gpuMs = msSince(begin_);
  }
  profiler_.rows_.push_back({stage_, cpuMs, gpuMs});
  glPopDebugGroup();
}

} // namespace lambent::gl

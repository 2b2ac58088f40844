#include "engine/gl/profiler.h"

#include <algorithm>

namespace lambent::gl {

namespace {

double msSince(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

} // namespace

Timing GpuProfiler::calibrate() {
  const TextureDesc desc{.format = GL_RGBA32F, .width = 1024, .height = 1024};
  const Texture from("timing/from", desc), to("timing/to", desc);
  const Framebuffer framebuffer("timing/clear", {&from});
  const Query begin(GL_TIMESTAMP), end(GL_TIMESTAMP);

  // A clear is rendered work (tiled on llvmpipe, where the queries fail); the copies that follow make it large enough
  // to measure on fast GPUs.
  const float grey[] = {0.5f, 0.5f, 0.5f, 0.5f};
  double wallMs = 0, queryMs = 0;
  for (int attempt = 0; attempt < 2; ++attempt) { // the first one pays for page faults and shader compilation
    glFinish();
    const auto start = std::chrono::steady_clock::now();
    glQueryCounter(begin.name(), GL_TIMESTAMP);
    for (int i = 0; i < 16; ++i) {
      glClearNamedFramebufferfv(framebuffer.name(), GL_COLOR, 0, grey);
      glCopyImageSubData(from.name(), GL_TEXTURE_2D, 0, 0, 0, 0, to.name(), GL_TEXTURE_2D, 0, 0, 0, 0, 1024, 1024, 1);
    }
    glQueryCounter(end.name(), GL_TIMESTAMP);
    glFinish();
    wallMs = msSince(start);
    GLuint64 t0 = 0, t1 = 0;
    glGetQueryObjectui64v(begin.name(), GL_QUERY_RESULT, &t0);
    glGetQueryObjectui64v(end.name(), GL_QUERY_RESULT, &t1);
    queryMs = double(t1 - t0) * 1e-6;
  }
  timing_ = queryMs > 0.5 * wallMs && queryMs < 2 * wallMs ? Timing::Queries : Timing::Finish;
  return timing_;
}

std::vector<StageTime> GpuProfiler::takeRows() {
  collectFinishedQueries();
  if (timing_ == Timing::Queries)
    for (StageTime& row : rows_)
      if (const auto found = latestGpuMs_.find(row.name); found != latestGpuMs_.end()) row.gpuMs = found->second;
  return std::exchange(rows_, {});
}

void GpuProfiler::collectFinishedQueries() {
  while (!pending_.empty()) {
    Pending& oldest = pending_.front();
    GLuint ready = 0;
    glGetQueryObjectuiv(oldest.end.name(), GL_QUERY_RESULT_AVAILABLE, &ready);
    if (!ready) return;
    GLuint64 t0 = 0, t1 = 0;
    glGetQueryObjectui64v(oldest.begin.name(), GL_QUERY_RESULT, &t0);
    glGetQueryObjectui64v(oldest.end.name(), GL_QUERY_RESULT, &t1);
    latestGpuMs_[oldest.name] = double(t1 - t0) * 1e-6;
    freeQueries_.emplace_back(std::move(oldest.begin), std::move(oldest.end));
    pending_.pop_front();
  }
}

PassScope::PassScope(GpuProfiler& profiler, std::string name) : profiler_(profiler), name_(std::move(name)) {
  glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, GLsizei(name_.size()), name_.c_str());
  if (profiler_.timing_ == Timing::Finish) {
    glFinish();
  } else {
    if (profiler_.freeQueries_.empty()) {
      beginQuery_ = Query(GL_TIMESTAMP);
      endQuery_ = Query(GL_TIMESTAMP);
    } else {
      beginQuery_ = std::move(profiler_.freeQueries_.back().first);
      endQuery_ = std::move(profiler_.freeQueries_.back().second);
      profiler_.freeQueries_.pop_back();
    }
    glQueryCounter(beginQuery_.name(), GL_TIMESTAMP);
  }
  begin_ = std::chrono::steady_clock::now();
}

PassScope::~PassScope() {
  double cpuMs = 0, gpuMs = 0;
  if (beginQuery_) {
    glQueryCounter(endQuery_.name(), GL_TIMESTAMP);
    cpuMs = msSince(begin_);
    profiler_.pending_.push_back({name_, std::move(beginQuery_), std::move(endQuery_)});
  } else {
    glFinish();
    cpuMs = gpuMs = msSince(begin_);
  }
  profiler_.rows_.push_back({std::move(name_), cpuMs, gpuMs});
  glPopDebugGroup();
}

} // namespace lambent::gl

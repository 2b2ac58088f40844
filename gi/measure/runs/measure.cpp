#include "engine/core/error.h"
#include "engine/gl/objects.h"
#include "gi/measure/runs/runs.h"

#include <algorithm>

namespace lambent {

namespace {

void runFrame(Runner& runner, const SceneView& view, int frame, const RunPlan& plan, Measured& out) {
  if (plan.cancelled && plan.cancelled()) throw RunError("interrupted before there was a result");
  const FrameStats& stats = runner.run(view);
  if (frame >= plan.skip) out.frames.push_back(stats);
  if (!plan.points.empty()) out.series.push_back(runner.at(plan.points));
  if (plan.buffer && std::ranges::count(plan.also, frame)) out.before.push_back(runner.image(*plan.buffer));
  if (frame + 1 < plan.frames) return;
  if (plan.buffer) out.image = runner.image(*plan.buffer);
  for (const auto& [owner, bytes] : gl::memoryByOwner()) out.gpuBytes += bytes;
  out.exposure = runner.exposure();
}

} // namespace

std::vector<Measured> measure(const std::vector<Variant>& variants, const RunPlan& plan) {
  CHECK(plan.skip < plan.frames);
  const int count = int(variants.size()), total = count * plan.frames;
  std::vector<Measured> out;
  for (const Variant& v : variants) out.push_back({.variant = v});
  int done = 0;
  const auto step = [&] {
    if (plan.progress) plan.progress(++done, total);
  };
  if (plan.inTurn) {
    std::vector<std::unique_ptr<Runner>> runners;
    for (const Variant& v : variants) runners.push_back(v.make(v));
    for (int frame = 0; frame < plan.frames; ++frame) {
      const SceneView view = plan.view(frame);
      for (int k = 0; k < count; ++k) {
        const size_t turn = size_t((k + frame) % count);
        runFrame(*runners[turn], view, frame, plan, out[turn]);
        step();
      }
    }
    return out;
  }
  for (size_t i = 0; i < variants.size(); ++i) {
    const std::unique_ptr<Runner> runner = variants[i].make(variants[i]);
    for (int frame = 0; frame < plan.frames; ++frame) {
      SceneView view = plan.view(frame);
      if (frame == 0) view.changes = {}; // since the last variant's last frame nothing may have changed
      runFrame(*runner, view, frame, plan, out[i]);
      step();
    }
  }
  return out;
}

Spread Measured::of(const std::function<double(const FrameStats&)>& value) const {
  std::vector<double> values;
  for (const FrameStats& s : frames) values.push_back(value(s));
  return spreadOf(std::move(values));
}

Spread Measured::ms(StageId stage) const {
  std::vector<double> values;
  for (const FrameStats& s : frames)
    if (std::ranges::any_of(s.stages, [&](const StageTime& t) { return t.stage == key(stage); }))
      values.push_back(s.ms(stage));
  return spreadOf(std::move(values));
}

std::vector<StageId> Measured::stages() const {
  std::vector<StageId> out;
  for (const FrameStats& s : frames)
    for (const StageTime& t : s.stages)
      if (std::ranges::find(out, StageId(t.stage.id)) == out.end()) out.push_back(StageId(t.stage.id));
  return out;
}

} // namespace lambent

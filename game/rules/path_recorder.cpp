#include "game/rules/path_recorder.h"

#include "engine/core/error.h"

#include <utility>

namespace lambent {

namespace fs = std::filesystem;

void PathRecorder::begin(const fs::path& scene, const Shot* shot) {
  walk_ = shot ? *shot : Shot{};
  walk_->scene = fs::absolute(scene);
  walk_->camera.clear();
  walk_->pixels.clear();
  walk_->seconds = 0;
}

void PathRecorder::add(double t, const CameraView& camera, const dvec3& origin) {
  CHECK(walk_.has_value());
  if (!walk_->camera.empty() && t <= walk_->camera.back().t) return;
  const dvec3 eye = origin + dvec3(camera.position());
  walk_->camera.push_back({t, eye, eye - dvec3(camera.worldFromView[2]), camera.fovY});
  walk_->seconds = std::max(t, 1 / walk_->fps);
}

std::optional<Shot> PathRecorder::end(const fs::path& folder) {
  std::optional<Shot> walk = std::exchange(walk_, std::nullopt);
  if (!walk || walk->camera.empty()) return {};
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure) throw RunError(folder.string() + ": cannot make this folder (" + failure.message() + ")");
  int number = 1;
  const auto name = [&] { return folder / ("walk-" + std::to_string(number) + ".json"); };
  while (fs::exists(name(), failure)) ++number;
  walk->file = name();
  saveShot(*walk, walk->file);
  return walk;
}

} // namespace lambent

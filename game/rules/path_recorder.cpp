#include "game/rules/path_recorder.h"

#include "engine/core/error.h"

#include <utility>

namespace lambent {

namespace fs = std::filesystem;

void PathRecorder::begin(const fs::path& scene, const Shot* shot, double fps, std::map<std::string, std::string> set) {
  walk_ = shot ? *shot : Shot{};
  walk_->scene = fs::absolute(scene);
  walk_->camera.clear();
  walk_->played.clear();
  walk_->pixels.clear();
  walk_->seconds = 0;
  walk_->fps = fps;
  walk_->set = std::move(set);
}

bool PathRecorder::add(const CameraView& camera, const dvec3& origin, PlayedMoment moment) {
  CHECK(walk_.has_value());
  const double t = moment.t;
  if (!walk_->camera.empty() && t <= walk_->camera.back().t) return false;
  const dvec3 eye = origin + dvec3(camera.position());
  walk_->camera.push_back({t, eye, eye - dvec3(camera.worldFromView[2]), camera.fovY});
  walk_->seconds = t + 1 / walk_->fps;
  std::vector<PlayedMoment>& played = walk_->played;
  const auto same = [&](const PlayedMoment& other) { // but for the time
    moment.t = other.t;
    return moment == other;
  };
  if (played.empty() || !same(played.back())) {
    if (!played.empty() && played.back().t < before_) { // what stood still did not drift until it moved
      played.push_back(played.back());
      played.back().t = before_;
    }
    moment.t = t;
    played.push_back(std::move(moment));
  }
  before_ = t;
  return true;
}

std::optional<Shot> PathRecorder::end(const fs::path& folder) {
  if (!walk_ || walk_->camera.empty()) {
    walk_.reset();
    return {};
  }
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure) throw RunError(folder.string() + ": cannot make this folder (" + failure.message() + ")");
  int number = 1;
  const auto name = [&] { return folder / ("walk-" + std::to_string(number) + ".json"); };
  while (fs::exists(name(), failure)) ++number;
  walk_->file = name();
  saveShot(*walk_, walk_->file);
  return std::exchange(walk_, std::nullopt);
}

} // namespace lambent

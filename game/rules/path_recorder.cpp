#include "game/rules/path_recorder.h"

#include "engine/core/error.h"

#include <utility>

namespace lambent {

namespace fs = std::filesystem;

namespace {

/// Makes the folder too.
fs::path newFileIn(const fs::path& folder) {
  makeFolder(folder);
  std::error_code failure;
  int number = 1;
  const auto name = [&] { return folder / ("walk-" + std::to_string(number) + ".json"); };
  while (fs::exists(fs::symlink_status(name(), failure))) ++number;
  return name();
}

} // namespace

void PathRecorder::begin(const fs::path& scene, const Shot* shot, double fps, std::map<std::string, std::string> set,
                         const fs::path& folder, double unit) {
  *this = {};
  walk_ = shot ? *shot : Shot{};
  walk_->scene = fs::absolute(scene);
  walk_->camera.clear();
  walk_->played.clear();
  walk_->pixels.clear();
  walk_->seconds = 0;
  walk_->fps = fps;
  walk_->unit = unit;
  walk_->set = std::move(set);
  folder_ = folder;
}

bool PathRecorder::add(const CameraView& camera, const dvec3& origin, PlayedMoment moment) {
  CHECK(walk_.has_value());
  const double t = moment.t;
  if (frames_ > 0 && t <= before_) return false;
  if (!writer_) {
    const fs::path file = newFileIn(folder_);
    writer_ = std::make_unique<ShotWriter>(*walk_, file);
    file_ = file;
  }
  const CameraKey key = keyOf(camera, origin, t);
  std::vector<PlayedMoment> now;
  std::vector<PlayedMoment>& played = walk_->played; // the last
  const auto same = [&](const PlayedMoment& other) { // but for the time
    moment.t = other.t;
    return moment == other;
  };
  if (played.empty() || !same(played.back())) {
    if (!played.empty() && played.back().t < before_) { // what stood still did not drift until it moved
      now.push_back(played.back());
      now.back().t = before_;
    }
    moment.t = t;
    now.push_back(std::move(moment));
  }
  writer_->add(key, now);
  walk_->camera = {key};
  walk_->seconds = t + 1 / walk_->fps;
  if (!now.empty()) played = {std::move(now.back())};
  ++frames_;
  before_ = t;
  return true;
}

std::optional<Shot> PathRecorder::end() {
  const std::unique_ptr<ShotWriter> writer = std::move(writer_);
  const std::optional<Shot> walk = std::exchange(walk_, std::nullopt);
  if (writer && frames_ == 0) { // the disk took the head alone
    std::error_code ignored;
    fs::remove(file_, ignored);
  }
  if (!writer || frames_ == 0) return {};
  writer->end(walk->seconds);
  return loadShot(file_);
}

} // namespace lambent

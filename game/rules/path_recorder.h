// A walk as a shot: the camera of every frame and what was played with, in the format that `lambent record` plays. It
// is written as it goes.
#pragma once

#include "engine/scene/shot.h"

#include <filesystem>
#include <memory>
#include <optional>

namespace lambent {

class PathRecorder {
 public:
  /// Begins a walk through `scene`, for a new file walk-N.json in `folder`. What moves by `shot` (may be null) becomes
  /// part of the new one, with these settings: scene time starts with the walk. `unit`: of the scene's file, metres.
  void begin(const std::filesystem::path& scene, const Shot* shot, double fps, std::map<std::string, std::string> set,
             const std::filesystem::path& folder, double unit = 1);
  bool recording() const { return walk_.has_value(); }
  double seconds() const { return walk_ ? walk_->seconds : 0; }
  size_t frames() const { return frames_; }
  /// Empty before the first frame.
  const std::filesystem::path& file() const { return file_; }

  /// A frame's camera, and all that was done until then, moment.t seconds after begin. A frame without time since the
  /// one before does not count; says whether it does. It is in the file then. Throws RunError where it cannot be.
  bool add(const CameraView& camera, const dvec3& origin, PlayedMoment moment);
  /// The camera of the last frame added, to the bit as the written walk has it.
  CameraView camera(const dvec3& origin) const { return shotCamera(*walk_, walk_->camera.back().t, origin); }
  /// Ends the file and reads it. Nothing where no frame was added. It records no more, also where this throws RunError:
  /// what is in the file is a shot all the same.
  std::optional<Shot> end();

 private:
  std::optional<Shot> walk_; // with the last key alone, and what is played
  std::filesystem::path folder_, file_;
  std::unique_ptr<ShotWriter> writer_;
  size_t frames_ = 0;
  double before_ = 0; // seconds: the last frame
};

} // namespace lambent

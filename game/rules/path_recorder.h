// A walk as a shot: the camera of every frame and what was played with, in the format that `lambent record` plays.
#pragma once

#include "engine/scene/shot.h"

#include <filesystem>
#include <optional>

namespace lambent {

class PathRecorder {
 public:
  /// Begins a walk through `scene`. What moves by `shot` (may be null) becomes part of the new one, with these
  /// settings: scene time starts with the walk.
  void begin(const std::filesystem::path& scene, const Shot* shot, double fps, std::map<std::string, std::string> set);
  bool recording() const { return walk_.has_value(); }
  double seconds() const { return walk_ ? walk_->seconds : 0; }
  size_t frames() const { return walk_ ? walk_->camera.size() : 0; }

  /// A frame's camera, and all that was done until then, moment.t seconds after begin. A frame without time since the
  /// one before does not count; says whether it does.
  bool add(const CameraView& camera, const dvec3& origin, PlayedMoment moment);
  /// The camera of the last frame added, to the bit as the written walk will have it.
  CameraView camera(const dvec3& origin) const { return shotCamera(*walk_, walk_->camera.back().t, origin); }
  /// Writes the walk to a new file walk-N.json in `folder` and returns it. Throws RunError, and
  /// then has it still. Nothing where no frame was added.
  std::optional<Shot> end(const std::filesystem::path& folder);

 private:
  std::optional<Shot> walk_;
  double before_ = 0; // seconds: the last frame
};

} // namespace lambent

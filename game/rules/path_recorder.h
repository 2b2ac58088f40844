// A walk as a shot: the camera of every frame, in the format that `lambent record` plays.
#pragma once

#include "engine/scene/shot.h"

#include <filesystem>
#include <optional>

namespace lambent {

class PathRecorder {
 public:
  /// Begins a walk through `scene`. What moves by `shot` (may be null) and its settings become part of the new one:
  /// scene time starts with the walk.
  void begin(const std::filesystem::path& scene, const Shot* shot);
  bool recording() const { return walk_.has_value(); }
  double seconds() const { return walk_ ? walk_->seconds : 0; }

  /// A frame's camera, `t` seconds after begin. Frames that no time lies between count once.
  void add(double t, const CameraView& camera, const dvec3& origin);
  /// Writes the walk to a new file walk-N.json in `folder` and returns it. Throws RunError. Nothing where no frame was
  /// added.
  std::optional<Shot> end(const std::filesystem::path& folder);

 private:
  std::optional<Shot> walk_;
};

} // namespace lambent

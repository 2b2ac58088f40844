// A view that outlives the scene's next extraction: for whoever keeps it, or works on it while frames run.
#pragma once

#include "engine/view/scene_view.h"

#include <vector>

namespace lambent {

/// A view with spans of its own: the scene's live only until its next extraction.
class ViewCopy {
 public:
  ViewCopy() = default;
  explicit ViewCopy(const SceneView& of) { take(of); }
  ViewCopy(ViewCopy&&) noexcept = default; // vectors that move keep their elements' places
  ViewCopy& operator=(ViewCopy&&) noexcept = default;

  /// With `frozen` the instances stay what and where they were.
  void take(const SceneView& now, bool frozen = false);
  SceneView& view() { return view_; }
  const SceneView& view() const { return view_; }

 private:
  SceneView view_;
  std::vector<InstanceView> instances_;
  std::vector<LightView> lights_;
  std::vector<Aabb> addedOrRemoved_;
};

} // namespace lambent

// The scene of one frame, placed for rays and for drawing.
#pragma once

#include "engine/scene/scene_view.h"

#include <vector>

namespace lambent {

class Disturbance;
class GpuScene;
class RayQuery;
struct LightSet;

struct World {
  const SceneView& view;
  const GpuScene& gpu;
  const RayQuery& rays;
  const Disturbance& moved; // where geometry changed since the last frame
  const LightSet& lights;   // those that the plan lets shine
  float reach = 1;          // distance that stands for 1 in maps, metres: the scene's size, with room to grow
};

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

// What a frame of a scene shows, and how it differs from the frame before.
#pragma once

#include "engine/view/scene_view.h"

#include <vector>

namespace lambent {

/// Of one sequence of frames. Spans stay valid until the next call.
class ViewChanges {
 public:
  /// Takes instances and lights as they stand now: `id`, `mesh`, `worldFromObject` and `deformed` of instances, all but
  /// `changed` of lights. The rest is found by comparison with the last call. Instances that are not near (isNear) are
  /// left out. World space.
  SceneView take(const SceneAssets& assets, std::vector<InstanceView> instances, std::vector<LightView> lights,
                 const Sky& sky, const CameraView& camera, double time);

 private:
  std::vector<InstanceView> instances_;
  std::vector<Aabb> addedOrRemoved_;
  std::vector<LightView> lights_;
  CameraView camera_;
  Sky sky_;
  bool first_ = true;
};

} // namespace lambent

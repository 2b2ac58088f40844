// The scene as bodies feel it: rays against everything, where it is now. GI has rays of its own, which follow what its
// settings leave out; these follow the scene.
#pragma once

#include "engine/scene/scene.h"
#include "engine/trace/embree_query.h"

namespace lambent {

class Solids {
 public:
  /// `scene` must outlive it.
  explicit Solids(const Scene& scene);

  /// Takes over where everything stands since the last call.
  void update();
  /// Lets one instance be passed through: what is carried is in nobody's way.
  void hide(std::optional<uint32_t> instance);
  const SceneView& view() const { return view_; } // of the last update; its camera is nobody's
  const RayQuery& rays() const { return rays_; }

 private:
  const Scene& scene_;
  EmbreeQuery rays_;
  SceneExtractor extractor_;
  SceneView view_;
  std::vector<InstanceView> shown_; // the view's, where one is hidden
  std::optional<uint32_t> hidden_;
};

/// The way of an instance since the view before; none where it stood still, or cannot be followed.
std::optional<mat4> motionOf(const SceneView& view, uint32_t instance);

} // namespace lambent

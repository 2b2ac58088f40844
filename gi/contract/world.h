// The scene of one frame, placed for rays and for drawing.
#pragma once

#include "engine/view/scene_view.h"

namespace lambent {

class DirtyRegion;
class GpuScene;
class RayQuery;
struct LightSet;

struct World {
  const SceneView& view;
  const GpuScene& gpu;
  const RayQuery& rays;
  const DirtyRegion& moved; // where geometry changed since the last frame
  const LightSet& lights;   // those that the plan lets shine
  float farDistance = 1;    // distance that stands for 1 in maps, metres: the scene's size, with room to grow
};

} // namespace lambent

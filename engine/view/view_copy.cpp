#include "engine/view/view_copy.h"

namespace lambent {

void ViewCopy::take(const SceneView& now, bool frozen) {
  lights_.assign(now.lights.begin(), now.lights.end());
  const Aabb bounds = view_.boundsWorld;
  view_ = now;
  if (frozen) {
    for (InstanceView& i : instances_) {
      i.moved = i.reshaped = false;
      i.worldFromObjectBefore = i.worldFromObject;
      i.boundsWorldBefore = i.boundsWorld;
    }
    addedOrRemoved_.clear();
    view_.changes.geometry = view_.changes.instances = false;
    view_.boundsWorld = bounds;
  } else {
    instances_.assign(now.instances.begin(), now.instances.end());
    addedOrRemoved_.assign(now.addedOrRemoved.begin(), now.addedOrRemoved.end());
  }
  view_.instances = instances_;
  view_.lights = lights_;
  view_.addedOrRemoved = addedOrRemoved_;
}

} // namespace lambent

#include "engine/view/view_changes.h"

#include <atomic>
#include <unordered_map>

namespace lambent {

namespace {

bool sameLight(const LightView& a, const LightView& b) {
  return a.type == b.type && a.position == b.position && a.direction == b.direction && a.intensity == b.intensity &&
         a.range == b.range && a.innerConeCos == b.innerConeCos && a.outerConeCos == b.outerConeCos &&
         a.angularRadius == b.angularRadius;
}

template <class View> std::unordered_map<uint32_t, const View*> byId(const std::vector<View>& views) {
  std::unordered_map<uint32_t, const View*> map;
  for (const View& v : views) map.emplace(v.id, &v);
  return map;
}

uint64_t shapeOf(const InstanceView& v) { return v.deformed ? v.deformed->revision : 0; }

} // namespace

std::shared_ptr<DeformedMesh> newShape() {
  static std::atomic<uint64_t> last{0};
  const auto shape = std::make_shared<DeformedMesh>();
  shape->revision = ++last;
  return shape;
}

SceneView ViewChanges::take(const SceneAssets& assets, std::vector<InstanceView> instances,
                            std::vector<LightView> lights, const Sky& sky, const CameraView& camera, double time) {
  SceneChanges changes{first_, first_, first_, first_, first_};
  SceneView view;
  auto instancesBefore = byId(instances_);
  addedOrRemoved_.clear();
  for (InstanceView& v : instances) {
    const Aabb& box = v.deformed ? v.deformed->boundsObject : assets.meshes[v.mesh].boundsObject;
    v.boundsWorld = v.boundsWorldBefore = transformed(box, v.worldFromObject);
    v.worldFromObjectBefore = v.worldFromObject;
  }
  std::erase_if(instances, [](const InstanceView& v) { return !isNear(v.boundsWorld); });
  for (InstanceView& v : instances) {
    v.reshaped = v.moved = false;
    if (const auto before = instancesBefore.find(v.id);
        before != instancesBefore.end() && before->second->mesh == v.mesh) {
      v.worldFromObjectBefore = before->second->worldFromObject;
      v.boundsWorldBefore = before->second->boundsWorld;
      v.reshaped = shapeOf(v) != shapeOf(*before->second);
      v.moved = v.reshaped || v.worldFromObjectBefore != v.worldFromObject;
      changes.geometry |= v.moved;
      instancesBefore.erase(before);
    } else {
      addedOrRemoved_.push_back(v.boundsWorld); // there was no shape to differ from
    }
    view.boundsWorld.add(v.boundsWorld);
  }
  for (const auto& [id, gone] : instancesBefore) addedOrRemoved_.push_back(gone->boundsWorld);
  changes.instances |= !addedOrRemoved_.empty();

  const auto lightsBefore = byId(lights_);
  for (LightView& v : lights) {
    const auto before = lightsBefore.find(v.id);
    v.changed = before == lightsBefore.end() || !sameLight(v, *before->second);
    changes.lights |= v.changed;
  }
  changes.lights |= lights.size() != lights_.size() || sky_ != sky;
  changes.camera |= camera_ != camera;

  instances_ = std::move(instances);
  lights_ = std::move(lights);
  camera_ = camera;
  sky_ = sky;
  first_ = false;

  view.assets = &assets;
  view.instances = instances_;
  view.lights = lights_;
  view.addedOrRemoved = addedOrRemoved_;
  view.sky = sky;
  view.camera = camera;
  view.changes = changes;
  view.time = time;
  return view;
}

} // namespace lambent

// Extraction: what the registry holds now, as spans, and how it differs from the extraction before.

#include "engine/core/parallel.h"
#include "engine/scene/scene.h"

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

/// See DeformedMesh::revision.
uint64_t nextRevision() {
  static std::atomic<uint64_t> last{0};
  return ++last;
}

} // namespace

/// Poses every instance that is skinned or morphed, again where its pose changed. A changed shape is a new object: who
/// holds the old one may still read it.
std::vector<InstanceView> SceneExtractor::placeInstances(const Scene& scene) {
  std::vector<InstanceView> instances;
  instances.reserve(instances_.size());
  std::unordered_map<uint32_t, Shape> shapes;
  std::vector<Shape*> changed;
  scene.registry.each<MeshInstance, WorldTransform>([&](Entity e, const MeshInstance& m, const WorldTransform& w) {
    std::optional<PlacedPose> placed = poseOf(scene, e, m, w);
    if (!placed) return;
    InstanceView v;
    v.id = e.id();
    v.mesh = m.mesh;
    v.worldFromObject = v.worldFromObjectBefore = placed->worldFromObject;
    if (deforms(scene.assets.meshes[m.mesh], placed->pose)) {
      auto node = shapes_.extract(v.id);
      Shape& shape = node ? shapes.insert(std::move(node)).position->second : shapes[v.id];
      if (shape.mesh != v.mesh || shape.pose != placed->pose) {
        shape.mesh = v.mesh;
        shape.pose = std::move(placed->pose);
        shape.deformed = std::make_shared<DeformedMesh>();
        shape.deformed->revision = nextRevision();
        v.reshaped = true;
        changed.push_back(&shape);
      }
      v.deformed = shape.deformed;
    }
    instances.push_back(v);
  });
  shapes_ = std::move(shapes);
  parallelFor(changed.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      deform(scene.assets.meshes[changed[i]->mesh], changed[i]->pose, *changed[i]->deformed);
  });
  return instances;
}

SceneView SceneExtractor::extract(const Scene& scene, const CameraView& camera, double time) {
  SceneChanges changes{first_, first_, first_, first_, first_};
  SceneView view;

  auto instancesBefore = byId(instances_);
  addedOrRemoved_.clear();
  std::vector<InstanceView> instances = placeInstances(scene);
  for (InstanceView& v : instances) {
    const Aabb& box = v.deformed ? v.deformed->boundsObject : scene.assets.meshes[v.mesh].boundsObject;
    v.boundsWorld = v.boundsWorldBefore = transformed(box, v.worldFromObject);
  }
  std::erase_if(instances, [](const InstanceView& v) { return !isNear(v.boundsWorld); });
  for (InstanceView& v : instances) {
    if (const auto before = instancesBefore.find(v.id);
        before != instancesBefore.end() && before->second->mesh == v.mesh) {
      v.worldFromObjectBefore = before->second->worldFromObject;
      v.boundsWorldBefore = before->second->boundsWorld;
      v.reshaped |= (v.deformed == nullptr) != (before->second->deformed == nullptr);
      v.moved = v.reshaped || v.worldFromObjectBefore != v.worldFromObject;
      changes.geometry |= v.moved;
      instancesBefore.erase(before);
    } else {
      v.reshaped = false; // there was no shape to differ from
      addedOrRemoved_.push_back(v.boundsWorld);
    }
    view.boundsWorld.add(v.boundsWorld);
  }
  for (const auto& [id, gone] : instancesBefore) addedOrRemoved_.push_back(gone->boundsWorld);
  changes.instances |= !addedOrRemoved_.empty();

  const auto lightsBefore = byId(lights_);
  std::vector<LightView> lights;
  scene.registry.each<PunctualLight, WorldTransform>([&](Entity e, const PunctualLight& l, const WorldTransform& w) {
    LightView v;
    v.id = e.id();
    v.type = l.type;
    v.position = scene.fromOrigin(dvec3(w.worldFromNode[3]));
    const dvec3 forward = -dvec3(w.worldFromNode[2]); // of a node as large as single precision goes
    const double length = glm::length(forward);
    if (!isNear(v.position) || !std::isfinite(length)) return;
    v.direction = length > 0 ? vec3(forward / length) : vec3(0, 0, -1);
    v.intensity = l.intensity;
    v.range = l.range;
    v.innerConeCos = l.innerConeCos;
    v.outerConeCos = l.outerConeCos;
    v.angularRadius = l.angularRadius;
    const auto before = lightsBefore.find(v.id);
    v.changed = before == lightsBefore.end() || !sameLight(v, *before->second);
    changes.lights |= v.changed;
    lights.push_back(v);
  });
  changes.lights |= lights.size() != lights_.size() || sky_ != scene.sky;
  changes.camera |= camera_ != camera;

  instances_ = std::move(instances);
  lights_ = std::move(lights);
  camera_ = camera;
  sky_ = scene.sky;
  first_ = false;

  view.assets = &scene.assets;
  view.instances = instances_;
  view.lights = lights_;
  view.addedOrRemoved = addedOrRemoved_;
  view.sky = scene.sky;
  view.camera = camera;
  view.changes = changes;
  view.time = time;
  return view;
}

} // namespace lambent

// Extraction: what the registry holds now, as spans, and how it differs from the extraction before.

#include "engine/scene/scene.h"

#include <unordered_map>

namespace lambent {

namespace {

/// A matrix that flattens its object onto a plane or line cannot be inverted, and so gives no normals. Its lost axes
/// get back this share of the largest one: invisible, and well inside float precision.
constexpr float kFlattenedScale = 1e-5f;

/// Gives a flattened matrix its lost axes back. False when it still cannot be inverted: all axes lost, not finite, or
/// sheared flat; such instances are left out.
bool makeInvertible(mat4& m) {
  for (int c = 0; c < 4; ++c)
    if (!isFinite(vec3(m[c]))) return false;
  const float largest = glm::max(glm::length(vec3(m[0])), glm::max(glm::length(vec3(m[1])), glm::length(vec3(m[2]))));
  if (!(largest > 1e-12f)) return false;
  const float least = kFlattenedScale * largest;
  for (int c = 0; c < 3; ++c) { // axes of no length: along what the other two leave free
    if (glm::length(vec3(m[c])) >= least) continue;
    const vec3 a = vec3(m[(c + 1) % 3]), b = vec3(m[(c + 2) % 3]);
    vec3 free = glm::cross(a, b);
    if (!(glm::length(free) > least * least)) {
      const vec3 longer = glm::length(a) > glm::length(b) ? a : b;
      free = glm::cross(longer, std::abs(longer.x) < 0.5f * glm::length(longer) ? vec3(1, 0, 0) : vec3(0, 1, 0));
    }
    m[c] = vec4(least * glm::normalize(free), 0);
  }
  const float box = glm::length(vec3(m[0])) * glm::length(vec3(m[1])) * glm::length(vec3(m[2]));
  return std::abs(glm::determinant(mat3(m))) > 1e-6f * box; // else three axes in one plane: shear has flattened it
}

bool sameLight(const LightView& a, const LightView& b) {
  return a.type == b.type && a.position == b.position && a.direction == b.direction && a.intensity == b.intensity &&
         a.range == b.range && a.innerConeCos == b.innerConeCos && a.outerConeCos == b.outerConeCos;
}

bool sameCamera(const CameraView& a, const CameraView& b) {
  return a.worldFromView == b.worldFromView && a.fovY == b.fovY && a.orthoHalfHeight == b.orthoHalfHeight &&
         a.near == b.near && a.width == b.width && a.height == b.height;
}

template <class View> std::unordered_map<uint32_t, const View*> byId(const std::vector<View>& views) {
  std::unordered_map<uint32_t, const View*> map;
  for (const View& v : views) map.emplace(v.id, &v);
  return map;
}

} // namespace

SceneView SceneExtractor::extract(const Scene& scene, const CameraView& camera, double time) {
  SceneChanges changes{first_, first_, first_, first_, first_};
  SceneView view;

  auto instancesBefore = byId(instances_);
  addedOrRemoved_.clear();
  std::vector<InstanceView> instances;
  instances.reserve(instances_.size());
  scene.registry.each<MeshInstance, WorldTransform>([&](Entity e, const MeshInstance& m, const WorldTransform& w) {
    InstanceView v;
    v.id = e.id();
    v.mesh = m.mesh;
    v.worldFromObject = w.worldFromNode;
    if (!makeInvertible(v.worldFromObject)) return;
    v.worldFromObjectBefore = v.worldFromObject;
    v.boundsWorld = v.boundsWorldBefore = transformed(scene.assets.meshes[m.mesh].boundsObject, v.worldFromObject);
    if (const auto before = instancesBefore.find(v.id);
        before != instancesBefore.end() && before->second->mesh == v.mesh) {
      v.worldFromObjectBefore = before->second->worldFromObject;
      v.boundsWorldBefore = before->second->boundsWorld;
      v.moved = v.worldFromObjectBefore != v.worldFromObject;
      changes.geometry |= v.moved;
      instancesBefore.erase(before);
    } else {
      addedOrRemoved_.push_back(v.boundsWorld);
    }
    view.boundsWorld.add(v.boundsWorld);
    instances.push_back(v);
  });
  for (const auto& [id, gone] : instancesBefore) addedOrRemoved_.push_back(gone->boundsWorld);
  changes.instances |= !addedOrRemoved_.empty();

  const auto lightsBefore = byId(lights_);
  std::vector<LightView> lights;
  scene.registry.each<PunctualLight, WorldTransform>([&](Entity e, const PunctualLight& l, const WorldTransform& w) {
    LightView v;
    v.id = e.id();
    v.type = l.type;
    v.position = vec3(w.worldFromNode[3]);
    const vec3 forward = -vec3(w.worldFromNode[2]);
    const float length = glm::length(forward);
    if (!isFinite(v.position) || !std::isfinite(length)) return;
    v.direction = length > 0 ? forward / length : vec3(0, 0, -1);
    v.intensity = l.intensity;
    v.range = l.range;
    v.innerConeCos = l.innerConeCos;
    v.outerConeCos = l.outerConeCos;
    const auto before = lightsBefore.find(v.id);
    v.changed = before == lightsBefore.end() || !sameLight(v, *before->second);
    changes.lights |= v.changed;
    lights.push_back(v);
  });
  changes.lights |= lights.size() != lights_.size() || sky_ != scene.skyRadiance;
  changes.camera |= !sameCamera(camera_, camera);

  instances_ = std::move(instances);
  lights_ = std::move(lights);
  camera_ = camera;
  sky_ = scene.skyRadiance;
  first_ = false;

  view.assets = &scene.assets;
  view.instances = instances_;
  view.lights = lights_;
  view.addedOrRemoved = addedOrRemoved_;
  view.skyRadiance = scene.skyRadiance;
  view.camera = camera;
  view.changes = changes;
  view.time = time;
  return view;
}

} // namespace lambent

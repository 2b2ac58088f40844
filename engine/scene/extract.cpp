// Extraction: what the registry holds now, as spans, and how it differs from the extraction before.

#include "engine/core/parallel.h"
#include "engine/scene/scene.h"

namespace lambent {

/// Poses every instance that is skinned or morphed, again where its pose changed. A changed shape is a new object: who
/// holds the old one may still read it.
std::vector<InstanceView> SceneExtractor::placeInstances(const Scene& scene) {
  std::vector<InstanceView> instances;
  std::unordered_map<uint32_t, Shape> shapes;
  std::vector<Shape*> changed;
  scene.registry.each<MeshInstance, WorldTransform>([&](Entity e, const MeshInstance& m, const WorldTransform& w) {
    std::optional<PlacedPose> placed = poseOf(scene, e, m, w);
    if (!placed) return;
    InstanceView v;
    v.id = e.id();
    v.mesh = m.mesh;
    v.worldFromObject = placed->worldFromObject;
    if (deforms(scene.assets.meshes[m.mesh], placed->pose)) {
      auto node = shapes_.extract(v.id);
      Shape& shape = node ? shapes.insert(std::move(node)).position->second : shapes[v.id];
      if (shape.mesh != v.mesh || shape.pose != placed->pose) {
        shape.mesh = v.mesh;
        shape.pose = std::move(placed->pose);
        shape.deformed = newShape();
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

std::optional<LightView> lightOf(const Scene& scene, Entity entity) {
  const auto* l = scene.registry.tryGet<PunctualLight>(entity);
  const auto* w = scene.registry.tryGet<WorldTransform>(entity);
  if (!l || !w) return {};
  LightView v;
  v.id = entity.id();
  v.type = l->type;
  v.position = scene.fromOrigin(dvec3(w->worldFromNode[3]));
  const dvec3 forward = -dvec3(w->worldFromNode[2]); // of a node as large as single precision goes
  const double length = glm::length(forward);
  if (!isNear(v.position) || !std::isfinite(length)) return {};
  v.direction = length > 0 ? vec3(forward / length) : vec3(0, 0, -1);
  v.intensity = l->intensity;
  v.range = l->range;
  v.innerConeCos = l->innerConeCos;
  v.outerConeCos = l->outerConeCos;
  v.angularRadius = l->angularRadius;
  return v;
}

SceneView SceneExtractor::extract(const Scene& scene, const CameraView& camera, double time) {
  std::vector<LightView> lights;
  scene.registry.each<PunctualLight, WorldTransform>([&](Entity e, const PunctualLight&, const WorldTransform&) {
    if (const std::optional<LightView> light = lightOf(scene, e)) lights.push_back(*light);
  });
  SceneView view = changes_.take(scene.assets, placeInstances(scene), std::move(lights), scene.sky, camera, time);
  view.rayWork = scene.rayWork;
  return view;
}

} // namespace lambent

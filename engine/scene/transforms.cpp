// World transforms down the hierarchy, and the questions that need nothing else.

#include "engine/scene/scene.h"

namespace lambent {

void updateWorldTransforms(Scene& scene) {
  Registry& registry = scene.registry;
  uint32_t slots = 0;
  std::vector<Entity> missing;
  registry.each<Transform>([&](Entity e, const Transform&) {
    slots = glm::max(slots, e.index() + 1);
    if (!registry.has<WorldTransform>(e)) missing.push_back(e);
  });
  for (const Entity e : missing) registry.emplace<WorldTransform>(e);

  // Parents may have been created after their children, so each entity climbs to its nearest finished ancestor first.
  std::vector<bool> done(slots, false);
  std::vector<Entity> path;
  registry.each<Transform, WorldTransform>([&](Entity e, const Transform&, const WorldTransform&) {
    const auto parentOf = [&](Entity child) {
      const Parent* p = registry.tryGet<Parent>(child);
      return p && registry.has<WorldTransform>(p->entity) ? p->entity : Entity();
    };
    path.clear();
    for (Entity up = e; registry.valid(up) && !done[up.index()]; up = parentOf(up)) {
      path.push_back(up);
      CHECK_LE(path.size(), size_t(slots)); // a longer way up means that an entity is its own ancestor
    }
    for (auto it = path.rbegin(); it != path.rend(); ++it) {
      const Entity parent = parentOf(*it);
      dmat4 world = registry.get<Transform>(*it).local();
      if (registry.valid(parent)) world = registry.get<WorldTransform>(parent).worldFromNode * world;
      registry.get<WorldTransform>(*it).worldFromNode = world;
      done[it->index()] = true;
    }
  });
}

void rescale(Scene& scene, float factor) {
  Registry& registry = scene.registry;
  std::vector<Entity> roots;
  registry.each<Transform>([&](Entity e, const Transform&) {
    if (!registry.has<Parent>(e)) roots.push_back(e);
  });
  const Entity unit = registry.create();
  registry.emplace<Name>(unit, "unit");
  registry.emplace<Transform>(unit).scale = vec3(factor);
  registry.emplace<WorldTransform>(unit);
  for (const Entity e : roots) registry.emplace<Parent>(e, unit);
  registry.each<PunctualLight>([&](Entity, PunctualLight& light) { light.range *= factor; });
  registry.each<CameraLens>([&](Entity, CameraLens& lens) {
    lens.near *= factor;
    lens.orthoHalfHeight *= factor;
  });
  animate(scene, 0);
  findOrigin(scene);
}

Entity addLight(Scene& scene, const LightView& light, const std::string& name) {
  Registry& registry = scene.registry;
  const Entity e = registry.create();
  Transform t;
  t.translation = scene.origin + dvec3(light.position);
  t.rotation = rotationTowards(light.direction);
  registry.emplace<Name>(e, name);
  registry.emplace<Transform>(e, t);
  registry.emplace<WorldTransform>(e, t.local());
  registry.emplace<PunctualLight>(e, light.type, light.intensity, light.range, light.innerConeCos, light.outerConeCos,
                                  light.angularRadius);
  return e;
}

std::optional<Entity> findByName(const Scene& scene, const std::string& name) {
  std::optional<Entity> found;
  scene.registry.each<Name>([&](Entity e, const Name& n) {
    if (!found && n.value == name) found = e;
  });
  return found;
}

Aabb worldBounds(const Scene& scene) {
  Aabb bounds;
  forEachPosed(scene, [&](const Mesh& mesh, const DeformedMesh* deformed, const mat4& worldFromObject) {
    bounds.add(transformed(deformed ? deformed->boundsObject : mesh.boundsObject, worldFromObject));
  });
  return bounds;
}

} // namespace lambent

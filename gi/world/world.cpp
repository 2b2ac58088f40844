// The calls of lambent_world.h.
#include "gi/world/world.h"

#include <algorithm>
#include <atomic>

using namespace lambent;
using namespace lambent::library;

namespace {

std::string& messageWithoutWorld() {
  thread_local std::string message;
  return message;
}

template <class Work> lambent_status call(lambent_world* world, const Work& work) noexcept {
  return alone(world, "world", messageWithoutWorld(), [&] {
    return guarded(world->message, [&] {
      try {
        work();
      } catch (const CheckFailure&) { // and no device's
        world->dead = true;
        throw;
      }
    });
  });
}

Entity entityOf(const lambent_world& world, lambent_entity id) {
  const Entity e(id & Entity::kMaxIndex, id >> Entity::kIndexBits);
  if (id == LAMBENT_NO_ENTITY || !world.scene.registry.valid(e)) refuse(LAMBENT_INVALID_HANDLE, "no such entity");
  return e;
}

Transform transformOf(const float* local) {
  const mat4 m = mat4Of(local);
  if (!isFinite(m) || m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0 || m[3][3] != 1)
    refuse("local is not finite and affine (columns one after the other, the last row 0 0 0 1)");
  Transform t;
  t.matrix = dmat4(m);
  return t;
}

void write(const mat4& m, float* to) {
  if (to) std::copy_n(&m[0][0], 16, to);
}

void requireMesh(const lambent_world& world, uint32_t mesh) {
  if (mesh >= world.scene.assets.meshes.size())
    refuse("no mesh " + std::to_string(mesh) + " (there are " + std::to_string(world.scene.assets.meshes.size()) + ")");
}

/// Tells the scene's sky as it is kept here: a picture's texels are the scene's own.
void keepTexels(lambent_world& world) {
  const Sky::Picture& picture = world.scene.sky.picture();
  if (picture.image) world.sky.texels = &picture.image->texels[0].x;
}

/// A sky that a file told: constant, or a picture.
void describeSky(lambent_world& world) {
  const Sky& sky = world.scene.sky;
  if (const Sky::Picture& picture = sky.picture(); picture.image) {
    world.sky.type = LAMBENT_SKY_PICTURE;
    world.sky.width = picture.image->width;
    world.sky.height = picture.image->height;
    world.sky.scale = picture.scale;
    world.sky.turn = picture.turn;
    keepTexels(world);
    return;
  }
  const vec3 radiance = sky.radiance({0, 1, 0});
  std::copy_n(&radiance.x, 3, world.sky.radiance);
}

std::atomic<bool> outsideAllowed = false, largeAllowed = false, twoSided = false;

} // namespace

extern "C" {

lambent_status lambent_world_load(const char* file, const char* scene, lambent_world** world) {
  if (world) *world = nullptr;
  return guarded(messageWithoutWorld(), [&] {
    require(world != nullptr, "world is NULL");
    auto made = std::make_unique<lambent_world>();
    LAMBENT_DEFAULTS(LAMBENT_SKY_DESC, &made->sky);
    if (file) {
      made->scene = loadScene(file, scene ? scene : "", {}, FileTrust{outsideAllowed, largeAllowed});
      if (twoSided)
        for (Material& m : made->scene.assets.materials) m.backHidden = false;
      animate(made->scene, 0);
      describeSky(*made);
    }
    Live<lambent_world>::add(made.get());
    *world = made.release();
  });
}

void lambent_world_allow_outside(int allow) { outsideAllowed = allow != 0; }
void lambent_world_allow_large(int allow) { largeAllowed = allow != 0; }
void lambent_world_two_sided(int shown) { twoSided = shown != 0; }

void lambent_world_destroy(lambent_world* world) {
  if (!Live<lambent_world>::has(world) || world->busy.exchange(true)) return;
  Live<lambent_world>::remove(world);
  delete world;
}

const char* lambent_world_message(const lambent_world* world) {
  return Live<lambent_world>::has(world) ? world->message.c_str() : messageWithoutWorld().c_str();
}

const char* lambent_world_warning(const lambent_world* world, size_t index) {
  if (!Live<lambent_world>::has(world) || index >= world->scene.warnings.size()) return nullptr;
  return world->scene.warnings[index].c_str();
}

lambent_status lambent_world_origin(lambent_world* world, double origin[3]) {
  return call(world, [&] {
    require(origin != nullptr, "origin is NULL");
    std::copy_n(&world->scene.origin.x, 3, origin);
  });
}

lambent_status lambent_world_entities(lambent_world* world, lambent_entity* entities, size_t* count) {
  return call(world, [&] {
    require(count != nullptr && (entities != nullptr || *count == 0), "entities or count is NULL");
    size_t there = 0;
    world->scene.registry.each<Name>([&](Entity e, const Name&) {
      if (there < *count) entities[there] = e.id();
      ++there;
    });
    *count = there;
  });
}

lambent_status lambent_world_find(lambent_world* world, const char* name, lambent_entity* entity) {
  return call(world, [&] {
    require(name != nullptr && entity != nullptr, "name or entity is NULL");
    const std::optional<Entity> found = findByName(world->scene, name);
    if (!found) refuse("no entity is called " + std::string(name));
    *entity = found->id();
  });
}

const char* lambent_world_name(const lambent_world* world, lambent_entity entity) {
  if (!Live<lambent_world>::has(world)) return nullptr;
  const Name* name = nullptr;
  if (entity != LAMBENT_NO_ENTITY)
    name = world->scene.registry.tryGet<Name>(Entity(entity & Entity::kMaxIndex, entity >> Entity::kIndexBits));
  return name ? name->value.c_str() : nullptr;
}

lambent_status lambent_world_create(lambent_world* world, const char* name, lambent_entity parent,
                                    const float local[16], lambent_entity* entity) {
  return call(world, [&] {
    require(entity != nullptr, "entity is NULL");
    Transform t;
    if (local)
      t = transformOf(local);
    else if (parent == LAMBENT_NO_ENTITY)
      t.translation = world->scene.origin;
    Registry& registry = world->scene.registry;
    const Entity above = parent == LAMBENT_NO_ENTITY ? Entity() : entityOf(*world, parent);
    const Entity made = registry.create();
    registry.emplace<Name>(made, name ? name : "");
    registry.emplace<Transform>(made, t);
    registry.emplace<WorldTransform>(made);
    if (registry.valid(above)) registry.emplace<Parent>(made, above);
    *entity = made.id();
  });
}

lambent_status lambent_world_remove(lambent_world* world, lambent_entity entity) {
  return call(world, [&] {
    Registry& registry = world->scene.registry;
    std::vector<Entity> gone{entityOf(*world, entity)};
    for (size_t i = 0; i < gone.size(); ++i)
      registry.each<Parent>([&](Entity e, const Parent& p) {
        if (p.entity == gone[i]) gone.push_back(e);
      });
    for (const Entity e : gone) registry.destroy(e);
  });
}

lambent_status lambent_world_set_transform(lambent_world* world, lambent_entity entity, const float local[16]) {
  return call(world, [&] {
    Registry& registry = world->scene.registry;
    const Entity e = entityOf(*world, entity);
    const Transform t = transformOf(local);
    registry.emplace<Transform>(e, t); // a matrix goes before what channels set
    if (registry.has<Animated>(e)) registry.emplace<Animated>(e, t);
  });
}

lambent_status lambent_world_get_transform(lambent_world* world, lambent_entity entity, float local[16],
                                           float world_from_node[16]) {
  return call(world, [&] {
    const Entity e = entityOf(*world, entity);
    updateWorldTransforms(world->scene);
    write(mat4(world->scene.registry.get<Transform>(e).local()), local);
    write(world->scene.fromOrigin(world->scene.registry.get<WorldTransform>(e).worldFromNode), world_from_node);
  });
}

lambent_status lambent_world_animate(lambent_world* world, double seconds) {
  return call(world, [&] {
    require(std::isfinite(seconds), "seconds is not finite");
    animate(world->scene, seconds);
  });
}

lambent_status lambent_world_set_light(lambent_world* world, lambent_entity entity, const lambent_light_desc* light) {
  return call(world, [&] {
    const Entity e = entityOf(*world, entity);
    if (!light) return world->scene.registry.remove<PunctualLight>(e);
    const LightView v = lightOf(light);
    world->scene.registry.emplace<PunctualLight>(e, v.type, v.intensity, v.range, v.innerConeCos, v.outerConeCos,
                                                 v.angularRadius);
  });
}

lambent_status lambent_world_get_light(lambent_world* world, lambent_entity entity, lambent_light_desc* light) {
  return call(world, [&] {
    const Entity e = entityOf(*world, entity);
    require(light != nullptr, "light is NULL");
    updateWorldTransforms(world->scene);
    const std::optional<LightView> found = lightOf(world->scene, e);
    require(found.has_value(), "the entity has no light, or stands at no place within 1e12 m");
    *light = describe(*found);
  });
}

lambent_status lambent_world_set_sky(lambent_world* world, const lambent_sky_desc* sky) {
  return call(world, [&] {
    world->scene.sky = skyOf(sky);
    world->sky = *sky;
    keepTexels(*world);
  });
}

lambent_status lambent_world_set_mesh(lambent_world* world, lambent_entity entity, uint32_t mesh) {
  return call(world, [&] {
    const Entity e = entityOf(*world, entity);
    requireMesh(*world, mesh);
    Registry& registry = world->scene.registry;
    registry.remove<Skin>(e); // of what it showed
    registry.remove<MorphWeights>(e);
    registry.remove<AnimatedWeights>(e);
    registry.emplace<MeshInstance>(e, mesh);
  });
}

lambent_status lambent_world_get_mesh(lambent_world* world, lambent_entity entity, uint32_t* mesh) {
  return call(world, [&] {
    const MeshInstance* const shown = world->scene.registry.tryGet<MeshInstance>(entityOf(*world, entity));
    require(mesh != nullptr, "mesh is NULL");
    require(shown != nullptr, "the entity shows no mesh");
    *mesh = shown->mesh;
  });
}

lambent_status lambent_world_mesh_data(lambent_world* world, uint32_t mesh, lambent_mesh_desc* desc) {
  return call(world, [&] {
    requireMesh(*world, mesh);
    require(desc != nullptr, "desc is NULL");
    *desc = describe(world->scene.assets.meshes[mesh]);
  });
}

lambent_status lambent_world_camera(lambent_world* world, size_t index, lambent_frame* frame) {
  return call(world, [&] {
    read(frame, "frame");
    updateWorldTransforms(world->scene);
    const std::vector<NamedCamera> cameras = sceneCameras(world->scene);
    if (index > 0 && index >= cameras.size())
      refuse("no camera " + std::to_string(index) + " (there are " + std::to_string(cameras.size()) + ")");
    const CameraView view = cameras.empty() ? defaultView(world->scene) : cameras[index].view;
    require(isNear(view.position()), "the camera stands at no place within 1e12 m");
    write(view.worldFromView, frame->world_from_view);
    frame->fov_y = view.fovY;
    frame->ortho_half_height = view.orthoHalfHeight;
    frame->near_plane = view.near;
  });
}

lambent_status lambent_world_sync(lambent_world* world, lambent_device* device, lambent_scene scene) {
  return call(world, [&] { sync(*world, device, scene); });
}

lambent_instance lambent_world_instance(const lambent_world* world, lambent_entity entity, lambent_device* device,
                                        lambent_scene scene) {
  if (!Live<lambent_world>::has(world)) return 0;
  const auto synced = world->synced.find({device, scene});
  if (synced == world->synced.end()) return 0;
  const auto placed = synced->second.instances.find(entity);
  return placed == synced->second.instances.end() ? 0 : placed->second.instance;
}

} // extern "C"

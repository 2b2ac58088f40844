// The calls of lambent_world.h: a scene of the engine, kept and told through lambent.h alone.
#include "gi/lambent_world.h"

#include "engine/scene/scene.h"
#include "gi/library/descriptors.h"

#include <algorithm>
#include <map>
#include <tuple>

using namespace lambent;
using namespace lambent::library;

namespace {

/// What one scene has been told; true after each call of lambent.h, so that a call that fails can be made again.
struct Told {
  struct Placed {
    lambent_instance instance = 0; // 0: it was refused
    uint32_t mesh = kNone;
    mat4 place{0};
    uint64_t shape = 0;
  };
  struct Lit {
    lambent_light light = 0; // 0: it was refused
    lambent_light_desc as;
    bool told = false;
  };
  SceneExtractor extractor;
  // By number, as far as a call got; 0: refused, or a mesh without triangles.
  std::map<std::tuple<uint32_t, Wrap, Wrap, bool>, lambent_texture> textures;
  std::vector<lambent_material> materials;
  std::vector<lambent_mesh> meshes;
  std::map<uint32_t, Placed> instances;
  std::map<uint32_t, Lit> lights; // by entity
  std::optional<Sky> sky;
};
using TellingKey = std::pair<lambent_device*, lambent_scene>;

} // namespace

struct lambent_world {
  Scene scene;
  lambent_sky_desc sky; // as given
  std::map<TellingKey, Told> told;
  std::string message;
  bool dead = false; // after a fault of this code

  void warn(const std::string& line) {
    if (std::ranges::find(scene.warnings, line) == scene.warnings.end()) scene.warnings.push_back(line);
  }
};

namespace {

std::string& messageWithoutWorld() {
  thread_local std::string message;
  return message;
}

template <class Work> lambent_status call(lambent_world* world, const Work& work) noexcept {
  if (!Live<lambent_world>::has(world)) {
    guarded(messageWithoutWorld(), [] { refuse("no such world"); });
    return LAMBENT_INVALID_HANDLE;
  }
  if (world->dead) return LAMBENT_DEAD;
  const lambent_status status = guarded(world->message, work);
  world->dead = status == LAMBENT_DEAD;
  return status;
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

/// A view of the mesh's arrays; parts are left out.
lambent_mesh_desc describe(const Mesh& mesh) {
  lambent_mesh_desc d;
  LAMBENT_DEFAULTS(LAMBENT_MESH_DESC, &d);
  d.vertex_count = uint32_t(mesh.positions.size());
  d.triangle_count = uint32_t(mesh.triangles.size());
  d.positions = mesh.positions.empty() ? nullptr : &mesh.positions[0].x;
  d.normals = mesh.normals.empty() ? nullptr : &mesh.normals[0].x;
  d.uvs = mesh.uv0.empty() ? nullptr : &mesh.uv0[0].x;
  d.uvs1 = mesh.uv1.empty() ? nullptr : &mesh.uv1[0].x;
  d.colors = mesh.colors.empty() ? nullptr : &mesh.colors[0].x;
  d.indices = mesh.triangles.empty() ? nullptr : &mesh.triangles[0].x;
  d.name = mesh.name.c_str();
  return d;
}

lambent_light_desc describe(const LightView& light) {
  lambent_light_desc d{}; // with its padding: descriptors are compared
  LAMBENT_DEFAULTS(LAMBENT_LIGHT_DESC, &d);
  d.type = light.type == LightType::Point  ? LAMBENT_POINT
           : light.type == LightType::Spot ? LAMBENT_SPOT
                                           : LAMBENT_DIRECTIONAL;
  std::copy_n(&light.position.x, 3, d.position);
  std::copy_n(&light.direction.x, 3, d.direction);
  std::copy_n(&light.intensity.x, 3, d.intensity);
  d.range = light.range;
  d.inner_cone_angle = std::acos(std::clamp(light.innerConeCos, -1.0f, 1.0f));
  d.outer_cone_angle = std::max(d.inner_cone_angle, std::acos(std::clamp(light.outerConeCos, -1.0f, 1.0f)));
  d.angular_radius = light.angularRadius;
  return d;
}

/// Tells one scene: each thing where it differs from what was told.
class Telling {
 public:
  Telling(lambent_world& world, lambent_device* device, lambent_scene scene, Told& told)
      : world_(world), device_(device), scene_(scene), told_(told) {}

  void run() {
    for (const auto& [id, told] : told_.instances) {
      if (!told.instance) continue; // says whether the scene is the one that was told
      need(lambent_instance_move(device_, scene_, told.instance, &told.place[0][0]));
      break;
    }
    tellAssets();
    updateWorldTransforms(world_.scene);
    const SceneView view = told_.extractor.extract(world_.scene, CameraView(), 0);
    tellInstances(view);
    tellLights(view);
    if (told_.sky != view.sky) {
      need(lambent_scene_sky(device_, scene_, &world_.sky));
      told_.sky = view.sky;
    }
  }

 private:
  /// What the library refuses is left out; all else that fails ends the call.
  bool taken(lambent_status status, const std::string& what) {
    if (status == LAMBENT_OK) return true;
    if (status != LAMBENT_INVALID_ARGUMENT) need(status);
    world_.warn(what + " is left out: " + lambent_message(device_));
    return false;
  }
  void need(lambent_status status) const {
    if (status != LAMBENT_OK) refuse(status, lambent_message(status == LAMBENT_BUSY ? nullptr : device_));
  }

  lambent_texture textureOf(const TextureRef& ref) {
    if (ref.image == kNone) return 0;
    const auto key = std::tuple(ref.image, ref.wrapU, ref.wrapV, ref.nearest);
    if (const auto found = told_.textures.find(key); found != told_.textures.end()) return found->second;
    const TextureImage& image = world_.scene.assets.images[ref.image];
    lambent_texture_desc d;
    LAMBENT_DEFAULTS(LAMBENT_TEXTURE_DESC, &d);
    d.width = image.width;
    d.height = image.height;
    d.rgba = image.texels.empty() ? nullptr : &image.texels[0].x;
    d.srgb = image.srgb;
    d.wrap_u = int32_t(ref.wrapU);
    d.wrap_v = int32_t(ref.wrapV);
    d.nearest = ref.nearest;
    lambent_texture made = 0;
    taken(lambent_texture_create(device_, scene_, &d, &made), "texture " + image.name);
    return told_.textures[key] = made;
  }

  void tellAssets() {
    const SceneAssets& assets = world_.scene.assets;
    while (told_.materials.size() < assets.materials.size()) {
      const Material& m = assets.materials[told_.materials.size()];
      lambent_material_desc d;
      LAMBENT_DEFAULTS(LAMBENT_MATERIAL_DESC, &d);
      const auto uses = [&](const TextureRef& ref, lambent_texture& texture, int32_t& set, float* uv) {
        texture = textureOf(ref);
        set = int32_t(ref.uvSet);
        for (int row = 0; row < 2; ++row)
          for (int column = 0; column < 3; ++column) uv[3 * row + column] = ref.uvTransform[column][row];
      };
      std::copy_n(&m.baseColor.x, 3, d.base_color);
      std::copy_n(&m.emission.x, 3, d.emission);
      uses(m.baseColorTexture, d.base_texture, d.base_uv_set, d.base_uv);
      uses(m.emissiveTexture, d.emission_texture, d.emission_uv_set, d.emission_uv);
      d.double_sided = m.doubleSided;
      d.masked = m.alphaMode == AlphaMode::Mask;
      d.alpha = m.alpha;
      d.alpha_cutoff = m.alphaCutoff;
      lambent_material made = 0;
      taken(lambent_material_create(device_, scene_, &d, &made), "material " + m.name);
      told_.materials.push_back(made);
    }
    while (told_.meshes.size() < assets.meshes.size()) {
      const Mesh& mesh = assets.meshes[told_.meshes.size()];
      lambent_mesh_desc d = describe(mesh);
      std::vector<lambent_part> parts;
      for (const Primitive& p : mesh.primitives)
        parts.push_back({p.firstTriangle, p.triangleCount, told_.materials[p.material]});
      d.parts = parts.data();
      d.part_count = uint32_t(parts.size());
      lambent_mesh made = 0;
      if (!mesh.triangles.empty()) // else points and lines
        taken(lambent_mesh_create(device_, scene_, &d, &made), "mesh " + mesh.name);
      told_.meshes.push_back(made);
    }
  }

  std::string named(uint32_t entity) const {
    const char* const name = lambent_world_name(&world_, entity);
    return name && *name ? name : "node " + std::to_string(entity & Entity::kMaxIndex);
  }

  void tellInstances(const SceneView& view) {
    std::set<uint32_t> there;
    for (const InstanceView& v : view.instances) {
      there.insert(v.id);
      Told::Placed& told = told_.instances[v.id];
      if (told.instance && told.mesh != v.mesh) end(told);
      const uint64_t shape = v.deformed ? v.deformed->revision : 0;
      if (told.mesh == v.mesh && told.place == v.worldFromObject && told.shape == shape) continue;
      const float* const place = &v.worldFromObject[0][0];
      if (told.instance) {
        if (told.place != v.worldFromObject)
          taken(lambent_instance_move(device_, scene_, told.instance, place), named(v.id) + ", moved,");
      } else if (told_.meshes[v.mesh]) {
        taken(lambent_instance_create(device_, scene_, told_.meshes[v.mesh], place, &told.instance), named(v.id));
      }
      told.mesh = v.mesh;
      told.place = v.worldFromObject;
      if (!told.instance) continue;
      if (told.shape != shape) {
        const DeformedMesh* const d = v.deformed.get();
        taken(lambent_instance_deform(device_, scene_, told.instance, d ? &d->positions[0].x : nullptr,
                                      d ? &d->normals[0].x : nullptr, d ? uint32_t(d->positions.size()) : 0),
              named(v.id) + ", posed,");
      }
      told.shape = shape;
    }
    for (auto& [id, told] : told_.instances)
      if (!there.contains(id)) end(told);
    std::erase_if(told_.instances, [&](const auto& told) { return !there.contains(told.first); });
  }
  void end(Told::Placed& told) const {
    if (told.instance) need(lambent_instance_destroy(device_, scene_, told.instance));
    told = {};
  }

  void tellLights(const SceneView& view) {
    std::set<uint32_t> there;
    for (const LightView& v : view.lights) {
      there.insert(v.id);
      Told::Lit& told = told_.lights[v.id];
      const lambent_light_desc d = describe(v);
      if (told.told && std::memcmp(&d, &told.as, sizeof d) == 0) continue;
      if (told.light)
        taken(lambent_light_set(device_, scene_, told.light, &d), named(v.id) + ", changed,");
      else
        taken(lambent_light_create(device_, scene_, &d, &told.light), named(v.id));
      told.as = d;
      told.told = true;
    }
    for (auto& [id, told] : told_.lights)
      if (told.light && !there.contains(id)) need(lambent_light_destroy(device_, scene_, std::exchange(told.light, 0)));
    std::erase_if(told_.lights, [&](const auto& told) { return !there.contains(told.first); });
  }

  lambent_world& world_;
  lambent_device* device_;
  lambent_scene scene_;
  Told& told_;
};

} // namespace

extern "C" {

lambent_status lambent_world_load(const char* file, const char* scene, lambent_world** world) {
  if (world) *world = nullptr;
  return guarded(messageWithoutWorld(), [&] {
    require(world != nullptr, "world is NULL");
    auto made = std::make_unique<lambent_world>();
    LAMBENT_DEFAULTS(LAMBENT_SKY_DESC, &made->sky);
    if (file) {
      made->scene = loadScene(file, scene ? scene : "");
      animate(made->scene, 0);
    }
    Live<lambent_world>::add(made.get());
    *world = made.release();
  });
}

void lambent_world_destroy(lambent_world* world) {
  if (!Live<lambent_world>::has(world)) return;
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

lambent_status lambent_world_place(lambent_world* world, lambent_entity entity, const float local[16]) {
  return call(world, [&] {
    Registry& registry = world->scene.registry;
    const Entity e = entityOf(*world, entity);
    const Transform t = transformOf(local);
    registry.emplace<Transform>(e, t); // a matrix goes before what channels set
    if (registry.has<Animated>(e)) registry.emplace<Animated>(e, t);
  });
}

lambent_status lambent_world_placement(lambent_world* world, lambent_entity entity, float local[16],
                                       float world_from_node[16]) {
  return call(world, [&] {
    const Entity e = entityOf(*world, entity);
    updateWorldTransforms(world->scene);
    write(mat4(world->scene.registry.get<Transform>(e).local()), local);
    write(world->scene.fromOrigin(world->scene.registry.get<WorldTransform>(e).worldFromNode), world_from_node);
  });
}

lambent_status lambent_world_pose(lambent_world* world, double seconds) {
  return call(world, [&] {
    require(std::isfinite(seconds), "seconds is not finite");
    animate(world->scene, seconds);
  });
}

lambent_status lambent_world_light(lambent_world* world, lambent_entity entity, const lambent_light_desc* light) {
  return call(world, [&] {
    const Entity e = entityOf(*world, entity);
    if (!light) return world->scene.registry.remove<PunctualLight>(e);
    const LightView v = lightOf(light);
    world->scene.registry.emplace<PunctualLight>(e, v.type, v.intensity, v.range, v.innerConeCos, v.outerConeCos,
                                                 v.angularRadius);
  });
}

lambent_status lambent_world_light_of(lambent_world* world, lambent_entity entity, lambent_light_desc* light) {
  return call(world, [&] {
    const Entity e = entityOf(*world, entity);
    require(light != nullptr, "light is NULL");
    updateWorldTransforms(world->scene);
    bool found = false;
    SceneExtractor extractor;
    for (const LightView& v : extractor.extract(world->scene, CameraView(), 0).lights)
      if (v.id == e.id()) *light = describe(v), found = true;
    require(found, "the entity has no light");
  });
}

lambent_status lambent_world_sky(lambent_world* world, const lambent_sky_desc* sky) {
  return call(world, [&] {
    world->scene.sky = skyOf(sky);
    world->sky = *sky;
  });
}

lambent_status lambent_world_show(lambent_world* world, lambent_entity entity, uint32_t mesh) {
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

lambent_status lambent_world_mesh_of(lambent_world* world, lambent_entity entity, uint32_t* mesh) {
  return call(world, [&] {
    const MeshInstance* const shown = world->scene.registry.tryGet<MeshInstance>(entityOf(*world, entity));
    require(mesh != nullptr, "mesh is NULL");
    require(shown != nullptr, "the entity shows no mesh");
    *mesh = shown->mesh;
  });
}

lambent_status lambent_world_mesh(lambent_world* world, uint32_t mesh, lambent_mesh_desc* desc) {
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
    write(view.worldFromView, frame->world_from_view);
    frame->fov_y = view.fovY;
    frame->ortho_half_height = view.orthoHalfHeight;
    frame->near_plane = view.near;
  });
}

lambent_status lambent_world_tell(lambent_world* world, lambent_device* device, lambent_scene scene) {
  const auto tell = [&] {
    return call(world, [&] { Telling(*world, device, scene, world->told[{device, scene}]).run(); });
  };
  const lambent_status status = tell();
  if (status != LAMBENT_INVALID_HANDLE || !Live<lambent_world>::has(world)) return status;
  world->told.erase({device, scene}); // of a device that has ended, and had the same name
  return tell();
}

lambent_instance lambent_world_instance(const lambent_world* world, lambent_entity entity, lambent_device* device,
                                        lambent_scene scene) {
  if (!Live<lambent_world>::has(world)) return 0;
  const auto told = world->told.find({device, scene});
  if (told == world->told.end()) return 0;
  const auto placed = told->second.instances.find(entity);
  return placed == told->second.instances.end() ? 0 : placed->second.instance;
}

} // extern "C"

// What of a world a scene lacks, told through lambent.h alone.
#include "gi/world/world.h"

#include <algorithm>
#include <utility>

namespace lambent::library {

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
  lambent_light_desc d;
  LAMBENT_DEFAULTS(LAMBENT_LIGHT_DESC, &d);
  d.type = light.type == LightType::Point  ? LAMBENT_LIGHT_POINT
           : light.type == LightType::Spot ? LAMBENT_LIGHT_SPOT
                                           : LAMBENT_LIGHT_DIRECTIONAL;
  std::copy_n(&light.position.x, 3, d.position);
  std::copy_n(&light.direction.x, 3, d.direction);
  std::copy_n(&light.intensity.x, 3, d.intensity);
  d.range = light.range;
  d.inner_cone_angle = std::acos(std::clamp(light.innerConeCos, -1.0f, 1.0f));
  d.outer_cone_angle = std::max(d.inner_cone_angle, std::acos(std::clamp(light.outerConeCos, -1.0f, 1.0f)));
  d.angular_radius = light.angularRadius;
  return d;
}

namespace {

/// Each thing where it differs from what the scene has.
class Syncing {
 public:
  Syncing(lambent_world& world, lambent_device* device, lambent_scene scene, Synced& synced)
      : world_(world), device_(device), scene_(scene), synced_(synced) {}

  void run() {
    tellAssets();
    updateWorldTransforms(world_.scene);
    const SceneView view = synced_.extractor.extract(world_.scene, CameraView(), 0);
    tellInstances(view);
    tellLights(view);
    if (synced_.sky != view.sky) {
      need(lambent_scene_set_sky(device_, scene_, &world_.sky));
      synced_.sky = view.sky;
    }
  }

 private:
  /// What the library refuses is left out; all else that fails ends the call.
  void take(lambent_status status, const std::string& what) {
    if (status == LAMBENT_INVALID_ARGUMENT)
      world_.warn(what + " is left out: " + lambent_message(device_));
    else
      need(status);
  }
  /// The same for a change of what was made. Says whether the host has destroyed it.
  bool isGone(lambent_status status, const std::string& what) {
    if (status == LAMBENT_INVALID_HANDLE) return true;
    take(status, what);
    return false;
  }
  void need(lambent_status status) const {
    if (status != LAMBENT_OK) refuse(status, lambent_message(status == LAMBENT_BUSY ? nullptr : device_));
  }

  lambent_texture textureOf(const TextureRef& ref) {
    if (ref.image == kNone) return 0;
    const auto key = std::tuple(ref.image, ref.wrapU, ref.wrapV, ref.nearest);
    if (const auto found = synced_.textures.find(key); found != synced_.textures.end()) return found->second;
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
    take(lambent_texture_create(device_, scene_, &d, &made), "texture " + image.name);
    return synced_.textures[key] = made;
  }

  void tellAssets() {
    const SceneAssets& assets = world_.scene.assets;
    while (synced_.materials.size() < assets.materials.size()) {
      const Material& m = assets.materials[synced_.materials.size()];
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
      d.back_hidden = m.backHidden;
      d.alpha_mode = int32_t(m.alphaMode);
      d.alpha = m.alpha;
      d.alpha_cutoff = m.alphaCutoff;
      lambent_material made = 0;
      take(lambent_material_create(device_, scene_, &d, &made), "material " + m.name);
      synced_.materials.push_back(made);
    }
    while (synced_.meshes.size() < assets.meshes.size()) {
      const Mesh& mesh = assets.meshes[synced_.meshes.size()];
      lambent_mesh_desc d = describe(mesh);
      std::vector<lambent_submesh> parts;
      for (const Primitive& p : mesh.primitives)
        parts.push_back({p.firstTriangle, p.triangleCount, synced_.materials[p.material]});
      d.submeshes = parts.data();
      d.submesh_count = uint32_t(parts.size());
      lambent_mesh made = 0;
      if (!mesh.triangles.empty()) // else points and lines
        take(lambent_mesh_create(device_, scene_, &d, &made), "mesh " + mesh.name);
      synced_.meshes.push_back(made);
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
      Synced::Placed& has = synced_.instances[v.id];
      const Synced::Placed wanted{has.instance, v.mesh, v.worldFromObject, v.deformed ? v.deformed->revision : 0};
      if (has == wanted) continue;
      if (has.mesh != v.mesh) end(has);
      const float* const place = &v.worldFromObject[0][0];
      const DeformedMesh* const d = v.deformed.get();
      const auto create = [&] {
        has = {};
        if (synced_.meshes[v.mesh])
          take(lambent_instance_create(device_, scene_, synced_.meshes[v.mesh], place, &has.instance), named(v.id));
      };
      const auto pose = [&] {
        if (!has.instance || has.shape == wanted.shape) return LAMBENT_OK;
        return lambent_instance_deform(device_, scene_, has.instance, d ? &d->positions[0].x : nullptr,
                                       d ? &d->normals[0].x : nullptr, d ? uint32_t(d->positions.size()) : 0);
      };
      if (has.instance && has.place != wanted.place &&
          isGone(lambent_instance_move(device_, scene_, has.instance, place), named(v.id) + ", moved,"))
        has.instance = 0;
      if (!has.instance) create();
      if (isGone(pose(), named(v.id) + ", posed,")) {
        create();
        take(pose(), named(v.id) + ", posed,");
      }
      has = {has.instance, wanted.mesh, wanted.place, wanted.shape};
    }
    for (auto& [id, has] : synced_.instances)
      if (!there.contains(id)) end(has);
    std::erase_if(synced_.instances, [&](const auto& has) { return !there.contains(has.first); });
  }
  void end(Synced::Placed& has) {
    if (has.instance) isGone(lambent_instance_destroy(device_, scene_, has.instance), "an instance");
    has = {};
  }

  void tellLights(const SceneView& view) {
    std::set<uint32_t> there;
    for (const LightView& v : view.lights) {
      there.insert(v.id);
      Synced::Lit& has = synced_.lights[v.id];
      const lambent_light_desc wanted = describe(v);
      static_assert(sizeof wanted == sizeof(size_t) + 14 * sizeof(float), "no padding, which would differ");
      if (has.as && std::memcmp(&wanted, &*has.as, sizeof wanted) == 0) continue;
      if (has.light && isGone(lambent_light_set(device_, scene_, has.light, &wanted), named(v.id) + ", changed,"))
        has.light = 0;
      if (!has.light) take(lambent_light_create(device_, scene_, &wanted, &has.light), named(v.id));
      has.as = wanted;
    }
    for (auto& [id, has] : synced_.lights)
      if (has.light && !there.contains(id)) {
        isGone(lambent_light_destroy(device_, scene_, has.light), "a light");
        has.light = 0;
      }
    std::erase_if(synced_.lights, [&](const auto& has) { return !there.contains(has.first); });
  }

  lambent_world& world_;
  lambent_device* device_;
  lambent_scene scene_;
  Synced& synced_;
};

} // namespace

void sync(lambent_world& world, lambent_device* device, lambent_scene scene) {
  const auto key = std::pair(device, scene);
  const lambent_status status = lambent_scene_exists(device, scene);
  if (status == LAMBENT_INVALID_HANDLE) world.synced.erase(key);
  if (status != LAMBENT_OK) refuse(status, lambent_message(status == LAMBENT_BUSY ? nullptr : device));
  Syncing(world, device, scene, world.synced[key]).run();
}

} // namespace lambent::library

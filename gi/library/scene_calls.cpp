// Calls of lambent.h about scenes and what is in them.
#include "engine/gl/state_guard.h"
#include "gi/library/border.h"

#include <cmath>

using namespace lambent;
using namespace lambent::library;

namespace {

/// Takes a thing out of its scene.
template <Kind kind>
lambent_status destroy(lambent_device* device, lambent_scene scene, uint64_t id, const char* what,
                       bool (HostScene::*has)(uint32_t) const, void (HostScene::*remove)(uint32_t)) {
  return call(device, Gl::NotNeeded, [&] {
    HostScene& host = sceneOf(*device, scene).host;
    const uint32_t number = numberOf(kind, scene, id, what, host, has);
    (host.*remove)(number);
  });
}

Material materialOf(const Scene& s, lambent_scene scene, const lambent_material_desc* given) {
  const lambent_material_desc d = read(given, "material");
  const auto textureOf = [&](lambent_texture id, int32_t set, const float* m) -> TextureRef {
    if (id == 0) return {};
    requireWithin(set, 2, "material: base_uv_set or emission_uv_set");
    TextureRef t = s.textures[numberOf(Kind::Texture, scene, id, "texture", s.host, &HostScene::hasTexture)];
    t.uvSet = uint32_t(set);
    t.uvTransform = {m[0], m[3], 0, m[1], m[4], 0, m[2], m[5], 1};
    return t;
  };
  Material m;
  m.baseColor = vec3Of(d.base_color);
  m.baseColorTexture = textureOf(d.base_texture, d.base_uv_set, d.base_uv);
  m.emission = vec3Of(d.emission);
  m.emissiveTexture = textureOf(d.emission_texture, d.emission_uv_set, d.emission_uv);
  m.doubleSided = d.double_sided != 0;
  m.backHidden = d.back_hidden != 0;
  requireWithin(d.alpha_mode, 3, "material: alpha_mode");
  m.alphaMode = AlphaMode(d.alpha_mode);
  m.alpha = d.alpha;
  m.alphaCutoff = d.alpha_cutoff;
  return m;
}

/// A copy of level 0 of a host's texture.
std::vector<u8vec4> texelsOf(uint32_t name, int& width, int& height) {
  const gl::Texture texture = gl::Texture::borrowed(name);
  if (texture.width() == 0 || !texture.readsAsFlat() || texture.isDepth())
    refuse("texture " + std::to_string(name) + " is none (a GL_TEXTURE_2D of colours)");
  const gl::StateGuard guard;
  width = texture.width();
  height = texture.height();
  std::vector<u8vec4> texels(size_t(width) * size_t(height));
  texture.read(std::span(texels), GL_RGBA, GL_UNSIGNED_BYTE);
  return texels;
}

} // namespace

extern "C" {

lambent_status lambent_scene_create(lambent_device* device, lambent_scene* scene) {
  return call(device, Gl::NotNeeded, [&] {
    require(scene != nullptr, "scene is NULL");
    const uint64_t id = idOf(Kind::Scene, nextSerial(), 0);
    device->scenes.emplace(std::piecewise_construct, std::forward_as_tuple(id), std::forward_as_tuple());
    *scene = id;
  });
}

lambent_status lambent_scene_exists(lambent_device* device, lambent_scene scene) {
  return call(device, Gl::NotNeeded, [&] { sceneOf(*device, scene); });
}

lambent_status lambent_scene_destroy(lambent_device* device, lambent_scene scene) {
  return call(device, Gl::Needed, [&] {
    sceneOf(*device, scene);
    const gl::StateGuard guard;
    std::erase_if(device->views, [&](const auto& view) { return view.second->scene == scene; });
    device->scenes.erase(scene);
  });
}

lambent_status lambent_texture_create(lambent_device* device, lambent_scene scene, const lambent_texture_desc* given,
                                      lambent_texture* texture) {
  const bool byName = given && given->size == sizeof *given && given->gl_texture != 0;
  return call(device, byName ? Gl::Needed : Gl::NotNeeded, [&] {
    Scene& s = sceneOf(*device, scene);
    const lambent_texture_desc d = read(given, "texture");
    require(texture != nullptr, "texture is NULL");
    requireWithin(d.wrap_u, 3, "texture: wrap_u");
    requireWithin(d.wrap_v, 3, "texture: wrap_v");
    TextureImage image;
    image.width = d.width;
    image.height = d.height;
    image.srgb = d.srgb != 0;
    if (byName) {
      image.texels = texelsOf(d.gl_texture, image.width, image.height);
    } else {
      require(d.rgba != nullptr, "texture: rgba and gl_texture are both missing");
      require(d.width >= 1 && d.height >= 1 && d.width <= 32768 && d.height <= 32768,
              "texture: width and height are not within 1 and 32768");
      const auto texels = spanOf<u8vec4>(d.rgba, size_t(d.width) * size_t(d.height));
      image.texels.assign(texels.begin(), texels.end());
    }
    s.textures.push_back({.image = s.host.addTexture(std::move(image)),
                          .wrapU = Wrap(int(d.wrap_u)),
                          .wrapV = Wrap(int(d.wrap_v)),
                          .nearest = d.nearest != 0});
    *texture = idOf(Kind::Texture, serialOf(scene), s.textures.size() - 1);
  });
}

lambent_status lambent_texture_destroy(lambent_device* device, lambent_scene scene, lambent_texture texture) {
  return destroy<Kind::Texture>(device, scene, texture, "texture", &HostScene::hasTexture, &HostScene::removeTexture);
}

lambent_status lambent_material_create(lambent_device* device, lambent_scene scene, const lambent_material_desc* desc,
                                       lambent_material* material) {
  return call(device, Gl::NotNeeded, [&] {
    Scene& s = sceneOf(*device, scene);
    const Material m = materialOf(s, scene, desc);
    require(material != nullptr, "material is NULL");
    *material = idOf(Kind::Material, serialOf(scene), s.host.addMaterial(m));
  });
}

lambent_status lambent_material_set(lambent_device* device, lambent_scene scene, lambent_material material,
                                    const lambent_material_desc* desc) {
  return call(device, Gl::NotNeeded, [&] {
    Scene& s = sceneOf(*device, scene);
    const uint32_t number = numberOf(Kind::Material, scene, material, "material", s.host, &HostScene::hasMaterial);
    const Material m = materialOf(s, scene, desc);
    s.host.setMaterial(number, m);
  });
}

lambent_status lambent_material_destroy(lambent_device* device, lambent_scene scene, lambent_material material) {
  return destroy<Kind::Material>(device, scene, material, "material", &HostScene::hasMaterial,
                                 &HostScene::removeMaterial);
}

lambent_status lambent_mesh_create(lambent_device* device, lambent_scene scene, const lambent_mesh_desc* given,
                                   lambent_mesh* mesh) {
  return call(device, Gl::NotNeeded, [&] {
    Scene& s = sceneOf(*device, scene);
    const lambent_mesh_desc d = read(given, "mesh");
    require(mesh != nullptr, "mesh is NULL");
    require(d.positions && d.indices, "mesh: positions or indices are NULL");
    require(d.submeshes || d.submesh_count == 0, "mesh: submeshes is NULL");
    const auto materialOf = [&](lambent_material id) -> uint32_t {
      return id == 0 ? 0 : numberOf(Kind::Material, scene, id, "material", s.host, &HostScene::hasMaterial);
    };
    std::vector<HostMesh::Part> parts;
    for (const lambent_submesh& part : std::span(d.submeshes, d.submesh_count))
      parts.push_back({part.first_triangle, part.triangle_count, materialOf(part.material)});
    const uint32_t number = s.host.addMesh({.name = d.name ? std::string(d.name).substr(0, 200) : std::string(),
                                            .positions = spanOf<vec3>(d.positions, d.vertex_count),
                                            .normals = spanOf<vec3>(d.normals, d.vertex_count),
                                            .uvs = spanOf<vec2>(d.uvs, d.vertex_count),
                                            .uvs1 = spanOf<vec2>(d.uvs1, d.vertex_count),
                                            .colors = spanOf<vec4>(d.colors, d.vertex_count),
                                            .triangles = spanOf<uvec3>(d.indices, d.triangle_count),
                                            .parts = parts,
                                            .material = materialOf(d.material)});
    *mesh = idOf(Kind::Mesh, serialOf(scene), number);
  });
}

lambent_status lambent_mesh_destroy(lambent_device* device, lambent_scene scene, lambent_mesh mesh) {
  return destroy<Kind::Mesh>(device, scene, mesh, "mesh", &HostScene::hasMesh, &HostScene::removeMesh);
}

lambent_status lambent_instance_create(lambent_device* device, lambent_scene scene, lambent_mesh mesh,
                                       const float world_from_object[16], lambent_instance* instance) {
  return call(device, Gl::NotNeeded, [&] {
    HostScene& host = sceneOf(*device, scene).host;
    require(instance != nullptr, "instance is NULL");
    const uint32_t number = numberOf(Kind::Mesh, scene, mesh, "mesh", host, &HostScene::hasMesh);
    *instance = idOf(Kind::Instance, serialOf(scene), host.addInstance(number, mat4Of(world_from_object)));
  });
}

lambent_status lambent_instance_move(lambent_device* device, lambent_scene scene, lambent_instance instance,
                                     const float world_from_object[16]) {
  return call(device, Gl::NotNeeded, [&] {
    HostScene& host = sceneOf(*device, scene).host;
    host.moveInstance(numberOf(Kind::Instance, scene, instance, "instance", host, &HostScene::hasInstance),
                      mat4Of(world_from_object));
  });
}

lambent_status lambent_instance_deform(lambent_device* device, lambent_scene scene, lambent_instance instance,
                                       const float* positions, const float* normals, uint32_t vertex_count) {
  return call(device, Gl::NotNeeded, [&] {
    HostScene& host = sceneOf(*device, scene).host;
    const uint32_t number = numberOf(Kind::Instance, scene, instance, "instance", host, &HostScene::hasInstance);
    require(!positions || vertex_count > 0, "instance: vertex_count is 0");
    host.deformInstance(number, spanOf<vec3>(positions, vertex_count), spanOf<vec3>(normals, vertex_count));
  });
}

lambent_status lambent_instance_destroy(lambent_device* device, lambent_scene scene, lambent_instance instance) {
  return destroy<Kind::Instance>(device, scene, instance, "instance", &HostScene::hasInstance,
                                 &HostScene::removeInstance);
}

lambent_status lambent_light_create(lambent_device* device, lambent_scene scene, const lambent_light_desc* desc,
                                    lambent_light* light) {
  return call(device, Gl::NotNeeded, [&] {
    HostScene& host = sceneOf(*device, scene).host;
    require(light != nullptr, "light is NULL");
    *light = idOf(Kind::Light, serialOf(scene), host.addLight(lightOf(desc)));
  });
}

lambent_status lambent_light_set(lambent_device* device, lambent_scene scene, lambent_light light,
                                 const lambent_light_desc* desc) {
  return call(device, Gl::NotNeeded, [&] {
    HostScene& host = sceneOf(*device, scene).host;
    host.setLight(numberOf(Kind::Light, scene, light, "light", host, &HostScene::hasLight), lightOf(desc));
  });
}

lambent_status lambent_light_destroy(lambent_device* device, lambent_scene scene, lambent_light light) {
  return destroy<Kind::Light>(device, scene, light, "light", &HostScene::hasLight, &HostScene::removeLight);
}

lambent_status lambent_sky_sun(const lambent_sky_desc* given, float irradiance[3], float* angular_radius) {
  return guarded(messageWithoutDevice(), [&] {
    const Sky sky = skyOf(given);
    require(given->type == LAMBENT_SKY_CLEAR, "sky: only a clear one has a sun");
    const vec3 sun = daylightSun(glm::normalize(vec3Of(given->towards_sun)), given->turbidity);
    if (irradiance) std::copy(&sun.x, &sun.x + 3, irradiance);
    if (angular_radius) *angular_radius = kSunRadius;
  });
}

lambent_status lambent_sky_radiance(const lambent_sky_desc* given, const float* directions, size_t count,
                                    float* radiance) {
  return guarded(messageWithoutDevice(), [&] {
    const Sky sky = skyOf(given);
    require(count == 0 || (directions && radiance), "directions or radiance is NULL");
    for (size_t i = 0; i < count; ++i) {
      const vec3 direction = vec3Of(directions + 3 * i);
      const float length = glm::length(direction);
      require(length > 0 && std::isfinite(length), "sky: a direction has no length");
      const vec3 found = sky.radiance(direction / length);
      std::copy(&found.x, &found.x + 3, radiance + 3 * i);
    }
  });
}

lambent_status lambent_scene_set_sky(lambent_device* device, lambent_scene scene, const lambent_sky_desc* given) {
  return call(device, Gl::NotNeeded, [&] {
    HostScene& host = sceneOf(*device, scene).host;
    host.setSky(skyOf(given));
  });
}

} // extern "C"

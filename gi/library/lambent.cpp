// The C interface: checks what crosses the border, and makes every failure a status.
#include "engine/core/error.h"
#include "engine/gl/context.h"
#include "engine/gl/state_guard.h"
#include "gi/contract/frame_outputs.h"
#include "gi/library/device.h"
#include "gi/library/driver_check.h"
#include "gi/library/surface_check.h"
#include "gi/plan/presets.h"
#include "gi/surfaces/surfaces.h"

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <mutex>
#include <new>
#include <set>

using namespace lambent;
using library::Scene;
using library::View;

namespace {

// Live devices, so that a pointer to none is an error and not a crash. -----------------------------------------------

std::mutex devicesMutex;
std::set<const lambent_device*>& devices() {
  static std::set<const lambent_device*> live;
  return live;
}
bool isLive(const lambent_device* device) {
  const std::lock_guard lock(devicesMutex);
  return devices().contains(device);
}

thread_local std::string messageWithoutDevice;

/// A failure with its status.
struct Refusal {
  lambent_status status;
  std::string message;
};
[[noreturn]] void refuse(lambent_status status, const std::string& message) { throw Refusal{status, message}; }
[[noreturn]] void refuse(const std::string& message) { refuse(LAMBENT_INVALID_ARGUMENT, message); }
void require(bool holds, const char* message) {
  if (!holds) refuse(message);
}

/// Runs work that may throw. Says what went wrong in `message`.
template <class Work> lambent_status guarded(std::string& message, const Work& work) noexcept {
  try {
    try {
      work();
      return LAMBENT_OK;
    } catch (const Refusal& r) {
      message = r.message;
      return r.status;
    } catch (const InputError& e) {
      message = e.what();
      return LAMBENT_INVALID_ARGUMENT;
    } catch (const CheckFailure& e) {
      message = std::string("a fault in the library, please report it: ") + e.what();
      return LAMBENT_DEAD;
    } catch (const std::bad_alloc&) {
      message = "out of memory";
      return LAMBENT_OUT_OF_MEMORY;
    } catch (const std::exception& e) {
      message = e.what();
      return LAMBENT_FAILED;
    }
  } catch (...) { // even the message found no memory
    return LAMBENT_OUT_OF_MEMORY;
  }
}

enum class Gl { NotNeeded, Needed };

void requireOwnContext(const lambent_device& device) {
  try {
    gl::requireContext();
  } catch (const RunError& e) {
    refuse(LAMBENT_NO_CONTEXT, e.what());
  }
  char label[64] = "";
  if (glIsVertexArray(device.mark.name()))
    glGetObjectLabel(GL_VERTEX_ARRAY, device.mark.name(), sizeof label, nullptr, label);
  if (label != device.markLabel)
    refuse(LAMBENT_NO_CONTEXT, "another OpenGL context is current than the one in which the device was created");
}

/// Runs a call on a device, on its threads and its account.
template <class Work> lambent_status call(lambent_device* device, Gl needs, const Work& work) noexcept {
  if (!isLive(device)) {
    guarded(messageWithoutDevice, [] { refuse("no such device"); });
    return LAMBENT_INVALID_HANDLE;
  }
  if (device->busy.exchange(true)) {
    guarded(messageWithoutDevice, [] { refuse("the device is busy with another call"); });
    return LAMBENT_BUSY;
  }
  lambent_status status = LAMBENT_DEAD;
  if (!device->dead) {
    status = guarded(device->message, [&] {
      if (needs == Gl::Needed) requireOwnContext(*device);
      const MemoryAccount::Scope account(device->account);
      device->workers.run(work);
    });
    device->dead = status == LAMBENT_DEAD;
    if (status != LAMBENT_OK) guarded(device->message, [&] { device->log(LAMBENT_ERROR, device->message); });
  }
  device->busy = false;
  return status;
}

// Descriptors --------------------------------------------------------------------------------------------------------

template <class Desc> Desc standard();
template <> lambent_device_desc standard() {
  lambent_device_desc d{};
  d.seed = 1;
  return d;
}
template <> lambent_texture_desc standard() {
  lambent_texture_desc d{};
  d.srgb = 1;
  return d;
}
template <> lambent_material_desc standard() {
  lambent_material_desc d{};
  for (float& c : d.base_color) c = 0.8f;
  d.alpha_cutoff = 0.5f;
  return d;
}
template <> lambent_mesh_desc standard() { return {}; }
template <> lambent_light_desc standard() {
  lambent_light_desc d{};
  d.direction[1] = -1;
  for (float& c : d.intensity) c = 1;
  d.range = kInfinity;
  d.outer_cone_angle = kPi / 4;
  return d;
}
template <> lambent_sky_desc standard() {
  lambent_sky_desc d{};
  d.towards_sun[1] = 1;
  d.turbidity = 3;
  return d;
}
template <> lambent_view_desc standard() {
  lambent_view_desc d{};
  d.width = 320;
  d.height = 180;
  return d;
}
template <> lambent_frame standard() {
  lambent_frame f{};
  for (int i = 0; i < 4; ++i) f.world_from_view[5 * i] = 1;
  f.fov_y = 1;
  f.near_plane = 0.05f;
  f.far_plane = kInfinity;
  return f;
}
template <> lambent_output standard() { return {}; }

template <class Desc> void writeStandard(void* to, size_t size) {
  Desc d = standard<Desc>();
  d.size = size;
  std::memcpy(to, &d, size);
}

/// Checks a descriptor's size: that of a version so far, which is one. (A later one lets the sizes of older hosts pass,
/// and fills up what these do not know.)
template <class Desc> Desc read(const Desc* given, const char* what) {
  if (!given) refuse(std::string(what) + " is NULL");
  size_t size = 0;
  std::memcpy(&size, given, sizeof size);
  if (size != sizeof(Desc))
    refuse(std::string(what) + " has a size field of " + std::to_string(size) + " (LAMBENT_DEFAULTS sets it; " +
           std::to_string(sizeof(Desc)) + " in version " + lambent_version_text() + ")");
  return *given;
}

vec3 vec3Of(const float v[3]) { return {v[0], v[1], v[2]}; }
mat4 mat4Of(const float* m) {
  require(m != nullptr, "a matrix is NULL");
  mat4 out;
  for (int i = 0; i < 16; ++i) out[i / 4][i % 4] = m[i];
  return out;
}
template <class T> std::span<const T> spanOf(const void* data, size_t count) {
  return data ? std::span(static_cast<const T*>(data), count) : std::span<const T>();
}
void requireWithin(int value, int count, const char* what) {
  if (value < 0 || value >= count) refuse(std::string(what) + " is none of its values");
}

// Numbers of things --------------------------------------------------------------------------------------------------
// From the top: 8 bits what it is, 24 bits which scene it is of, 32 bits its number there, from 1.

enum class Kind : uint64_t { Scene = 1, View, Texture, Material, Mesh, Instance, Light };
constexpr uint64_t kMostGiven = (1u << 24) - 1;

uint64_t idOf(Kind kind, uint64_t scene, uint64_t number) { return uint64_t(kind) << 56 | scene << 32 | (number + 1); }
uint64_t serialOf(uint64_t id) { return id >> 32 & kMostGiven; }

[[noreturn]] void unknown(const char* what) { refuse(LAMBENT_INVALID_HANDLE, std::string("no such ") + what); }

Scene& sceneOf(lambent_device& device, lambent_scene id) {
  const auto found = device.scenes.find(id);
  if (found == device.scenes.end()) unknown("scene");
  return found->second;
}
View& viewOf(lambent_device& device, lambent_view id) {
  const auto found = device.views.find(id);
  if (found == device.views.end()) unknown("view");
  return *found->second;
}
/// The number of a thing in its scene, as far as the id says.
uint32_t numberOf(Kind kind, lambent_scene scene, uint64_t id, const char* what) {
  if (id >> 56 != uint64_t(kind) || serialOf(id) != serialOf(scene) || (id & 0xffffffffu) == 0) unknown(what);
  return uint32_t(id) - 1;
}
uint32_t knownOf(Kind kind, lambent_scene scene, uint64_t id, const char* what, const HostScene& in,
                 bool (HostScene::*has)(uint32_t) const) {
  const uint32_t number = numberOf(kind, scene, id, what);
  if (!(in.*has)(number)) unknown(what);
  return number;
}

/// Before textures, materials or meshes change: views may still work with them beside the GPU.
void settle(lambent_device& device, lambent_scene scene) {
  for (const auto& [id, view] : device.views)
    if (view->scene == scene) view->gi.vpls();
}

LightView lightOf(const lambent_light_desc* given) {
  const lambent_light_desc d = read(given, "light");
  requireWithin(d.type, 3, "light: type");
  LightView light;
  light.type = d.type == LAMBENT_POINT  ? LightType::Point
               : d.type == LAMBENT_SPOT ? LightType::Spot
                                        : LightType::Directional;
  light.position = vec3Of(d.position);
  light.direction = vec3Of(d.direction);
  light.intensity = vec3Of(d.intensity);
  light.range = d.range;
  require(d.inner_cone_angle >= 0 && d.outer_cone_angle >= d.inner_cone_angle && d.outer_cone_angle <= kPi,
          "light: cone angles are not 0 <= inner <= outer <= pi");
  light.innerConeCos = std::cos(d.inner_cone_angle);
  light.outerConeCos = std::cos(d.outer_cone_angle);
  light.angularRadius = d.angular_radius;
  return light;
}

Sky skyOf(const lambent_sky_desc* given) {
  const lambent_sky_desc d = read(given, "sky");
  requireWithin(d.type, 2, "sky: type");
  const vec3 radiance = vec3Of(d.radiance), sun = vec3Of(d.towards_sun);
  if (d.type == LAMBENT_CONSTANT_SKY) {
    require(isFinite(radiance) && std::min({radiance.x, radiance.y, radiance.z}) >= 0 && maxComponent(radiance) < 1e30f,
            "sky: radiance is below 0, or not finite");
    return Sky(radiance);
  }
  const float length = glm::length(sun);
  require(length > 0 && std::isfinite(length), "sky: towards_sun has no length");
  require(std::isfinite(d.turbidity), "sky: turbidity is not a number");
  return Sky::daylight(sun / length, d.turbidity);
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

CameraView cameraOf(const lambent_frame& f, const View& view) {
  CameraView camera;
  camera.worldFromView = mat4Of(f.world_from_view);
  const mat3 rotation(camera.worldFromView);
  const mat3 off = glm::transpose(rotation) * rotation - mat3(1);
  float most = 0;
  for (int i = 0; i < 3; ++i) most = std::max(most, maxComponent(glm::abs(off[i])));
  constexpr float kRigid = 1e-3f;
  const mat4& m = camera.worldFromView;
  require(isFinite(m) && most <= kRigid && glm::determinant(rotation) > 0 && m[0][3] == 0 && m[1][3] == 0 &&
              m[2][3] == 0 && m[3][3] == 1,
          "frame: world_from_view is not rigid (columns one after the other; no scale, no mirroring)");
  require(isNear(camera.position()), "frame: the camera is farther than 1e12 m");
  camera.fovY = f.fov_y;
  camera.orthoHalfHeight = f.ortho_half_height;
  camera.near = f.near_plane;
  require(f.ortho_half_height >= 0 && f.ortho_half_height < 1e12f, "frame: ortho_half_height is not a length");
  require(f.ortho_half_height > 0 || (f.fov_y > 1e-3f && f.fov_y < 3.14f), "frame: fov_y is not within 0.001 and 3.14");
  require(f.near_plane >= 1e-9f && f.near_plane < 1e12f, "frame: near_plane is not within 1e-9 and 1e12");
  require(f.far_plane > f.near_plane, "frame: far_plane is not beyond near_plane");
  require(f.ortho_half_height == 0 || std::isfinite(f.far_plane) || f.depth_type == LAMBENT_DEPTH_LINEAR ||
              f.depth == 0,
          "frame: parallel rays need a finite far_plane");
  camera.width = view.width;
  camera.height = view.height;
  return camera;
}

HostSurfaces surfacesOf(const lambent_frame& f) {
  requireWithin(f.depth_type, 3, "frame: depth_type");
  requireWithin(f.normal_type, 4, "frame: normal_type");
  requireWithin(f.normal_space, 2, "frame: normal_space");
  HostSurfaces host{.depth = f.depth, .normal = f.normal, .emission = f.emission};
  HostConventions& c = host.conventions;
  c.depth = f.depth_type == LAMBENT_DEPTH_FORWARD    ? HostDepth::Forward
            : f.depth_type == LAMBENT_DEPTH_REVERSED ? HostDepth::Reversed
                                                     : HostDepth::Linear;
  c.depthMinusOne = f.depth_minus_one != 0;
  c.near = f.near_plane;
  c.far = f.far_plane;
  c.normals = HostNormals(int(f.normal_type));
  c.viewSpace = f.normal_space == LAMBENT_VIEW;
  c.originTop = f.origin_top != 0;
  c.x = f.x;
  c.y = f.y;
  return host;
}

/// For tests of what a fault in the library does to a host: LAMBENT_FAULT=call or worker has the next frames meet one.
void provokeFault() {
  const char* const where = std::getenv("LAMBENT_FAULT");
  if (!where) return;
  if (std::string(where) == "call") CHECK(where == nullptr);
  if (std::string(where) == "worker") parallelFor(64, 1, [](size_t begin, size_t) { CHECK_LT(begin, size_t(60)); });
}

/// The points of a query as surfaces.
std::vector<SurfaceHit> pointsOf(const float* points, const float* normals, size_t count) {
  require(count == 0 || (points && normals), "points or normals are NULL");
  std::vector<SurfaceHit> hits(count);
  const auto places = spanOf<vec3>(points, count), directions = spanOf<vec3>(normals, count);
  for (size_t i = 0; i < count; ++i) {
    const float length = glm::length(directions[i]);
    if (!isNear(places[i]) || !(length > 0) || !std::isfinite(length))
      refuse("point " + std::to_string(i) + " is not finite, or its normal has no length");
    hits[i].t = 0;
    hits[i].position = places[i];
    hits[i].normal = hits[i].geometricNormal = directions[i] / length;
  }
  return hits;
}

void requireRendered(lambent_device& device, const View& view) {
  if (view.rendered != sceneOf(device, view.scene).host.assetsVersion())
    refuse("the view has not been rendered since meshes, materials or textures changed (lambent_render first)");
}

} // namespace

lambent_device::lambent_device(const lambent_device_desc& from)
    : desc(from), shaders(from.shader_folder ? from.shader_folder : ""), workers(from.threads),
      account(from.memory ? [d = from](int64_t bytes) { return d.memory(d.user, bytes) != 0; }
                          : std::function<bool(int64_t)>()) {
  const MemoryAccount::Scope scope(account);
  static std::atomic<uint64_t> last = 0;
  markLabel = "lambent/mark " + std::to_string(++last) + " " + std::to_string(uintptr_t(this));
  mark = gl::VertexArray(markLabel);
}

// The interface ------------------------------------------------------------------------------------------------------

extern "C" {

uint32_t lambent_version(void) { return LAMBENT_VERSION; }

#define LAMBENT_TEXT_(x) #x
#define LAMBENT_TEXT(x) LAMBENT_TEXT_(x)
const char* lambent_version_text(void) {
  return LAMBENT_TEXT(LAMBENT_VERSION_MAJOR) "." LAMBENT_TEXT(LAMBENT_VERSION_MINOR) "." LAMBENT_TEXT(
      LAMBENT_VERSION_PATCH);
}

const char* lambent_status_text(int status) {
  switch (status) {
  case LAMBENT_OK:
    return "ok";
  case LAMBENT_INVALID_ARGUMENT:
    return "invalid argument";
  case LAMBENT_INVALID_HANDLE:
    return "invalid handle";
  case LAMBENT_NO_CONTEXT:
    return "no OpenGL context";
  case LAMBENT_OUT_OF_MEMORY:
    return "out of memory";
  case LAMBENT_FAILED:
    return "failed";
  case LAMBENT_DEAD:
    return "dead device";
  case LAMBENT_BUSY:
    return "busy device";
  }
  return "no status";
}

lambent_status lambent_defaults(int kind, void* desc, size_t size) {
  struct Row {
    size_t size;
    void (*write)(void*, size_t);
  };
  static constexpr Row kRows[] = {{sizeof(lambent_device_desc), writeStandard<lambent_device_desc>},
                                  {sizeof(lambent_texture_desc), writeStandard<lambent_texture_desc>},
                                  {sizeof(lambent_material_desc), writeStandard<lambent_material_desc>},
                                  {sizeof(lambent_mesh_desc), writeStandard<lambent_mesh_desc>},
                                  {sizeof(lambent_light_desc), writeStandard<lambent_light_desc>},
                                  {sizeof(lambent_sky_desc), writeStandard<lambent_sky_desc>},
                                  {sizeof(lambent_view_desc), writeStandard<lambent_view_desc>},
                                  {sizeof(lambent_frame), writeStandard<lambent_frame>},
                                  {sizeof(lambent_output), writeStandard<lambent_output>}};
  return guarded(messageWithoutDevice, [&] {
    requireWithin(kind, std::size(kRows), "kind");
    require(desc != nullptr, "descriptor is NULL");
    const Row& row = kRows[kind];
    if (size != row.size)
      refuse("a descriptor of this kind has " + std::to_string(row.size) + " bytes in version " +
             lambent_version_text() + ", not " + std::to_string(size));
    row.write(desc, size);
  });
}

lambent_status lambent_create(const lambent_device_desc* given, lambent_device** device) {
  if (device) *device = nullptr;
  return guarded(messageWithoutDevice, [&] {
    require(device != nullptr, "device is NULL");
    const lambent_device_desc desc = given ? read(given, "device") : standard<lambent_device_desc>();
    require(desc.threads >= 0 && desc.threads <= 1024, "device: threads is not within 0 and 1024");
    try {
      gl::requireContext();
    } catch (const RunError& e) {
      refuse(LAMBENT_NO_CONTEXT, e.what());
    }
    auto made = std::make_unique<lambent_device>(desc);
    const std::lock_guard lock(devicesMutex);
    devices().insert(made.get());
    *device = made.release();
  });
}

void lambent_destroy(lambent_device* device) {
  if (!device || !isLive(device) || device->busy.exchange(true)) return;
  const lambent_status context = guarded(messageWithoutDevice, [&] { requireOwnContext(*device); });
  {
    const std::lock_guard lock(devicesMutex);
    devices().erase(device);
  }
  if (context != LAMBENT_OK) { // without its context nothing of it can be given back
    guarded(messageWithoutDevice,
            [&] { device->log(LAMBENT_ERROR, "destroyed without its OpenGL context: its memory stays"); });
    return;
  }
  guarded(messageWithoutDevice, [&] {
    const gl::StateGuard guard;
    const std::unique_ptr<lambent_device> gone(device);
    const MemoryAccount::Scope account(gone->account);
    gone->workers.run([&] { gone->views.clear(); });
    gone->mark = {};
  });
}

const char* lambent_message(const lambent_device* device) {
  return device && isLive(device) ? device->message.c_str() : messageWithoutDevice.c_str();
}

lambent_status lambent_memory(lambent_device* device, lambent_memory_row* rows, size_t* count) {
  return call(device, Gl::NotNeeded, [&] {
    require(count != nullptr && (rows != nullptr || *count == 0), "rows or count is NULL");
    std::vector<MemoryAccount::Row> held = device->account.rows();
    uint64_t scenes = 0;
    for (const auto& [id, scene] : device->scenes) scenes += scene.host.bytes();
    if (scenes > 0) held.push_back({"scenes", false, scenes});
    for (size_t i = 0; i < std::min(*count, held.size()); ++i) {
      rows[i] = {};
      held[i].owner.copy(rows[i].owner, sizeof rows[i].owner - 1);
      rows[i].gpu = held[i].gpu;
      rows[i].bytes = held[i].bytes;
    }
    *count = held.size();
  });
}

// Scene ---------------------------------------------------------------------------------------------------------------

lambent_status lambent_scene_create(lambent_device* device, lambent_scene* scene) {
  return call(device, Gl::NotNeeded, [&] {
    require(scene != nullptr, "scene is NULL");
    if (device->given >= kMostGiven) refuse(LAMBENT_FAILED, "a device gives 16 million scenes and views at most");
    const uint64_t id = idOf(Kind::Scene, ++device->given, 0);
    device->scenes.emplace(std::piecewise_construct, std::forward_as_tuple(id), std::forward_as_tuple());
    *scene = id;
  });
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
    settle(*device, scene);
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

lambent_status lambent_material_create(lambent_device* device, lambent_scene scene, const lambent_material_desc* given,
                                       lambent_material* material) {
  return call(device, Gl::NotNeeded, [&] {
    Scene& s = sceneOf(*device, scene);
    const lambent_material_desc d = read(given, "material");
    require(material != nullptr, "material is NULL");
    const auto textureOf = [&](lambent_texture id) -> TextureRef {
      if (id == 0) return {};
      return s.textures[knownOf(Kind::Texture, scene, id, "texture", s.host, &HostScene::hasTexture)];
    };
    Material m;
    m.baseColor = vec3Of(d.base_color);
    m.baseColorTexture = textureOf(d.base_texture);
    m.emission = vec3Of(d.emission);
    m.emissiveTexture = textureOf(d.emission_texture);
    m.doubleSided = d.double_sided != 0;
    m.alphaMode = d.masked ? AlphaMode::Mask : AlphaMode::Opaque;
    m.alphaCutoff = d.alpha_cutoff;
    settle(*device, scene);
    *material = idOf(Kind::Material, serialOf(scene), s.host.addMaterial(m));
  });
}

lambent_status lambent_mesh_create(lambent_device* device, lambent_scene scene, const lambent_mesh_desc* given,
                                   lambent_mesh* mesh) {
  return call(device, Gl::NotNeeded, [&] {
    Scene& s = sceneOf(*device, scene);
    const lambent_mesh_desc d = read(given, "mesh");
    require(mesh != nullptr, "mesh is NULL");
    require(d.positions && d.indices, "mesh: positions or indices are NULL");
    require(d.parts || d.part_count == 0, "mesh: parts is NULL");
    const auto materialOf = [&](lambent_material id) -> uint32_t {
      return id == 0 ? 0 : knownOf(Kind::Material, scene, id, "material", s.host, &HostScene::hasMaterial);
    };
    std::vector<HostMesh::Part> parts;
    for (const lambent_part& part : std::span(d.parts, d.part_count))
      parts.push_back({part.first_triangle, part.triangle_count, materialOf(part.material)});
    settle(*device, scene);
    const uint32_t number = s.host.addMesh({.name = d.name ? std::string(d.name).substr(0, 200) : std::string(),
                                            .positions = spanOf<vec3>(d.positions, d.vertex_count),
                                            .normals = spanOf<vec3>(d.normals, d.vertex_count),
                                            .uvs = spanOf<vec2>(d.uvs, d.vertex_count),
                                            .colors = spanOf<vec4>(d.colors, d.vertex_count),
                                            .triangles = spanOf<uvec3>(d.indices, d.triangle_count),
                                            .parts = parts,
                                            .material = materialOf(d.material)});
    *mesh = idOf(Kind::Mesh, serialOf(scene), number);
  });
}

lambent_status lambent_mesh_destroy(lambent_device* device, lambent_scene scene, lambent_mesh mesh) {
  return call(device, Gl::NotNeeded, [&] {
    HostScene& host = sceneOf(*device, scene).host;
    const uint32_t number = knownOf(Kind::Mesh, scene, mesh, "mesh", host, &HostScene::hasMesh);
    settle(*device, scene);
    host.removeMesh(number);
  });
}

lambent_status lambent_instance_create(lambent_device* device, lambent_scene scene, lambent_mesh mesh,
                                       const float world_from_object[16], lambent_instance* instance) {
  return call(device, Gl::NotNeeded, [&] {
    HostScene& host = sceneOf(*device, scene).host;
    require(instance != nullptr, "instance is NULL");
    const uint32_t number = knownOf(Kind::Mesh, scene, mesh, "mesh", host, &HostScene::hasMesh);
    *instance = idOf(Kind::Instance, serialOf(scene), host.addInstance(number, mat4Of(world_from_object)));
  });
}

lambent_status lambent_instance_move(lambent_device* device, lambent_scene scene, lambent_instance instance,
                                     const float world_from_object[16]) {
  return call(device, Gl::NotNeeded, [&] {
    HostScene& host = sceneOf(*device, scene).host;
    host.moveInstance(knownOf(Kind::Instance, scene, instance, "instance", host, &HostScene::hasInstance),
                      mat4Of(world_from_object));
  });
}

lambent_status lambent_instance_deform(lambent_device* device, lambent_scene scene, lambent_instance instance,
                                       const float* positions, const float* normals, uint32_t vertex_count) {
  return call(device, Gl::NotNeeded, [&] {
    HostScene& host = sceneOf(*device, scene).host;
    const uint32_t number = knownOf(Kind::Instance, scene, instance, "instance", host, &HostScene::hasInstance);
    require(!positions || vertex_count > 0, "instance: vertex_count is 0");
    host.deformInstance(number, spanOf<vec3>(positions, vertex_count), spanOf<vec3>(normals, vertex_count));
  });
}

lambent_status lambent_instance_destroy(lambent_device* device, lambent_scene scene, lambent_instance instance) {
  return call(device, Gl::NotNeeded, [&] {
    HostScene& host = sceneOf(*device, scene).host;
    host.removeInstance(knownOf(Kind::Instance, scene, instance, "instance", host, &HostScene::hasInstance));
  });
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
    host.setLight(knownOf(Kind::Light, scene, light, "light", host, &HostScene::hasLight), lightOf(desc));
  });
}

lambent_status lambent_light_destroy(lambent_device* device, lambent_scene scene, lambent_light light) {
  return call(device, Gl::NotNeeded, [&] {
    HostScene& host = sceneOf(*device, scene).host;
    host.removeLight(knownOf(Kind::Light, scene, light, "light", host, &HostScene::hasLight));
  });
}

lambent_status lambent_sky_sun(const lambent_sky_desc* given, float irradiance[3], float* angular_radius) {
  return guarded(messageWithoutDevice, [&] {
    const Sky sky = skyOf(given);
    require(given->type == LAMBENT_CLEAR_SKY, "sky: only a clear one has a sun");
    const vec3 sun = daylightSun(glm::normalize(vec3Of(given->towards_sun)), given->turbidity);
    if (irradiance) std::copy(&sun.x, &sun.x + 3, irradiance);
    if (angular_radius) *angular_radius = kSunRadius;
  });
}

lambent_status lambent_sky_radiance(const lambent_sky_desc* given, const float* directions, size_t count,
                                    float* radiance) {
  return guarded(messageWithoutDevice, [&] {
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

lambent_status lambent_scene_sky(lambent_device* device, lambent_scene scene, const lambent_sky_desc* given) {
  return call(device, Gl::NotNeeded, [&] {
    HostScene& host = sceneOf(*device, scene).host;
    host.setSky(skyOf(given));
  });
}

// View ----------------------------------------------------------------------------------------------------------------

lambent_status lambent_view_create(lambent_device* device, lambent_scene scene, const lambent_view_desc* given,
                                   lambent_view* view) {
  return call(device, Gl::Needed, [&] {
    sceneOf(*device, scene);
    const lambent_view_desc d = read(given, "view");
    require(view != nullptr, "view is NULL");
    require(d.width >= 1 && d.height >= 1 && d.width <= 16384 && d.height <= 16384,
            "view: width and height are not within 1 and 16384");
    if (device->given >= kMostGiven) refuse(LAMBENT_FAILED, "a device gives 16 million scenes and views at most");
    const gl::StateGuard guard;
    auto made = std::make_unique<View>(scene, d, device->desc.seed, device->shaders);
    const uint64_t id = idOf(Kind::View, ++device->given, 0);
    device->views.emplace(id, std::move(made));
    *view = id;
  });
}

lambent_status lambent_view_destroy(lambent_device* device, lambent_view view) {
  return call(device, Gl::Needed, [&] {
    viewOf(*device, view);
    const gl::StateGuard guard;
    device->views.erase(view);
  });
}

lambent_status lambent_view_resize(lambent_device* device, lambent_view view, int width, int height) {
  return call(device, Gl::NotNeeded, [&] {
    View& v = viewOf(*device, view);
    require(width >= 1 && height >= 1 && width <= 16384 && height <= 16384,
            "view: width and height are not within 1 and 16384");
    v.width = width;
    v.height = height;
  });
}

lambent_status lambent_view_preset(lambent_device* device, lambent_view view, const char* preset) {
  return call(device, Gl::NotNeeded, [&] {
    View& v = viewOf(*device, view);
    require(preset != nullptr, "preset is NULL");
    if (std::string(preset) != "default") return applyPreset(v.gi.settings(), preset);
    for (const auto& [setting, value] : presetTable().front().set) // what presets are about
      applySetting(v.gi.settings(), setting, settingText({}, setting));
  });
}

lambent_status lambent_view_set(lambent_device* device, lambent_view view, const char* setting, const char* value) {
  return call(device, Gl::NotNeeded, [&] {
    View& v = viewOf(*device, view);
    require(setting != nullptr && value != nullptr, "setting or value is NULL");
    Settings changed = v.gi.settings();
    if (std::string(setting) == "technique")
      applyTechnique(changed, std::string(value));
    else
      applySetting(changed, setting, value);
    if (const std::string reason = whyNot(changed); !reason.empty()) refuse(std::string(setting) + ": " + reason);
    v.gi.settings() = changed;
  });
}

lambent_status lambent_view_get(lambent_device* device, lambent_view view, const char* setting, char* value,
                                size_t size) {
  return call(device, Gl::NotNeeded, [&] {
    View& v = viewOf(*device, view);
    require(setting != nullptr && value != nullptr && size > 0, "setting or value is NULL, or has no room");
    const std::string text = std::string(setting) == "technique" ? std::string(techniqueOf(v.gi.settings()).name)
                                                                 : settingText(v.gi.settings(), setting);
    if (text.size() + 1 > size)
      refuse("the value of " + std::string(setting) + " needs " + std::to_string(text.size() + 1) + " bytes");
    std::memcpy(value, text.c_str(), text.size() + 1);
  });
}

lambent_status lambent_render(lambent_device* device, lambent_view view, const lambent_frame* given,
                              lambent_output* output) {
  return call(device, Gl::Needed, [&] {
    const auto begin = std::chrono::steady_clock::now();
    View& v = viewOf(*device, view);
    HostScene& host = sceneOf(*device, v.scene).host;
    const lambent_frame f = read(given, "frame");
    if (output) read(output, "output");
    require((f.depth == 0) == (f.normal == 0), "frame: depth or normal is missing (both, or neither)");
    require(std::isfinite(f.time), "frame: time is not finite");
    const CameraView camera = cameraOf(f, v);
    const HostSurfaces surfaces = surfacesOf(f);
    const bool hosted = f.depth != 0;
    if (hosted) checkHost(surfaces, camera); // before the view is taken: a call that fails changes nothing

    const auto targetOf = [&](uint32_t texture) { return DeliveryTarget{texture, f.x, f.y, f.origin_top != 0}; };
    for (const uint32_t texture : {f.indirect_out, f.direct_out})
      for (const uint32_t other : {f.depth, f.normal, f.emission, v.gi.indirectIrradiance(), v.gi.directIrradiance()})
        require(texture == 0 || texture != other, "frame: light cannot go into a texture that it is read from");
    require(f.indirect_out == 0 || f.indirect_out != f.direct_out,
            "frame: indirect_out and direct_out are one texture");
    const gl::StateGuard guard;
    provokeFault();
    for (const uint32_t texture : {f.indirect_out, f.direct_out}) Delivery::check(v.width, v.height, targetOf(texture));
    v.rendered = 0;
    try {
      v.gi.run(host.view(v.changes, camera, f.time), {}, hosted ? &surfaces : nullptr);
    } catch (...) {
      v.changes = {}; // what changed has not been seen
      throw;
    }
    v.rendered = host.assetsVersion();
    if (const std::string& warning = v.gi.stats().warning; !warning.empty()) device->log(LAMBENT_WARNING, warning);
    if (hosted && v.checked != surfaces.conventions) {
      v.checked = surfaces.conventions;
      const std::string wrong = library::checkSurfaces(v.gi.outputs().surfaces, camera, v.gi.rays());
      if (!wrong.empty()) device->log(LAMBENT_WARNING, "frame: " + wrong);
    }
    const auto deliver = [&](uint32_t light, uint32_t to, int index) {
      return v.delivery.run(light, v.width, v.height, targetOf(to), index);
    };
    lambent_output out = standard<lambent_output>();
    out.indirect = deliver(v.gi.indirectIrradiance(), f.indirect_out, 0);
    out.direct = deliver(v.gi.directIrradiance(), f.direct_out, 1);
    const FrameOutputs& made = v.gi.outputs();
    if (!hosted) {
      const auto name = [](const gl::Texture* texture) { return texture ? texture->name() : 0; };
      out.depth = name(made.surfaces.depth);
      out.normal = name(made.surfaces.normal);
      out.albedo = name(made.surfaces.albedo);
      out.emission = name(made.surfaces.emission);
    }
    out.converged = v.gi.converged();
    out.milliseconds = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    if (!output) return;
    out.size = output->size;
    std::memcpy(output, &out, output->size);
  });
}

lambent_status lambent_irradiance(lambent_device* device, lambent_view view, const float* points, const float* normals,
                                  size_t count, float* indirect, float* direct) {
  return call(device, Gl::NotNeeded, [&] {
    const View& v = viewOf(*device, view);
    requireRendered(*device, v);
    const std::vector<SurfaceHit> hits = pointsOf(points, normals, count);
    const auto give = [&](float* to, std::vector<vec3> (GiFrame::*light)(std::span<const SurfaceHit>) const) {
      if (!to || count == 0) return;
      const std::vector<vec3> found = (v.gi.*light)(hits);
      std::memcpy(to, found.data(), count * sizeof(vec3));
    };
    give(indirect, &GiFrame::indirectAt);
    give(direct, &GiFrame::directAt);
  });
}

lambent_status lambent_irradiance_texture(lambent_device* device, lambent_view view, const float* points,
                                          const float* normals, size_t count, int width, uint32_t* indirect,
                                          uint32_t* direct) {
  return call(device, Gl::Needed, [&] {
    View& v = viewOf(*device, view);
    requireRendered(*device, v);
    require(width >= 1 && width <= 16384 && count >= 1 && count <= size_t(width) * 16384,
            "the texture's width, or its height for so many points, is not within 1 and 16384");
    const std::vector<SurfaceHit> hits = pointsOf(points, normals, count);
    const gl::StateGuard guard;
    const int height = int((count + size_t(width) - 1) / size_t(width));
    const auto give = [&](uint32_t* to, gl::Texture& texture,
                          std::vector<vec3> (GiFrame::*light)(std::span<const SurfaceHit>) const) {
      if (!to) return;
      std::vector<vec4> texels;
      for (const vec3& e : (v.gi.*light)(hits)) texels.emplace_back(e, 1);
      texels.resize(size_t(width) * size_t(height), vec4(0));
      if (!texture || texture.width() != width || texture.height() != height)
        texture = gl::Texture("library/points", {.format = GL_RGBA32F, .width = width, .height = height});
      glTextureSubImage2D(texture.name(), 0, 0, 0, width, height, GL_RGBA, GL_FLOAT, texels.data());
      *to = texture.name();
    };
    give(indirect, v.points[0], &GiFrame::indirectAt);
    give(direct, v.points[1], &GiFrame::directAt);
  });
}

lambent_status lambent_check(lambent_check_function report, void* user) {
  bool works = true;
  const lambent_status status = guarded(messageWithoutDevice, [&] {
    try {
      gl::requireContext();
    } catch (const RunError& e) {
      if (report) report(user, 0, e.what());
      refuse(LAMBENT_NO_CONTEXT, e.what());
    }
    works = library::checkDriver([&](bool ok, const std::string& line) {
      if (report) report(user, ok, line.c_str());
    });
    if (!works) refuse(LAMBENT_FAILED, "something does not work with this driver (see the report)");
  });
  return status == LAMBENT_DEAD ? LAMBENT_FAILED : status;
}

} // extern "C"

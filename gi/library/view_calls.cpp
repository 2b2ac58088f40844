// Calls of lambent.h about views: settings, frames, light at points.
#include "engine/gl/state_guard.h"
#include "gi/contract/frame_outputs.h"
#include "gi/library/border.h"
#include "gi/library/surface_check.h"
#include "gi/plan/presets.h"
#include "gi/surfaces/surfaces.h"

#include <chrono>
#include <cmath>
#include <cstdlib>

using namespace lambent;
using namespace lambent::library;

namespace {

void requireSize(int width, int height) {
  require(width >= 1 && height >= 1 && width <= 16384 && height <= 16384,
          "view: width and height are not within 1 and 16384");
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
  c.viewSpace = f.normal_space == LAMBENT_SPACE_VIEW;
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
    refuse("the view has not been rendered since a material changed, or meshes, materials or textures went "
           "(lambent_render first)");
}

} // namespace

extern "C" {

lambent_status lambent_view_create(lambent_device* device, lambent_scene scene, const lambent_view_desc* given,
                                   lambent_view* view) {
  return call(device, Gl::Needed, [&] {
    sceneOf(*device, scene);
    const lambent_view_desc d = read(given, "view");
    require(view != nullptr, "view is NULL");
    requireSize(d.width, d.height);
    const gl::StateGuard guard;
    auto made = std::make_unique<View>(scene, d, device->desc.seed, device->shaders);
    const uint64_t id = idOf(Kind::View, nextSerial(), 0);
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
    requireSize(width, height);
    v.width = width;
    v.height = height;
  });
}

lambent_status lambent_view_preset(lambent_device* device, lambent_view view, const char* preset) {
  return call(device, Gl::NotNeeded, [&] {
    View& v = viewOf(*device, view);
    require(preset != nullptr, "preset is NULL");
    Settings changed = v.gi.settings();
    applyPreset(changed, preset);
    if (const std::string reason = whyNot(changed); !reason.empty()) refuse(std::string(preset) + ": " + reason);
    v.gi.settings() = changed;
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
    if (const std::string& warning = v.gi.stats().warning; !warning.empty()) device->log(LAMBENT_LOG_WARNING, warning);
    if (hosted && v.checked != surfaces.conventions) {
      v.checked = surfaces.conventions;
      const std::string wrong = checkSurfaces(v.gi.outputs().surfaces, camera, v.gi.rays());
      if (!wrong.empty()) device->log(LAMBENT_LOG_WARNING, "frame: " + wrong);
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

} // extern "C"

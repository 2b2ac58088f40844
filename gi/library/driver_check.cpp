#include "gi/library/driver_check.h"

#include "engine/core/error.h"
#include "engine/gl/state_guard.h"
#include "gi/contract/frame_outputs.h"
#include "gi/frame/gi_frame.h"
#include "gi/host/host_scene.h"
#include "gi/vpl/smc.h"

#include <cmath>
#include <cstdio>

namespace lambent::library {

namespace {

constexpr int kWidth = 48, kHeight = 32;
constexpr int kFrames = 10; // that are averaged

std::string number(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", v);
  return text;
}

/// A grey room with a block, a lamp, and a patch of its ceiling that glows.
HostScene room() {
  HostScene scene;
  const auto box = [&](const vec3& lo, const vec3& hi, bool inward) {
    std::vector<vec3> positions;
    std::vector<uvec3> triangles;
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) {
        const uint32_t first = uint32_t(positions.size());
        for (int corner = 0; corner < 4; ++corner) {
          vec3 p;
          p[axis] = side ? hi[axis] : lo[axis];
          const int u = (axis + 1) % 3, v = (axis + 2) % 3;
          p[u] = corner == 1 || corner == 2 ? hi[u] : lo[u];
          p[v] = corner >= 2 ? hi[v] : lo[v];
          positions.push_back(p);
        }
        const bool turned = (side == 0) != inward; // counter-clockwise from where it is seen
        for (const uvec3& t : {uvec3(0, 1, 2), uvec3(0, 2, 3)})
          triangles.push_back(first + (turned ? uvec3(t.x, t.z, t.y) : t));
      }
    scene.addInstance(scene.addMesh({.name = "box", .positions = positions, .triangles = triangles}), mat4(1));
  };
  box(vec3(-1), vec3(1), true);
  box({-0.6f, -1, -0.7f}, {0, -0.2f, -0.1f}, false);
  Material glow;
  glow.emission = vec3(3);
  const uint32_t material = scene.addMaterial(glow);
  const std::vector<vec3> corners{{0.2f, 0.98f, -0.4f}, {0.6f, 0.98f, -0.4f}, {0.6f, 0.98f, 0}, {0.2f, 0.98f, 0}};
  const std::vector<uvec3> halves{uvec3(0, 1, 2), uvec3(0, 2, 3)}; // seen from below
  scene.addInstance(scene.addMesh({.name = "glow", .positions = corners, .triangles = halves, .material = material}),
                    mat4(1));
  LightView lamp;
  lamp.position = {0.3f, 0.5f, 0.4f};
  lamp.intensity = vec3(1);
  scene.addLight(lamp);
  return scene;
}

struct Checks {
  const std::function<void(bool, const std::string&)>& report;
  HostScene scene = room();
  CameraView camera = {};
  std::vector<SurfaceHit> seen = {}; // by the pixels
  bool works = true;

  void tell(bool ok, const std::string& line) {
    works = works && ok;
    report(ok, line);
  }

  Settings settings(const Technique& technique) const {
    Settings s;
    s.smc.vpls = s.smc.points = 256;
    s.smc.warmup = 8;
    s.shadow.resolution = 64;
    applyTechnique(s, technique);
    return s;
  }

  double meanOf(const gl::Texture* texture, bool& finite) const {
    if (!texture) return 0;
    std::vector<vec4> texels(size_t(kWidth) * kHeight);
    texture->read(std::span(texels), GL_RGBA, GL_FLOAT);
    double sum = 0;
    for (const vec4& t : texels) {
      finite = finite && isFinite(vec3(t));
      sum += double(luminance(vec3(t))) / double(texels.size());
    }
    return sum;
  }
  static double meanOf(const std::vector<vec3>& values) {
    double sum = 0;
    for (const vec3& v : values) sum += double(luminance(v)) / double(values.size());
    return sum;
  }

  /// Depth of what the rasteriser drew, against rays.
  void surfaces(const GiFrame& gi) {
    const GBuffer& drawn = gi.outputs().surfaces;
    std::vector<float> depth(size_t(kWidth) * kHeight);
    drawn.depth->read(std::span(depth), GL_DEPTH_COMPONENT, GL_FLOAT);
    size_t off = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const SurfaceHit& h = seen[size_t(y) * kWidth + size_t(x)];
        const float distance = glm::dot(h.position - camera.position(), -vec3(camera.worldFromView[2]));
        const float stored = depth[size_t(kHeight - 1 - y) * kWidth + size_t(x)];
        off += !(std::abs(camera.near / stored - distance) < 0.01f * distance);
      }
    tell(off * 50 < depth.size(), "surfaces: " + std::to_string(off) + " of " + std::to_string(depth.size()) +
                                      " pixels lie elsewhere than rays say (edges: a few)");
  }

  void run(const std::string& name, const Settings& s, bool first) {
    try {
      GiFrame gi(s);
      ViewChanges changes;
      for (int frame = 0; frame < kFrames; ++frame) gi.run(scene.view(changes, camera, 0));
      if (first) {
        std::vector<vec2> centres;
        for (int y = 0; y < kHeight; ++y)
          for (int x = 0; x < kWidth; ++x) centres.push_back((vec2(x, y) + 0.5f) / vec2(kWidth, kHeight));
        seen = surfacesAt(gi.rays(), camera, centres);
        surfaces(gi);
        light("direct light", gi.outputs().direct.irradiance, meanOf(gi.directAt(seen)), 0.1);
      }
      const Needs needs = needsOf(s); // what is looked up in a store over the scene comes near only
      light(name, gi.outputs().indirect.irradiance, gi.vpls().slots.empty() ? 0 : meanOf(gi.indirectAt(seen)),
            needs.nearRays ? 0.1 : 0.5);
    } catch (const std::exception& e) {
      tell(false, name + ": " + e.what());
    }
    if (const GLenum error = glGetError(); error != GL_NO_ERROR)
      tell(false, name + ": OpenGL error " + std::to_string(error));
  }

  /// The same from a host's textures, with a block that moves: light that follows is what the first run had.
  void host() {
    try {
      const Settings s = settings(techniqueTable().front());
      GiFrame drawn(s), hosted(s);
      ViewChanges changes, hostChanges;
      for (int frame = 0; frame < kFrames; ++frame) {
        const float x = frame < kFrames / 2 ? 0.02f * float(frame) : 0;
        scene.moveInstance(1, mat4(vec4(1, 0, 0, 0), vec4(0, 1, 0, 0), vec4(0, 0, 1, 0), vec4(x, 0, 0, 1)));
        drawn.run(scene.view(changes, camera, 0));
        const GBuffer& own = drawn.outputs().surfaces;
        const HostSurfaces surfaces{.depth = own.depth->name(),
                                    .normal = own.normal->name(),
                                    .emission = own.emission->name(),
                                    .conventions = {.near = camera.near}};
        hosted.run(scene.view(hostChanges, camera, 0), {}, &surfaces);
      }
      bool finite = true;
      light("a host's G-buffer, direct light", hosted.outputs().direct.irradiance,
            meanOf(drawn.outputs().direct.irradiance, finite), 0.02);
      light("a host's G-buffer, indirect light", hosted.outputs().indirect.irradiance,
            meanOf(drawn.outputs().indirect.irradiance, finite), 0.05);
    } catch (const std::exception& e) {
      tell(false, std::string("a host's G-buffer: ") + e.what());
    }
  }

  /// `expected` 0: not known, but there is some.
  void light(const std::string& name, const gl::Texture* texture, double expected, double tolerance) {
    bool finite = true;
    const double mean = meanOf(texture, finite);
    const bool near = expected > 0 ? std::abs(mean / expected - 1) < tolerance : mean > 0;
    tell(finite && near, name + ": mean irradiance " + number(mean) + " W/m2" +
                             (expected > 0 ? ", by rays " + number(expected) : "") +
                             (finite ? "" : "; some pixels are no numbers"));
  }
};

} // namespace

bool checkDriver(const std::function<void(bool, const std::string&)>& report) {
  const gl::StateGuard guard;
  Checks checks{report};
  checks.camera = lookAt({0, 0, 0.95f}, {0, -0.1f, 0}, 1.3f);
  checks.camera.width = kWidth;
  checks.camera.height = kHeight;
  const auto text = [](GLenum what) { return std::string(reinterpret_cast<const char*>(glGetString(what))); };
  report(true, "OpenGL " + text(GL_VERSION) + ", " + text(GL_RENDERER));
  bool first = true;
  for (const Technique& technique : techniqueTable()) {
    checks.run(std::string("indirect light, ") + technique.name, checks.settings(technique),
               std::exchange(first, false));
  }
  const Technique& smc = techniqueTable().front();
  for (const char* mode : {"interleaved", "full", "multires", "multires-interleaved"}) {
    Settings s = checks.settings(smc);
    applySetting(s, "gather.mode", mode);
    checks.run(std::string("indirect light, gather.mode=") + mode, s, false);
  }
  for (const char* maker : {"raster", "rays"}) {
    Settings s = checks.settings(smc);
    applySetting(s, "shadow.maker", maker);
    checks.run(std::string("indirect light, shadow.maker=") + maker, s, false);
  }
  checks.host();
  return checks.works;
}

} // namespace lambent::library

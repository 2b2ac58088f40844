#include "gi/library/driver_check.h"

#include "engine/core/error.h"
#include "engine/gl/state_guard.h"
#include "gi/contract/frame_outputs.h"
#include "gi/frame/gi_frame.h"
#include "gi/host/host_scene.h"
#include "gi/vpl/smc.h"

#include <algorithm>
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

/// Adds a box of which the outside is seen, or the inside; `open`: without its upper side.
void addBox(HostScene& scene, const vec3& lo, const vec3& hi, bool inward, uint32_t material = 0, bool open = false) {
  std::vector<vec3> positions;
  std::vector<vec2> uvs;
  std::vector<uvec3> triangles;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      if (open && axis == 1 && side == 1) continue;
      const uint32_t first = uint32_t(positions.size());
      for (int corner = 0; corner < 4; ++corner) {
        vec3 p;
        p[axis] = side ? hi[axis] : lo[axis];
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        p[u] = corner == 1 || corner == 2 ? hi[u] : lo[u];
        p[v] = corner >= 2 ? hi[v] : lo[v];
        positions.push_back(p);
        uvs.emplace_back(p[u], p[v]);
      }
      const bool turned = (side == 0) != inward; // counter-clockwise from where it is seen
      for (const uvec3& t : {uvec3(0, 1, 2), uvec3(0, 2, 3)})
        triangles.push_back(first + (turned ? uvec3(t.x, t.z, t.y) : t));
    }
  scene.addInstance(
      scene.addMesh({.name = "box", .positions = positions, .uvs = uvs, .triangles = triangles, .material = material}),
      mat4(1));
}

/// A grey room with a block, a lamp, and a patch of its ceiling that glows.
HostScene room() {
  HostScene scene;
  addBox(scene, vec3(-1), vec3(1), true);
  addBox(scene, {-0.6f, -1, -0.7f}, {0, -0.2f, -0.1f}, false);
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

/// A court under a clear sky with its sun and a spot: walls of a checkered texture, and a grating, whose texture cuts
/// it out.
HostScene court() {
  HostScene scene;
  const auto textured = [&](const auto& texelAt, bool masked) {
    TextureImage image;
    image.width = image.height = 8;
    for (int i = 0; i < 64; ++i) image.texels.push_back(texelAt(i % 8, i / 8));
    Material m;
    m.baseColor = vec3(0.9f);
    m.baseColorTexture = {.image = scene.addTexture(std::move(image)), .nearest = true};
    m.alphaMode = masked ? AlphaMode::Mask : AlphaMode::Opaque;
    m.doubleSided = masked;
    return scene.addMaterial(m);
  };
  addBox(scene, vec3(-1), vec3(1), true,
         textured(
             [](int x, int y) { return (x / 4 + y / 4) % 2 ? u8vec4(230, 180, 120, 255) : u8vec4(90, 110, 160, 255); },
             false),
         true);
  addBox(scene, {-0.5f, -0.99f, -0.6f}, {0.3f, -0.1f, -0.55f}, false,
         textured([](int x, int) { return u8vec4(200, 200, 200, x % 4 < 2 ? 255 : 0); }, true));
  const vec3 towardsSun = glm::normalize(vec3(0.4f, 0.8f, 0.3f));
  LightView sun;
  sun.type = LightType::Directional;
  sun.direction = -towardsSun;
  sun.intensity = vec3(2);
  scene.addLight(sun);
  LightView spot;
  spot.type = LightType::Spot;
  spot.position = {-0.6f, 0.6f, 0.6f};
  spot.direction = glm::normalize(vec3(0.4f, -1, -0.6f));
  spot.intensity = vec3(2);
  spot.outerConeCos = 0.8f;
  spot.innerConeCos = 0.9f;
  scene.addLight(spot);
  scene.setSky(Sky::daylight(towardsSun, 3));
  return scene;
}

struct Checks {
  const std::function<void(bool, const std::string&)>& report;
  HostScene scene;
  CameraView camera;
  std::string where;                 // in what is reported; empty: the room
  std::vector<SurfaceHit> seen = {}; // by the pixels; not valid: nothing
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
  /// Of all pixels, by light at what is seen there.
  double meanAtSeen(const GiFrame& gi, std::vector<vec3> (GiFrame::*light)(std::span<const SurfaceHit>) const) const {
    std::vector<SurfaceHit> hits;
    std::ranges::copy_if(seen, std::back_inserter(hits), &SurfaceHit::valid);
    double sum = 0;
    for (const vec3& v : (gi.*light)(hits)) sum += double(luminance(v)) / double(seen.size());
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
        off += h.valid() ? !(std::abs(camera.near / stored - distance) < 0.01f * distance) : stored > 0;
      }
    tell(off * 50 < depth.size(), "surfaces" + where + ": " + std::to_string(off) + " of " +
                                      std::to_string(depth.size()) +
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
        if (camera.orthoHalfHeight == 0) surfaces(gi); // else light tells
        light("direct light" + where, gi.outputs().direct.irradiance, meanAtSeen(gi, &GiFrame::directAt), 0.1);
      }
      const Needs needs = needsOf(s); // what is looked up in a store over the scene comes near only
      light(name + where, gi.outputs().indirect.irradiance,
            gi.vpls().slots.empty() ? 0 : meanAtSeen(gi, &GiFrame::indirectAt), needs.nearRays ? 0.1 : 0.5);
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
  CameraView camera = lookAt({0, 0, 0.95f}, {0, -0.1f, 0}, 1.3f);
  camera.width = kWidth;
  camera.height = kHeight;
  Checks checks{report, room(), camera, ""};
  const auto text = [](GLenum what) { return std::string(reinterpret_cast<const char*>(glGetString(what))); };
  report(true, "OpenGL " + text(GL_VERSION) + ", " + text(GL_RENDERER));
  bool first = true;
  for (const Technique& technique : techniqueTable()) {
    checks.run(std::string("indirect light, ") + technique.name, checks.settings(technique),
               std::exchange(first, false));
  }
  // Every other way to the same light.
  const Technique& smc = techniqueTable().front();
  for (const auto& [setting, value] : {std::pair("gather.mode", "interleaved"),
                                       {"gather.mode", "full"},
                                       {"gather.mode", "multires"},
                                       {"gather.mode", "multires-interleaved"},
                                       {"shadow.maker", "raster"},
                                       {"shadow.maker", "rays"}}) {
    Settings s = checks.settings(smc);
    applySetting(s, setting, value);
    checks.run(std::string("indirect light, ") + setting + "=" + value, s, false);
  }
  checks.host();

  Checks open{report, court(), camera, " of a court (textures, masks, spot, sun and sky)"};
  open.run("indirect light", open.settings(smc), true);
  camera.orthoHalfHeight = 0.9f;
  Checks parallel{report, court(), camera, " of the court, seen in parallel"};
  parallel.run("indirect light", parallel.settings(smc), true);
  camera.orthoHalfHeight = 0;
  Checks patches{report, room(), camera, ", with lamps at patches, traced on the GPU"};
  Settings s = patches.settings(smc);
  applySetting(s, "shadow.emitters", "patches");
  applySetting(s, "area.tracer", "gpu");
  patches.run("indirect light", s, true);
  return checks.works && open.works && parallel.works && patches.works;
}

} // namespace lambent::library

#include "tools/launch/launch_light.h"

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/scene/sky_file.h"
#include "engine/trace/open_sky.h"
#include "gi/plan/techniques.h"

#include <algorithm>
#include <charconv>

namespace lambent {

namespace fs = std::filesystem;

namespace {

/// Comma-separated finite numbers, `least` to `most` of them.
std::vector<double> numbers(const std::string& option, const std::string& text, size_t least, size_t most) {
  std::vector<double> out;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at < end) {
    double value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !std::isfinite(float(value)) || (next != end && *next != ',')) break;
    out.push_back(value);
    at = next == end ? end : next + 1;
    if (next != end && at == end) out.clear(); // a trailing comma
  }
  if (out.size() < least || out.size() > most || at != end)
    throw InputError(option + " " + text, "needs " + (least < most ? std::to_string(least) + " to " : std::string()) +
                                              std::to_string(most) + " numbers separated by commas");
  return out;
}

} // namespace

dvec3 threeNumbers(const std::string& option, const std::string& text) {
  const std::vector<double> n = numbers(option, text, 3, 3);
  return {n[0], n[1], n[2]};
}

namespace {

/// Radiometric values are not negative.
vec3 lightValue(const std::string& option, const std::string& text, const vec3& v) {
  if (v.x < 0 || v.y < 0 || v.z < 0) throw InputError(option + " " + text, "light is negative (0 or more)");
  if (maxComponent(v) > kMostLight) throw InputError(option + " " + text, "light is beyond what pictures hold (1e30)");
  return v;
}

/// Radius of a sun's disk: --sun-size, or what is usual for it.
float sunRadius(const LaunchOptions& options, float usual) {
  if (!options.sunSize) return usual;
  if (!(*options.sunSize >= 0 && *options.sunSize <= 90))
    throw InputError("--sun-size", "is out of range (0 to 90 degrees across; the sun's is 0.53)");
  return glm::radians(0.5f * *options.sunSize);
}

LightView sunLight(const std::string& text, const LaunchOptions& options) {
  const std::vector<double> n = numbers("--sun", text, 6, 6);
  const dvec3 direction(n[0], n[1], n[2]);
  if (!(glm::length(direction) > 0)) throw InputError("--sun " + text, "the direction has no length");
  LightView light;
  light.type = LightType::Directional;
  light.direction = vec3(glm::normalize(direction));
  light.intensity = lightValue("--sun", text, {n[3], n[4], n[5]});
  light.angularRadius = sunRadius(options, 0);
  return light;
}

LightView pointLight(const std::string& text, const Scene& scene) {
  const std::vector<double> n = numbers("--point", text, 6, 6);
  LightView light;
  light.position = scene.fromOrigin(dvec3(n[0], n[1], n[2]));
  if (!isNear(light.position)) throw InputError("--point " + text, "is farther than 1e12 m away");
  light.intensity = lightValue("--point", text, {n[3], n[4], n[5]});
  return light;
}

/// --daylight: degrees.
struct Daylight {
  double elevation = 60, azimuth = 50, turbidity = 3;

  vec3 towardsSun() const {
    const double up = glm::radians(elevation), around = glm::radians(azimuth);
    return glm::normalize(vec3(std::cos(up) * std::sin(around), std::sin(up), std::cos(up) * std::cos(around)));
  }
};

void addSun(Scene& scene, const Daylight& daylight, float radius) {
  LightView sun;
  sun.type = LightType::Directional;
  sun.direction = -daylight.towardsSun();
  sun.intensity = daylightSun(daylight.towardsSun(), float(daylight.turbidity));
  sun.angularRadius = radius;
  if (maxComponent(sun.intensity) > 0) addLight(scene, sun, "sun");
}

/// A sky, and while it is up a sun that goes with it.
void addSkyAndSun(Scene& scene, const Daylight& daylight, float sunRadius) {
  scene.sky = Sky::daylight(daylight.towardsSun(), float(daylight.turbidity));
  addSun(scene, daylight, sunRadius);
}

Sky givenSky(LaunchContext& stage, const LaunchOptions& options) {
  const fs::path file = options.sky;
  if (!namesSky(file)) {
    if (options.skyScale != 1 || options.skyTurn != 0)
      throw InputError("--sky " + options.sky,
                       "is no picture, which --sky-scale and --sky-turn are for (.hdr or .exr)");
    if (options.sky.find_first_not_of("0123456789+-.,eE \t") != std::string::npos)
      throw InputError("--sky " + options.sky, "is neither a picture (.hdr, .exr) nor three numbers (r,g,b)");
    return lightValue("--sky", options.sky, vec3(threeNumbers("--sky", options.sky)));
  }
  for (const std::string& written : options.written)
    if (sameFile(file, written)) throw InputError(written, "the sky is read from this file (name another)");
  keepFromReplacing(file);
  const Sky sky = Sky::image(readSky(file, stage.notes), float(options.skyScale), float(glm::radians(options.skyTurn)));
  if (sky.black()) stage.notes.push_back(options.sky + " is black: the sky gives no light");
  return sky;
}

/// In place of the scene's own.
void replaceDaylight(LaunchContext& stage, const LaunchOptions& options) {
  const std::string given = "--daylight " + options.daylight;
  if (!options.sky.empty() || !options.suns.empty())
    throw InputError(given, std::string("is a sky and a sun of its own (leave out ") +
                                (options.sky.empty() ? "--sun)" : "--sky)"));
  const std::vector<double> n = numbers("--daylight", options.daylight, 1, 3);
  Daylight daylight{.elevation = n[0]};
  if (n.size() > 1) daylight.azimuth = n[1];
  if (n.size() > 2) daylight.turbidity = n[2];
  if (!(std::abs(daylight.elevation) <= 90)) throw InputError(given, "elevation is out of range (-90 to 90 degrees)");
  if (!(std::abs(daylight.azimuth) <= 360)) throw InputError(given, "azimuth is out of range (-360 to 360 degrees)");
  if (!(daylight.turbidity >= 2 && daylight.turbidity <= 10))
    throw InputError(given, "turbidity is out of range (2 to 10)");
  int suns = 0;
  stage.scene.registry.each<PunctualLight>([&](Entity e, PunctualLight& light) {
    if (light.type != LightType::Directional) return;
    const Name* name = stage.scene.registry.tryGet<Name>(e);
    const bool keyed = name && stage.shot && stage.shot->lights.erase(name->value) > 0;
    if (!keyed && !(maxComponent(light.intensity) > 0)) return;
    light.intensity = vec3(0);
    ++suns;
  });
  if (suns > 0)
    stage.notes.push_back("the scene's own sun, and what the shot does with it, gives way to that of --daylight");
  addSkyAndSun(stage.scene, daylight, sunRadius(options, kSunRadius));
}

bool hasEmitters(const Scene& scene) {
  for (const Mesh& mesh : scene.assets.meshes)
    for (const Primitive& p : mesh.primitives)
      if (scene.assets.materials[p.material].emits()) return true;
  return false;
}

/// Whether no more than decoration shines (nothing above radiance 1), in the open, and what is seen gets next to
/// nothing of it.
bool onlyGlows(const LaunchContext& stage, RaysOnce& rays) {
  const SceneView& view = rays.view();
  if (!view.lights.empty() || !view.sky.black()) return false;
  for (const Material& m : stage.scene.assets.materials)
    if (maxComponent(m.emission) > 1) return false;
  const std::vector<NamedCamera> cameras = sceneCameras(stage.scene); // not the person's: all views are lit alike
  const CameraView from = cameras.empty() ? defaultView(stage.scene) : cameras[0].view;
  if (!skyReaches(rays(), from.position())) return false;
  const Glow glow = glowOnSeen(rays(), from);
  constexpr float kMostShown = 0.1f, kDark = 0.01f;
  return glow.shown < kMostShown && glow.reaches < kDark;
}

/// Whether the sky is to be seen from the camera, or lights what is; else adds a lamp by the camera, for a sun would
/// leave a closed room black. `lack`: what the scene is without.
bool isOpenOrHasLamp(LaunchContext& stage, RaysOnce& rays, const std::string& lack) {
  const SceneView& view = rays.view();
  if (skyReaches(rays(), view.camera.position())) return true;
  const float size = view.boundsWorld.diameter();
  LightView light;
  light.position = view.camera.position() + vec3(view.camera.worldFromView[1]) * 0.01f * size;
  light.intensity = vec3(0.02f * size * size);
  addLight(stage.scene, light, "default light");
  stage.notes.push_back("the scene has no " + lack + ", and no sky reaches it: added a lamp by the camera (--point)");
  return false;
}

} // namespace

void addGivenLights(LaunchContext& stage, const LaunchOptions& options) {
  for (const std::string& text : options.suns) addLight(stage.scene, sunLight(text, options), "sun");
  for (const std::string& text : options.points) addLight(stage.scene, pointLight(text, stage.scene), "lamp");
  if (options.sky.empty() && (options.skyScale != 1 || options.skyTurn != 0))
    throw InputError("command line", "--sky-scale and --sky-turn are for a picture (--sky FILE)");
  if (!options.sky.empty()) stage.scene.sky = givenSky(stage, options);
  sunRadius(options, 0); // whether there is a sun or not
  if (!options.daylight.empty()) replaceDaylight(stage, options);
}

void lightWhatIsDark(LaunchContext& stage, const LaunchOptions& options, RaysOnce& rays) {
  const SceneView& view = rays.view();
  if (!options.sky.empty()) return; // which is what there shall be
  const bool lit = !view.lights.empty() || !view.sky.black() || hasEmitters(stage.scene);
  if (!lit && !view.instances.empty() && isOpenOrHasLamp(stage, rays, "light")) {
    addSkyAndSun(stage.scene, {}, sunRadius(options, kSunRadius));
    stage.notes.push_back(
        "the scene has no light: added a clear sky and its sun (--daylight 60; --sky 0,0,0 leaves it dark)");
  } else if (lit && onlyGlows(stage, rays)) {
    addSkyAndSun(stage.scene, {}, sunRadius(options, kSunRadius));
    stage.notes.push_back("what shines in the scene hardly lights it: added a clear sky and its sun (--daylight 60; "
                          "--sky 0,0,0 leaves it as it is)");
  }
}

void tellWhatIsLeftOut(LaunchContext& stage, const Settings& settings) {
  if (!needsOf(settings).reflective()) return;
  SceneExtractor probe;
  const SceneView view = probe.extract(stage.scene, stage.camera, 0);
  const std::string technique = "technique " + std::string(techniqueOf(settings).name);
  if (view.lights.empty() && (hasEmitters(stage.scene) || !view.sky.black()))
    stage.notes.push_back(technique +
                          " reflects punctual lights only, and there is none: no indirect light (--point, --sun)");
  else if (hasEmitters(stage.scene) || !view.sky.black())
    stage.notes.push_back(technique + " reflects punctual lights only: none of what glows or of the sky");
}

void needPunctualLight(LaunchContext& stage) {
  SceneExtractor probe;
  const SceneView view = probe.extract(stage.scene, stage.camera, 0);
  const bool lit = std::any_of(view.lights.begin(), view.lights.end(),
                               [](const LightView& light) { return maxComponent(light.intensity) > 0; });
  RaysOnce rays(view);
  if (!lit && !view.instances.empty() && isOpenOrHasLamp(stage, rays, "punctual light")) {
    addSun(stage.scene, {}, 0);
    stage.notes.push_back("the scene has no punctual light: added a sun (--sun)");
  }
}

} // namespace lambent

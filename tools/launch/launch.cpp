#include "tools/launch/launch.h"

#include "gi/plan/techniques.h"

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/free_memory.h"
#include "engine/core/parallel.h"
#include "engine/core/resources.h"
#include "engine/core/text.h"
#include "engine/gl/program.h"
#include "engine/scene/ray_work.h"
#include "engine/trace/open_sky.h"
#include "game/rules/props.h"
#include "gi/plan/asked_work.h"
#include "gi/plan/presets.h"
#include "tools/launch/launch_light.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <tuple>

namespace lambent {

namespace fs = std::filesystem;

namespace {

constexpr const char* kDefaultSize = "320x180";

/// For a person to type: nothing that a shell would take for more than a name.
std::string hintOfContent(const std::string& name) {
  const bool plain = !name.empty() && name[0] != '-' &&
                     std::ranges::all_of(name, [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '_'; });
  return plain ? " (a generated one: lambent content " + name + ")" : "";
}

/// Of a frame with all that the defaults ask for, and of what reads it back; measured: 346 (1920x1080 less 640x360,
/// llvmpipe).
constexpr size_t kBytesPerPixel = 400;

/// Whether a picture fits into this machine, before hours are spent on finding out. Throws RunError with the largest
/// picture of the same shape that fits, where a frame of this size would not. Of a GPU the memory is not known; a
/// driver that draws on the CPU takes the machine's.
void checkPictureFits(const CameraView& camera) {
  const size_t pixels = size_t(camera.width) * size_t(camera.height), free = freeMemory();
  if (pixels <= free / kBytesPerPixel) return;
  const auto gib = [](size_t bytes) {
    return std::to_string((bytes >> 29) / 2) + (bytes >> 29 & 1 ? ".5" : "") + " GiB";
  };
  const double side = std::sqrt(double(free / kBytesPerPixel) / double(pixels));
  const CameraView fits = camera.scaled(float(0.95 * side));
  throw RunError("a picture of " + std::to_string(camera.width) + "x" + std::to_string(camera.height) +
                 " needs about " + gib(pixels * kBytesPerPixel) + " of memory, " + gib(free) + " are free (" +
                 std::to_string(fits.width) + "x" + std::to_string(fits.height) + " would fit: --size)");
}

CameraView namedCamera(const Scene& scene, const std::string& name) {
  std::vector<std::string> names;
  for (const NamedCamera& c : sceneCameras(scene)) {
    if (c.name == name) return c.view;
    names.push_back(c.name);
  }
  const std::string near = nearestName(name, names);
  throw InputError(scene.file.string(), "no camera '" + name + "' (" +
                                            (names.empty()  ? "the file has none: use --eye and --target"
                                             : near.empty() ? "it has " + names[0]
                                                            : "did you mean " + near + "?") +
                                            ")");
}

void chooseCamera(LaunchContext& stage, const LaunchOptions& options) {
  const bool eye = !options.eye.empty();
  if (eye != !options.target.empty())
    throw InputError(eye ? "--eye " + options.eye : "--target " + options.target, "--eye and --target go together");
  if (options.fovDegrees && !(*options.fovDegrees > 1 && *options.fovDegrees < 179))
    throw InputError("--fov", "out of range (1 to 179 degrees)");
  const auto [width, height] = sizeOf(options.size.empty() ? kDefaultSize : options.size);
  const std::vector<NamedCamera> cameras = sceneCameras(stage.scene);
  if (eye && !options.camera.empty()) throw InputError("--camera " + options.camera, "and --eye exclude each other");
  stage.cameraGiven = eye || !options.camera.empty();
  if (eye) {
    const dvec3 from = threeNumbers("--eye", options.eye), to = threeNumbers("--target", options.target);
    if (from == to) throw InputError("--target " + options.target, "is where --eye is");
    if (!isNear(vec3(from))) throw InputError("--eye " + options.eye, "is farther than 1e12 m away");
    if (!isNear(vec3(to))) throw InputError("--target " + options.target, "is farther than 1e12 m away");
    stage.camera = lookAt(stage.scene.fromOrigin(from), stage.scene.fromOrigin(to), glm::radians(60.0f));
    stage.camera.near = std::min(stage.camera.near, 1e-3f * worldBounds(stage.scene).diameter()); // of small scenes
  } else if (!options.camera.empty()) {
    stage.camera = namedCamera(stage.scene, options.camera);
  } else if (!cameras.empty()) {
    stage.camera = cameras[0].view;
  } else {
    stage.camera = defaultView(stage.scene, float(width) / float(height));
    if (!stage.shot || stage.shot->camera.empty())
      stage.notes.push_back("the file has no camera: a default view was chosen (--eye, --target)");
  }
  if (!isNear(stage.camera.position()))
    throw InputError(stage.scene.file.string(), "its camera is farther than 1e12 m away (--eye, --target)");
  if (options.fovDegrees) stage.camera.fovY = glm::radians(*options.fovDegrees);
  std::tie(stage.camera.width, stage.camera.height) = std::pair(width, height);
  checkPictureFits(stage.camera);
}

/// The file was tried from its own first camera; another may look into what is slow.
void tryOtherCameras(LaunchContext& stage, const LaunchOptions& options) {
  constexpr int kTimes = 5; // of a shot's camera
  const FileTrust trust = options.trust;
  if (stage.cameraGiven || options.fovDegrees) requireQuickRays(stage.scene, stage.camera, trust);
  if (stage.cameraGiven || !stage.shot || stage.shot->camera.empty()) return;
  for (int i = 0; i < kTimes; ++i)
    requireQuickRays(stage.scene, shotCamera(*stage.shot, stage.shot->seconds * i / (kTimes - 1), stage.scene.origin),
                     trust);
}

/// What the first frames of a scene whose rays are slow leave for later ones.
void tellOfSlowRays(LaunchContext& stage, float rayWork) {
  const Settings& settings = stage.settings;
  const Needs needs = needsOf(settings);
  if (needs.maps && needs.sampled() && firstMapStep(settings.shadow.firstMaps, rayWork) > 1)
    stage.notes.push_back(
        "its rays are slow: where they draw shadow maps, the first are coarse and become whole (shadow.firstMaps)");
  const int warmup = warmupOf(settings.smc, rayWork);
  if (needs.lights == LightSupply::Kept && warmup < settings.smc.warmup)
    stage.notes.push_back("its rays are slow: " + std::to_string(warmup) + " iterations before the first frame, not " +
                          std::to_string(settings.smc.warmup) + " (smc.shortWarmup)");
}

/// Where the eye looks through most of what is before it, the picture is not what the person expects.
void tellOfHiddenBacks(LaunchContext& stage, RaysOnce& rays) {
  if (std::ranges::none_of(stage.scene.assets.materials, &Material::backHidden)) return;
  if (2 * shareLookedThrough(rays(), rays.view().camera) > 1)
    stage.notes.push_back("the camera looks through surfaces that are shown from their fronts alone (--two-sided shows "
                          "their backs)");
}

/// One note for each setting that is called by a name of before.
std::vector<std::string> notesOfRenamed(const LaunchOptions& options, const std::optional<Shot>& shot) {
  std::vector<std::string> names = options.set, notes;
  if (shot)
    for (const auto& [name, value] : shot->set) names.push_back(name);
  for (const std::string& text : names) {
    const std::string_view name = std::string_view(text).substr(0, text.find('='));
    const std::string_view now = presentName(name);
    if (now != name && name != "gather")
      notes.push_back("setting " + std::string(name) + " is called " + std::string(now) + " now");
  }
  return notes;
}

/// What a shot sets. Throws InputError that names the shot.
void applyShot(Settings& settings, const Shot& shot) {
  try {
    for (const auto& [name, value] : shot.set) applySetting(settings, name, value);
  } catch (const InputError& e) {
    throw InputError(shot.file.string(), std::string("set: ") + e.what());
  }
}

/// A shot is a file of somebody's too: what its settings ask for beside the defaults is bounded.
void refuseHeavyShot(const Shot& shot, const std::string& file) {
  constexpr double kMost = 16; // of what a default frame takes
  Settings settings;
  applyShot(settings, shot);
  const AskedWork asked = workOf(settings);
  if (asked.times <= kMost) return;
  std::ostringstream text;
  text << "its settings ask for " << std::lround(asked.times) << " times the work of the defaults (" << asked.names
       << "; " << kMost << " at most): a first picture would take very long; lower them, or --allow-large";
  throw InputError(file, text.str());
}

/// As chosenSettings, even where they contradict each other; null: without a shot.
Settings askedSettings(const LaunchOptions& options, const Shot* shot) {
  Settings settings;
  if (!options.preset.empty()) applyPreset(settings, options.preset);
  if (shot) applyShot(settings, *shot);
  if (!options.technique.empty()) applyTechnique(settings, options.technique);
  for (const std::string& text : options.set) {
    const size_t equals = text.find('=');
    if (equals == std::string::npos) throw InputError("--set " + text, "has no value (name=value)");
    applySetting(settings, text.substr(0, equals), text.substr(equals + 1));
  }
  settings.cubeFile = options.cube;
  if (options.bounces) applySetting(settings, "smc.bounces", std::to_string(*options.bounces));
  return settings;
}

/// What the person asks for beyond a picture of the default size and settings; what a shot asks for is the file's.
double timesAsked(const LaunchOptions& options, const CameraView& camera) {
  const auto [width, height] = sizeOf(kDefaultSize);
  constexpr double kStored = 5; // times a usual first frame: it casts a cube
  const Settings asked = askedSettings(options, nullptr);
  const double pixels = double(camera.width) * double(camera.height) / (double(width) * double(height));
  return std::max(1.0, pixels) * std::max(1.0, workOf(asked).times) * (needsOf(asked).stored ? kStored : 1);
}

} // namespace

std::pair<int, int> sizeOf(const std::string& text) {
  char cross = 0, rest = 0;
  int width = 0, height = 0;
  constexpr int kLargest = 16384; // texels per side that OpenGL 4.5 guarantees
  const int fields = std::sscanf(text.c_str(), "%6d%c%6d%c", &width, &cross, &height, &rest);
  if (fields != 3 || cross != 'x' || width < 1 || height < 1 || width > kLargest || height > kLargest)
    throw InputError("--size " + text, "not a size (WIDTHxHEIGHT, 1 to 16384 each, for example 1280x720)");
  return {width, height};
}

Settings chosenSettings(const LaunchOptions& options, const std::optional<Shot>& shot) {
  Settings settings = askedSettings(options, shot ? &*shot : nullptr);
  if (const std::string reason = whyNot(settings); !reason.empty()) throw InputError("settings", reason);
  return settings;
}

void addLaunchOptions(CLI::App& command, LaunchOptions& options) {
  std::string techniques; // but the first
  for (const Technique& t : techniqueTable().subspan(1))
    techniques += (techniques.empty() ? "" : ", ") + std::string(t.name);
  // Help shows groups in the order in which they begin: a command's own options stand before these.
  const std::string own = command.option_defaults()->get_group();
  command.option_defaults()->group("Scene, view, light and settings");
  command.add_option("--scene", options.sceneName, "which scene of a file with several, by name or index");
  command.add_flag("--allow-outside", options.trust.outside,
                   "let a file read what it names outside of its folder: for files that you trust");
  command.add_flag("--allow-large", options.trust.large,
                   "let a file ask for more memory and time than its size explains: for files that you trust");
  command.add_flag("--two-sided", options.twoSided,
                   "show the backs of surfaces that a file shows from their fronts alone");
  command.add_option("--camera", options.camera, "camera of the file, by name");
  command.add_option("--eye", options.eye, "view from x,y,z");
  command.add_option("--target", options.target, "look at x,y,z");
  command.add_option("--fov", options.fovDegrees, "vertical field of view, degrees");
  command.add_option("--size", options.size, "WIDTHxHEIGHT");
  command.add_option("--technique", options.technique, "how indirect light is made: smc (default), " + techniques);
  command.add_option("--preset", options.preset,
                     joined(presetNames()) + " (lambent inspect --presets); --set changes single settings");
  command.add_option("--set", options.set, "setting as name=value, repeatable (lambent settings lists them)")
      ->allow_extra_args(false);
  command.add_option("--bounces", options.bounces, "indirect bounces, same as --set smc.bounces");
  command.add_option("--cube-file", options.cube,
                     "ibrr: file that keeps its layered depth cube; read where it fits the scene, else written; a "
                     "build that was stopped goes on from it");
  command.add_option("--sun", options.suns, "add a sun: dx,dy,dz,r,g,b (direction of travel, irradiance)")
      ->allow_extra_args(false);
  command.add_option("--point", options.points, "add a lamp: x,y,z,r,g,b (intensity)")->allow_extra_args(false);
  command
      .add_option("--unit", options.unit,
                  "metres to a unit of the file (0.01: centimetres); else 1, or guessed where rooms would be over "
                  "100 m high")
      ->check(CLI::Range(1e-6, 1e6));
  command.add_option("--sky", options.sky,
                     "the sky: its radiance r,g,b, or a picture by longitude and latitude (.hdr, .exr)");
  command.add_option("--sky-scale", options.skyScale, "factor on the radiance of such a picture")
      ->check(CLI::Range(1e-6, 1e6));
  command.add_option("--sky-turn", options.skyTurn, "degrees by which it is turned, counter-clockwise seen from above")
      ->check(CLI::Range(-360.0, 360.0));
  command.add_option(
      "--daylight", options.daylight,
      "clear sky and its sun, in place of the scene's own sky and suns: ELEVATION[,AZIMUTH[,TURBIDITY]]; "
      "degrees, -90 to 90 (below 0: dusk) and from +Z towards +X (default 50); turbidity 2 (very clear) "
      "to 10 (default 3)");
  command.add_option("--sun-size", options.sunSize,
                     "how wide those suns are, degrees across: the sun's 0.53 with --daylight, else 0 (sharp shadows)");
  command.add_option("--seed", options.seed, "of all random numbers");
  command.add_option("--threads", options.threads, "worker threads, 0 = all cores")->check(CLI::Range(0, 1024));
  command.option_defaults()->group(own);
}

void refuseUnusable(CLI::App& command) {
  for (CLI::Option* option : command.get_options())
    option->check([](const std::string& text) { return text.empty() ? "needs a value (it is empty)" : ""; }, "");
  for (CLI::Option* option : command.get_options())
    if (option->get_type_name().starts_with("FLOAT"))
      option->check(
          [](const std::string& text) {
            char* end = nullptr;
            return std::isfinite(std::strtod(text.c_str(), &end)) ? "" : text + " is not a finite number";
          },
          "");
}

LaunchContext::LaunchContext() = default;
LaunchContext::~LaunchContext() = default;

SceneView LaunchContext::at(double t) {
  CameraView view = camera;
  if (shot) {
    poseShot(scene, *shot, t);
    if (!shot->played.empty()) props->show(playedAt(*shot, t), shot->file.string());
    if (!shot->camera.empty() && !cameraGiven) {
      view = shotCamera(*shot, t, scene.origin);
      view.width = camera.width;
      view.height = camera.height;
    }
  } else {
    animate(scene, t);
  }
  return extractor_.extract(scene, view, t);
}

void useThreads(int threads) {
  setThreadCount(threads);
  if (threads > 0) setenv("LP_NUM_THREADS", std::to_string(threads).c_str(), 1);
  requireResources(threadCount() + 1); // of loops, and one that traces beside frames or watches what is opened
}

/// A file in other units than glTF's metres: what the shot or the person says, or centimetres where rooms are too high
/// for metres. Who types places without a word about units means the file's, and is not guessed for.
void chooseUnit(LaunchContext& stage, const LaunchOptions& options) {
  constexpr float kHighest = 100; // metres
  constexpr double kCentimetre = 0.01;
  if (options.unit && stage.shot)
    throw InputError("--unit", "is for a scene (a shot has a unit of its own: \"unit\" in its file)");
  stage.unit = stage.shot ? stage.shot->unit : options.unit.value_or(1);
  const bool placed = !options.eye.empty() || !options.points.empty();
  if (!stage.shot && !options.unit && !placed && worldBounds(stage.scene).diameter() >= kHighest) {
    if (const float height = roomHeight(stage.scene).value_or(0); height >= kHighest) {
      stage.unit = kCentimetre;
      char text[160];
      std::snprintf(text, sizeof text,
                    "its rooms would be %.0f m high: the file is taken as told in centimetres (--unit 1 leaves metres)",
                    double(height));
      stage.notes.push_back(text);
    }
  }
  if (stage.unit != 1) rescale(stage.scene, float(stage.unit));
}

std::unique_ptr<LaunchContext> openLaunch(const LaunchOptions& options, WatchUntil until) {
  useThreads(options.threads);
  std::unique_ptr<OpenWatch> watch;
  if (!options.trust.large) watch = std::make_unique<OpenWatch>(options.scene);
  std::unique_ptr<LaunchContext> stage = loadLaunch(options, {});
  if (!watch || until == WatchUntil::Opened) return stage;
  watch->opened(timesAsked(options, stage->camera));
  stage->watch = std::move(watch);
  return stage;
}

std::unique_ptr<LaunchContext> loadLaunch(const LaunchOptions& options, const LoadStep& step) {
  auto stage = std::make_unique<LaunchContext>();
  fs::path file = options.scene;
  if (file.extension() == ".json") {
    stage->shot = loadShot(file);
    if (!options.trust.large) refuseHeavyShot(*stage->shot, options.scene);
    file = stage->shot->scene;
    if (const std::string kind = file.extension().string();
        kind != ".gltf" && kind != ".glb") // a shot may not make us open just any file
      throw InputError(options.scene, "scene: is not a scene's file (.gltf or .glb)");
  }
  const bool oneOfOurs = stage->shot || file.stem() == file.parent_path().filename(); // hall/hall.gltf
  if (std::error_code error; oneOfOurs && !fs::exists(file, error))
    throw InputError(options.scene, "there is no scene " + file.string() + hintOfContent(file.stem().string()));
  stage->seed = options.seed;
  stage->settings = chosenSettings(options, stage->shot);
  for (std::string& note : notesOfRenamed(options, stage->shot)) stage->notes.push_back(std::move(note));
  stage->scene = loadScene(file, options.sceneName, step, options.trust);
  for (const fs::path& read : stage->scene.files)
    for (const std::string& written : options.written)
      if (sameFile(read, written))
        throw InputError(written, "the scene is read from this file (name another for the result)");
  for (const fs::path& read : stage->scene.files) keepFromReplacing(read);
  if (stage->shot) keepFromReplacing(options.scene);
  if (options.twoSided)
    for (Material& m : stage->scene.assets.materials) m.backHidden = false;
  chooseUnit(*stage, options);
  addGivenLights(*stage, options);
  if (!options.cube.empty() && !needsOf(stage->settings).stored)
    stage->notes.push_back("--cube-file is for a technique that keeps a cube (--technique ibrr): not used");
  animate(stage->scene, 0);
  const auto tell = [&](const char* at) {
    if (step) step(at, 1);
  };
  tell("view");
  chooseCamera(*stage, options);
  tryOtherCameras(*stage, options);
  tell("light");
  SceneExtractor probe;
  const SceneView view = probe.extract(stage->scene, stage->camera, 0);
  RaysOnce rays(view);
  lightWhatIsDark(*stage, options, rays);
  tellOfSlowRays(*stage, view.rayWork);
  tellOfHiddenBacks(*stage, rays);
  tellWhatIsLeftOut(*stage, stage->settings);
  if (stage->shot && !stage->shot->played.empty()) {
    stage->props = std::make_unique<Props>(stage->scene);
    stage->props->check(*stage->shot);
  }
  stage->held.now(bytesOf(stage->scene.assets));
  return stage;
}

void chooseShaders() {
  if (const char* named = std::getenv("LAMBENT_SHADERS")) {
    if (!fs::is_directory(named))
      throw InputError("LAMBENT_SHADERS",
                       std::string("no folder ") + named + " (the folder that holds fullscreen.vert)");
    return gl::setShaderFolder(named);
  }
  std::error_code failure;
  const fs::path tree = fs::canonical(LAMBENT_SOURCE_DIR, failure),
                 program = fs::read_symlink("/proc/self/exe", failure);
  const auto [end, rest] = std::mismatch(tree.begin(), tree.end(), program.begin(), program.end());
  if (!tree.empty() && end == tree.end() && fs::is_directory(tree / "shaders", failure))
    gl::setShaderFolder(tree / "shaders");
}

fs::path findContentFolder() {
  std::vector<fs::path> places;
  if (const char* named = std::getenv("LAMBENT_CONTENT")) places.emplace_back(named);
  std::error_code unknown;
  const fs::path executable = fs::read_symlink("/proc/self/exe", unknown);
  if (!unknown) places.push_back(executable.parent_path().parent_path() / "share/lambent/content");
  places.emplace_back(fs::path(LAMBENT_SOURCE_DIR) / "content");
  std::string tried;
  for (const fs::path& place : places) {
    std::error_code failure;
    if (fs::is_directory(place, failure)) return place;
    tried += (tried.empty() ? "" : ", ") + place.string();
  }
  throw InputError("bundled scenes", "not found in " + tried + " (set LAMBENT_CONTENT, or name a scene)");
}

} // namespace lambent

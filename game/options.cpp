#include "game/options.h"

#include "engine/core/error.h"

#include <CLI/CLI.hpp>

#include <charconv>
#include <cstdlib>
#include <iostream>

namespace lambent {

namespace fs = std::filesystem;

namespace {

/// Comma-separated finite numbers, exactly `count` of them.
std::vector<float> numbers(const std::string& option, const std::string& text, size_t count) {
  std::vector<float> out;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at <= end) {
    float value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !std::isfinite(value) || (next != end && *next != ',')) break;
    out.push_back(value);
    at = next + 1;
    if (next == end) break;
  }
  if (out.size() != count || at != end + 1)
    throw InputError(option + " " + text, "needs " + std::to_string(count) + " numbers separated by commas");
  return out;
}

vec3 threeNumbers(const std::string& option, const std::string& text) {
  const std::vector<float> n = numbers(option, text, 3);
  return {n[0], n[1], n[2]};
}

/// Radiometric values are not negative.
vec3 checkedLight(const std::string& option, const std::string& text, const vec3& v) {
  if (v.x < 0 || v.y < 0 || v.z < 0) throw InputError(option + " " + text, "light is negative (0 or more)");
  return v;
}

LightView sunLight(const std::string& text) {
  const std::vector<float> n = numbers("--sun", text, 6);
  const vec3 direction(n[0], n[1], n[2]);
  if (glm::length(direction) == 0) throw InputError("--sun " + text, "the direction has no length");
  LightView light;
  light.type = LightType::Directional;
  light.direction = glm::normalize(direction);
  light.intensity = checkedLight("--sun", text, {n[3], n[4], n[5]});
  return light;
}

LightView pointLight(const std::string& text) {
  const std::vector<float> n = numbers("--point", text, 6);
  LightView light;
  light.position = {n[0], n[1], n[2]};
  light.intensity = checkedLight("--point", text, {n[3], n[4], n[5]});
  return light;
}

void readSize(const std::string& text, WalkthroughOptions& options) {
  char cross = 0, rest = 0;
  constexpr int kLargest = 16384; // texels per side that GL 4.5 guarantees
  const int fields = std::sscanf(text.c_str(), "%5d%c%5d%c", &options.width, &cross, &options.height, &rest);
  if (fields != 3 || cross != 'x' || options.width < 1 || options.height < 1 || options.width > kLargest ||
      options.height > kLargest)
    throw InputError("--size " + text, "not a size (WIDTHxHEIGHT, 1 to 16384 each, for example 1280x720)");
}

} // namespace

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

std::optional<WalkthroughOptions> readOptions(int argc, char** argv) {
  WalkthroughOptions options;
  std::string scene, shot, technique = "smc", size, eye, target, sky;
  std::vector<std::string> settings, suns, points;
  std::optional<float> fovDegrees;
  std::optional<int> bounces;

  CLI::App app{"Walk through a scene under global illumination that follows its moving lights and objects.\n"
               "Keys: W A S D Q E and the mouse with its right button move, Shift is faster, F1 shows all keys.",
               "walkthrough"};
  app.add_option("scene", scene, "glTF file (default: the bundled hall)");
  app.add_option("--shot", shot, "shot file: its scene, camera path and moving lights");
  app.add_option("--camera", options.camera, "start at this camera of the file");
  app.add_option("--eye", eye, "start at x,y,z");
  app.add_option("--target", target, "look at x,y,z");
  app.add_option("--fov", fovDegrees, "vertical field of view, degrees");
  app.add_option("--size", size, "window, WxH pixels (default 1280x720)");
  app.add_option("--technique", technique, "how indirect light is found (smc)");
  app.add_option("--set", settings, "setting as name=value, repeatable; the panel lists all")->take_all();
  app.add_option("--bounces", bounces, "indirect bounces, the same as --set smc.bounces");
  app.add_option("--buffer", options.buffer, "what to show first (beauty, indirect, vpls, ...)");
  app.add_option("--sun", suns, "add a sun: dx,dy,dz,r,g,b (direction of travel, irradiance)")->take_all();
  app.add_option("--point", points, "add a lamp: x,y,z,r,g,b (intensity)")->take_all();
  app.add_option("--sky", sky, "radiance of the sky: r,g,b");
  app.add_option("--seed", options.seed, "of all random numbers");
  app.add_option("--frames", options.frames)->group(""); // for tests: not shown
  app.add_option("--screenshot", options.screenshot)->group("");
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    std::cout << app.help();
    return std::nullopt;
  } catch (const CLI::ParseError& e) {
    throw InputError("command line", std::string(e.what()) + " (see walkthrough --help)");
  }

  if (technique != "smc") throw InputError("--technique " + technique, "no such technique (smc)");
  if (!size.empty()) readSize(size, options);
  if (!eye.empty()) options.eye = threeNumbers("--eye", eye);
  if (!target.empty()) options.target = threeNumbers("--target", target);
  if (options.target && !options.eye) throw InputError("--target " + target, "needs --eye as well");
  if (options.eye && !options.target) throw InputError("--eye " + eye, "needs --target as well");
  if (options.eye && *options.eye == *options.target) throw InputError("--target " + target, "is where --eye is");
  if (fovDegrees) {
    if (!(*fovDegrees > 1 && *fovDegrees < 179)) throw InputError("--fov", "out of range (1 to 179 degrees)");
    options.fovY = glm::radians(*fovDegrees);
  }
  if (!sky.empty()) options.skyRadiance = checkedLight("--sky", sky, threeNumbers("--sky", sky));
  for (const std::string& text : suns)
    options.lights.push_back(sunLight(text));
  for (const std::string& text : points)
    options.lights.push_back(pointLight(text));
  for (const std::string& text : settings) {
    const size_t equals = text.find('=');
    if (equals == std::string::npos) throw InputError("--set " + text, "has no value (name=value)");
    options.set.emplace_back(text.substr(0, equals), text.substr(equals + 1));
  }
  if (bounces) options.set.emplace_back("smc.bounces", std::to_string(*bounces));
  if (options.frames && *options.frames < 0) throw InputError("--frames", "is negative (0 or more)");

  options.shot = shot;
  options.scene = scene;
  if (scene.empty() && shot.empty()) options.scene = findContentFolder() / "hall/hall.gltf";
  return options;
}

} // namespace lambent

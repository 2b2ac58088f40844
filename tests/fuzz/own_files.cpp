// What a reader takes is used, written and read again: it must be the same then. Checksums are mended, so that a reader
// has to see by the values what is wrong.
#include "tests/fuzz/own_files.h"

#include "engine/scene/scene.h"
#include "engine/scene/shot.h"
#include "engine/trace/analytic_query.h"
#include "game/rules/preferences.h"
#include "game/rules/props.h"
#include "game/rules/shapes.h"
#include "gi/cube/cube_file.h"
#include "gi/lighting/light_set.h"
#include "gi/plan/presets.h"
#include "gi/reference/state_file.h"
#include "tests/fuzz/files.h"
#include "tests/support/checked.h"
#include "tools/kept/recording_folder.h"
#include "tools/kept/run_log.h"
#include "tools/kept/value.h"

#include <algorithm>
#include <limits>
#include <sstream>

namespace lambent::fuzz {

namespace {

/// Lists in lists: deeper than a stack.
std::string nested(const std::string& before, const std::string& after) {
  constexpr size_t kDepth = 30000;
  return before + std::string(kDepth, '[') + std::string(kDepth, ']') + after;
}

// Shots ---------------------------------------------------------------------------------------------------------------

bool near(const std::optional<vec3>& a, const std::optional<vec3>& b) {
  return a.has_value() == b.has_value() && (!a || glm::length(*a - *b) <= 1e-6f);
}

using Nodes = std::map<std::string, std::vector<NodeKey>>;

/// But for what is rounded: directions are made unit again, angles go through degrees.
void checkSame(const Nodes& a, const Nodes& b) {
  CHECK_EQ(a.size(), b.size());
  for (const auto& [name, keys] : a) {
    const std::vector<NodeKey>& others = b.at(name);
    CHECK_EQ(keys.size(), others.size());
    for (size_t i = 0; i < keys.size(); ++i) {
      const NodeKey &k = keys[i], &o = others[i];
      CHECK_EQ(k.t, o.t);
      CHECK(k.position == o.position && k.rotation == o.rotation && k.intensity == o.intensity);
      CHECK(near(k.direction, o.direction));
    }
  }
}

void checkSame(const Shot& a, const Shot& b) {
  std::error_code none;
  CHECK(fs::weakly_canonical(a.scene, none) == fs::weakly_canonical(b.scene, none));
  CHECK_EQ(a.fps, b.fps);
  CHECK_EQ(a.seconds, b.seconds);
  CHECK_EQ(a.camera.size(), b.camera.size());
  for (size_t i = 0; i < a.camera.size(); ++i) {
    const CameraKey &k = a.camera[i], &o = b.camera[i];
    CHECK_EQ(k.t, o.t);
    CHECK(k.eye == o.eye && k.target == o.target && std::abs(k.fovY - o.fovY) <= 1e-6f);
  }
  checkSame(a.lights, b.lights);
  checkSame(a.objects, b.objects);
  CHECK_EQ(a.played.size(), b.played.size());
  for (size_t i = 0; i < a.played.size(); ++i) {
    PlayedMoment moment = a.played[i];
    if (moment.things.empty()) moment.lampIntensity = b.played[i].lampIntensity; // nobody carries one
    CHECK(moment == b.played[i]);
  }
  CHECK(a.pixels == b.pixels);
  CHECK(a.set == b.set);
}

/// A door with a lamp on it, and a lift.
Scene house() {
  Scene scene;
  Registry& registry = scene.registry;
  const uint32_t box = addBoxMesh(scene.assets, "box", vec3(1), vec3(0.5f));
  const Entity door = addInstance(scene, "door leaf", box, {}), lift = addInstance(scene, "cabin", box, {});
  registry.get<Transform>(lift).translation = dvec3(3, 0, 0);
  LightView spot;
  spot.type = LightType::Spot;
  registry.emplace<Parent>(addLight(scene, spot, "lamp"), door);
  updateWorldTransforms(scene);
  return scene;
}

void checkPlaced(const SceneView& view) {
  CHECK(view.boundsWorld.empty() || (isFinite(view.boundsWorld.lo) && isFinite(view.boundsWorld.hi)));
  for (const InstanceView& i : view.instances) CHECK(finite(i.worldFromObject));
  for (const LightView& l : view.lights) {
    CHECK(isFinite(l.position) && isFinite(l.intensity) && maxComponent(l.intensity) <= kMostLight);
    CHECK(std::abs(glm::length(l.direction) - 1) < 1e-3f);
  }
}

/// As `lambent record` and the walkthrough show it.
void show(const Shot& shot) {
  CHECK(shot.frameCount() >= 1);
  Scene scene = house();
  std::optional<Props> props;
  if (!shot.played.empty()) props.emplace(scene).check(shot);
  SceneExtractor extractor;
  std::vector<double> times = {0, 0.3, shot.seconds};
  for (const CameraKey& k : shot.camera) times.push_back(k.t);
  for (const PlayedMoment& moment : shot.played) times.push_back(moment.t + 0.01);
  times.resize(std::min<size_t>(times.size(), 12));
  for (const double t : times) {
    if (!shot.camera.empty()) {
      const CameraView view = shotCamera(shot, t, scene.origin);
      CHECK(finite(view.worldFromView) && view.fovY > 0 && view.fovY < kPi);
    }
    poseShot(scene, shot, t);
    if (props) {
      const PlayedMoment moment = playedAt(shot, t);
      CHECK(!moment.torch || (isFinite(moment.torch->position) && isFinite(moment.torch->direction)));
      for (const PlayedMoment::Thing& thing : moment.things) CHECK(isFinite(thing.centre) && std::isfinite(thing.yaw));
      for (const auto& [name, at] : moment.movers) CHECK(std::isfinite(at));
      props->show(moment, shot.file.string());
    }
    checkPlaced(extractor.extract(scene, CameraView(), t));
  }
}

bool shot(std::string_view bytes) {
  return reading(bytes, ".json", [](const fs::path& file) {
    const Shot shot = loadShot(file);
    const fs::path again = scratch("-again.json");
    saveShot(shot, again);
    const std::string text = readBytes(again);
    Shot read;
    try {
      read = loadShot(again);
    } catch (const InputError& e) {
      CHECK_EQ(std::string("taken"), std::string(e.what()));
    }
    fs::remove(again);
    checkSame(shot, read);
    show(shot);
  });
}

std::vector<std::string> shotSeeds() {
  return {
      R"({"shot": 1, "scene": "room.glb", "fps": 24, "seconds": 2.5,
  "camera": {"keys": [{"t": 0, "eye": [0, 1, 5], "target": [0, 1, 0], "fov": 60}, {"t": 2, "eye": [4, 1, 5], "target": [0, 1, 0]},
                      {"t": 3, "eye": [4, 1, 6], "target": [0, 1, 1]}]},
  "lights": {"lamp": {"keys": [{"t": 0, "intensity": [0, 0, 0], "direction": [0, -1, 0]}, {"t": 2, "intensity": [4, 2, 0],
                                "direction": [1, 0, 0], "position": [0, 1, 0]}]}},
  "objects": {"door leaf": {"keys": [{"t": 1, "rotation": [0, 90, 0]}, {"t": 0.5e1, "position": [1, 2, 3], "rotation": [0, 0, 0]}]}},
  "pixels": [[0.25, 0.75]], "set": {"smc.vpls": 4096, "vpl.source": "smc", "filter.on": true}})",
      R"({"shot": 1, "scene": "house.gltf", "seconds": 1, "camera": {"keys": [
  {"t": 0, "eye": [0, 1, 5], "target": [0, 1, 0], "fov": 179.9, "played": [{"t": 0, "movers": {"door leaf": 0.5}, "hour": 8,
   "torch": {"at": [0, 1, 5], "direction": [0, 0, -1], "intensity": [1, 1, 1]}, "lamps": [2, 2, 2],
   "things": [{"number": 1, "kind": "lamp", "at": [1, 0, 1], "yaw": 0.5}, {"number": 2, "kind": "red box", "at": [1, 0, 1], "yaw": 3}]}]},
  {"t": 0.5, "eye": [0, 1, 4], "target": [0, 1, 0]}]},
  "played": [{"t": 0.5, "movers": {"cabin": 1.5, "door leaf": 1}, "hour": 9.5,
   "torch": {"at": [0, 1, 4], "direction": [0, 1, -1], "intensity": [1, 1, 1]}, "lamps": [1, 1, 1],
   "things": [{"number": 2, "kind": "red box", "at": [2, 0, 1], "yaw": -3}]}]})"};
}

// Walks that a program was killed at ----------------------------------------------------------------------------------

std::optional<Shot> taken(const fs::path& file) {
  std::optional<Shot> shot;
  takes([&] { shot = loadShot(file); });
  return shot;
}

bool walk(std::string_view bytes) {
  const Folder folder("-walks");
  const fs::path file = folder / "walk-1.json";
  writeBytes(file, bytes);
  const std::optional<Shot> before = taken(file);
  const bool ended = !endCutShots(folder.path()).empty();
  if (!fs::exists(file)) {
    CHECK(!ended && before && before->camera.empty());
    return true;
  }
  if (!ended) {
    CHECK(readBytes(file) == bytes);
    return before.has_value();
  }
  const std::optional<Shot> after = taken(file);
  CHECK(before && after);
  checkSame(*before, *after);
  CHECK(endCutShots(folder.path()).empty());
  return takes([&] { show(*after); });
}

std::vector<std::string> walkSeeds() {
  const Folder folder("-seeds");
  const fs::path file = folder / "walk-1.json";
  Shot shot;
  shot.scene = folder / "house.gltf";
  shot.set["smc.vpls"] = "64";
  shot.lights["lamp"] = {{1, {}, {}, {}, vec3(2)}};
  std::vector<std::string> seeds;
  {
    ShotWriter writer(shot, file);
    seeds.push_back(readBytes(file));
    for (const double t : {0.0, 0.5, 1.0}) {
      PlayedMoment moment;
      moment.t = t, moment.movers["door leaf"] = t, moment.hour = 8 + t;
      moment.things.push_back({1, "lamp", vec3(float(t), 0, 1), 0.5f});
      writer.add({t, dvec3(0, 1, 5 + t), dvec3(0, 1, 0), 1}, {moment});
      seeds.push_back(readBytes(file) + "{\"t\":");
    }
    writer.end(1.5);
  }
  seeds.push_back(readBytes(file));
  return seeds;
}

// What a person changed in the window ---------------------------------------------------------------------------------

/// Stands for the table of techniques, which needs OpenGL.
void applyTechnique(Settings& settings, const std::string& name) {
  if (name != "ir") throw InputError("technique " + name, "no such technique");
  applySetting(settings, "vpl.source", "ir");
}

bool isLine(std::string_view text) { return text.find('\n') == text.npos; }

bool preferences(std::string_view bytes) {
  return reading(bytes, ".json", [](const fs::path& file) {
    const bool refused = !KeptPreferences(file).takeComplaint().empty();
    Preferences p;
    try {
      p = loadPreferences(file);
    } catch (const InputError& e) {
      CHECK(refused && isLine(e.what()));
      throw;
    }
    CHECK(!refused);
    CHECK(std::abs(p.exposure) <= 24 && p.speed >= 0.1 && p.speed <= 10);
    if (p.window) CHECK(p.window->first > 0 && p.window->first < 32768 && p.window->second > 0);
    for (const AskedFor& asked : {AskedFor(), AskedFor{true, {}}, AskedFor{false, {"smc.vpls"}}}) {
      std::string complaint;
      const Settings settings = p.over(Settings(), asked, applyTechnique, complaint);
      CHECK_EQ(whyNot(settings), "");
      CHECK(isLine(complaint));
      if (!complaint.empty()) CHECK(settings == Settings());
    }
    const fs::path again = scratch("-again.json");
    savePreferences(p, again);
    CHECK(loadPreferences(again) == p);
    fs::remove(again);
  });
}

std::vector<std::string> preferencesSeeds() {
  const std::string begin = R"({"kind": "lambent walkthrough", )";
  return {begin + R"("preset": "low", "technique": "ir", "set": {"image.toneMapper": "filmic", "smc.vpls": "64",
  "gather.clamp": "0.5"}, "exposure": -1.25, "panel": false, "folded": true, "speed": 2.5, "window": [800, 600]})",
          begin + R"("speed": 1, "panel": true})"};
}

// How far a recording got ---------------------------------------------------------------------------------------------

bool recording(std::string_view bytes) {
  const Folder folder("-recording");
  writeBytes(folder.path() / "recording.json", bytes);
  for (const char* name : {"000000.png", "000017.png", "000017.exr"}) writeBytes(folder.path() / name, "x");
  const bool taken = takes([&] {
    RecordingFolder mark(folder.path(), "0123456789abcdef", "png");
    const bool counted = takes([&] {
      const int kept = mark.kept();
      CHECK(kept >= 0 && kept < std::numeric_limits<int>::max()); // one frame more can be counted
      mark.write(kept);
      CHECK_EQ(mark.kept(), kept);
    });
    mark.end(1);
    if (!counted) throw InputError("recording.json", "another's");
  });
  for (const char* name : {"000000.png", "000017.exr"}) CHECK(fs::exists(folder.path() / name));
  const std::string text = Value::parsed(std::string(bytes)).json(-1);
  CHECK_EQ(Value::parsed(text).json(-1), text);
  return taken && text != "null";
}

std::vector<std::string> recordingSeeds() {
  return {R"({"conditions":"0123456789abcdef","frames":17,"format":"png","before_png":18})",
          R"({"conditions":"fedcba9876543210","frames":17.5})",
          R"({"conditions":"0123456789abcdef","frames":1,"list":[1,-2.5,true,null,"text",{"a":[]}]})"};
}

// What an accuracy report has measured --------------------------------------------------------------------------------

/// Behind each line's checksum.
bool runs(std::string_view bytes) {
  const Folder folder("-runs");
  const fs::path file = folder.path() / "runs.jsonl";
  std::string text;
  std::istringstream in{std::string(bytes)};
  for (std::string line; std::getline(in, line);) {
    const Value run = Value::parsed(line);
    text += (run.isObject() ? lineOf(run) : line) + "\n";
  }
  writeBytes(file, text);
  RunLog log(file, "0123456789abcdef");
  const size_t before = log.runs().size();
  log.add("another", Value::of("ms", 1));
  CHECK(log.has("another"));
  CHECK_EQ(RunLog(file, "0123456789abcdef").runs().size(), before + 1);
  return before > 0;
}

std::vector<std::string> runsSeeds() {
  const std::string line = R"({"conditions":"0123456789abcdef","key":"smc seed 0","session":1,"moving":{"ms":2.5}})";
  return {line + "\n", line + "\n\n" + line + "\n"};
}

// Sums of a reference -------------------------------------------------------------------------------------------------

/// Of a reference of this size, by this key.
struct State {
  AnalyticQuery rays;
  LightSet lights;
  CameraView camera;
  ReferenceInputs in{rays, lights, camera};
  static constexpr uint64_t kKey = 42;
  State() {
    camera.width = 4, camera.height = 3;
    rays.addBox(vec3(-1), vec3(1), {vec3(0.5f)});
  }
};

/// Behind its checksum: its pictures are drawn, and it goes on.
bool state(std::string_view bytes) {
  const std::string whole = test::mended(std::string(bytes));
  return reading(whole, ".state", [&](const fs::path& file) {
    const State s;
    ReferenceSums sums = loadReference(file, s.in, State::kKey);
    CHECK_EQ(sums.pixels.size(), size_t(12));
    CHECK(written(".state", [&](const fs::path& again) { saveReference(again, sums, State::kKey); }) == whole);
    using enum ReferenceBuffer;
    for (const ReferenceBuffer buffer : {Beauty, Direct, Indirect, Irradiance}) {
      const ReferenceImage image = readReference(sums, s.in, buffer);
      for (const vec3& p : image.mean.pixels) CHECK(isFinite(p) && glm::min(p.x, glm::min(p.y, p.z)) >= 0);
      for (const vec3& p : image.error.pixels) CHECK(p.x >= 0 && p.y >= 0 && p.z >= 0); // infinite of a single sample
      if (sums.samples > 1) CHECK(std::isfinite(image.relativeError) && std::isfinite(image.relativeErrorOfMean));
    }
    RayCounts counts;
    if (sums.samples == ReferenceSums::kMostSamples) return;
    addSamples(sums, s.in, 1, counts);
    saveReference(file, sums, State::kKey);
    CHECK_EQ(loadReference(file, s.in, State::kKey).samples, sums.samples);
  });
}

std::string stateOf(uint32_t samples, double direct, double indirect) {
  ReferenceSums sums(4, 3);
  sums.samples = samples;
  for (size_t i = 0; i < sums.pixels.size(); ++i) {
    PixelSums& p = sums.pixels[i];
    p.direct = dvec3(direct) * double(i), p.directSquares = p.direct * p.direct / double(samples);
    p.indirect = dvec3(indirect), p.indirectSquares = p.indirect * p.indirect / double(samples);
    p.product = p.direct * p.indirect / double(samples);
  }
  return written(".state", [&](const fs::path& file) { saveReference(file, sums, State::kKey); });
}

std::vector<std::string> stateSeeds() {
  return {stateOf(7, 0, 0), stateOf(1, 0.5, 2), stateOf(1000, 3, 1e-3), stateOf(2, 1e-160, 1e38)};
}

// The layered depth cube ----------------------------------------------------------------------------------------------

/// Of a box, with two lights.
struct Cube {
  AnalyticQuery rays;
  Aabb bounds{vec3(-1), vec3(1)};
  CubeSettings settings{.resolution = 8, .levels = 1, .split = 0.3f};
  GatherSettings gather;
  std::vector<VirtualLight> lights;
  static constexpr uint64_t kKey = 42;
  Cube() {
    rays.addBox(bounds.lo, bounds.hi, {vec3(0.5f)});
    for (const float x : {0.0f, 0.5f}) lights.push_back({{x, -0.9f, 0}, {0, 1, 0}, {0, 1, 0}, vec3(3), 0.1f, true});
  }
  CubeInputs inputs(const DirtyRegion& moved) const {
    return {bounds, rays, moved, false, lights, ~0u, settings, gather};
  }
};

std::string writtenCube(const LayeredCube& cube) {
  return written(".cube", [&](const fs::path& file) { saveCube(file, cube, Cube::kKey); });
}

/// Behind its checksum: what is believed goes on, also where something moved.
bool cube(std::string_view bytes) {
  const std::string whole = test::mended(std::string(bytes));
  return reading(whole, ".cube", [&](const fs::path& file) {
    const Cube c;
    LayeredCube cube = loadCube(file, Cube::kKey);
    const std::string again = writtenCube(cube); // as the file, but for bytes that say nothing
    writeBytes(file, again);
    CHECK(again.size() == whole.size() && writtenCube(loadCube(file, Cube::kKey)) == again);
    const Aabb place{vec3(-0.2f), vec3(0.3f)};
    cube.update(c.inputs(DirtyRegion(std::span(&place, 1))));
    for (size_t e = 0; e < cube.surfaces().entries().size(); ++e) CHECK(isFinite(cube.irradiance(e)));
  });
}

std::vector<std::string> cubeSeeds() {
  const Cube c;
  LayeredCube cube;
  cube.update(c.inputs(kNothingMoved));
  return {writtenCube(cube)};
}

// Words ---------------------------------------------------------------------------------------------------------------

template <class T> void addWords(std::vector<std::string>& words, std::initializer_list<T> values) {
  for (const T v : values) append<T>(words.emplace_back(), {v});
}

std::vector<std::string> numbers() {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  std::vector<std::string> words;
  addWords<uint32_t>(words, {0, 1, 2, 8, 255, 1u << 24, 0x7fffffff, 0x80000000, ~0u});
  addWords<uint64_t>(words, {0, 1, 1ull << 32, 1ull << 61, ~0ull});
  addWords<float>(words, {kNan, kInfinity, -1, -0.0f, 1e30f, 1e-30f, 1, 3e38f});
  addWords<double>(words, {double(kNan), double(kInfinity), -1, -0.0, 1e300, 1e-300, 1, 1e-320});
  return words;
}

std::vector<std::string> json(std::initializer_list<const char*> more) {
  std::vector<std::string> words = {"null",  "true",   "[]",     "{}",   "-1",   "0",          "-0.0",
                                    "1e308", "-1e308", "1e-308", "3e38", "\"\"", "\"\\u0000\""};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

std::string keysAt(const std::string& first, const std::string& second) {
  return R"({"shot": 1, "scene": "a", "seconds": 1, "camera": {"keys": [{"t": )" + first +
         R"(, "eye": [0, 0, 1], "target": [0, 0, 0]}, {"t": )" + second +
         R"(, "eye": [9, 0, 1], "target": [0, 0, 0]}]}})";
}

} // namespace

std::vector<Target> ownFiles() {
  const std::string kept = R"({"conditions":"0123456789abcdef","frames":)",
                    ours = R"({"kind": "lambent walkthrough", )";
  return {
      {"shot",
       shot,
       shotSeeds,
       json({"\"t\":", "\"fov\":", "179.9", "0.1", "1e12", "1e-200", "[0,1e-50,0]", "\"set\":", "\"played\":", "86400",
             "\"cabin\"", "\"lamp\"", "\"white board\""}),
       {nested(R"({"shot": 1, "scene": )", "}"), keysAt("-1e308", "1e308"), keysAt("0", "1e-308")}},
      {"walk", walk, walkSeeds, json({"\n", "}\n", "]}", ",\"seconds\":", "\"camera\":", "86400", "1e-300"}), {}},
      {"preferences",
       preferences,
       preferencesSeeds,
       json({"\"low\"", "\"smc\"", "\"set\":", "\"window\":", "[1,2]", "[true,1e300]", "\"nan\"", "24", "0.1", "10"}),
       {nested(ours + R"("set": )", "}"), ours + R"("window": [1e300, -1e300]})"}},
      {"recording",
       recording,
       recordingSeeds,
       json({"2147483647", "2147483648", "1e39", "\"frames\":", "17"}),
       {nested(kept, "}"), kept + "4294967297}", kept + "1e39}"}},
      {"runs",
       runs,
       runsSeeds,
       json({"\n", "\"check\":", "\"key\":", "\"conditions\":", "\"0123456789abcdef\"", "\"session\":", "1e300"}),
       {nested(R"({"conditions":"0123456789abcdef","key":)", "}")}},
      {"state", state, stateSeeds, numbers(), {stateOf(1, 1e150, 0)}},
      {"cube", cube, cubeSeeds, numbers(), {}},
  };
}

} // namespace lambent::fuzz

// Shot files: strict JSON in, tidy JSON out. Every message says where in the file: "shot.json: camera.keys[2].fov: …".

#include "engine/core/files.h"
#include "engine/core/text.h"
#include "engine/scene/json_text.h"
#include "engine/scene/shot.h"
#include "engine/view/scene_view.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <string_view>

#include <nlohmann/json.hpp>
#include <unistd.h>

namespace lambent {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr float kDegree = kPi / 180;

/// One JSON value and where it is, with typed readers that refuse anything else.
class Field {
 public:
  Field(const json& value, std::string file, std::string path)
      : value_(value), file_(std::move(file)), path_(std::move(path)) {}

  [[noreturn]] void fail(const std::string& reason) const {
    throw InputError(file_, path_.empty() ? reason : path_ + ": " + reason);
  }
  /// Refuses keys that are not in `known`.
  void checkKeys(const std::vector<std::string>& known) const {
    checkObject();
    for (const auto& [key, value] : value_.items()) {
      if (std::find(known.begin(), known.end(), key) != known.end()) continue;
      const std::string nearest = nearestName(key, known);
      fail("unknown key '" + key + "' (" +
           (nearest.empty() ? "known: " + join(known) : "did you mean " + nearest + "?") + ")");
    }
  }
  void checkObject() const {
    if (!value_.is_object()) fail("is not an object ({...} expected)");
  }
  bool has(const char* key) const { return value_.contains(key); }
  Field operator[](const std::string& key) const {
    if (!value_.contains(key)) fail("lacks the key '" + key + "'");
    return {value_[key], file_, path_.empty() ? key : path_ + "." + key};
  }
  /// Calls fn(element) for each element of an array.
  template <class Fn> void elements(Fn&& fn) const {
    if (!value_.is_array()) fail("is not a list ([...] expected)");
    for (size_t i = 0; i < value_.size(); ++i) fn(Field(value_[i], file_, path_ + "[" + std::to_string(i) + "]"));
  }
  /// Calls fn(key, member) for each member of an object.
  template <class Fn> void members(Fn&& fn) const {
    checkObject();
    for (const auto& [key, value] : value_.items()) fn(key, Field(value, file_, path_ + "." + key));
  }

  double number() const {
    if (!value_.is_number()) fail("is not a number");
    return value_.get<double>();
  }
  float single() const {
    const auto v = float(number());
    if (!std::isfinite(v)) fail("is a number beyond single precision");
    return v;
  }
  std::string text() const {
    if (!value_.is_string()) fail("is not text (\"...\" expected)");
    return value_.get<std::string>();
  }
  /// Text, or a number or truth value as text.
  std::string scalarText() const {
    if (value_.is_string()) return value_.get<std::string>();
    if (value_.is_number() || value_.is_boolean()) return value_.dump();
    fail("is not a text, number, true or false");
  }
  template <int N, class Number = float> glm::vec<N, Number> vector() const {
    glm::vec<N, Number> v(0);
    int n = 0;
    elements([&](const Field& f) {
      f.single(); // larger numbers are refused
      if (n < N) v[n] = Number(f.number());
      ++n;
    });
    if (n != N) fail("has " + std::to_string(n) + " numbers (" + std::to_string(N) + " expected)");
    return v;
  }

 private:
  static std::string join(const std::vector<std::string>& names) {
    std::string all;
    for (const std::string& n : names) all += (all.empty() ? "" : ", ") + n;
    return all;
  }

  const json& value_;
  std::string file_, path_;
};

/// Time of the key that follows `before`, which must lie after these: so far, and no farther, that speeds are finite.
template <class Key> double keyTime(const Field& key, const std::vector<Key>& before) {
  constexpr double kLatest = 1e9, kShortest = 1e-12; // seconds
  const double t = key["t"].number();
  if (!(std::abs(t) <= kLatest)) key["t"].fail("is out of range (-1e9 to 1e9)");
  if (!before.empty() && !(t - before.back().t >= kShortest))
    key["t"].fail("is not after the key before it (keys go up in time)");
  return t;
}

dvec3 placeOf(const Field& field) {
  const auto at = field.vector<3, double>();
  if (!isNear(vec3(at))) field.fail("is farther than 1e12 m away");
  return at;
}

void readPlayed(const Field& list, std::vector<PlayedMoment>& moments);

std::vector<CameraKey> readCamera(const Field& camera, std::vector<PlayedMoment>& played) {
  camera.checkKeys({"keys"});
  std::vector<CameraKey> keys;
  camera["keys"].elements([&](const Field& k) {
    k.checkKeys({"t", "eye", "target", "fov", "played"});
    if (k.has("played")) readPlayed(k["played"], played);
    CameraKey key;
    key.t = keyTime(k, keys);
    key.eye = placeOf(k["eye"]);
    key.target = placeOf(k["target"]);
    if (key.eye == key.target) k["target"].fail("is the same point as the eye");
    if (k.has("fov")) {
      const float degrees = k["fov"].single();
      if (!(degrees >= 0.1f && degrees <= 179.9f)) k["fov"].fail("is out of range (0.1 to 179.9 degrees)");
      key.fovY = degrees * kDegree;
    } else {
      key.fovY = keys.empty() ? 60 * kDegree : keys.back().fovY;
    }
    keys.push_back(key);
  });
  return keys;
}

vec3 lightOf(const Field& field) {
  const vec3 light = field.vector<3>();
  if (glm::min(light.x, glm::min(light.y, light.z)) < 0) field.fail("is negative");
  if (maxComponent(light) > kMostLight) field.fail("is beyond what pictures can hold (1e30)");
  return light;
}

dvec3 directionOf(const Field& field) {
  const auto direction = field.vector<3, double>();
  const double length = glm::length(direction); // single precision takes its square, and differences
  if (!(length >= 1e-12)) field.fail("has no length");
  if (!(length <= 1e12)) field.fail("is longer than 1e12");
  return direction;
}

std::map<std::string, std::vector<NodeKey>> readNodes(const Field& nodes, bool lights) {
  std::map<std::string, std::vector<NodeKey>> out;
  nodes.members([&](const std::string& name, const Field& node) {
    node.checkKeys({"keys"});
    std::vector<NodeKey>& keys = out[name];
    node["keys"].elements([&](const Field& k) {
      k.checkKeys(lights ? std::vector<std::string>{"t", "position", "rotation", "direction", "intensity"}
                         : std::vector<std::string>{"t", "position", "rotation"});
      NodeKey key;
      key.t = keyTime(k, keys);
      if (k.has("position")) key.position = k["position"].vector<3, double>();
      if (k.has("rotation")) key.rotation = k["rotation"].vector<3>();
      if (k.has("direction")) key.direction = vec3(glm::normalize(directionOf(k["direction"])));
      if (k.has("intensity")) key.intensity = lightOf(k["intensity"]);
      keys.push_back(key);
    });
  });
  return out;
}

PlayedMoment::Thing readThing(const Field& t) {
  t.checkKeys({"number", "kind", "at", "yaw"});
  PlayedMoment::Thing thing;
  const double number = t["number"].number();
  if (!(number >= 0 && number <= 1e9)) t["number"].fail("is out of range (0 to 1e9)");
  thing.number = uint32_t(number);
  thing.kind = t["kind"].text();
  thing.centre = vec3(placeOf(t["at"]));
  thing.yaw = t["yaw"].single();
  return thing;
}

void readPlayed(const Field& list, std::vector<PlayedMoment>& moments) {
  list.elements([&](const Field& m) {
    m.checkKeys({"t", "movers", "things", "lamps", "hour", "torch"});
    PlayedMoment moment;
    moment.t = keyTime(m, moments);
    if (m.has("movers"))
      m["movers"].members([&](const std::string& name, const Field& at) {
        at.single(); // larger numbers are refused
        moment.movers[name] = at.number();
      });
    if (m.has("things")) m["things"].elements([&](const Field& t) { moment.things.push_back(readThing(t)); });
    if (m.has("lamps")) moment.lampIntensity = lightOf(m["lamps"]);
    if (m.has("hour")) {
      moment.hour = m["hour"].number();
      if (!(*moment.hour >= 0 && *moment.hour <= 24)) m["hour"].fail("is out of range (0 to 24)");
    }
    if (m.has("torch")) {
      const Field torch = m["torch"];
      torch.checkKeys({"at", "direction", "intensity"});
      moment.torch = {vec3(placeOf(torch["at"])), vec3(directionOf(torch["direction"])), lightOf(torch["intensity"])};
    }
    moments.push_back(std::move(moment));
  });
}

std::string textOf(const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error)) throw InputError(file.string(), "no such file");
  if (!fs::is_regular_file(file, error)) throw InputError(file.string(), "is not a file (a shot in JSON expected)");
  std::ifstream in(file);
  if (!in) throw InputError(file.string(), "cannot be opened for reading");
  return {std::istreambuf_iterator<char>(in), {}};
}

json parse(const fs::path& file, const std::string& text) {
  checkJson(file, text);
  try {
    return json::parse(text);
  } catch (const json::exception& e) {
    throw InputError(file.string(), "is not JSON: " + reasonOf(e.what()));
  }
}

template <int N, class Number> json toJson(const glm::vec<N, Number>& v) {
  json list = json::array();
  for (int i = 0; i < N; ++i) list.push_back(v[i]);
  return list;
}

json toJson(const std::map<std::string, std::vector<NodeKey>>& nodes) {
  json out = json::object();
  for (const auto& [name, keys] : nodes) {
    json list = json::array();
    for (const NodeKey& k : keys) {
      json key{{"t", k.t}};
      if (k.position) key["position"] = toJson(*k.position);
      if (k.rotation) key["rotation"] = toJson(*k.rotation);
      if (k.direction) key["direction"] = toJson(*k.direction);
      if (k.intensity) key["intensity"] = toJson(*k.intensity);
      list.push_back(std::move(key));
    }
    out[name]["keys"] = std::move(list);
  }
  return out;
}

json toJson(const CameraKey& k) {
  return {{"t", k.t}, {"eye", toJson(k.eye)}, {"target", toJson(k.target)}, {"fov", k.fovY / kDegree}};
}

json toJson(const PlayedMoment& m) {
  json out{{"t", m.t}};
  if (!m.movers.empty()) out["movers"] = m.movers;
  for (const PlayedMoment::Thing& t : m.things)
    out["things"].push_back({{"number", t.number}, {"kind", t.kind}, {"at", toJson(t.centre)}, {"yaw", t.yaw}});
  if (!m.things.empty()) out["lamps"] = toJson(m.lampIntensity);
  if (m.hour) out["hour"] = *m.hour;
  if (m.torch)
    out["torch"] = {{"at", toJson(m.torch->position)},
                    {"direction", toJson(m.torch->direction)},
                    {"intensity", toJson(m.torch->intensity)}};
  return out;
}

/// What a shot holds beside camera, played and seconds.
json headOf(const Shot& shot, const fs::path& file) {
  std::error_code error;
  fs::path scene = fs::proximate(shot.scene, file.parent_path().empty() ? "." : file.parent_path(), error);
  if (error) scene = fs::absolute(shot.scene);
  json out{{"shot", 1}, {"scene", scene.generic_string()}, {"fps", shot.fps}};
  if (shot.unit != 1) out["unit"] = shot.unit;
  if (!shot.lights.empty()) out["lights"] = toJson(shot.lights);
  if (!shot.objects.empty()) out["objects"] = toJson(shot.objects);
  for (const vec2& p : shot.pixels) out["pixels"].push_back(toJson(p));
  if (!shot.set.empty()) out["set"] = shot.set;
  return out;
}

/// Throws RunError for names that are no UTF-8.
std::string textOf(const json& shot, const fs::path& file) {
  try {
    return shot.dump();
  } catch (const json::exception&) {
    throw RunError(file.string() + ": cannot be written: a name in it, or the scene's, is not UTF-8");
  }
}

// Lines of a file that a ShotWriter writes: the head, a key each, the end.
constexpr const char *kKeysBegin = ",\"camera\":{\"keys\":[\n", *kKeysEnd = "]}";
std::string endLine(double seconds) { return std::string(kKeysEnd) + ",\"seconds\":" + json(seconds).dump() + "}\n"; }

/// Bytes of whole lines of what a ShotWriter began; nothing where it came to its end, or did not write it.
std::optional<size_t> cutAt(const std::string& text) {
  const std::string_view begin = kKeysBegin;
  const size_t head = text.find('\n');
  if (head == text.npos || head + 1 < begin.size() || text.compare(head + 1 - begin.size(), begin.size(), begin) != 0)
    return {};
  const size_t whole = text.rfind('\n') + 1, last = text.rfind('\n', whole - 2) + 1;
  if (text.compare(last, std::strlen(kKeysEnd), kKeysEnd) == 0) return {};
  return json::accept(text) ? std::nullopt : std::optional(whole); // somebody may have written on it
}

} // namespace

Shot loadShot(const fs::path& file) {
  std::string text = textOf(file);
  const std::optional<size_t> cut = cutAt(text);
  if (cut) text = text.substr(0, *cut) + endLine(0);
  const json document = parse(file, text);
  const Field root(document, file.string(), "");
  root.checkKeys({"shot", "scene", "unit", "fps", "seconds", "camera", "lights", "objects", "played", "pixels", "set"});
  if (root["shot"].number() != 1) root["shot"].fail("is not a version this program reads (1 expected)");
  Shot shot;
  shot.file = file;
  shot.scene = (file.parent_path() / root["scene"].text()).lexically_normal();
  if (root.has("unit")) shot.unit = root["unit"].number();
  if (!(shot.unit >= 1e-6 && shot.unit <= 1e6)) root["unit"].fail("is out of range (metres, 1e-6 to 1e6)");
  if (root.has("fps")) shot.fps = root["fps"].number();
  if (!(shot.fps > 0 && shot.fps <= 1000)) root["fps"].fail("is out of range (frames per second, above 0 to 1000)");
  shot.seconds = root["seconds"].number();
  if (root.has("camera")) shot.camera = readCamera(root["camera"], shot.played);
  if (cut && !shot.camera.empty()) shot.seconds = shot.camera.back().t + 1 / shot.fps;
  if (!(shot.seconds >= 0 && shot.seconds <= kLongestShot))
    root["seconds"].fail("is out of range (0 to " + std::to_string(int(kLongestShot)) + ")");
  if (root.has("lights")) shot.lights = readNodes(root["lights"], true);
  if (root.has("objects")) shot.objects = readNodes(root["objects"], false);
  if (root.has("played")) readPlayed(root["played"], shot.played);
  if (root.has("pixels"))
    root["pixels"].elements([&](const Field& p) {
      const vec2 uv = p.vector<2>();
      if (glm::min(uv.x, uv.y) < 0 || glm::max(uv.x, uv.y) > 1) p.fail("is outside the image (0 to 1)");
      shot.pixels.push_back(uv);
    });
  constexpr size_t kMostPixels = 65536; // all are traced in every frame that is watched
  if (shot.pixels.size() > kMostPixels)
    root["pixels"].fail("are " + std::to_string(shot.pixels.size()) + " (" + std::to_string(kMostPixels) + " at most)");
  if (root.has("set"))
    root["set"].members([&](const std::string& key, const Field& value) { shot.set[key] = value.scalarText(); });
  return shot;
}

void saveShot(const Shot& shot, const fs::path& file) {
  json out = headOf(shot, file);
  out["seconds"] = shot.seconds;
  for (const CameraKey& k : shot.camera) out["camera"]["keys"].push_back(toJson(k));
  for (const PlayedMoment& moment : shot.played) out["played"].push_back(toJson(moment));
  writeAtomically(file, out.dump(2) + "\n");
}

ShotWriter::ShotWriter(const Shot& shot, const fs::path& file)
    : name_(file.string()),
      last_(kLongestShot - 2 / shot.fps) { // so that the last frame too ends within it, however it is rounded
  std::string head = textOf(headOf(shot, file), file);
  head.pop_back();
  file_ = std::make_unique<AppendedFile>(file);
  try {
    file_->append(head + kKeysBegin);
  } catch (...) {
    std::error_code ignored;
    fs::remove(file, ignored);
    throw;
  }
}

ShotWriter::~ShotWriter() = default;

void ShotWriter::add(const CameraKey& key, const std::vector<PlayedMoment>& played) {
  if (key.t > last_) throw RunError(name_ + ": is a day long, the longest that a shot may be (begin another)");
  json line = toJson(key);
  for (const PlayedMoment& moment : played) line["played"].push_back(toJson(moment));
  file_->append((first_ ? "" : ",") + line.dump() + "\n");
  first_ = false;
}

void ShotWriter::end(double seconds) { file_->append(endLine(seconds)); }

namespace {

/// Whether its last bytes are those of a shot that has its end: what they are is seen without reading all of it.
bool looksEnded(const fs::path& file) {
  constexpr std::streamoff kTail = 256;
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  const std::streamoff size = in.tellg(), begin = std::max<std::streamoff>(0, size - kTail);
  std::string tail(size_t(std::max<std::streamoff>(0, size - begin)), '\0');
  in.seekg(begin);
  in.read(tail.data(), std::streamsize(tail.size()));
  return tail.ends_with("\n}\n") || (tail.ends_with("}\n") && tail.find(std::string("\n") + kKeysEnd) != tail.npos);
}

/// Whether there was something to end. What has no frame goes.
bool endCut(const fs::path& file, int descriptor) {
  const std::optional<size_t> cut = cutAt(textOf(file));
  if (!cut) return false;
  const Shot shot = loadShot(file);
  if (shot.camera.empty()) {
    fs::remove(file);
    return false;
  }
  if (ftruncate(descriptor, off_t(*cut)) != 0) return false;
  appendAll(descriptor, endLine(shot.seconds));
  return true;
}

} // namespace

std::vector<fs::path> endCutShots(const fs::path& folder) {
  std::vector<fs::path> ended;
  std::error_code none;
  for (fs::directory_iterator at(folder, none), end; !none && at != end; at.increment(none)) {
    const fs::path file = at->path();
    std::error_code unseen;
    if (!file.filename().string().starts_with("walk-") || file.extension() != ".json" ||
        !fs::is_regular_file(fs::symlink_status(file, unseen)) || looksEnded(file))
      continue;
    try {
      if (withUnheld(file, [&](int descriptor) { return endCut(file, descriptor); })) ended.push_back(file);
    } catch (const std::exception&) { // it stays as it is
    }
  }
  std::ranges::sort(ended);
  return ended;
}

} // namespace lambent

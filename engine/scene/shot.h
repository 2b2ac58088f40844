// Shots: scripted camera paths with moving lights and objects, as JSON (format in README). Paths are relative to the
// shot file. Unknown keys are errors that name the nearest known key.
#pragma once

#include "engine/core/files.h"
#include "engine/scene/scene.h"

#include <map>
#include <memory>

namespace lambent {

struct CameraKey {
  double t = 0;            // seconds
  dvec3 eye{0}, target{0}; // in the file's coordinates: see Scene::origin
  float fovY = 1.0f;       // radians (degrees in the file)
};

/// Any subset of a node's placement and a light's colour at time t; absent fields keep the node's own value.
struct NodeKey {
  double t = 0;
  std::optional<dvec3> position; // metres, in the parent's space
  std::optional<vec3> rotation;  // degrees, Euler XYZ in the file; intrinsic Y·X·Z order
  std::optional<vec3> direction; // lights: the way the light travels, world space
  std::optional<vec3> intensity; // lights: per channel
};

/// What somebody who played did to the scene, at time t and until the next moment: game/rules/props.h shows it. World
/// space, from the scene's origin.
struct PlayedMoment {
  struct Thing {
    uint32_t number = 0; // of those taken so far
    std::string kind;
    vec3 centre{0};
    float yaw = 0; // radians
    bool operator==(const Thing&) const = default;
  };
  struct Torch {
    vec3 position{0}, direction{0, 0, -1}, intensity{0};
    bool operator==(const Torch&) const = default;
  };
  double t = 0;
  std::map<std::string, double> movers; // where doors and lifts are that were used, in stops
  std::vector<Thing> things;
  vec3 lampIntensity{0}; // of carried lamps, W/sr
  std::optional<double> hour;
  std::optional<Torch> torch;
  bool operator==(const PlayedMoment&) const = default;
};

struct Shot {
  std::filesystem::path file;
  std::filesystem::path scene;
  double unit = 1; // of the scene's file, metres: what the shot says is in metres
  double fps = 30, seconds = 0;
  std::vector<CameraKey> camera;                      // empty: the scene's own camera
  std::map<std::string, std::vector<NodeKey>> lights; // by node name
  std::map<std::string, std::vector<NodeKey>> objects;
  std::vector<PlayedMoment> played;
  std::vector<vec2> pixels;               // tracked pixels, (u,v) in [0,1], v down
  std::map<std::string, std::string> set; // settings that belong to the shot, as --set key=value

  int frameCount() const;
};

constexpr double kLongestShot = 86400; // seconds

/// Loads a shot. Throws InputError for a missing file, bad JSON (with line), unknown key, wrong type, keys out of time
/// order. Of one that a ShotWriter was not able to end it has all whole frames.
Shot loadShot(const std::filesystem::path& file);
/// Saves a shot: written to a temporary name, then renamed.
void saveShot(const Shot& shot, const std::filesystem::path& file);

/// A shot whose frames are appended to its file as they come, so that whatever ends the program loses none. Until end()
/// the file lacks its last line; only so much is kept in memory as a frame takes.
class ShotWriter {
 public:
  /// Makes a new file of what `shot` holds beside camera, played and seconds. Throws RunError, also where there is one.
  ShotWriter(const Shot& shot, const std::filesystem::path& file);
  ~ShotWriter();

  /// Appends a key, and what was played from the key before on until then. Throws RunError where the disk is full, and
  /// where the shot would be longer than loadShot takes: the file then is as it was.
  void add(const CameraKey& key, const std::vector<PlayedMoment>& played);
  /// Throws likewise.
  void end(double seconds);

 private:
  std::unique_ptr<AppendedFile> file_;
  const std::string name_;
  const double last_; // seconds: the latest key
  bool first_ = true;
};

/// Ends shots walk-N.json in a folder that a program began and was killed at; returns those. What somebody still writes
/// is left alone, and what has no frame goes.
std::vector<std::filesystem::path> endCutShots(const std::filesystem::path& folder);

/// A camera as a key of a shot. `origin`: the scene's.
CameraKey keyOf(const CameraView& camera, const dvec3& origin, double t);

/// Camera of the shot at time t: eye and target on a Catmull-Rom spline through the keys, held before the first and
/// after the last, counted from `origin`: the scene's. Requires shot.camera not empty.
CameraView shotCamera(const Shot& shot, double t, const dvec3& origin);

/// Returns what was played at time t; between two moments, what both have is interpolated. Requires shot.played not
/// empty.
PlayedMoment playedAt(const Shot& shot, double t);

/// Applies animate(scene, t), then the shot's light and object keys (linear between keys), then world transforms.
/// Throws InputError for a node that the scene lacks (nearest name given).
void poseShot(Scene& scene, const Shot& shot, double t);

} // namespace lambent

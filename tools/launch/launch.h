// Options that `lambent` and `walkthrough` share, and what they open with them: scene, shot, camera, lights, settings.
#pragma once

#include "engine/core/memory.h"
#include "engine/core/open_watch.h"
#include "engine/scene/scene.h"
#include "engine/scene/shot.h"
#include "gi/plan/settings.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace lambent {

class Props;

/// As parsed; texts are checked by openLaunch.
struct LaunchOptions {
  std::string scene;          // glTF file or shot file (.json)
  std::string sceneName;      // of several in the file
  FileTrust trust;            // in what it reads and asks for
  bool twoSided = false;      // no back is hidden
  std::optional<double> unit; // of the file, metres; none: guessed
  std::string camera, eye, target, size, sky, daylight, technique, preset;
  double skyScale = 1, skyTurn = 0;         // of a picture; degrees
  std::optional<float> fovDegrees, sunSize; // sunSize: degrees across
  std::vector<std::string> set, suns, points;
  std::optional<int> bounces;
  std::string cube;                 // file
  std::vector<std::string> written; // results: none may be a file that the scene is read from
  uint32_t seed = 1;
  int threads = 0; // 0 = all cores
};

/// Refuses empty text for every option of the command, and "nan" and "inf" for those that take a number: ranges let
/// the first pass.
void refuseUnusable(CLI::App& command);
/// Declares the common options on a command. `options` must outlive the parse.
void addLaunchOptions(CLI::App& command, LaunchOptions& options);

/// Preset, then the shot's own settings, then technique, --set and --bounces. Throws InputError, also where they
/// contradict each other.
Settings chosenSettings(const LaunchOptions& options, const std::optional<Shot>& shot);

/// Where the watch over a file (engine/core/open_watch.h) ends. FirstPicture: by Viewer's first frame, or traceImage.
enum class WatchUntil { Opened, FirstPicture };

/// Everything that a frame is made from.
class LaunchContext {
 public:
  LaunchContext();
  ~LaunchContext();

  Scene scene;
  std::optional<Shot> shot;
  std::unique_ptr<Props> props; // what somebody plays or, as the shot has it, played with; null: nobody
  HeldMemory held{"scene"};     // its meshes and textures
  CameraView camera; // of the command line, the file or a default; the shot's camera comes first where it has one
  double unit = 1;   // of the scene's file, metres
  bool cameraGiven = false; // from the command line: overrides the shot's
  Settings settings;
  uint32_t seed = 1;
  std::vector<std::string> notes;   // defaults that were chosen, one line each
  std::unique_ptr<OpenWatch> watch; // until the first picture

  /// Poses scene and camera at time t and extracts the view; valid until the next call.
  SceneView at(double t);

 private:
  SceneExtractor extractor_;
};

/// Loads and checks everything. A scene without light gets a stated default: a clear sky and its sun, or where none of
/// the sky reaches a lamp by the camera. Also applies `threads`, to OpenGL on software Mesa too, so call it before a
/// context is made. Throws InputError. A watch ends the program where the file takes too much until `until`.
std::unique_ptr<LaunchContext> openLaunch(const LaunchOptions& options, WatchUntil until = WatchUntil::Opened);

/// A note where settings take virtual lights from reflective shadow maps, which see light of some kinds only.
/// openLaunch does it for the stage's own.
void tellWhatIsLeftOut(LaunchContext& stage, const Settings& settings);
/// Its two halves, for who loads beside a window: the first before there is a context, the second on any thread. The
/// first throws RunError where the machine gives no threads or memory.
void useThreads(int threads);
std::unique_ptr<LaunchContext> loadLaunch(const LaunchOptions& options, const LoadStep& step);

/// Width and height of --size. Throws InputError.
std::pair<int, int> sizeOf(const std::string& text);

/// Such a sun or lamp for a scene that only lamps that glow or a sky light: reflective shadow maps need punctual
/// lights.
void needPunctualLight(LaunchContext& stage);

/// Has programs read their shaders from LAMBENT_SHADERS, or where they run in the tree that they were built from, from
/// its folder, so that changes show; else from themselves. Throws InputError where there is no such folder.
void chooseShaders();

/// Folder of the bundled scenes: LAMBENT_CONTENT, else ../share/lambent/content beside the executable, else the source
/// tree's. Throws InputError naming the places when none is there.
std::filesystem::path findContentFolder();

} // namespace lambent

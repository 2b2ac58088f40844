// Hard cases: scenes and edits on which global illumination goes wrong. Each is a row: what it is, why it is hard,
// between what its light must lie, and the world. hard_test.cpp runs them; rows stand in the files *_cases.cpp.
#pragma once

#include "engine/scene/scene.h"
#include "gi/plan/settings.h"
#include "tests/support/hand_scene.h"

namespace lambent::test {

/// A world that may change from frame to frame.
struct HardWorld {
  /// Few lights and small maps, or what the preset says.
  explicit HardWorld(const char* preset = nullptr);

  HandScene scene;
  Settings settings;
  int frames = 3;
  std::function<void(int frame)> step; // before each frame but the first; what it changes, all may be
  std::vector<Aabb> addedOrRemoved;    // by the step

  /// A closed room from `lo` to `hi` of this albedo, seen from inside.
  void room(const vec3& lo = vec3(-1), const vec3& hi = vec3(1), const vec3& albedo = vec3(0.7f));
  LightView& lamp(const vec3& position, float intensity = 1); // W/sr
};

/// Looks from `eye` to `target`, 32 × 18 pixels.
CameraView look(const vec3& eye, const vec3& target);

/// Of the mean irradiance by indirect light, W/m², in the last frame: of smc. Other techniques, with few lights
/// noisier, may bring twice the most; of a leak, the most.
struct HardBounds {
  double least = 0, most = kInfinity;
  double change = kInfinity; // mean |difference| of the last two frames over the mean
  bool leak = false;         // `most` is what may pass through walls: of techniques that know who sees a light
};

/// Another world that must show the same picture.
struct HardTwin {
  std::function<void(HardWorld&)> make; // null: there is none
  bool mirrored = false;                // left is right in its picture
  double apart = 0.08;                  // its light, of that of the other
};

/// Which techniques show a case: all, or those that differ in how they find lights. With LAMBENT_LONG, every one shows
/// all.
enum class ShownBy { All, OneOfEachKind };

struct HardCase {
  const char *name, *reason;
  HardBounds bounds;
  std::function<void(HardWorld&)> make;
  ShownBy shownBy = ShownBy::All;
  // Reflective maps, light volumes, layered cubes: may show none of its light.
  bool tooFineForMaps = false, tooFineForVolumes = false, tooFineForCubes = false;
  HardTwin twin = {};
  double leastOfPresets = 1, mostOfPresets = 1; // factors on the bounds, where the document says why

  friend void PrintTo(const HardCase& c, std::ostream* out) { *out << c.name; }
};
const std::vector<HardCase>& hardCases();
/// Those that take minutes: with LAMBENT_LONG alone.
const std::vector<HardCase>& longCases();

} // namespace lambent::test

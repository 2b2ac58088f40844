// Hard cases: scenes and edits on which global illumination goes wrong. Each is a row: what it is, why it is hard,
// between what its light must lie, and the world. All run with every technique (hard_test.cpp).
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

struct HardCase {
  const char *name, *reason;
  HardBounds bounds;
  std::function<void(HardWorld&)> make;
};
const std::vector<HardCase>& hardCases();
/// Those that take minutes: with LAMBENT_LONG alone.
const std::vector<HardCase>& longCases();

} // namespace lambent::test

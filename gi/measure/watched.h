// Points of a picture that measurements watch over the frames of a shot.
#pragma once

#include "engine/scene/shot.h"
#include "engine/trace/embree_query.h"
#include "gi/plan/settings.h"
#include "gi/reference/path_tracer.h"

#include <memory>

namespace lambent {

/// The shot's own points first, then the cell centres of a grid; (u, v) in [0, 1], v down.
struct TrackedPixels {
  std::vector<vec2> points;
  size_t marked = 0; // the shot's own
};
TrackedPixels trackedPixels(const Shot& shot, int grid);

/// What is watched: indirect light, or where settings turn that off, direct light with what surfaces emit.
inline bool watchesDirect(const Settings& settings) { return settings.effects[EffectId::Indirect] == EffectMode::Off; }

/// Radiance of one watched point and its standard error, per channel.
struct TrackedValue {
  vec3 radiance{0}, error{0};
};
/// Zero where the camera sees no surface.
TrackedValue trackedValue(const PixelSums& sums, const SurfaceHit& surface, uint32_t samples, bool direct = false);

/// What commands that watch points set before what their command line says.
inline constexpr const char* kLambertReceivers = "gather.glossy=off";
/// Throws InputError when receivers are to be glossy: values and their truth are those of Lambert surfaces.
void refuseGlossy(const Settings& settings);

/// Rays, lights, and what the camera sees at the points, of the present frame.
class WatchedScene {
 public:
  explicit WatchedScene(std::vector<vec2> points) : points_(std::move(points)) {}
  void update(const SceneView& view);

  std::span<const vec2> points() const { return points_; }
  const RayQuery& rays() const { return *rays_; }
  const LightSet& lights() const { return lights_; }
  std::span<const SurfaceHit> surfaces() const { return surfaces_; }
  /// Whether the camera saw a surface: [frame][point], of all frames.
  const std::vector<std::vector<bool>>& seen() const { return seen_; }

 private:
  std::vector<vec2> points_;
  std::unique_ptr<EmbreeQuery> rays_;
  LightSet lights_;
  std::vector<SurfaceHit> surfaces_;
  std::vector<std::vector<bool>> seen_;
};

} // namespace lambent

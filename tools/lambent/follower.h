// A technique that is followed over the frames of a shot.
#pragma once

#include "engine/platform/gl_context.h"
#include "gi/frame/gi_frame.h"
#include "gi/vpl/smc.h"
#include "gi/vpl/sources.h"
#include "tools/lambent/stability_report.h"

#include <optional>

namespace lambent {

/// A technique with all that it keeps between frames. Where its VPLs have shadow maps or come from reflective ones,
/// whole frames are drawn and the tracked pixels are read from the indirect buffer; else they alone are gathered, each
/// from all VPLs by rays.
class Follower {
 public:
  /// `settings` are those of the technique. A `context` is made where it is needed and lacks; it must outlive this.
  Follower(const Settings& settings, const std::string& name, uint32_t seed, std::optional<GlContext>& context);

  /// Radiance of indirect light at the tracked points of this frame.
  std::vector<vec3> frame(const SceneView& view, const RayQuery& rays, const LightSet& lights,
                          std::span<const vec2> points, std::span<const SurfaceHit> surfaces);

  /// Of all frames but the first, which warms up.
  double medianPlaceMs();

  TechniqueRun run;

 private:
  std::vector<vec3> drawn(const SceneView& view, std::span<const vec2> points);
  void place(const std::vector<StageTime>& stages);

  Settings settings_;
  uint32_t seed_;
  VplSet set_;
  std::optional<GiFrame> gi_;
  std::vector<double> placeMs_;
};

} // namespace lambent

// Lights of the command line, and those that a scene without any gets.
#pragma once

#include "engine/trace/embree_query.h"
#include "tools/launch/launch.h"

#include <optional>

namespace lambent {

/// Rays of a view, made when first asked for. The view must outlive it.
class RaysOnce {
 public:
  explicit RaysOnce(const SceneView& view) : view_(view) {}
  const SceneView& view() const { return view_; }
  const RayQuery& operator()() {
    if (!rays_) rays_.emplace(*view_.assets).update(view_);
    return *rays_;
  }

 private:
  const SceneView& view_;
  std::optional<EmbreeQuery> rays_;
};

/// Three finite numbers with commas between them. Throws InputError.
dvec3 threeNumbers(const std::string& option, const std::string& text);

/// --sun, --point, --sky and --daylight, which takes the place of the scene's own sky and suns. Throws InputError.
void addGivenLights(LaunchContext& stage, const LaunchOptions& options);

/// A clear sky and its sun for a scene that has no light, or where what shines hardly lights it; a lamp by the camera
/// where no sky reaches it. `rays`: of the scene as it is.
void lightWhatIsDark(LaunchContext& stage, const LaunchOptions& options, RaysOnce& rays);

} // namespace lambent

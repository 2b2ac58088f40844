// Global illumination as engines use it: a frame takes a view and gives light on its surfaces, as textures. The frame
// itself is read top to bottom in gi_frame.cpp. Needs no OpenGL header; what it gives and takes of OpenGL's are names.
// To look at it (composite, exposure, tone mapping, debug views): gi/viewer.
#pragma once

#include "engine/trace/ray_query.h"
#include "engine/view/scene_view.h"
#include "gi/contract/figures.h"
#include "gi/contract/makers.h"
#include "gi/contract/surfaces.h"
#include "gi/plan/settings.h"
#include "gi/plan/techniques.h"
#include "gi/visibility/shadow_agreement.h"
#include "gi/vpl/vpl_set.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace lambent {

struct FrameOutputs; // gi/contract/frame_outputs.h
struct PassContext;

/// Owns all GI state of one scene in the current GL context (OpenGL 4.5, the host's or ours). Not copyable; destroy
/// while the context is current. The same views and settings give the same light to the bit, unless `makers` are
/// measured.
class GiFrame {
 public:
  /// `shaders`: their folder, empty for the built-in ones; nothing: as gl::shaderFolder.
  explicit GiFrame(const Settings& settings, uint32_t seed = 1, Makers makers = Makers::ByRule,
                   const std::optional<std::filesystem::path>& shaders = {});
  ~GiFrame();

  /// Makes this as a new GiFrame with the present settings: nothing of earlier frames is kept.
  void restart();

  Settings& settings(); // may be changed between frames; takes effect at the next one
  const Settings& settings() const;

  /// Computes one frame of `view` into textures of the view's size. The first frame warms the VPL set up. Where nothing
  /// changed and the technique has converged, nothing is computed and the last outputs stay. With frame.overlap the
  /// VPLs of this view are still being updated when it returns, and its assets read (SceneAssets::readers). The
  /// state of the context is left as it was. `progress` (may be empty) is called during the warm-up with done and total
  /// iterations. With `host` the surfaces are not drawn but taken over; they must be those of the view. Throws
  /// InputError where settings contradict each other, or a host's texture does not fit.
  const FrameStats& run(const SceneView& view, const std::function<void(int, int)>& progress = {},
                        const HostSurfaces* host = nullptr);

  /// Returns the irradiance of the last frame at its surfaces, W/m², albedo not included: names of RGBA32F textures of
  /// the view's size, rows from the bottom, valid until the next run; alpha is the frame's own. 0: there is no such
  /// light.
  uint32_t directIrradiance() const;
  uint32_t indirectIrradiance() const;
  /// Says whether another frame of the same view, drawn alike, would bring nothing new.
  bool converged() const;
  /// Returns all that the last frame made.
  const FrameOutputs& outputs() const;

  /// Returns irradiance at points of the last frame's scene, W/m², by its lights: the virtual ones, all with a ray
  /// each, and the scene's own. Each has a position (world space), a unit normal and the same as geometric normal.
  /// Waits for an update of the VPLs that still runs. Throws InputError where the technique has no virtual lights on
  /// the CPU.
  std::vector<vec3> indirectAt(std::span<const SurfaceHit> points) const;
  std::vector<vec3> directAt(std::span<const SurfaceHit> points) const;

  /// Compares the shadow maps of the present VPLs with each other and with rays, as `view` (the last one run) sees
  /// them.
  ShadowAgreement compareShadowMaps(const SceneView& view, int slots, int points,
                                    const std::function<void(int, int)>& progress = {});

  /// Compiles again the shaders that changed on disk; returns one message per program touched. A failed one keeps its
  /// last good version.
  std::vector<std::string> reloadShaders();

  const FrameStats& stats() const; // of the last frame
  /// Returns the VPLs. Waits for an update that still runs in parallel with the GPU.
  const VplSet& vpls() const;
  const RayQuery& rays() const;
  /// Returns programs and timers, for code that draws with these outputs.
  PassContext context() const;

 private:
  struct Kept;
  std::unique_ptr<Kept> kept_;
};

} // namespace lambent

// Global illumination as programs use it. The frame itself is read top to bottom in gi_frame.cpp:
// world → plan → lights → surfaces → patches → direct → seen → gathered → indirect → picture.
// Needs no OpenGL header; what it gives and takes of OpenGL's are names.
#pragma once

#include "engine/core/image.h"
#include "engine/scene/scene_view.h"
#include "engine/trace/ray_query.h"
#include "gi/contract/figures.h"
#include "gi/contract/surfaces.h"
#include "gi/plan/settings.h"
#include "gi/plan/techniques.h"
#include "gi/visibility/shadow_agreement.h"
#include "gi/vpl/vpl_set.h"

#include <functional>
#include <memory>
#include <string>

namespace lambent {

/// What may be shown or read back. The first seven are meant for users; the others are debug views.
enum class Buffer : int {
  Beauty,
  Direct,
  Indirect,
  Irradiance,
  Albedo,
  Normal,
  Depth,
  Emission,   // radiance the visible surfaces emit
  Unfiltered, // irradiance before the cross-bilateral filter: shows the 4×4 subsets
  Vpls,       // beauty with the VPLs drawn in: colour = intensity, ring = age
  ShadowMaps, // the first paraboloid maps as a contact sheet
  Patches, // irradiance with the patches of the multiresolution buffer: their size as a colour, blue coarse, red fine
  Nan,     // NaN magenta, infinity cyan, else grey beauty
};
/// Throws InputError with the nearest name.
Buffer bufferByName(const std::string& name);
const std::vector<std::string>& bufferNames();

/// Owns all GI state of one scene in the current GL context. Not copyable; destroy while the context is current.
class GiFrame {
 public:
  explicit GiFrame(const Settings& settings, uint32_t seed = 1);
  ~GiFrame();

  /// As a new one with the present settings: nothing is known of frames before.
  void restart();

  Settings& settings(); // may be changed between frames; takes effect at the next one

  /// Computes one frame of `view` into textures of the view's size. The first frame warms the VPL set up. Where nothing
  /// changed and the VPLs have settled, nothing is computed and the last picture stays. With frame.overlap the VPLs of
  /// this view are still being updated when it returns.
  /// `progress` (may be empty) is called during the warm-up with done and total iterations.
  /// With `host` the surfaces are not drawn but taken over; they must be those of the view.
  /// Throws InputError where settings contradict each other, or a host's texture does not fit.
  const FrameStats& run(const SceneView& view, const std::function<void(int, int)>& progress = {},
                        const HostSurfaces* host = nullptr);

  /// The last frame as linear values: radiance (beauty, direct, indirect), irradiance, albedo, world normal, depth in
  /// metres along the view direction.
  Image read(Buffer buffer) const;
  /// The last frame as shown on a display: exposure, tone mapper, sRGB (albedo, normal, depth mapped to visible
  /// ranges).
  Image8 readDisplay(Buffer buffer) const;
  /// Name of the texture that holds the last frame's radiance (beauty) or irradiance (direct, before albedo;
  /// irradiance): RGBA32F, rows from the bottom, valid until the next run. 0 where it was not made.
  uint32_t texture(Buffer buffer) const;
  /// Draws the last frame as shown on a display into the framebuffer bound as `framebuffer`, scaled to its size.
  void present(Buffer buffer, uint32_t framebuffer, int width, int height) const;

  // A truth of the last frame's view beside the picture. Of beauty, direct, indirect or irradiance only.

  /// Takes it over: linear, of the picture's size, as read() gives the buffer.
  void takeTruth(const Image& truth);
  /// present; right of `divider`, a share of the width, the truth of the buffer, shown alike.
  void presentBesideTruth(Buffer buffer, float divider, uint32_t framebuffer, int width, int height) const;
  /// Draws how far the buffer is from its truth (shaders/shared/error_color.h); `full`: the error that has the full
  /// colour, in the buffer's unit.
  void presentError(Buffer buffer, float full, uint32_t framebuffer, int width, int height) const;

  /// Shadow maps of the present VPLs held against each other and against rays, as `view` (the last one run) sees them.
  ShadowAgreement compareShadowMaps(const SceneView& view, int slots, int points,
                                    const std::function<void(int, int)>& progress = {});

  /// Compiles shaders anew that changed on disk; one message per program touched. A failed one keeps its last good
  /// version.
  std::vector<std::string> reloadShaders();

  const FrameStats& stats() const; // of the last frame
  const VplSet& vpls() const;
  const RayQuery& rays() const;
  float exposure() const;

 private:
  struct Kept;
  std::unique_ptr<Kept> kept_;
};

} // namespace lambent

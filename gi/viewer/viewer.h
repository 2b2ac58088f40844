// Looking at global illumination: the frame (gi/frame/gi_frame.h), the image that comes of it, and every buffer on the
// way. For the walkthrough, tools and tests; an engine that composes its own image does without. Needs no OpenGL
// header.
#pragma once

#include "engine/image/image.h"
#include "gi/frame/gi_frame.h"

namespace lambent {

struct Look; // gi/viewer/viewer_stages.h

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
  Patches,   // irradiance with the patches of the multiresolution buffer: their size as a colour, blue coarse, red fine
  Fragments, // direct irradiance with the fragments of area lights (paper 4), coloured as patches
  Nan,       // NaN magenta, infinity cyan, else grey beauty
};
/// Finds a buffer. Throws InputError with the nearest name.
Buffer bufferByName(const std::string& name);
const std::vector<std::string>& bufferNames();

/// A GiFrame with a view on it. Not copyable; destroy while the context is current.
class Viewer {
 public:
  explicit Viewer(const Settings& settings, uint32_t seed = 1, Makers makers = Makers::ByRule);
  ~Viewer();

  /// Runs GiFrame::run, then makes the image. The figures are those of both.
  const FrameStats& run(const SceneView& view, const std::function<void(int, int)>& progress = {},
                        const HostSurfaces* host = nullptr);
  /// Makes this as a new Viewer with the present settings: nothing of earlier frames is kept.
  void restart();
  const FrameStats& stats() const; // of the last frame

  const GiFrame& gi() const { return gi_; }
  // As those of GiFrame.
  Settings& settings() { return gi_.settings(); }
  const VplSet& vpls() const { return gi_.vpls(); }
  const RayQuery& rays() const { return gi_.rays(); }
  std::vector<std::string> reloadShaders() { return gi_.reloadShaders(); }
  ShadowAgreement compareShadowMaps(const SceneView& view, int slots, int points,
                                    const std::function<void(int, int)>& progress = {}) {
    return gi_.compareShadowMaps(view, slots, points, progress);
  }

  /// Lets seconds go by before the next frame, for image.adaptation.
  void passTime(double seconds) { elapsed_ += float(seconds); }
  /// Factor on radiance before tone mapping: image.exposure, or what the first frame asked for, adapted to later ones.
  float exposure() const { return exposure_; }

  /// Reads the last frame as linear values: radiance (beauty, direct, indirect, emission), irradiance, albedo, world
  /// normal, depth in metres along the view direction. Empty before the first frame, and after one that something was
  /// thrown out of.
  Image read(Buffer buffer) const;
  /// Returns the name of a texture that holds the same on the GPU: float, rows from the bottom, valid until the next
  /// run. 0 for depth (GBuffer::depth holds it reversed) and debug views, and before the first frame.
  uint32_t texture(Buffer buffer) const;
  /// Reads the last frame as shown on a display: exposure, tone mapper, sRGB (albedo, normal, depth mapped to visible
  /// ranges).
  Image8 readDisplay(Buffer buffer) const;
  /// Draws the buffer as a display shows it into the framebuffer named `framebuffer`, scaled to its size.
  void present(Buffer buffer, uint32_t framebuffer, int width, int height) const;

  // A truth of the last frame's view next to the image. Of beauty, direct, indirect or irradiance only.

  /// Takes the truth over: linear, of the image's size, as read() gives the buffer.
  void takeTruth(const Image& truth);
  /// Presents the buffer and, right of `divider` (a share of the width), its truth, shown alike.
  void presentBesideTruth(Buffer buffer, float divider, uint32_t framebuffer, int width, int height) const;
  /// Draws how far the buffer is from its truth (shaders/shared/error_color.h); `full`: the error that has the full
  /// colour, in the buffer's unit.
  void presentError(Buffer buffer, float full, uint32_t framebuffer, int width, int height) const;

 private:
  struct Passes;
  bool show(Buffer buffer) const; // false: there is no frame
  Look look() const;
  void expose(bool drawn, float elapsed);

  GiFrame gi_;
  std::unique_ptr<Passes> passes_;
  float exposure_ = 0, measured_ = 0, firstMeasured_ = 0; // 0: not yet
  bool given_ = false;                                    // exposure_: by the settings
  float elapsed_ = 0;                                     // seconds since the last frame
};

} // namespace lambent

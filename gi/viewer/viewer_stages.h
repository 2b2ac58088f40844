// The image, and looking at everything that led to it.
#pragma once

#include "engine/image/image.h"
#include "engine/view/sky.h"
#include "gi/contract/frame_outputs.h"
#include "gi/contract/pass_context.h"
#include "gi/plan/settings.h"

namespace lambent {

/// The sky as what is seen where no surface is (shaders/lib/background.glsl). Keeps its picture, if it is one, as a
/// texture.
class Background {
 public:
  std::vector<std::string> variants(const Sky& sky) const;
  /// Sets what the program needs, which is in use; the sky is seen by the camera of `surfaces`.
  void set(const gl::Program& program, const Sky& sky, const GBuffer& surfaces);

 private:
  std::shared_ptr<const SkyImage> shown_;
  gl::Texture texture_;
};

enum class Buffer : int; // gi/viewer/viewer.h

struct CompositeInputs {
  const GBuffer& surfaces;
  SurfaceLighting direct, indirect;
  Sky sky;
  bool emission = true; // of surfaces
  bool mixes = false;   // pixels where blended surfaces are
};

class CompositePass {
 public:
  explicit CompositePass(PassContext context) : context_(context) {}
  /// Adds up emission + albedo/π · (E_direct + E_indirect) + glossy light; the sky where nothing is seen.
  /// Radiance towards the camera, W/(m² sr), RGBA32F; a = 1 on surfaces, 0 on background.
  const gl::Texture& run(const CompositeInputs& in);

 private:
  const gl::Texture& mixBlended(const gl::Texture& blended);

  PassContext context_;
  gl::Texture radiance_, black_, mixed_;
  gl::Framebuffer framebuffer_, mixedFramebuffer_;
  Background background_;
};

/// The exposure that suits an image's surfaces (engine/image/exposure.h).
class ExposureMeter {
 public:
  explicit ExposureMeter(PassContext context) : context_(context) {}
  /// Returns it; 0 when there is no light. Reads the image back.
  float measureNow(const gl::Texture& radiance);
  /// Measures it for the next read, with the weights that the measurement before found; at once after a black image.
  void measure(const gl::Texture& radiance);
  /// What the image measured last asks for, once; 0 where there is no light in it, or nothing new. Called before a
  /// frame is drawn it waits for the one before alone.
  float read();

 private:
  PassContext context_;
  gl::Texture sums_;
  gl::Framebuffer framebuffer_;
  float dark_ = 0; // ExposureSums::dark; 0: not known, of a black image
  float now_ = 0;  // measured at once where it was not known; else 0
  bool unread_ = false;
};

// Looking at it ----------------------------------------------------------------------------------------------------

/// Everything a frame made, for read-back and views.
struct FrameResults : FrameOutputs {
  const gl::Texture* radiance = nullptr; // CompositePass
};

struct Look {
  float exposure = 1; // factor on radiance
  ToneMapper toneMapper = ToneMapper::Reinhard;
  bool markNan = true;                           // NaN magenta and infinity cyan in every radiometric view
  AntiAliasing antiAliasing = AntiAliasing::Off; // of beauty, direct and indirect
};

/// Draws the error of a buffer of light in place of the buffer (shaders/shared/error_color.h).
struct ErrorView {
  const gl::Texture* truth = nullptr; // linear, of the same buffer and size; null: the buffer itself is drawn
  float full = 1;                     // error with the full colour, in the buffer's unit
};

class DisplayPass {
 public:
  explicit DisplayPass(PassContext context) : context_(context) {}

  /// Draws `buffer` as a display shows it into a texture (RGB8, sRGB-encoded, dithered; alpha means nothing) of the
  /// image's size.
  const gl::Texture& run(Buffer buffer, const FrameResults& frame, const Look& look, const ErrorView& error = {});
  /// Draws the texture of the last run into framebuffer `framebuffer`, scaled to width × height. With `right`, that
  /// texture is shown right of `divider`, a share of the width, and a line separates the two.
  void present(uint32_t framebuffer, int width, int height, const gl::Texture* right = nullptr, float divider = 1);
  /// Reads back the texture of the last run.
  Image8 read() const;

 private:
  void draw(Buffer buffer, const FrameResults& frame, const Look& look, const ErrorView& error, bool smooth);
  void antiAlias();
  void drawVpls(const FrameResults& frame);

  PassContext context_;
  Background background_;
  gl::Texture display_, aliased_, black_; // aliased_: a copy of display_ before anti-aliasing
  gl::Framebuffer framebuffer_;
  gl::Ring sprites_{"display/vpls"};
  gl::VertexArray spriteArray_;
};

/// A truth of what is shown, made on the CPU, as a display shows it.
class TruthDisplay {
 public:
  explicit TruthDisplay(PassContext context) : context_(context), display_(context) {}

  /// Takes the truth of a buffer over: beauty, direct, indirect or irradiance; linear, row 0 at the top.
  void take(const Image& truth, const FrameResults& frame);
  /// Draws the truth as the frame's own buffer would be. It must have been taken for a frame of this size.
  const gl::Texture& run(Buffer buffer, const FrameResults& frame, const Look& look);
  const gl::Texture& linear() const { return linear_; }

 private:
  PassContext context_;
  gl::Texture linear_;
  DisplayPass display_;
};

/// Reads linear values of a buffer: radiance for beauty, direct (emission and background included: beauty − indirect),
/// indirect, emission; irradiance (indirect, filtered) and unfiltered; albedo; world normal; depth in metres along the
/// view direction, 0 on background. The other views give beauty. Stages that did not run read as black.
Image readBuffer(Buffer buffer, const FrameResults& frame);

} // namespace lambent

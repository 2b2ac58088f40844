#include "gi/gather/add_pixels.h"
#include "gi/viewer/viewer.h"
#include "gi/viewer/viewer_stages.h"

#include "engine/core/error.h"

namespace lambent {

void TruthDisplay::take(const Image& truth, const FrameResults& frame) {
  const gl::PassScope scope = context_.scope(StageId::Display);
  const int width = frame.surfaces.width, height = frame.surfaces.height;
  CHECK_EQ(truth.width, width);
  CHECK_EQ(truth.height, height);
  if (!linear_ || linear_.width() != width || linear_.height() != height)
    linear_ = gl::Texture("truth/linear", {.format = GL_RGBA32F, .width = width, .height = height});
  uploadPixels(linear_, truth.pixels, frame.surfaces, 1);
}

const gl::Texture& TruthDisplay::run(Buffer buffer, const FrameResults& frame, const Look& look) {
  CHECK_EQ(linear_.width(), frame.surfaces.width);
  CHECK_EQ(linear_.height(), frame.surfaces.height);
  CHECK(buffer == Buffer::Beauty || buffer == Buffer::Direct || buffer == Buffer::Indirect ||
        buffer == Buffer::Irradiance);
  FrameResults shown;
  shown.surfaces = frame.surfaces;
  // Irradiance is drawn over π. The others are radiance with all that belongs to it, as beauty is.
  if (buffer == Buffer::Irradiance)
    shown.indirect.irradiance = &linear_;
  else
    shown.radiance = &linear_;
  return display_.run(buffer == Buffer::Irradiance ? buffer : Buffer::Beauty, shown, look);
}

} // namespace lambent

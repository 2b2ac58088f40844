// Pictures that come from the CPU, as files.
#pragma once

#include "engine/core/image.h"
#include "gi/plan/settings.h"

#include <string>

namespace lambent {

/// .exr or .pfm; throws InputError for other names.
Image readLinear(const std::string& file);

/// .exr: the values as they are. .png: times `factor`, tone mapped, sRGB, as the display shows radiance but for the
/// dither (NaN magenta, infinity cyan). Throws InputError for other names.
void writePicture(const std::string& file, const Image& image, float factor,
                  ToneMapper toneMapper = ToneMapper::Reinhard);

/// |a − b| of pictures of the same size, times `factor`.
Image absoluteDifference(const Image& a, const Image& b, float factor = 1);
/// The factor that shows this value as mid grey.
inline float midGreyAt(double value) { return value > 0 ? float(0.25 / value) : 1.0f; }

/// What such a .png holds, before it is rounded: values of the display, 0 to 1.
Image shownImage(const Image& image, float factor, ToneMapper toneMapper = ToneMapper::Reinhard);
/// Writes such values as a .png.
void writeShown(const std::string& file, const Image& shown);

} // namespace lambent

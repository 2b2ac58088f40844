// Pictures: as files and as a display shows them, put together, with text and marks burnt in.
#pragma once

#include "engine/image/image.h"
#include "gi/plan/settings.h"

#include <filesystem>
#include <span>
#include <string>

namespace lambent {

/// An .exr, of `layer` where one is named, or a .pfm. Throws InputError for other names, and above 4096² texels where
/// the file has fewer bytes than texels.
Image readLinear(const std::string& file, const std::string& layer = {});

/// Checks before long work that `file` has an extension that can be written, and a folder that takes it.
void checkPictureName(const std::string& file);
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
void writeShown(const std::filesystem::path& file, const Image& shown);
/// NAME.png, and NAME-difference.png: eight times how far these values are from the truth's.
void writeShownBesideTruth(const std::filesystem::path& folder, const std::string& name, const Image& shown,
                           const Image& truthShown);

/// Around each point (u right, v down, 0 to 1) a ring, and next to it the point's index, white on black. `shown` holds
/// values of the display.
void drawMarks(Image& shown, std::span<const vec2> points);

/// Two of the same height, left and right.
Image beside(const Image& left, const Image& right);
Image8 beside(const Image8& left, const Image8& right);

/// White on a darkened strip at the lower edge, as tall as the picture asks; what is too long is cut off. ASCII.
void writeCaption(Image8& picture, const std::string& text);

/// Small pictures of a recording on one sheet, in rows from the upper left.
class ContactSheet {
 public:
  /// So many frames, evenly spaced from the first to the last of `total`, each of this size.
  ContactSheet(int count, int total, int width, int height);

  bool wants(int frame) const;
  /// A picture of the size, of the next frame that the sheet wants.
  void add(const Image8& picture);
  /// Those that were added; black where a row is not full. Empty where none was.
  Image8 sheet() const;

 private:
  const int count_, total_, width_, height_;
  std::vector<Image8> pictures_;
};

} // namespace lambent

// Pictures put together: beside each other, many on one sheet, with a line of text burnt in.
#pragma once

#include "engine/core/image.h"

#include <string>

namespace lambent {

/// Of the same height, left and right.
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

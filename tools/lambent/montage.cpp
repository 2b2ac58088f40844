#include "tools/lambent/montage.h"

#include "engine/core/error.h"

#include <stb/stb_easy_font.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace lambent {

namespace {

/// Copies a whole picture into another, its upper left corner at (x, y).
void paste(Image8& onto, const Image8& picture, int x, int y) {
  for (int row = 0; row < picture.height; ++row)
    std::memcpy(&onto.rgb[3 * (size_t(y + row) * onto.width + x)], &picture.rgb[3 * size_t(row) * picture.width],
                3 * size_t(picture.width));
}

Image8 blackPicture(int width, int height) { return {width, height, std::vector<uint8_t>(3 * size_t(width) * height)}; }

constexpr int kLetterHeight = 9, kLetterMargin = 2; // of stb_easy_font, in its units; g and p reach down

/// One of the four corners that the font gives per rectangle.
struct LetterVertex {
  float x, y, z;
  uint8_t color[4];
};

} // namespace

Image beside(const Image& left, const Image& right) {
  CHECK_EQ(left.height, right.height);
  Image out(left.width + right.width, left.height);
  for (int y = 0; y < out.height; ++y) {
    std::copy_n(&left.at(0, y), left.width, &out.at(0, y));
    std::copy_n(&right.at(0, y), right.width, &out.at(left.width, y));
  }
  return out;
}

Image8 beside(const Image8& left, const Image8& right) {
  CHECK_EQ(left.height, right.height);
  Image8 out = blackPicture(left.width + right.width, left.height);
  paste(out, left, 0, 0);
  paste(out, right, left.width, 0);
  return out;
}

void writeCaption(Image8& picture, const std::string& text) {
  const int unit = std::max(1, (picture.height + 100) / 200); // pixels per unit of the font
  const int strip = std::min(picture.height, unit * (kLetterHeight + 2 * kLetterMargin));
  const int top = picture.height - strip;
  for (size_t i = 3 * size_t(top) * picture.width; i < picture.rgb.size(); ++i) picture.rgb[i] /= 4;
  std::vector<LetterVertex> vertices(4 * 40 * (text.size() + 1)); // a letter has fewer than 40 rectangles
  std::string letters = text;
  const int rectangles = stb_easy_font_print(kLetterMargin, kLetterMargin, letters.data(), nullptr, vertices.data(),
                                             int(vertices.size() * sizeof(LetterVertex)));
  for (int r = 0; r < rectangles; ++r) {
    const LetterVertex &from = vertices[4 * size_t(r)], &to = vertices[4 * size_t(r) + 2]; // opposite corners
    for (int y = top + int(from.y) * unit; y < std::min(picture.height, top + int(to.y) * unit); ++y)
      for (int x = int(from.x) * unit; x < std::min(picture.width, int(to.x) * unit); ++x)
        std::fill_n(&picture.rgb[3 * (size_t(y) * picture.width + x)], 3, uint8_t(255));
  }
}

ContactSheet::ContactSheet(int count, int total, int width, int height)
    : count_(std::min(count, total)), total_(total), width_(width), height_(height) {}

bool ContactSheet::wants(int frame) const {
  const int next = int(pictures_.size());
  if (next >= count_) return false;
  return frame == (count_ > 1 ? int(std::lround(double(next) * (total_ - 1) / (count_ - 1))) : 0);
}

void ContactSheet::add(const Image8& picture) {
  CHECK(picture.width == width_ && picture.height == height_);
  pictures_.push_back(picture);
}

Image8 ContactSheet::sheet() const {
  const int count = int(pictures_.size());
  if (count == 0) return {};
  // About 4:3.
  const int columns = std::clamp(int(std::lround(std::sqrt(count * 4.0 * height_ / (3.0 * width_)))), 1, count);
  Image8 out = blackPicture(columns * width_, (count + columns - 1) / columns * height_);
  for (int i = 0; i < count; ++i) paste(out, pictures_[size_t(i)], i % columns * width_, i / columns * height_);
  return out;
}

} // namespace lambent

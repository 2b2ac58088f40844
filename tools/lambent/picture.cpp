#include "tools/lambent/picture.h"

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "shaders/shared/tone_map.h"

#include <stb/stb_easy_font.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace lambent {

namespace fs = std::filesystem;

namespace {

/// shaders/display.frag, MODE 0.
vec3 displayed(const vec3& value, float factor, ToneMapper toneMapper) {
  if (glm::any(glm::isnan(value))) return {1, 0, 1};
  if (glm::any(glm::isinf(value))) return {0, 1, 1};
  const vec3 c = glm::clamp(toneMapped(glm::max(value * factor, vec3(0)), int(toneMapper)), vec3(0), vec3(1));
  return {srgbFromLinear(c.x), srgbFromLinear(c.y), srgbFromLinear(c.z)};
}

/// Copies a whole picture of pixels of `channels` values each into another, its upper left corner at (x, y).
template <class T>
void paste(std::vector<T>& onto, int ontoWidth, const std::vector<T>& picture, int width, int channels, int x, int y) {
  const size_t row = size_t(width) * size_t(channels);
  for (size_t at = 0; at < picture.size(); at += row, ++y)
    std::copy_n(&picture[at], row, &onto[size_t(channels) * (size_t(y) * size_t(ontoWidth) + size_t(x))]);
}

Image8 blackImage(int width, int height) { return {width, height, std::vector<uint8_t>(3 * size_t(width) * height)}; }

constexpr int kLetterHeight = 9, kLetterMargin = 2; // of stb_easy_font, in its units; g and p reach down

/// Gives the pixels of the text's letters, whose upper left corner is at (0, 0), `unit` pixels per unit of the font.
void eachTextPixel(std::string text, int unit, const std::function<void(int, int)>& put) {
  struct Corner { // four per rectangle, as the font gives them
    float x, y, z;
    uint8_t color[4];
  };
  std::vector<Corner> corners(4 * 40 * (text.size() + 1)); // a letter has fewer than 40 rectangles
  const int rectangles =
      stb_easy_font_print(0, 0, text.data(), nullptr, corners.data(), int(corners.size() * sizeof(Corner)));
  for (int r = 0; r < rectangles; ++r) {
    const Corner &from = corners[4 * size_t(r)], &to = corners[4 * size_t(r) + 2];
    for (int y = int(from.y) * unit; y < int(to.y) * unit; ++y)
      for (int x = int(from.x) * unit; x < int(to.x) * unit; ++x) put(x, y);
  }
}

} // namespace

Image readLinear(const std::string& file, const std::string& layer) {
  const std::string extension = fs::path(file).extension().string();
  if (extension == ".exr" || !layer.empty()) {
    constexpr uint64_t kMostSmall = 4096 * 4096; // texels; larger pictures have a byte for each at least
    std::error_code unknown;
    const uintmax_t size = fs::file_size(file, unknown);
    return readExr(file, layer, std::max<uint64_t>(kMostSmall, unknown ? 0 : size));
  }
  if (extension == ".pfm") return readPfm(file);
  throw InputError(file, "not a linear picture (.exr or .pfm)");
}

void checkPictureName(const std::string& file) {
  const std::string extension = fs::path(file).extension().string();
  if (extension != ".png" && extension != ".exr")
    throw InputError(file, "not a picture format that can be written (.png or .exr)");
  checkWritable(file);
}

void writePicture(const std::string& file, const Image& image, float factor, ToneMapper toneMapper) {
  checkPictureName(file);
  if (fs::path(file).extension() == ".exr") return writeExr(file, image);
  writeShown(file, shownImage(image, factor, toneMapper));
}

Image absoluteDifference(const Image& a, const Image& b, float factor) {
  Image out = a;
  for (size_t i = 0; i < out.pixels.size(); ++i) out.pixels[i] = factor * glm::abs(a.pixels[i] - b.pixels[i]);
  return out;
}

Image shownImage(const Image& image, float factor, ToneMapper toneMapper) {
  Image out = image;
  for (vec3& pixel : out.pixels) pixel = displayed(pixel, factor, toneMapper);
  return out;
}

void writeShown(const fs::path& file, const Image& shown) {
  Image8 out{shown.width, shown.height, {}};
  for (const vec3& pixel : shown.pixels)
    for (int c = 0; c < 3; ++c) out.rgb.push_back(uint8_t(std::lround(255 * std::clamp(pixel[c], 0.0f, 1.0f))));
  writePng(file, out);
}

void writeShownBesideTruth(const fs::path& folder, const std::string& name, const Image& shown,
                           const Image& truthShown) {
  writeShown(folder / (name + ".png"), shown);
  writeShown(folder / (name + "-difference.png"), absoluteDifference(shown, truthShown, 8));
}

void drawMarks(Image& shown, std::span<const vec2> points) {
  constexpr int kRadius = 6, kReach = kRadius + 2, kUnit = 2; // pixels
  const auto put = [&](int x, int y, float grey) {
    if (x >= 0 && y >= 0 && x < shown.width && y < shown.height) shown.at(x, y) = vec3(grey);
  };
  for (size_t i = 0; i < points.size(); ++i) {
    const int x = int(points[i].x * float(shown.width)), y = int(points[i].y * float(shown.height));
    for (int dy = -kReach; dy <= kReach; ++dy)
      for (int dx = -kReach; dx <= kReach; ++dx) {
        const float off = std::abs(std::hypot(float(dx), float(dy)) - float(kRadius));
        if (off < 1.8f) put(x + dx, y + dy, off < 0.8f ? 1.0f : 0.0f);
      }
    std::string index = std::to_string(i);
    const int width = kUnit * stb_easy_font_width(index.data()), height = kUnit * kLetterHeight;
    const bool room = x + kReach + 2 * kUnit + width < shown.width;
    const int left = room ? x + kReach + kUnit : x - kReach - kUnit - width, top = y - height / 2;
    for (int v = -kUnit; v < height; ++v)
      for (int u = -kUnit; u < width; ++u) put(left + u, top + v, 0);
    eachTextPixel(index, kUnit, [&](int u, int v) { put(left + u, top + v, 1); });
  }
}

Image beside(const Image& left, const Image& right) {
  CHECK_EQ(left.height, right.height);
  Image out(left.width + right.width, left.height);
  paste(out.pixels, out.width, left.pixels, left.width, 1, 0, 0);
  paste(out.pixels, out.width, right.pixels, right.width, 1, left.width, 0);
  return out;
}

Image8 beside(const Image8& left, const Image8& right) {
  CHECK_EQ(left.height, right.height);
  Image8 out = blackImage(left.width + right.width, left.height);
  paste(out.rgb, out.width, left.rgb, left.width, 3, 0, 0);
  paste(out.rgb, out.width, right.rgb, right.width, 3, left.width, 0);
  return out;
}

void writeCaption(Image8& picture, const std::string& text) {
  const int unit = std::max(1, (picture.height + 100) / 200); // pixels per unit of the font
  const int strip = std::min(picture.height, unit * (kLetterHeight + 2 * kLetterMargin));
  const int top = picture.height - strip + unit * kLetterMargin;
  for (size_t i = 3 * size_t(picture.height - strip) * picture.width; i < picture.rgb.size(); ++i) picture.rgb[i] /= 4;
  eachTextPixel(text, unit, [&](int u, int v) {
    const int x = u + unit * kLetterMargin, y = v + top;
    if (x < picture.width && y < picture.height)
      std::fill_n(&picture.rgb[3 * (size_t(y) * picture.width + x)], 3, uint8_t(255));
  });
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
  Image8 out = blackImage(columns * width_, (count + columns - 1) / columns * height_);
  for (int i = 0; i < count; ++i)
    paste(out.rgb, out.width, pictures_[size_t(i)].rgb, width_, 3, i % columns * width_, i / columns * height_);
  return out;
}

} // namespace lambent

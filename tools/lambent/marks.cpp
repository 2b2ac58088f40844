#include "tools/lambent/marks.h"

#include <cmath>
#include <string>

namespace lambent {

namespace {

/// Digits of 3 × 5 texels, rows from the top, the left texel the highest bit.
constexpr uint8_t kDigits[10][5] = {{7, 5, 5, 5, 7}, {2, 6, 2, 2, 7}, {7, 1, 7, 4, 7}, {7, 1, 7, 1, 7},
                                    {5, 5, 7, 1, 1}, {7, 4, 7, 1, 7}, {7, 4, 7, 5, 7}, {7, 1, 1, 1, 1},
                                    {7, 5, 7, 5, 7}, {7, 5, 7, 1, 7}};
constexpr int kRadius = 6, kScale = 2, kDigitWidth = 4 * kScale, kDigitHeight = 5 * kScale; // pixels

void put(Image& image, int x, int y, float grey) {
  if (x >= 0 && y >= 0 && x < image.width && y < image.height) image.at(x, y) = vec3(grey);
}

void drawRing(Image& image, int x, int y) {
  const int reach = kRadius + 2;
  for (int dy = -reach; dy <= reach; ++dy)
    for (int dx = -reach; dx <= reach; ++dx) {
      const float off = std::abs(std::hypot(float(dx), float(dy)) - float(kRadius));
      if (off < 1.8f) put(image, x + dx, y + dy, off < 0.8f ? 1.0f : 0.0f);
    }
}

/// With its upper left corner at (x, y).
void drawText(Image& image, int x, int y, const std::string& digits) {
  for (int dy = -kScale; dy < kDigitHeight + kScale; ++dy)
    for (int dx = -kScale; dx < kDigitWidth * int(digits.size()); ++dx) put(image, x + dx, y + dy, 0);
  for (size_t i = 0; i < digits.size(); ++i)
    for (int row = 0; row < kDigitHeight; ++row)
      for (int column = 0; column < 3 * kScale; ++column)
        if (kDigits[digits[i] - '0'][row / kScale] >> (2 - column / kScale) & 1)
          put(image, x + int(i) * kDigitWidth + column, y + row, 1);
}

} // namespace

void drawMarks(Image& shown, std::span<const vec2> points) {
  for (size_t i = 0; i < points.size(); ++i) {
    const int x = int(points[i].x * float(shown.width)), y = int(points[i].y * float(shown.height));
    const std::string digits = std::to_string(i);
    const int width = kDigitWidth * int(digits.size()), aside = kRadius + 2 * kScale + 1;
    drawRing(shown, x, y);
    const bool room = x + aside + width < shown.width;
    drawText(shown, room ? x + aside : x - aside - width, y - kDigitHeight / 2, digits);
  }
}

} // namespace lambent

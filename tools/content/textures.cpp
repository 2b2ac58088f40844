#include "tools/content/textures.h"

#include "engine/core/image.h"
#include "tools/content/scene_builder.h"

#include <cmath>

namespace lambent::content {

namespace {

uint8_t encoded(double linear) {
  return uint8_t(std::lround(255.0 * srgbFromLinear(float(glm::clamp(linear, 0.0, 1.0)))));
}

} // namespace

Texture stoneSlabs(const std::string& name) {
  constexpr uint32_t kSize = 128, kRows = 4, kColumns = 2, kJoint = 1; // texels
  Texture t{name, kSize, kSize, {}};
  for (uint32_t y = 0; y < kSize; ++y)
    for (uint32_t x = 0; x < kSize; ++x) {
      const uint32_t row = y * kRows / kSize;
      const uint32_t slab = kSize / kColumns, height = kSize / kRows;
      const uint32_t shifted = (x + (row % 2) * slab / 2) % kSize;
      const bool joint = shifted % slab < kJoint || y % height < kJoint;
      const double tint = hashed(shifted / slab + 100, row) - 0.5;
      const double grain = hashed(x, y + 1000) - 0.5;
      const double light = joint ? 0.24 : 0.46 + 0.12 * tint + 0.04 * grain;
      const dvec3 color = light * dvec3(1.04, 1.0, 0.92 - 0.05 * tint);
      for (const double channel : {color.x, color.y, color.z}) t.rgba.push_back(encoded(channel));
      t.rgba.push_back(255);
    }
  return t;
}

Texture lattice(const std::string& name) {
  constexpr uint32_t kSize = 64;
  constexpr double kBar = 0.09; // half width of a bar, in cells across the diagonal
  Texture t{name, kSize, kSize, {}};
  for (uint32_t y = 0; y < kSize; ++y)
    for (uint32_t x = 0; x < kSize; ++x) {
      const double u = (x + 0.5) / kSize, v = (y + 0.5) / kSize;
      const auto nearLine = [](double s) { return std::abs(s - std::round(s)) < kBar; };
      const bool bar = nearLine(u + v) || nearLine(u - v);
      for (int channel = 0; channel < 3; ++channel)
        t.rgba.push_back(encoded(0.5)); // also where cut away, so that filtering does not darken the bars' edges
      t.rgba.push_back(bar ? 255 : 0);
    }
  return t;
}

} // namespace lambent::content

#include "tools/content/textures.h"

#include "engine/core/color.h"
#include "tools/content/scene_builder.h"

#include <cmath>

namespace lambent::content {

namespace {

uint8_t encoded(double linear) {
  return uint8_t(std::lround(255.0 * srgbFromLinear(float(glm::clamp(linear, 0.0, 1.0)))));
}

/// Smooth noise in [-1, 1] whose lattice of `cells` × `cells` repeats over the unit square.
double noise(double u, double v, uint32_t cells, uint32_t seed) {
  const double x = u * cells, y = v * cells;
  const double fx = x - std::floor(x), fy = y - std::floor(y);
  const auto at = [&](int dx, int dy) {
    const auto wrapped = [&](double s, int d) {
      return uint32_t(int64_t(std::floor(s)) + d + 4 * int64_t(cells)) % cells;
    };
    return 2 * hashed(wrapped(x, dx) + 1000 * wrapped(y, dy), seed) - 1;
  };
  const double sx = fx * fx * (3 - 2 * fx), sy = fy * fy * (3 - 2 * fy);
  return glm::mix(glm::mix(at(0, 0), at(1, 0), sx), glm::mix(at(0, 1), at(1, 1), sx), sy);
}

/// Octaves of noise, each half as strong and twice as fine as the one before.
double clouds(double u, double v, uint32_t cells, uint32_t seed, int octaves) {
  double sum = 0, weight = 1, total = 0;
  for (int i = 0; i < octaves; ++i, weight *= 0.5, cells *= 2) {
    sum += weight * noise(u, v, cells, seed + uint32_t(i));
    total += weight;
  }
  return sum / total;
}

/// Texture of `size` × `size` from a function of (u, v) at the texels' middles that gives their bytes.
template <class Texel> Texture fromTexels(const std::string& name, uint32_t size, const Texel& texel) {
  Texture t{name, size, size, {}};
  for (uint32_t y = 0; y < size; ++y)
    for (uint32_t x = 0; x < size; ++x) {
      const std::array<uint8_t, 4> bytes = texel((x + 0.5) / size, (y + 0.5) / size);
      t.rgba.insert(t.rgba.end(), bytes.begin(), bytes.end());
    }
  return t;
}

/// The same from a function that gives the linear colour.
template <class Color> Texture painted(const std::string& name, uint32_t size, const Color& color) {
  return fromTexels(name, size, [&](double u, double v) {
    const dvec3 c = color(u, v);
    return std::array<uint8_t, 4>{encoded(c.x), encoded(c.y), encoded(c.z), 255};
  });
}

/// Where water stands on the asphalt: 0 dry to 1 wet.
double wetness(double u, double v) { return glm::smoothstep(-0.12, 0.22, clouds(u, v, 4, 900, 4)); }

} // namespace

Texture stoneSlabs(const std::string& name) {
  constexpr uint32_t kSize = 128, kSlab = kSize / 2, kHeight = kSize / 4, kJoint = 1; // texels
  return painted(name, kSize, [](double u, double v) {
    const uint32_t x = uint32_t(u * kSize), y = uint32_t(v * kSize), row = y / kHeight;
    const uint32_t shifted = (x + (row % 2) * kSlab / 2) % kSize;
    const bool joint = shifted % kSlab < kJoint || y % kHeight < kJoint;
    const double tint = hashed(shifted / kSlab + 100, row) - 0.5;
    const double grain = hashed(x, y + 1000) - 0.5;
    const double light = joint ? 0.24 : 0.46 + 0.12 * tint + 0.04 * grain;
    return light * dvec3(1.04, 1.0, 0.92 - 0.05 * tint);
  });
}

Texture lattice(const std::string& name) {
  constexpr double kBar = 0.09; // half width of a bar, in cells across the diagonal
  return fromTexels(name, 64, [](double u, double v) {
    const auto nearLine = [](double s) { return std::abs(s - std::round(s)) < kBar; };
    const uint8_t color = encoded(0.5); // also where cut away, so that filtering does not darken the bars' edges
    return std::array<uint8_t, 4>{color, color, color, uint8_t(nearLine(u + v) || nearLine(u - v) ? 255 : 0)};
  });
}

Texture bricks(const std::string& name) {
  constexpr uint32_t kRows = 16, kColumns = 4;
  constexpr double kJoint = 0.09; // of a course's height
  return painted(name, 256, [](double u, double v) {
    const uint32_t row = uint32_t(v * kRows);
    const double along = u * kColumns + (row % 2 ? 0.5 : 0.0), up = v * kRows - row;
    const uint32_t brick = uint32_t(along) % kColumns;
    const double across = (along - std::floor(along)) * 4, edge = std::min({up, 1 - up, across, 4 - across});
    const double grain = clouds(u, v, 32, 300, 3);
    const double mortar = 1 - glm::smoothstep(kJoint, 2 * kJoint, edge + 0.05 * grain);
    const double light = 0.8 + 0.45 * (hashed(brick, 310 + row) - 0.5) + 0.2 * grain;
    const dvec3 fired = light * glm::mix(dvec3(0.34, 0.12, 0.07), dvec3(0.26, 0.13, 0.1), hashed(brick, 350 + row));
    return glm::mix(fired, (0.36 + 0.06 * grain) * dvec3(1, 0.96, 0.88), mortar);
  });
}

Texture asphalt(const std::string& name) {
  return painted(name, 256, [](double u, double v) {
    const double grit = noise(u, v, 128, 400), patches = clouds(u, v, 4, 410, 4);
    const double dry = 0.075 + 0.03 * grit + 0.02 * patches + (grit > 0.75 ? 0.07 : 0.0);
    return std::max(0.012, dry * (1 - 0.55 * wetness(u, v))) * dvec3(1, 1, 1.05);
  });
}

Texture asphaltFinish(const std::string& name) {
  return fromTexels(name, 128, [](double u, double v) { // a quantity, not a colour: stored as it is
    const double roughness = glm::mix(0.85, 0.3, wetness(u, v));
    return std::array<uint8_t, 4>{255, uint8_t(std::lround(255 * roughness)), 0, 255};
  });
}

Texture plaster(const std::string& name) {
  return painted(name, 256, [](double u, double v) {
    const double marks = noise(u + 0.02 * clouds(u, v, 8, 500, 2), v, 64, 510);
    return (0.76 + 0.07 * clouds(u, v, 4, 520, 4) + 0.025 * marks) * dvec3(1, 0.99, 0.97);
  });
}

Texture planks(const std::string& name) {
  constexpr uint32_t kBoards = 8;
  return painted(name, 256, [](double u, double v) {
    const uint32_t board = uint32_t(u * kBoards);
    const double across = u * kBoards - board, shift = hashed(board, 600);
    // Rings cut lengthwise: noise stretched along the board, through a fine wave.
    const double ring = noise(u, v + shift, 8, 610) + 0.5 * noise(u, v + shift, 16, 620);
    const double grain = 0.5 + 0.5 * std::sin(26 * across + 9 * ring);
    const double fibre = noise(16 * u, v + shift, 8, 630);
    const bool joint = across < 0.025 || across > 0.975 || std::abs(v - shift) < 0.004;
    const double light = joint ? 0.3 : 0.8 + 0.35 * (hashed(board, 640) - 0.5) + 0.18 * grain + 0.1 * fibre;
    return light * dvec3(0.4, 0.25, 0.13);
  });
}

Texture marble(const std::string& name) {
  return painted(name, 256, [](double u, double v) {
    const double bent = clouds(u, v, 4, 700, 5), fine = clouds(u, v, 8, 710, 4);
    const double vein = 1 - std::min(1.0, 7 * std::abs(bent + 0.25 * fine)); // along the lines where the noise is zero
    const double hair = 1 - std::min(1.0, 14 * std::abs(fine - 0.3 * bent));
    const double light = 0.74 + 0.05 * bent - 0.3 * vein * vein - 0.12 * hair * hair;
    return light * dvec3(1, 0.98, 0.95 + 0.04 * vein);
  });
}

} // namespace lambent::content

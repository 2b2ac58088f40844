// Edges of the picture as it is shown, against how much of each pixel really lies beyond them.
#include "frames.h"

namespace lambent::test::antialias_test {

using Inside = std::function<bool(float x, float y)>; // y from the top, pixels

constexpr float kDark = 0.05f, kBright = 0.8f; // of what a display shows, linear

/// Share of a pixel that lies inside: mean over samples × samples looks.
float share(const Inside& inside, int x, int y, int samples) {
  int hits = 0;
  for (int j = 0; j < samples; ++j)
    for (int i = 0; i < samples; ++i)
      hits += inside(float(x) + (float(i) + 0.5f) / float(samples), float(y) + (float(j) + 0.5f) / float(samples));
  return float(hits) / float(samples * samples);
}

/// A shape as a camera sees it: one look per pixel.
Image drawn(int width, int height, const Inside& inside) {
  Image image(width, height);
  for (const auto [x, y] : Pixels(width, height)) image.at(x, y) = vec3(share(inside, x, y, 1) > 0 ? kBright : kDark);
  return image;
}

/// Signed distance from a line through the middle of 64×64 pixels, in pixels.
float beyondLine(float x, float y, float degrees, float offset) {
  const float angle = degrees * kPi / 180;
  return (x - 32) * std::sin(angle) + (y - 32) * std::cos(angle) - offset;
}

/// Offsets of a line from the grid that no symmetry favours.
constexpr float kOffsets[] = {0.06f, 0.19f, 0.31f, 0.44f, 0.56f, 0.69f, 0.81f, 0.94f};

float linearAt(const Image8& image, int x, int y) { return linearFromSrgb(byteAt(image, x, y).y / 255); }
/// 0 dark, 1 bright.
float coveredAt(const Image8& image, int x, int y) { return (linearAt(image, x, y) - kDark) / (kBright - kDark); }

class AntiAliasTest : public GlTest {
 protected:
  /// A picture of which a display shows `picture` (linear), by way of Reinhard's tone mapper.
  const FrameResults& frameOf(const Image& picture) {
    const int width = picture.width, height = picture.height;
    Image radiance = picture;
    for (vec3& c : radiance.pixels)
      if (std::isfinite(luminance(c))) c /= 1 - luminance(c);
    radiance_ = textureOf(radiance);
    depth_ = gl::Texture("depth", {.format = GL_RGBA32F, .width = width, .height = height});
    depth_.clear();
    const float one = 1;
    glClearTexImage(depth_.name(), 0, GL_RED, GL_FLOAT, &one);
    frame_ = {};
    frame_.surfaces.depth = &depth_;
    frame_.surfaces.normal = frame_.surfaces.albedo = frame_.surfaces.emission = &radiance_;
    frame_.surfaces.width = width;
    frame_.surfaces.height = height;
    frame_.direct = frame_.indirect = {&radiance_};
    frame_.radiance = &radiance_;
    return frame_;
  }
  Image8 shown(const Image& picture, AntiAliasing mode = AntiAliasing::Edges, Buffer buffer = Buffer::Beauty) {
    display_.run(buffer, frameOf(picture), {.antiAliasing = mode});
    return display_.read();
  }
  /// RMSE of the coverage of pixels that lie within `width` of a line, over offsets of the line.
  double rmse(float degrees, AntiAliasing mode, float width, const std::function<bool(float)>& inside) {
    double sum = 0;
    int count = 0;
    for (const float offset : kOffsets) {
      const Inside shape = [&](float x, float y) { return inside(beyondLine(x, y, degrees, offset)); };
      const Image8 picture = shown(drawn(64, 64, shape), mode);
      for (const auto [x, y] : Pixels({20, 20}, {44, 44})) {
        if (std::abs(beyondLine(float(x) + 0.5f, float(y) + 0.5f, degrees, offset)) > width) continue;
        const double error = coveredAt(picture, x, y) - share(shape, x, y, 16);
        sum += error * error;
        ++count;
      }
    }
    return std::sqrt(sum / count);
  }

  gl::Texture radiance_, depth_;
  FrameResults frame_;
  DisplayPass display_{passes};
};

/// Measured 0.032, 0.019, 0.010, 0.012, 0.026, 0.031, 0.052, 0.085, 0.076, 0.096, 0.129;
/// without 0.205 to 0.187. At 45° no picture tells where in its pixels the edge lies.
TEST_F(AntiAliasTest, EdgesCoverAsMuchOfTheirPixelsAsTheyDo) {
  const std::pair<float, double> bounds[] = {{1, 0.04},   {2, 0.03},   {3, 0.02},  {5, 0.02},
                                             {8, 0.035},  {12, 0.04},  {20, 0.06}, {26.57f, 0.095},
                                             {35, 0.085}, {40, 0.105}, {45, 0.14}};
  const auto inside = [](float distance) { return distance > 0; };
  for (const auto& [slope, bound] : bounds) {
    for (const float degrees : {slope, 90 - slope, 180 + slope})
      EXPECT_LT(rmse(degrees, AntiAliasing::Edges, 1, inside), bound) << degrees << " degrees";
    EXPECT_GT(rmse(slope, AntiAliasing::Off, 1, inside), 0.18) << "the measure sees stairs";
  }
  EXPECT_NEAR(rmse(0, AntiAliasing::Edges, 1, inside), rmse(0, AntiAliasing::Off, 1, inside), 1e-6)
      << "an edge along the pixels' own";
}

TEST_F(AntiAliasTest, LinesAsThinAsAPixelKeepTheirLight) {
  const std::pair<float, double> bounds[] = {{2, 0.04},  {3, 0.03},  {5, 0.03}, {12, 0.05},
                                             {20, 0.07}, {35, 0.11}, {45, 0.16}};
  const auto inside = [](float distance) { return std::abs(distance) < 0.5f; };
  for (const auto& [slope, bound] : bounds)
    for (const float degrees : {slope, 90 + slope}) {
      EXPECT_LT(rmse(degrees, AntiAliasing::Edges, 1.5f, inside), bound) << degrees << " degrees";
      EXPECT_GT(rmse(degrees, AntiAliasing::Off, 1.5f, inside), 0.2);
      double off = 0, on = 0;
      for (const bool bright : {true, false}) {
        const Image line =
            drawn(64, 64, [&](float x, float y) { return inside(beyondLine(x, y, degrees, 0.3f)) == bright; });
        const Image8 before = shown(line, AntiAliasing::Off), after = shown(line);
        for (const auto [x, y] : Pixels(64, 64)) {
          const float sign = bright ? 1.0f : -1.0f;
          off += sign * (coveredAt(before, x, y) - (bright ? 0 : 1));
          on += sign * (coveredAt(after, x, y) - (bright ? 0 : 1));
        }
      }
      EXPECT_NEAR(on, off, 0.05 * off) << degrees << " degrees";
    }
}

TEST_F(AntiAliasTest, WhatHasNoEdgeKeepsItsBytes) {
  Image picture(64, 48);
  for (const auto [x, y] : Pixels(64, 48)) // slopes, and a texture of small steps
    picture.at(x, y) = vec3(0.2f + 0.004f * float(x), 0.3f, 0.25f) * ((x ^ y) & 4 ? 1.0f : 1.08f);
  EXPECT_EQ(shown(picture).rgb, shown(picture, AntiAliasing::Off).rgb);

  const Image board = drawn(32, 32, [](float x, float y) { return ((int(x) ^ int(y)) & 1) != 0; });
  const Image8 boardOn = shown(board), boardOff = shown(board, AntiAliasing::Off);
  for (int y = 1; y < 31; ++y) // the picture goes on past its border as it ends there
    for (int x = 1; x < 31; ++x) EXPECT_EQ(byteAt(boardOn, x, y), byteAt(boardOff, x, y)) << "single pixels, no lines";

  const Image half = drawn(64, 64, [](float x, float y) { return beyondLine(x, y, 10, 0.3f) > 0; });
  const Image8 on = shown(half), off = shown(half, AntiAliasing::Off);
  int changed = 0;
  for (const auto [x, y] : Pixels(64, 64)) {
    if (byteAt(on, x, y) == byteAt(off, x, y)) continue;
    EXPECT_LT(std::abs(beyondLine(float(x) + 0.5f, float(y) + 0.5f, 10, 0.3f)), 1) << x << ", " << y;
    ++changed;
  }
  EXPECT_GT(changed, 64);
}

TEST_F(AntiAliasTest, APictureOnItsSideIsSmoothedLikewise) {
  const Inside shape = [](float x, float y) {
    return std::hypot(x - 30, y - 27) < 17 || std::abs(beyondLine(x, y, 17, 19)) < 0.6f;
  };
  const Image8 given = shown(drawn(64, 64, shape));
  const Image8 turned = shown(drawn(64, 64, [&](float x, float y) { return shape(y, x); }));
  const Image8 mirrored = shown(drawn(64, 64, [&](float x, float y) { return shape(64 - x, y); }));
  const Image8 upsideDown = shown(drawn(64, 64, [&](float x, float y) { return shape(x, 64 - y); }));
  int differ = 0; // edges that run exactly between the two axes are taken as horizontal
  for (const auto [x, y] : Pixels(64, 64)) {
    const vec3 c = byteAt(given, x, y);
    EXPECT_LE(maxComponent(glm::abs(byteAt(mirrored, 63 - x, y) - c)), 3) << x << ", " << y;
    EXPECT_LE(maxComponent(glm::abs(byteAt(upsideDown, x, 63 - y) - c)), 3) << x << ", " << y;
    differ += maxComponent(glm::abs(byteAt(turned, y, x) - c)) > 3;
  }
  EXPECT_LT(differ, 12);
}

TEST_F(AntiAliasTest, AnEdgeThatMovesSlowlyIsSteadier) {
  for (const float degrees : {4.0f, 14.0f, 30.0f, 86.0f}) {
    double squares[2] = {}, sums[2] = {};
    for (const AntiAliasing mode : {AntiAliasing::Off, AntiAliasing::Edges}) {
      Image8 before;
      for (int frame = 0; frame <= 32; ++frame) {
        const float offset = float(frame) / 16;
        const Image8 now =
            shown(drawn(64, 64, [&](float x, float y) { return beyondLine(x, y, degrees, offset) > 0; }), mode);
        if (frame > 0)
          for (const auto [x, y] : Pixels({16, 16}, {48, 48})) {
            const double change = coveredAt(now, x, y) - coveredAt(before, x, y);
            squares[int(mode)] += change * change;
            sums[int(mode)] += std::abs(change);
          }
        before = now;
      }
    }
    EXPECT_LT(squares[1], 0.4 * squares[0]) << degrees << " degrees";
    EXPECT_LT(sums[1], 1.02 * sums[0]) << degrees << " degrees: nothing swings back and forth";
    RecordProperty("degrees" + std::to_string(int(degrees)),
                   std::to_string(squares[1] / squares[0]) + " " + std::to_string(sums[1] / sums[0]));
  }
}

TEST_F(AntiAliasTest, MarksStayAndColourNothingElse) {
  Image picture = drawn(64, 64, [](float x, float y) { return beyondLine(x, y, 10, 0.3f) > 0; });
  const Image8 unmarked = shown(picture);
  for (int x = 8; x < 56; x += 8) picture.at(x, 32).y = std::nanf("");
  picture.at(12, 40).x = kInfinity;
  const auto area = [](int x, int y) { return beyondLine(float(x), float(y), 80, 22.3f) > 0; }; // has stairs of its own
  for (const auto [x, y] : Pixels(64, 64))
    if (area(x, y)) picture.at(x, y) = vec3(std::nanf(""));
  const Image8 marked = shown(picture);
  EXPECT_EQ(byteAt(marked, 12, 40), vec3(0, 255, 255));
  for (const auto [x, y] : Pixels(64, 64)) {
    const vec3 c = byteAt(marked, x, y);
    if (area(x, y) || (y == 32 && x >= 8 && x < 56 && x % 8 == 0)) {
      EXPECT_EQ(c, vec3(255, 0, 255)) << x;
    } else if (x != 12 || y != 40) {
      EXPECT_LE(maxComponent(c) + maxComponent(-c), 1) << x << ", " << y << ": grey";
    }
  }
  EXPECT_EQ(byteAt(marked, 4, 4), byteAt(unmarked, 4, 4));
}

TEST_F(AntiAliasTest, OffAndOtherBuffersAreAsBefore) {
  const Image picture = drawn(64, 48, [](float x, float y) { return beyondLine(x, y, 30, 0.3f) > 0; });
  const Image8 on = shown(picture);
  EXPECT_NE(shown(picture, AntiAliasing::Off).rgb, on.rgb);
  DisplayPass never{passes};
  never.run(Buffer::Beauty, frameOf(picture), {});
  EXPECT_EQ(shown(picture, AntiAliasing::Off).rgb, never.read().rgb);
  for (const std::string& name : bufferNames()) {
    const Buffer buffer = bufferByName(name);
    if (buffer == Buffer::Beauty || buffer == Buffer::Direct || buffer == Buffer::Indirect) continue;
    EXPECT_EQ(shown(picture, AntiAliasing::Edges, buffer).rgb, shown(picture, AntiAliasing::Off, buffer).rgb) << name;
  }
}

TEST_F(AntiAliasTest, PicturesOfAnySize) {
  for (const glm::ivec2 size : {glm::ivec2(1, 1), glm::ivec2(7, 5), glm::ivec2(1, 9), glm::ivec2(13, 1)}) {
    const Image picture = drawn(size.x, size.y, [&](float x, float y) { return x + 2 * y < float(size.y) + 1; });
    const Image8 off = shown(picture, AntiAliasing::Off), on = shown(picture);
    ASSERT_EQ(on.rgb.size(), size_t(size.x) * size.y * 3);
    for (const uint8_t byte : on.rgb) {
      EXPECT_GE(byte, *std::min_element(off.rgb.begin(), off.rgb.end()));
      EXPECT_LE(byte, *std::max_element(off.rgb.begin(), off.rgb.end()));
    }
    EXPECT_TRUE(on.rgb != off.rgb || size != glm::ivec2(7, 5));
    // Beyond its border a picture goes on as its outermost pixels are.
    constexpr int kAround = 32;
    const Image8 larger = shown(drawn(size.x + 2 * kAround, size.y + 2 * kAround, [&](float x, float y) {
      x = glm::clamp(x - kAround, 0.5f, float(size.x) - 0.5f), y = glm::clamp(y - kAround, 0.5f, float(size.y) - 0.5f);
      return x + 2 * y < float(size.y) + 1;
    }));
    for (const auto [x, y] : Pixels(size.x, size.y))
      EXPECT_LE(maxComponent(glm::abs(byteAt(on, x, y) - byteAt(larger, x + kAround, y + kAround))), 3) // dither
          << x << ' ' << y << " of " << size.x << 'x' << size.y;
  }
}

/// What programs get: smooth where it is shown, radiance where it is read.
TEST_F(AntiAliasTest, FramesAreShownSmoothAndReadAsTheyAre) {
  Room room;
  room.scene.lamp({0.5f, 0.6f, 0.3f}, vec3(2));
  Settings settings;
  settings.effects[EffectId::Indirect] = EffectMode::Off;
  settings.image.exposure = 1;
  Viewer gi(settings);
  gi.run(room.scene.view());
  const Image8 on = gi.readDisplay(Buffer::Beauty), normals = gi.readDisplay(Buffer::Normal);
  const Image radiance = gi.read(Buffer::Beauty);
  applySetting(gi.settings(), "image.antiAliasing", "off");
  gi.run(room.scene.view());
  EXPECT_NE(gi.readDisplay(Buffer::Beauty).rgb, on.rgb);
  EXPECT_EQ(gi.readDisplay(Buffer::Normal).rgb, normals.rgb);
  EXPECT_EQ(gi.read(Buffer::Beauty).pixels, radiance.pixels);
}

} // namespace lambent::test::antialias_test

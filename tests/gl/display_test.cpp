// What is shown: exposure, tone mapping, markers, the views, and which way up they are.
#include "gi/reference/traced_image.h"
#include "gl_fixture.h"
#include "shaders/shared/tone_map.h"

namespace lambent::test::display_test {

class DisplayTest : public GatherTest {
 protected:
  /// A frame of the room whose beauty is `radiance` (row 0 at the top), by way of an upload.
  FrameResults frameWith(const Image& radiance) {
    FrameResults frame;
    frame.surfaces = surfaces(room.scene);
    texture = textureOf(radiance);
    frame.indirect = {&texture};
    frame.radiance = frame.indirect.irradiance;
    frame.farDistance = 3.5f;
    return frame;
  }

  Room room;
  gl::Texture texture;
  DisplayPass displayPass{passes};
};

TEST_F(DisplayTest, ReinhardOnLuminanceThenSrgb) {
  Image image(64, 48, vec3(0.5f));
  image.at(0, 0) = vec3(4, 1, 0.2f);
  const FrameResults frame = frameWith(image);
  displayPass.run(Buffer::Beauty, frame, {2});
  const Image8 shown = displayPass.read();
  const auto encoded = [](const vec3& c) {
    const vec3 mapped = c / (1 + luminance(c));
    return vec3(srgbFromLinear(std::min(1.0f, mapped.x)), srgbFromLinear(mapped.y), srgbFromLinear(mapped.z)) * 255.0f;
  };
  EXPECT_LT(maxComponent(glm::abs(byteAt(shown, 5, 5) - encoded(vec3(1)))), 1.01f);
  EXPECT_LT(maxComponent(glm::abs(byteAt(shown, 0, 0) - encoded(vec3(8, 2, 0.4f)))), 1.01f) << "top left is first";
}

TEST_F(DisplayTest, ToneMappersAreThoseOfTheCpuAndKeepTheirPromises) {
  Image image(64, 48);
  for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = vec3(0.003f * float(i), 0.02f, 0.001f * float(i));
  const FrameResults frame = frameWith(image);
  for (const ToneMapper mapper : {ToneMapper::Reinhard, ToneMapper::Neutral, ToneMapper::Filmic}) {
    displayPass.run(Buffer::Beauty, frame, {1, mapper});
    const Image8 shown = displayPass.read();
    for (const int i : {0, 10, 100, 250, 300, 1000, 3000}) {
      const vec3 c = glm::clamp(toneMapped(image.pixels[size_t(i)], int(mapper)), vec3(0), vec3(1));
      const vec3 expected = 255.0f * vec3(srgbFromLinear(c.x), srgbFromLinear(c.y), srgbFromLinear(c.z));
      EXPECT_LT(maxComponent(glm::abs(byteAt(shown, i % 64, i / 64) - expected)), 1.01f) << i << ' ' << int(mapper);
    }
  }
  EXPECT_LT(maxComponent(glm::abs(pbrNeutral(vec3(0.6f, 0.3f, 0.2f)) - vec3(0.56f, 0.26f, 0.16f))), 1e-6f);
  float before = 0;
  for (float x = 0.01f; x < 100; x *= 1.1f) {
    const vec3 red = pbrNeutral(x * vec3(1, 0.1f, 0.1f)), film = filmic(vec3(x));
    EXPECT_GT(red.x, before) << "no two that differ become one";
    EXPECT_LE(maxComponent(red), 1.0f);
    EXPECT_LE(film.x, 1.04f);
    before = red.x;
  }
  EXPECT_GT(pbrNeutral(vec3(100, 10, 10)).y, 0.8f) << "bright colours go over to white";
}

TEST_F(DisplayTest, DitherKeepsTheMeanOfWhatEightBitsCannotHold) {
  const float value = 0.2f; // 0.16667 after Reinhard, 113.3 of 255
  displayPass.run(Buffer::Beauty, frameWith(Image(64, 48, vec3(value))), {1});
  const Image8 shown = displayPass.read();
  double sum = 0;
  for (const uint8_t byte : shown.rgb) sum += byte;
  const double expected = 255 * double(srgbFromLinear(value / (1 + value)));
  EXPECT_GT(std::abs(expected - std::round(expected)), 0.2) << "or there is nothing to dither";
  EXPECT_NEAR(sum / double(shown.rgb.size()), expected, gl::drawnByCpu() ? 0.02 : 0.07); // an H100: 0.055 less
  displayPass.run(Buffer::Beauty, frameWith(Image(64, 48, vec3(0))), {1});
  for (const uint8_t byte : displayPass.read().rgb) ASSERT_EQ(byte, 0);
}

TEST_F(DisplayTest, MarksWhatIsNoNumber) {
  Image image(64, 48, vec3(0.5f));
  image.at(3, 4).y = std::nanf("");
  image.at(5, 6).z = kInfinity;
  const FrameResults frame = frameWith(image);
  for (const Buffer buffer : {Buffer::Beauty, Buffer::Nan}) {
    displayPass.run(buffer, frame, {1});
    const Image8 shown = displayPass.read();
    EXPECT_EQ(byteAt(shown, 3, 4), vec3(255, 0, 255));
    EXPECT_EQ(byteAt(shown, 5, 6), vec3(0, 255, 255));
    EXPECT_EQ(byteAt(shown, 7, 8).x, byteAt(shown, 7, 8).y);
  }
}

TEST_F(DisplayTest, ExposureBringsTheLogAverageToMidGrey) {
  Image image(64, 48, vec3(2));
  for (int x = 0; x < 64; ++x) image.at(x, 0) = vec3(0); // black says nothing about exposure
  for (int y = 1; y < 48; y += 2)
    for (int x = 0; x < 64; ++x) image.at(x, y) = vec3(8);
  const int bright = 24, dim = 23;
  const double logAverage = (bright * std::log(8.0) + dim * std::log(2.0)) / (bright + dim);
  // The upload has no alpha of its own: 1, a surface.
  EXPECT_NEAR(measureExposure(*frameWith(image).radiance), 0.18 / std::exp(logAverage), 1e-4);
  EXPECT_EQ(measureExposure(*frameWith(Image(64, 48)).radiance), 0) << "no light at all";
  // What one lamp lights is what there is to see, not the night around it.
  Image dark(60, 50, vec3(1e-5f));
  for (int x = 0; x < 6; ++x)
    for (int y = 0; y < 50; ++y) dark.at(x, y) = vec3(1);
  EXPECT_NEAR(measureExposure(*frameWith(dark).radiance), 0.18, 1e-3);
  EXPECT_NEAR(exposureFor(dark.pixels), 0.18, 1e-3) << "of the reference";
}

TEST_F(DisplayTest, EveryViewDraws) {
  FrameResults frame = frameWith(Image(64, 48, vec3(0.5f)));
  VplSet set;
  set.slots.resize(3);
  set.slots[1].alive = true;
  set.slots[1].position = {0, -0.4f, -0.99f}; // on the far wall, in sight
  set.slots[1].normal = {0, 0, 1};
  set.slots[1].radiance = vec3(1);
  set.slots[1].area = 1;
  frame.inside.vpls = &set;
  for (int i = 0; i <= int(Buffer::Nan); ++i) {
    displayPass.run(Buffer(i), frame, {1});
    EXPECT_EQ(displayPass.read().rgb.size(), 64u * 48 * 3) << i;
  }
  displayPass.run(Buffer::Beauty, frame, {1});
  const Image8 without = displayPass.read();
  displayPass.run(Buffer::Vpls, frame, {1});
  const Image8 with = displayPass.read();
  EXPECT_NE(without.rgb, with.rgb) << "the VPL's sprite";
}

TEST_F(DisplayTest, PresentScalesIntoAnyFramebuffer) {
  Image image(64, 48, vec3(0));
  for (const auto [x, y] : Pixels(64, 24)) image.at(x, y) = vec3(100); // upper half bright
  const FrameResults frame = frameWith(image);
  const gl::Texture target("window", {.format = GL_RGBA8, .width = 128, .height = 96});
  const gl::Framebuffer framebuffer("window", {&target});
  displayPass.run(Buffer::Beauty, frame, {1});
  displayPass.present(framebuffer.name(), 128, 96);
  const std::vector<vec4> shown = readTexture(target); // row 0 at the bottom
  EXPECT_LT(shown[10 * 128 + 64].x, 0.01f);
  EXPECT_GT(shown[80 * 128 + 64].x, 0.9f);
}

} // namespace lambent::test::display_test

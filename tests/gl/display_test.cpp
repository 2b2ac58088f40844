// What is shown: exposure, tone mapping, markers, the views, and which way up they are.
#include "engine/image/exposure.h"
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
  ExposureMeter meter(passes);
  const auto of = [&](const Image& image) { return meter.measureNow(*frameWith(image).radiance); };
  // The upload has no alpha of its own: 1, a surface.
  EXPECT_EQ(of(Image(64, 48)), 0) << "no light at all";
  EXPECT_EQ(exposureFor(Image(64, 48).pixels), 1);
  Image image(64, 48, vec3(2));
  for (int x = 0; x < 64; ++x) image.at(x, 0) = vec3(0); // black says nothing about exposure
  image.at(5, 0) = vec3(kInfinity);
  for (int y = 1; y < 48; y += 2)
    for (int x = 0; x < 64; ++x) image.at(x, y) = vec3(8);
  const double bright = 24.0 / 47, root = bright * std::sqrt(8) + (1 - bright) * std::sqrt(2), dark = root * root / 50;
  const double wide = 64 / (64 + dark * dark), narrow = 4 / (4 + dark * dark);
  const double logs = bright * wide * std::log(8) + (1 - bright) * narrow * std::log(2);
  const double wanted = 0.18 / std::exp(logs / (bright * wide + (1 - bright) * narrow));
  EXPECT_NEAR(of(image), wanted, 1e-4 * wanted);
  EXPECT_NEAR(wanted, 0.18 / 4, 0.02 * 0.18 / 4) << "their log-average, or nearly";
  EXPECT_NEAR(exposureFor(image.pixels), wanted, 1e-4 * wanted) << "of the reference";
  // From the grid, with what the measurement before found: the same.
  meter.measure(*frameWith(image).radiance);
  EXPECT_NEAR(meter.read(), wanted, 1e-4 * wanted);
  EXPECT_EQ(meter.read(), 0) << "nothing new";
}

/// What one lamp lights is what there is to see, not the night around it; and a room is, not a lamp or a patch of sun
/// in it. From one to the other there is no step.
TEST_F(DisplayTest, ExposureIsThatOfWhatThereIsToSee) {
  ExposureMeter meter(passes);
  const auto of = [&](int brightColumns, float bright, float rest) {
    Image image(100, 40, vec3(rest));
    for (int x = 0; x < brightColumns; ++x)
      for (int y = 0; y < 40; ++y) image.at(x, y) = vec3(bright);
    const FrameResults frame = frameWith(image);
    ExposureMeter fresh(passes); // knows of no image, as after a black one
    fresh.measure(*frame.radiance);
    const float now = meter.measureNow(*frame.radiance);
    EXPECT_NEAR(fresh.read(), now, 1e-3f * now);
    for (int frames = 0; frames < 3; ++frames) {
      meter.measure(*frame.radiance);
      EXPECT_NEAR(meter.read(), now, 1e-3f * now) << "from the grid";
    }
    return now / 0.18f;
  };
  EXPECT_NEAR(of(10, 1, 1e-5f), 1, 0.3f) << "a lit tenth in the night";
  EXPECT_NEAR(of(30, 1, 1e-4f), 1, 0.1f);
  EXPECT_GT(of(2, 1e4f, 1), 0.5f) << "a bulb: the room loses a stop at most";
  EXPECT_GT(of(5, 2e3f, 1), 0.5f) << "a patch of sun";
  float before = of(1, 1e4f, 1);
  for (int columns = 2; columns < 100; ++columns) {
    const float now = of(columns, 1e4f, 1);
    EXPECT_LT(now, before);
    EXPECT_GT(now, before / 4) << columns;
    before = now;
  }
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

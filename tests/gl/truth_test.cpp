// The truth beside the picture, and the picture's error against it as colours.
#include "gl_fixture.h"
#include "shaders/shared/error_color.h"

namespace lambent::test::truth_test {

class TruthTest : public GatherTest {
 protected:
  TruthTest() {
    frame_.surfaces = surfaces(room_.scene);
    width_ = frame_.surfaces.width;
    height_ = frame_.surfaces.height;
    frame_.farDistance = 3.5f;
  }

  /// Irradiance and radiance that change from pixel to pixel.
  Image waves(float phase) const {
    Image image(width_, height_);
    for (const auto [x, y] : Pixels(width_, height_))
      image.at(x, y) = 1.0f + 0.9f * vec3(std::sin(0.3f * float(x) + phase), std::cos(0.2f * float(y) + phase),
                                          std::sin(0.1f * float(x * y) + phase));
    return image;
  }
  /// All light of the frame.
  void fill() {
    texture_ = textureOf(waves(1));
    frame_.indirect = frame_.direct = {&texture_};
    frame_.radiance = &texture_;
  }

  /// What `draw(framebuffer)` leaves, row 0 at the top.
  template <class Draw> Image8 shown(int width, int height, const Draw& draw) const {
    const gl::Texture target("window", {.format = GL_RGBA8, .width = width, .height = height});
    const gl::Framebuffer framebuffer("window", {&target});
    draw(framebuffer.name());
    const std::vector<vec4> texels = readTexture(target);
    Image8 out{width, height, std::vector<uint8_t>(size_t(width) * height * 3)};
    for (const auto [x, y] : Pixels(width, height))
      for (int c = 0; c < 3; ++c)
        out.rgb[(size_t(y) * width + x) * 3 + c] =
            uint8_t(std::lround(255 * texels[size_t(height - 1 - y) * width + x][c]));
    return out;
  }

  Room room_;
  FrameResults frame_;
  gl::Texture texture_;
  int width_ = 0, height_ = 0;
  DisplayPass display_{passes};
  TruthDisplay truth_{passes};
};

TEST_F(TruthTest, LeftOfTheDividerIsThePictureRightOfItTheTruth) {
  const gl::Texture picture = textureOf(waves(0));
  frame_.radiance = &picture;
  const Look look{1.5f, ToneMapper::Filmic, true, AntiAliasing::Edges};
  truth_.take(waves(2), frame_);
  const gl::Texture& right = truth_.run(Buffer::Beauty, frame_, look);
  display_.run(Buffer::Beauty, frame_, look);
  const Image8 gi = display_.read();
  const gl::Texture other = textureOf(waves(2)); // the truth as a frame's own picture
  FrameResults exact;
  exact.surfaces = frame_.surfaces;
  exact.radiance = &other;
  DisplayPass separate(passes);
  separate.run(Buffer::Beauty, exact, look);
  const Image8 truth = separate.read();
  for (const float divider : {0.0f, 0.25f, 0.5f, 1.0f}) {
    const Image8 both = shown(width_, height_, [&](uint32_t framebuffer) {
      display_.present(framebuffer, width_, height_, &right, divider);
    });
    int differ = 0;
    for (const auto [x, y] : Pixels(width_, height_)) {
      const float beyond = float(x) + 0.5f - divider * float(width_);
      const vec3 expected = std::abs(beyond) < 1 ? vec3(255) : byteAt(beyond > 0 ? truth : gi, x, y);
      ASSERT_EQ(byteAt(both, x, y), expected) << x << ' ' << y << ' ' << divider;
      differ += byteAt(truth, x, y) != byteAt(gi, x, y);
    }
    EXPECT_GT(differ, width_ * height_ / 2) << "or the test shows nothing";
  }
}

TEST_F(TruthTest, TheTruthOfEveryBufferIsShownAsTheBuffer) {
  fill();
  const Look look{0.7f, ToneMapper::Neutral, true, AntiAliasing::Off};
  for (const Buffer buffer : {Buffer::Beauty, Buffer::Direct, Buffer::Indirect, Buffer::Irradiance}) {
    display_.run(buffer, frame_, look);
    const Image8 gi = display_.read();
    truth_.take(readBuffer(buffer, frame_), frame_); // a truth that is what the frame has
    const gl::Texture& right = truth_.run(buffer, frame_, look);
    const Image8 truth = shown(
        width_, height_, [&](uint32_t framebuffer) { display_.present(framebuffer, width_, height_, &right, 0); });
    int worst = 0;
    for (const auto [x, y] : Pixels({1, 0}, {width_, height_})) // the line is at 0
      worst = std::max(worst, int(maxComponent(glm::abs(byteAt(gi, x, y) - byteAt(truth, x, y)))));
    EXPECT_LE(worst, 1) << bufferNames()[size_t(buffer)] << ": rounding of the products apart";
  }
}

TEST_F(TruthTest, NoErrorIsBlackAndItsSignAndSizeAreColours) {
  EXPECT_EQ(errorColor(0), vec3(0));
  EXPECT_EQ(errorColor(2), errorColor(1)) << "more than full is full";
  for (const float sign : {-1.0f, 1.0f})
    for (float e = 0; e < 1; e += 0.01f)
      EXPECT_GT(luminance(errorColor(sign * (e + 0.01f))), luminance(errorColor(sign * e))) << "more is lighter";
  for (float e = 0.05f; e <= 1; e += 0.05f) EXPECT_GT(errorColor(e).x, errorColor(-e).x) << "which is which";

  fill();
  const Look look{3, ToneMapper::Reinhard, true, AntiAliasing::Edges}; // neither exposure nor smoothing matters
  for (const Buffer buffer : {Buffer::Beauty, Buffer::Direct, Buffer::Indirect, Buffer::Irradiance}) {
    const Image picture = readBuffer(buffer, frame_);
    truth_.take(picture, frame_);
    display_.run(buffer, frame_, look, {&truth_.linear(), 1e-3f});
    for (const uint8_t byte : display_.read().rgb) ASSERT_LE(byte, 1) << bufferNames()[size_t(buffer)];

    constexpr float kFull = 0.5f;
    Image truth = picture; // off by up to full, more from left to right; too bright in the upper half
    const auto error = [&](int x, int y) {
      return kFull * float(x) / float(width_) * (y < height_ / 2 ? 1.0f : -1.0f);
    };
    for (const auto [x, y] : Pixels(width_, height_))
      truth.at(x, y) -= vec3(1.5f, 1.5f, 0) * error(x, y); // their mean counts
    truth_.take(truth, frame_);
    display_.run(buffer, frame_, look, {&truth_.linear(), kFull});
    const Image8 heat = display_.read();
    for (const auto [x, y] : Pixels(width_, height_))
      ASSERT_LT(maxComponent(glm::abs(byteAt(heat, x, y) - 255.0f * errorColor(error(x, y) / kFull))), 1.01f)
          << bufferNames()[size_t(buffer)] << ' ' << x << ' ' << y;
  }
}

TEST_F(TruthTest, AFrameShowsTheTruthItWasGiven) {
  Settings settings;
  settings.smc.vpls = 32;
  settings.smc.warmup = 1;
  room_.scene.lamp({0, 0.8f, 0});
  Viewer gi(settings);
  gi.run(room_.scene.view());
  const auto buffer = Buffer::Indirect;
  const Image8 own = gi.readDisplay(buffer);
  const Image picture = gi.read(buffer);
  Image brighter = picture;
  for (vec3& p : brighter.pixels) p += 0.25f;
  gi.takeTruth(brighter);
  const Image8 heat = shown(width_, height_, [&](uint32_t f) { gi.presentError(buffer, 1, f, width_, height_); });
  for (int i = 0; i < width_ * height_; ++i)
    ASSERT_LT(maxComponent(glm::abs(byteAt(heat, i % width_, i / width_) - 255.0f * errorColor(-0.25f))), 1.01f);
  const Image8 split =
      shown(width_, height_, [&](uint32_t f) { gi.presentBesideTruth(buffer, 0.5f, f, width_, height_); });
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_ / 2 - 1; ++x) ASSERT_EQ(byteAt(split, x, y), byteAt(own, x, y));
    for (int x = width_ / 2 + 1; x < width_; ++x)
      ASSERT_GE(byteAt(split, x, y).y + 1, byteAt(own, x, y).y) << "the truth is brighter";
  }
}

} // namespace lambent::test::truth_test

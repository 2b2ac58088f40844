// The filter that is guided by variance: what it averages, and what it leaves alone.
#include "engine/core/rng.h"
#include "gl_fixture.h"

namespace lambent::test::denoise_test {

class DenoiseTest : public GatherTest {
 protected:
  static constexpr int kWidth = 64, kHeight = 48;
  DenoiseTest() : gbuffer(surfaces(floor.scene)) {}

  /// What a pixel's frames are about: bright and dark parts of one floor.
  static float truthAt(int x) { return x < 37 ? 1.0f : 3.0f; }
  /// The mean of frames, row by row from the bottom, after and before the filter. `rare`: one pixel in so many has all
  /// light of a frame.
  std::pair<Image, Image> denoised(int frames, float noise, int odd = -1, int rare = 1) {
    HistoryPass history(passes, StageId::History);
    DenoisePass denoise(passes, StageId::SoftLight);
    Rng rng(7, Stream::Test, 0);
    SurfaceLighting mean, smooth;
    gl::Texture given;
    for (int i = 0; i < frames; ++i) {
      std::vector<vec4> light(size_t(kWidth) * kHeight);
      for (const auto [x, y] : Pixels(kWidth, kHeight)) {
        const float brought = truthAt(x) * (1 + noise * (2 * rng.next() - 1));
        light[size_t(y) * kWidth + size_t(x)] = vec4(rng.next() * float(rare) < 1 ? brought * float(rare) : 0);
      }
      if (odd >= 0) light[size_t(odd)] = vec4(std::numeric_limits<float>::quiet_NaN());
      given = textureOf(kWidth, kHeight, light);
      history.fit(gbuffer);
      const SurfaceLighting raw{&given, nullptr, false};
      mean = history.run({gbuffer, raw, false, false, {.frames = 64}, {}, 0.5f, smooth});
      smooth = denoise.run({gbuffer, mean, history.variance(), history.worth(), {}});
    }
    return {read(Buffer::Irradiance, gbuffer, mean, smooth), read(Buffer::Irradiance, gbuffer, mean, mean)};
  }
  /// RMS of the error over the truth, and its mean.
  static std::pair<double, double> errorOf(const Image& image) {
    double squares = 0, sum = 0;
    for (const auto [x, y] : Pixels(kWidth, kHeight)) {
      const double error = double(image.at(x, y).x / truthAt(x)) - 1;
      squares += error * error, sum += error;
    }
    return {std::sqrt(squares / (kWidth * kHeight)), sum / (kWidth * kHeight)};
  }
  Floor floor;
  GBuffer gbuffer;
};

TEST_F(DenoiseTest, AveragesNoiseAndKeepsEdgesOfLight) {
  for (const int frames : {1, 2, 8}) {
    const auto [after, before] = denoised(frames, 0.5f);
    const auto [rms, bias] = errorOf(after);
    const double was = errorOf(before).first;
    std::printf("%d frames: error %.4f, was %.4f; mean error %.4f\n", frames, rms, was, bias);
    EXPECT_LT(rms, (frames == 1 ? 0.8 : 0.35) * was) << frames;
    EXPECT_LT(std::abs(bias), 0.02) << frames;
  }
}

TEST_F(DenoiseTest, OutliersLoseLittleLight) {
  for (const int frames : {8, 16}) {
    const auto [after, before] = denoised(frames, 0, -1, 40);
    const double kept = meanLuminance(after) / meanLuminance(before);
    std::printf("%d frames: %.4f of the light is kept, error %.3f, was %.3f\n", frames, kept, errorOf(after).first,
                errorOf(before).first);
    EXPECT_GT(kept, frames == 8 ? 0.7 : 0.8) << "by the variance of a pixel alone 0.44 and 0.67";
    EXPECT_LT(errorOf(after).first, 0.4 * errorOf(before).first);
  }
}

TEST_F(DenoiseTest, WhatHasNoNoiseStaysAsItIs) {
  const auto [after, before] = denoised(8, 0);
  EXPECT_TRUE(sameBits(after, before));
}

TEST_F(DenoiseTest, WhatIsNoNumberStaysAlone) {
  const int odd = 20 * kWidth + 30;
  const Image after = denoised(1, 0.5f, odd).first;
  for (const auto [x, y] : Pixels(kWidth, kHeight)) {
    const bool itself = (kHeight - 1 - y) * kWidth + x == odd;
    ASSERT_TRUE(itself || (after.at(x, y).x > 0.25f && after.at(x, y).x < 6)) << x << ' ' << y;
  }
}

} // namespace lambent::test::denoise_test

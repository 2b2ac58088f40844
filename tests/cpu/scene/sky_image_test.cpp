// Pictures as skies: what they send, what is drawn from them, and files that hold them.
#include "engine/core/rng.h"
#include "engine/image/image.h"
#include "engine/scene/sky_file.h"
#include "tests/support/daylight.h"
#include "tests/support/files.h"

#include <fstream>

namespace lambent::test::sky_image_test {

/// A dim gradient; texel (x, y) is a sun of radiance `sun`.
std::shared_ptr<SkyImage> picture(int width, int height, int x, int y, float sun) {
  auto image = std::make_shared<SkyImage>();
  image->width = width;
  image->height = height;
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column)
      image->texels.push_back(vec3(0.2f, 0.3f, 0.5f) * (1 + float(row) / float(height)));
  image->texels[size_t(y) * size_t(width) + size_t(x)] = vec3(sun);
  return image;
}

TEST(SkyImage, ShowsItsTexelsWhereTheyBelong) {
  const auto image = picture(64, 32, 48, 4, 9); // column 48: three quarters, +Z
  const float latitude = kPi * 4.5f / 32, longitude = 2 * kPi * (48.5f / 64 - 0.5f);
  const vec3 there(std::sin(latitude) * std::cos(longitude), std::cos(latitude),
                   std::sin(latitude) * std::sin(longitude));
  EXPECT_GT(there.z, 0.4f);
  EXPECT_NEAR(Sky::image(image).radiance(there).x, 9, 1e-3f);
  EXPECT_NEAR(Sky::image(image, 0.5f).radiance(there).x, 4.5f, 1e-3f);
  // A quarter turn, counter-clockwise seen from above: +Z comes to lie at +X.
  const vec3 turned(there.z, there.y, -there.x);
  EXPECT_NEAR(Sky::image(image, 1, kPi / 2).radiance(turned).x, 9, 1e-3f);
  // Around the seam and at the poles there is no gap.
  EXPECT_NEAR(Sky::image(image).radiance(glm::normalize(vec3(-1, 0.01f, 1e-6f))).z,
              Sky::image(image).radiance(glm::normalize(vec3(-1, 0.01f, -1e-6f))).z, 1e-4f);
  for (const float y : {1.0f, -1.0f}) EXPECT_TRUE(isFinite(Sky::image(image).radiance({0, y, 0})));
}

TEST(SkyImage, WhatIsDrawnHasTheDensityThatItSays) {
  SKIP_STATISTICS_WHEN_SANITIZED();
  for (const auto& [width, height] : {std::pair(1, 1), {64, 32}, {1024, 512}}) {
    const Sky sky = Sky::image(picture(width, height, width / 3, height / 4, 5000), 1, 0.7f);
    const vec3 normals[] = {{0, 1, 0}, glm::normalize(vec3(1, 0.2f, -0.4f)), {0, -1, 0}};
    // Densities are one over the sphere.
    EXPECT_NEAR(overSphere(512, [&](const vec3& d) { return double(sky.pdf(d)); }), 1, 5e-3) << width;
    for (const vec3& n : normals) {
      EXPECT_NEAR(overSphere(512, [&](const vec3& d) { return double(sky.pdfFacing(n, d)); }), 1, 5e-3) << width;
      // The mean over draws is the integral, with an error that the draws themselves tell.
      const dvec3 wanted = openIrradiance(sky, n, 1024);
      glm::dvec3 sum(0), squares(0);
      const int count = 40000;
      Rng rng(1, Stream::Test, uint32_t(width));
      for (int i = 0; i < count; ++i) {
        const SkySample s = sky.sampleFacing(n, rng.next2());
        const glm::dvec3 value =
            s.pdf > 0 ? glm::dvec3(s.radiance) * std::max(0.0, double(glm::dot(n, s.direction))) / double(s.pdf)
                      : glm::dvec3(0);
        sum += value;
        squares += value * value;
        if (s.pdf > 0) {
          ASSERT_NEAR(s.pdf, sky.pdfFacing(n, s.direction), 1e-4f * s.pdf);
        }
      }
      const glm::dvec3 mean = sum / double(count);
      for (int c = 0; c < 3; ++c) {
        const double error = std::sqrt(std::max(0.0, squares[c] / count - mean[c] * mean[c]) / count);
        EXPECT_NEAR(mean[c], wanted[c], 4 * error + 2e-2 * wanted[c]) << width << ' ' << n.y;
        EXPECT_LT(error, 0.02 * wanted[c]) << "a sun of one texel is found, " << width;
      }
    }
    const dvec3 floor = openIrradiance(sky, {0, 1, 0}, 1024);
    EXPECT_NEAR(sky.irradiance().x, floor.x, 2e-2 * floor.x) << width;
    const dvec3 ceiling = openIrradiance(sky, {0, -1, 0}, 1024);
    EXPECT_NEAR(sky.irradianceBelow().x, ceiling.x, 2e-2 * ceiling.x) << width;
    EXPECT_NEAR(sky.meanLuminance(),
                overSphere(1024, [&](const vec3& d) { return double(luminance(sky.radiance(d))); }) / (4 * M_PI),
                2e-2 * sky.meanLuminance());
  }
}

TEST(SkyImage, IsEqualToWhatHasTheSameTexels) {
  const auto a = picture(8, 4, 1, 1, 2), b = picture(8, 4, 1, 1, 2), c = picture(8, 4, 2, 1, 2);
  EXPECT_EQ(Sky::image(a), Sky::image(b));
  EXPECT_NE(Sky::image(a), Sky::image(c));
  EXPECT_NE(Sky::image(a), Sky::image(b, 2));
  EXPECT_NE(Sky::image(a), Sky::image(b, 1, 0.1f));
  EXPECT_NE(Sky::image(a), Sky(vec3(1)));
  auto black = std::make_shared<SkyImage>(SkyImage{2, 1, {vec3(0), vec3(0)}});
  EXPECT_TRUE(Sky::image(black).black());
  EXPECT_FALSE(Sky::image(a).black());
}

class SkyFile : public testing::Test {
 protected:
  TemporaryFolder folder;
  std::vector<std::string> notes;

  std::filesystem::path written(const std::string& name, const std::string& bytes) {
    std::ofstream(folder / name, std::ios::binary) << bytes;
    return folder / name;
  }
};

TEST_F(SkyFile, ReadsOpenExrAndRadiance) {
  Image image(6, 3, vec3(0.25f, 0.5f, 1));
  image.at(2, 1) = vec3(7, -1, NAN);
  image.at(3, 1).x = 1e9f;
  writeExr(folder / "sky.EXR", image);
  const auto exr = readSky(folder / "sky.EXR", notes);
  EXPECT_EQ(exr->width, 6);
  EXPECT_EQ(exr->texels[0], vec3(0.25f, 0.5f, 1));
  EXPECT_EQ(exr->texels[8], vec3(7, 0, 0));
  EXPECT_EQ(exr->texels[9].x, 65504);
  EXPECT_EQ(notes.size(), 2);
  // Flat RGBE: mantissas of 128 and exponent 129 are 1.
  const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n";
  const auto hdr = readSky(written("a.hdr", header + std::string("\x80\x40\x20\x81\x80\x80\x80\x80", 8)), notes);
  EXPECT_EQ(hdr->width, 2);
  EXPECT_EQ(hdr->texels[0], vec3(1, 0.5f, 0.25f));
  EXPECT_EQ(hdr->texels[1], vec3(0.5f));
  // What its texels were multiplied by is taken back; what is no factor is none.
  const std::string factors = "#?RADIANCE\nEXPOSURE=4\nEXPOSURE= +0.5\nCOLORCORR= 1 +2 4\nEXPOSURE=0\nEXPOSURE=x\n";
  const auto exposed = readSky(
      written("e.hdr", factors + header.substr(11) + std::string("\x80\x40\x20\x81\x80\x80\x80\x80", 8)), notes);
  EXPECT_EQ(exposed->texels[0], vec3(0.5f, 0.125f, 0.03125f));
  // In runs: red 1 eight times, green by itself, blue in two runs.
  const std::string wide = "#?RGBE\nEXPOSURE=1\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n";
  const std::string runs("\x02\x02\x00\x08\x88\x80\x08\x00\x10\x20\x30\x40\x50\x60\x70\x83\x40\x85\x80\x88\x81", 21);
  const auto row = readSky(written("runs.hdr", wide + runs), notes);
  EXPECT_EQ(row->texels[0], vec3(1, 0, 0.5f));
  EXPECT_EQ(row->texels[7], vec3(1, 0.875f, 1));
  for (size_t kept = 0; kept < runs.size(); ++kept)
    EXPECT_THROW(readSky(written("runs.hdr", wide + runs.substr(0, kept)), notes), InputError) << kept;
}

TEST_F(SkyFile, HalvesWhatIsVeryWide) {
  Image image(8192, 2);
  for (int x = 0; x < 8192; ++x) image.at(x, 0) = image.at(x, 1) = vec3(float(x % 2) * 2);
  writeExr(folder / "wide.exr", image);
  const auto sky = readSky(folder / "wide.exr", notes);
  EXPECT_EQ(sky->width, 4096);
  EXPECT_EQ(sky->texels[77], vec3(1));
}

TEST_F(SkyFile, HalvesWhatIsVeryTall) {
  const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 10000 +X 2\n";
  const auto sky = readSky(written("tall.hdr", header + std::string(80000, '\x80')), notes);
  EXPECT_EQ(sky->height, 2500);
  EXPECT_EQ(sky->texels.size(), size_t(2500 * sky->width));
}

TEST_F(SkyFile, RefusesWhatIsNoSky) {
  const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";
  EXPECT_THROW(readSky(folder / "none.hdr", notes), InputError);
  EXPECT_THROW(readSky(written("picture.png", "x"), notes), InputError);
  EXPECT_THROW(readSky(written("text.hdr", "hello"), notes), InputError);
  EXPECT_THROW(readSky(written("text.exr", "hello"), notes), InputError);
  EXPECT_THROW(readSky(written("huge.hdr", header + "-Y 30000 +X 30000\n...."), notes), InputError);
  EXPECT_THROW(readSky(written("short.hdr", header + "-Y 500 +X 1000\n...."), notes), InputError);
}

} // namespace lambent::test::sky_image_test

#include "tests/support/images.h"

#include <filesystem>

namespace lambent::test {

double relativeRmse(const Image& a, const Image& b) {
  double difference = 0, reference = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    const vec3 d = a.pixels[i] - b.pixels[i];
    difference += double(glm::dot(d, d));
    reference += double(glm::dot(b.pixels[i], b.pixels[i]));
  }
  return reference > 0 ? std::sqrt(difference / reference) : difference > 0 ? 1e9 : 0;
}

double relativeDifference(const Image& a, const Image& b) {
  double difference = 0, sum = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    difference += luminance(glm::abs(a.pixels[i] - b.pixels[i]));
    sum += luminance(b.pixels[i]);
  }
  EXPECT_GT(sum, 0);
  return difference / sum;
}

double meanLuminance(const Image& a) {
  double sum = 0;
  for (const vec3& p : a.pixels) sum += double(luminance(p)) / double(a.pixels.size());
  return sum;
}

bool sameBits(const Image& a, const Image& b) {
  return a.width == b.width && a.height == b.height &&
         std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(vec3)) == 0;
}

vec3 byteAt(const Image8& image, int x, int y) {
  const uint8_t* p = &image.rgb[(size_t(y) * image.width + x) * 3];
  return {p[0], p[1], p[2]};
}

void expectClose(const std::string& name, const Image& actual, const Image& expected, double bound) {
  ASSERT_EQ(actual.width, expected.width);
  ASSERT_EQ(actual.height, expected.height);
  const double error = relativeRmse(actual, expected);
  if (error <= bound) return;
  Image difference = actual;
  for (size_t i = 0; i < difference.pixels.size(); ++i)
    difference.pixels[i] = glm::abs(actual.pixels[i] - expected.pixels[i]);
  const std::filesystem::path folder = "out/failed";
  std::filesystem::create_directories(folder);
  writeExr(folder / (name + "-actual.exr"), actual);
  writeExr(folder / (name + "-expected.exr"), expected);
  writeExr(folder / (name + "-difference.exr"), difference);
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  ADD_FAILURE() << name << ": relative RMSE " << error << " is over " << bound << "; pictures in "
                << std::filesystem::absolute(folder).string()
                << "; again: build/bin/tests_gl --gtest_filter=" << test->test_suite_name() << "." << test->name();
}

} // namespace lambent::test

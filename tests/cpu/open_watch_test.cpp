// What a file takes while it is opened is bounded, whatever takes it.
#include "engine/core/open_watch.h"

#include "tests/support/effort.h"

#include <gtest/gtest.h>

#include <chrono>
#include <vector>

namespace lambent::test {

namespace {

double spin(double seconds) { // of a clock
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  double sum = 0;
  while (std::chrono::steady_clock::now() < end) sum += 1;
  return sum;
}

TEST(OpenWatch, GrowsWithTheFile) {
  const OpenWatch::Budget small = OpenWatch::of(0), still = OpenWatch::of(3 << 20), large = OpenWatch::of(103 << 20);
  EXPECT_EQ(small.seconds, still.seconds);
  EXPECT_EQ(small.bytes, still.bytes);
  EXPECT_LT(small.bytes, size_t(1'000'000'000) * (kSanitized ? 10 : 1));
  EXPECT_LT(small.seconds, 20 * (kSanitized ? 10 : 1));
  EXPECT_GT(large.seconds, 20 * small.seconds);
  EXPECT_GT(large.bytes, 20 * small.bytes);
}

TEST(OpenWatch, LetsPassWhatIsWithin) {
  const OpenWatch watch("small.gltf", 0.1);
  EXPECT_GT(spin(0.2), 0);
}

#ifndef __SANITIZE_THREAD__                          // does not let a program be doubled that has threads
constexpr double kShare = kSanitized ? 0.004 : 0.04; // of 14 s and 900 MB

TEST(OpenWatchDeathTest, EndsWhatTakesLong) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        const OpenWatch watch("slow.gltf", kShare);
        spin(20);
      },
      testing::ExitedWithCode(2), "error: slow.gltf: takes more to open than a file of its size may: 1 s of processor");
}

TEST(OpenWatchDeathTest, GivesMoreToWhatIsRead) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        const OpenWatch watch("large.gltf", kShare);
        OpenWatch::read(size_t(103) << 20); // 16 s
        spin(2);
        std::exit(7);
      },
      testing::ExitedWithCode(7), "");
}

TEST(OpenWatchDeathTest, EndsWhatTakesMuch) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        const OpenWatch watch("much.gltf", kShare);
        std::vector<char> much(100'000'000, 1);
        spin(20 * double(much[77'777'777]));
      },
      testing::ExitedWithCode(2), "error: much.gltf: takes more to open than a file of its size may: 36 MB of memory");
}
#endif

} // namespace

} // namespace lambent::test

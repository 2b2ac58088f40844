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
  constexpr int kSlower = kSanitized ? 10 : 1;
  for (const bool open : {false, true}) {
    const auto of = [&](size_t bytes) { return OpenWatch::of(bytes, open); };
    EXPECT_EQ(of(0).seconds, of(3 << 20).seconds);
    EXPECT_EQ(of(0).bytes, of(3 << 20).bytes);
    EXPECT_LT(of(0).bytes, size_t(1'000'000'000) * kSlower);
    EXPECT_LT(of(0).seconds, 20 * kSlower);
    EXPECT_GT(of(103 << 20).seconds, 20 * of(0).seconds);
    EXPECT_GT(of(103 << 20).bytes, 20 * of(0).bytes);
  }
  EXPECT_GT(OpenWatch::of(0, true).seconds, OpenWatch::of(0, false).seconds);
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
      testing::ExitedWithCode(2),
      "error: slow.gltf: takes more until its first picture than a file of its size may: 1 s of processor");
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

TEST(OpenWatchDeathTest, GivesAsMuchMoreAsAPictureAsksFor) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto spent = [](double times, double seconds) {
    OpenWatch watch("asked.gltf", kShare);
    watch.opened(times);
    spin(seconds);
    std::exit(7);
  };
  EXPECT_EXIT(spent(1, 20), testing::ExitedWithCode(2), "asked.gltf");
  EXPECT_EXIT(spent(20, 2), testing::ExitedWithCode(7), "");
}

TEST(OpenWatchDeathTest, EndsWithTheFirstPictureOrTheNextFile) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        const OpenWatch watch("drawn.gltf", kShare);
        EXPECT_TRUE(OpenWatch::any());
        OpenWatch::end();
        EXPECT_FALSE(OpenWatch::any());
        spin(2);
        std::exit(7);
      },
      testing::ExitedWithCode(7), "");
  EXPECT_EXIT(
      {
        const OpenWatch before("before.gltf", kShare);
        const OpenWatch now("now.gltf", 10);
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
      testing::ExitedWithCode(2),
      "error: much.gltf: takes more until its first picture than a file of its size may: 36 MB of memory");
}
#endif

} // namespace

} // namespace lambent::test

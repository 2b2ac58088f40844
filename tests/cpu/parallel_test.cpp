#include "engine/core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <vector>

namespace lambent {
namespace {

/// Bodies keep figures of their block in element begin / grain: two blocks there at once lost counts.
TEST(Parallel, BlocksBeginAtMultiplesOfTheGrain) {
  for (const size_t n : {1, 31, 32, 33, 100, 1000, 1023}) {
    std::vector<std::atomic<int>> calls((n + 31) / 32), covered(n);
    parallelFor(n, 32, [&](size_t begin, size_t end) {
      ++calls[begin / 32];
      EXPECT_EQ(begin % 32, 0u);
      for (size_t i = begin; i < end; ++i) ++covered[i];
    });
    for (const auto& c : calls) EXPECT_EQ(c, 1) << n;
    for (const auto& c : covered) EXPECT_EQ(c, 1) << n;
  }
}

} // namespace
} // namespace lambent

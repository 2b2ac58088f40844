// How much a test of many frames or scenes does.
#pragma once

#include <cstdlib>

/// First line of a test that asks for statistics of what other tests run too: sanitizers look there.
#define SKIP_STATISTICS_WHEN_SANITIZED()                                                                               \
  if (::lambent::test::kSanitized) GTEST_SKIP() << "statistics of what other tests run too"

namespace lambent::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true; // everything takes ten times as long: fewer frames do
#else
constexpr bool kSanitized = false;
#endif

/// Whether minutes may be spent (tools/test --long).
inline bool isLong() {
  const char* wanted = std::getenv("LAMBENT_LONG");
  return wanted && *wanted;
}

} // namespace lambent::test

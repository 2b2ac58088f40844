// Whether this build looks for memory errors or races.
#pragma once

namespace lambent::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true; // everything takes ten times as long: fewer frames do
#else
constexpr bool kSanitized = false;
#endif

} // namespace lambent::test

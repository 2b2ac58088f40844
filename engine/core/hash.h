// A hash of bytes in their order, for what must not be mistaken for something else.
#pragma once

#include "engine/core/math.h"
#include "engine/core/rng.h"

#include <cstring>
#include <type_traits>
#include <vector>

namespace lambent {

/// Depends on bytes and their order.
class Hash {
 public:
  explicit Hash(uint64_t version) : state_(version) {}
  void bytes(const void* data, size_t size) {
    const char* at = static_cast<const char*>(data);
    for (; size >= 8; at += 8, size -= 8) word(at, 8);
    if (size > 0) word(at, size);
  }
  template <class T> void value(const T& v) {
    static_assert(std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>);
    bytes(&v, sizeof v);
  }
  template <int N> void value(const glm::vec<N, float>& v) {
    for (int i = 0; i < N; ++i) value(v[i]);
  }
  template <class T> void values(const std::vector<T>& v) {
    value(v.size());
    bytes(v.data(), v.size() * sizeof(T));
  }
  uint64_t result() const { return state_; }

 private:
  void word(const char* at, size_t size) {
    uint64_t w = 0;
    std::memcpy(&w, at, size);
    state_ = mix64(state_ ^ w) + 0x9e3779b97f4a7c15ull;
  }
  uint64_t state_;
};

} // namespace lambent

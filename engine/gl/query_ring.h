// A count that the GPU makes in every frame and the CPU hears of when it is there, a frame or more late.
#pragma once

#include "engine/gl/objects.h"

#include <array>

namespace lambent::gl {

class QueryRing {
 public:
  explicit QueryRing(GLenum target) : target_(target) {}

  /// What is drawn between these two is counted. Asks nothing where every query still waits for the GPU: a result that
  /// is on its way is never given up for a newer one, so that a GPU far behind still reports something.
  void begin();
  void end();

  /// The newest result that the GPU has come to; does not wait.
  std::optional<uint64_t> latest();

 private:
  static constexpr size_t kQueries = 4; // GPUs are allowed about three frames behind

  GLenum target_;
  std::array<Query, kQueries> queries_;
  size_t oldest_ = 0, pending_ = 0; // those that wait for the GPU follow each other from the oldest on
  bool asking_ = false;
  std::optional<uint64_t> latest_;
};

} // namespace lambent::gl

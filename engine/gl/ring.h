// Memory for what the CPU sends to the GPU in every frame. Writing into a buffer that the GPU still reads makes the
// driver wait or copy; here each value gets a place of its own, and a place comes round again frames later.
#pragma once

#include "engine/gl/objects.h"

#include <array>

namespace lambent::gl {

/// Part of a buffer.
struct BufferSlice {
  const Buffer* buffer = nullptr;
  uint64_t offset = 0, bytes = 0;

  void bindUniform(int binding) const { buffer->bindUniform(binding, offset, bytes); }
};

class Ring {
 public:
  /// `bytesPerFrame`: about what is written between two frames; it has room for four times that.
  explicit Ring(std::string label, uint64_t bytesPerFrame = 4096);
  ~Ring();
  Ring(const Ring&) = delete;
  Ring& operator=(const Ring&) = delete;

  /// Makes room where a frame writes more than was thought. Slices given before are then no longer to be bound.
  void reserve(uint64_t bytesPerFrame);

  /// The next place, with `data` in it, aligned for uniform blocks. Commands may read it that are given before the next
  /// write or reserve. Waits, and counts it, only where the GPU is so far behind that it still reads that place.
  BufferSlice write(uint64_t bytes, const void* data);

  /// Writes into `to` in the order of commands, by way of a place of its own: those before see the old values, those
  /// after the new ones, and nobody waits. For what stays: the GPU reads it from memory that is its own.
  void upload(const Buffer& to, uint64_t offset, uint64_t bytes, const void* data);

 private:
  static constexpr size_t kParts = 4; // a fence for each

  void enter(size_t part);
  void forgetFences();

  std::string label_;
  Buffer buffer_;
  std::byte* mapped_ = nullptr;
  uint64_t partBytes_, head_ = 0, alignment_ = 0;
  size_t part_ = 0;
  std::array<GLsync, kParts> fences_{}; // of the commands that read the part when it was last left
};

} // namespace lambent::gl

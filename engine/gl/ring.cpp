#include "engine/gl/ring.h"

#include "engine/core/error.h"

#include <cstring>

namespace lambent::gl {

namespace {

uint64_t roundedUp(uint64_t value, uint64_t multiple) { return (value + multiple - 1) / multiple * multiple; }

} // namespace

Ring::Ring(std::string label, uint64_t bytesPerFrame) : label_(std::move(label)), partBytes_(bytesPerFrame) {}
Ring::~Ring() { forgetFences(); }

void Ring::forgetFences() {
  for (GLsync& fence : fences_) {
    if (fence) glDeleteSync(fence);
    fence = nullptr;
  }
}

void Ring::reserve(uint64_t bytesPerFrame) {
  if (bytesPerFrame <= partBytes_) return;
  partBytes_ = bytesPerFrame;
  buffer_ = {}; // the GPU keeps it until it has read it
}

BufferSlice Ring::write(uint64_t bytes, const void* data) {
  reserve(bytes);
  if (!buffer_) {
    GLint alignment = 256;
    glGetIntegerv(GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT, &alignment);
    alignment_ = uint64_t(std::max(16, alignment));
    partBytes_ = roundedUp(std::max<uint64_t>(1, partBytes_), alignment_);
    constexpr GLbitfield kAccess = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    buffer_ = Buffer(label_, kParts * partBytes_, nullptr, kAccess);
    mapped_ = static_cast<std::byte*>(glMapNamedBufferRange(buffer_.name(), 0, GLsizeiptr(buffer_.bytes()), kAccess));
    if (!mapped_) throw RunError(label_ + ": no memory for what is sent to the GPU in a frame");
    forgetFences();
    head_ = part_ = 0;
  }
  uint64_t offset = roundedUp(head_, alignment_);
  if (offset + bytes > (part_ + 1) * partBytes_) {
    enter((part_ + 1) % kParts);
    offset = part_ * partBytes_;
  }
  head_ = offset + bytes;
  std::memcpy(mapped_ + offset, data, bytes);
  return {&buffer_, offset, bytes};
}

void Ring::enter(size_t part) {
  fences_[part_] = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  part_ = part;
  GLsync& fence = fences_[part];
  if (!fence) return;
  if (glClientWaitSync(fence, 0, 0) == GL_TIMEOUT_EXPIRED) {
    ++detail::countsSoFar().waits;
    constexpr GLuint64 kSecond = 1'000'000'000;
    while (glClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, kSecond) == GL_TIMEOUT_EXPIRED) {
    }
  }
  glDeleteSync(fence);
  fence = nullptr;
}

void Ring::upload(const Buffer& to, uint64_t offset, uint64_t bytes, const void* data) {
  CHECK_LE(offset + bytes, to.bytes());
  if (bytes == 0) return;
  const BufferSlice from = write(bytes, data);
  glCopyNamedBufferSubData(from.buffer->name(), to.name(), GLintptr(from.offset), GLintptr(offset), GLsizeiptr(bytes));
}

} // namespace lambent::gl

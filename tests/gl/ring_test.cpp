// Rings: what was written arrives, however often the ring comes round before the GPU has read it.
#include "engine/gl/ring.h"
#include "gl_fixture.h"

namespace lambent::test::ring_test {

using RingTest = GlTest;

/// 0, 1, 2 …
void expectCounts(const gl::Buffer& heard, size_t count) {
  std::vector<uint32_t> values(count), expected(count);
  heard.read(0, std::span(values));
  std::iota(expected.begin(), expected.end(), 0);
  EXPECT_EQ(values, expected);
}

TEST_F(RingTest, EverySliceKeepsItsValueUntilItWasRead) {
  constexpr uint32_t kWrites = 500;
  gl::Ring ring("ring test/ring", 1024);
  const gl::Buffer heard("ring test/heard", kWrites * sizeof(uint32_t), nullptr);
  GLint alignment = 0;
  glGetIntegerv(GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT, &alignment);
  uint64_t end = 0, rounds = 0; // of the slice before
  for (uint32_t i = 0; i < kWrites; ++i) {
    std::vector<uint32_t> values(1 + i * 7 % 50, i);
    const gl::BufferSlice slice = ring.write(values.size() * sizeof(uint32_t), values.data());
    // One after the other till it comes round. (A driver that copies at once hides slices at one place.)
    EXPECT_TRUE(slice.offset >= end || slice.offset == 0) << i;
    rounds += slice.offset < end;
    end = slice.offset + slice.bytes;
    EXPECT_EQ(slice.offset % alignment, 0u);
    EXPECT_EQ(slice.bytes, values.size() * sizeof(uint32_t));
    glCopyNamedBufferSubData(slice.buffer->name(), heard.name(), slice.offset + slice.bytes - sizeof(uint32_t),
                             i * sizeof(uint32_t), sizeof(uint32_t));
  }
  expectCounts(heard, kWrites);
  EXPECT_GT(rounds, 10u);
  EXPECT_LT(rounds, kWrites / 8);
}

TEST_F(RingTest, UploadsKeepTheOrderOfCommands) {
  constexpr uint32_t kWrites = 500;
  gl::Ring ring("ring test/ring", 64);
  const gl::Buffer kept("ring test/kept", 64, nullptr), heard("ring test/heard", kWrites * sizeof(uint32_t), nullptr);
  for (uint32_t i = 0; i < kWrites; ++i) {
    ring.upload(kept, 12, sizeof i, &i);
    glCopyNamedBufferSubData(kept.name(), heard.name(), 12, i * sizeof(uint32_t), sizeof(uint32_t));
  }
  expectCounts(heard, kWrites);
}

TEST_F(RingTest, GrowsForWhatIsLargerThanThought) {
  gl::Ring ring("ring test/ring", 16);
  std::vector<uint32_t> values(100'000);
  std::iota(values.begin(), values.end(), 0);
  const gl::Buffer kept = gl::Buffer::of<uint32_t>("ring test/kept", std::vector<uint32_t>(values.size()));
  ring.upload(kept, 0, 8, values.data());
  ring.upload(kept, 0, values.size() * sizeof(uint32_t), values.data());
  expectCounts(kept, values.size());
}

} // namespace lambent::test::ring_test

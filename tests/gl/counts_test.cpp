// Draws, waits and read-backs are counted wherever they happen, and a frame makes no more of the last two than it
// needs.
#include "engine/gl/query_ring.h"
#include "gl_fixture.h"

namespace lambent::test::counts_test {

class CountsTest : public GlTest {
 protected:
  gl::Counts sinceBefore() const { return gl::counts() - before; }
  void SetUp() override {
    GlTest::SetUp();
    before = gl::counts();
  }
  gl::Counts before;
};

TEST_F(CountsTest, EveryWayToReadBackCounts) {
  const gl::Texture texture(
      "counts/texture", {.kind = gl::TextureKind::Array, .format = GL_RGBA32F, .width = 2, .height = 2, .layers = 2});
  const float two[] = {1, 2, 3, 4};
  glTextureSubImage3D(texture.name(), 0, 1, 1, 1, 1, 1, 1, GL_RGBA, GL_FLOAT, two);
  std::vector<vec4> all(8), layer(4);
  texture.read(std::span(all), GL_RGBA, GL_FLOAT);
  texture.readLayer(1, std::span(layer), GL_RGBA, GL_FLOAT);
  EXPECT_EQ(all[7], vec4(1, 2, 3, 4));
  EXPECT_EQ(layer[3], vec4(1, 2, 3, 4));
  const uint32_t values[] = {7, 8, 9};
  const gl::Buffer buffer = gl::Buffer::of<uint32_t>("counts/buffer", values);
  uint32_t last = 0;
  buffer.read(8, std::span(&last, 1));
  EXPECT_EQ(last, 9u);
  EXPECT_EQ(sinceBefore().readBacks, 3u);
  EXPECT_EQ(sinceBefore().waits, 0u);
}

TEST_F(CountsTest, OnlyTheResultOfAQueryWaits) {
  const gl::Query query(GL_TIMESTAMP);
  glQueryCounter(query.name(), GL_TIMESTAMP);
  query.known();
  EXPECT_EQ(sinceBefore().waits, 0u);
  const uint64_t time = query.result();
  EXPECT_EQ(sinceBefore().waits, 1u);
  EXPECT_EQ(query.known(), time);
  EXPECT_EQ(sinceBefore().waits, 1u);
}

/// Whether it holds within a second.
bool soon(const std::function<bool()>& holds) {
  for (int polls = 0; polls < 1000 && !holds(); ++polls) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return holds();
}

/// Frame i marks i fragments. Whatever the GPU has come to by then, what is heard is the count of a frame that was
/// drawn, never of an earlier one than was heard before, and at last that of the last frame that asked.
TEST_F(CountsTest, ARingOfQueriesNeitherWaitsNorForgets) {
  const gl::Texture target("ring/target", {.format = GL_RGBA8, .width = 64, .height = 1});
  const gl::Framebuffer framebuffer("ring", {&target});
  gl::QueryRing ring(GL_SAMPLES_PASSED);
  EXPECT_EQ(ring.latest(), std::nullopt);
  programs.get({.fragment = "present.frag"}).use();
  framebuffer.bind();
  uint64_t heard = 0;
  for (int i = 1; i <= 40; ++i) {
    gl::PipelineState{.width = i, .height = 1}.apply();
    ring.begin();
    gl::drawFullscreen();
    ring.end();
    const uint64_t now = ring.latest().value_or(0);
    EXPECT_GE(now, heard);
    EXPECT_LE(now, uint64_t(i));
    heard = now;
  }
  EXPECT_EQ(sinceBefore().waits, 0u);
  // Of a GPU that is done the results are known "in finite time" (OpenGL 4.5, 4.2.3): with some drivers a little later.
  glFinish();
  EXPECT_TRUE(soon([&] { return ring.latest().value_or(0) > 0; }));
  gl::PipelineState{.width = 50, .height = 1}.apply();
  ring.begin();
  gl::drawFullscreen();
  ring.end();
  glFinish();
  EXPECT_TRUE(soon([&] { return ring.latest() == 50u; })) << ring.latest().value_or(0);
}

/// Of the room: 17 rectangles, of three materials, one of them cut out in the end.
TEST_F(CountsTest, ARunOfOneMaterialIsOneDraw) {
  Room room;
  room.scene.assets.materials[1].alphaMode = AlphaMode::Mask;
  GpuScene gpu(passes, room.scene.assets);
  gpu.place(room.scene.instances);
  mat4 everything(0.1f);
  everything[3] = vec4(0, 0, 0.5f, 1);
  const gl::Texture depth("counts/depth", {.format = GL_DEPTH_COMPONENT32F, .width = 8, .height = 8});
  const gl::Framebuffer framebuffer("counts", {}, &depth);
  framebuffer.bind();
  const CameraBlock anywhere{};
  const gl::Buffer camera = gl::Buffer::of<CameraBlock>("counts/camera", {&anywhere, 1});
  camera.bindUniform(0); // a driver may read a block that is not there from nowhere
  gl::PipelineState{.depthTest = true, .depthWrite = true, .width = 8, .height = 8}.apply();
  gpu.setAlphaTest(AlphaTest::None);
  EXPECT_EQ(gpu.draw(DrawKind::GBuffer, everything), 3u);
  EXPECT_EQ(gpu.draw(DrawKind::Depth, everything), 1u);
  gpu.setAlphaTest(AlphaTest::Needed);
  EXPECT_EQ(gpu.draw(DrawKind::Depth, everything), 2u);
  EXPECT_EQ(gpu.testedDraws(), 1u);
  gpu.setAlphaTest(AlphaTest::All);
  EXPECT_EQ(gpu.draw(DrawKind::Depth, everything), 3u);
  EXPECT_EQ(sinceBefore().draws, 9u);
}

} // namespace lambent::test::counts_test

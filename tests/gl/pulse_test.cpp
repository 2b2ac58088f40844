// Frames that show signs of life while they are computed: what draws meanwhile changes nothing, what throws ends them.
#include "engine/core/error.h"
#include "engine/gl/pulse.h"
#include "engine/gl/state_guard.h"
#include "still_room.h"

namespace lambent::test {

class PulseTest : public StillRoomTest {
 protected:
  PulseTest() {
    settings.smc.vpls = 32;
    settings.smc.warmup = 2;
  }
};

TEST_F(PulseTest, WhatDrawsBetweenDrawsChangesNothing) {
  Viewer plain(settings), beating(settings);
  plain.run(still());
  const gl::Texture target("pulse/target", {.format = GL_RGBA8, .width = 4, .height = 4});
  const gl::Framebuffer framebuffer("pulse", {&target});
  const gl::Program& program = programs.get({.fragment = "present.frag"});
  uint64_t beats = 0, draws = 0;
  {
    const gl::Pulse pulse([&] {
      ++beats;
      const gl::StateGuard guard;
      framebuffer.bind();
      gl::PipelineState{.width = 4, .height = 4}.apply();
      program.use();
      gl::drawFullscreen();
    });
    draws = beating.run(still()).draws;
  }
  EXPECT_GT(beats, 20u);
  EXPECT_GE(draws, 2 * beats - 40) << "one of its own for each, but for textures and programs";
  EXPECT_EQ(beating.read(Buffer::Beauty).pixels, plain.read(Buffer::Beauty).pixels);
  const uint64_t before = beats;
  framebuffer.bind();
  program.use();
  gl::drawFullscreen();
  EXPECT_EQ(beats, before) << "it is over";
}

TEST_F(PulseTest, WhatThrowsEndsTheFrameAndOthersGoOn) {
  Viewer plain(settings);
  plain.run(still());
  for (const int last : {1, 7, 20}) {
    Viewer ended(settings);
    int beats = 0;
    const auto run = [&] {
      const gl::Pulse pulse([&] {
        if (++beats == last) throw RunError("enough");
      });
      ended.run(still());
    };
    EXPECT_THROW(run(), RunError);
    EXPECT_EQ(beats, last);
  }
  Viewer again(settings);
  again.run(still());
  EXPECT_EQ(again.read(Buffer::Beauty).pixels, plain.read(Buffer::Beauty).pixels);
}

TEST_F(PulseTest, IsNotTimed) {
  int beats = 0;
  const gl::Pulse pulse([&] { ++beats; });
  const gl::Texture target("pulse/target", {.format = GL_RGBA8, .width = 4, .height = 4});
  const gl::Framebuffer framebuffer("pulse", {&target});
  programs.get({.fragment = "present.frag"}).use();
  framebuffer.bind();
  gl::PipelineState{.width = 4, .height = 4}.apply();
  const int before = beats;
  gl::secondsOf([] { gl::drawFullscreen(); });
  EXPECT_EQ(beats, before);
  gl::drawFullscreen();
  EXPECT_EQ(beats, before + 1);
}

} // namespace lambent::test

// A host has an OpenGL context of its own making, by EGL or GLX: frames in it leave it as it was, and frames in a
// second one that shares its objects, on a thread of their own, give it textures. This program has neither GLFW nor
// engine/platform in it.
#include "contexts.h"
#include "gi/viewer/viewer.h"
#include "tests/support/hand_scene.h"
#include "tests/support/host_state.h"

namespace lambent::test::host_test {

namespace {

/// A box with a block and a lamp in it.
struct LitBox {
  HandScene scene;
  LitBox() {
    scene.box(vec3(-1), vec3(1), scene.material(vec3(0.7f)), true);
    scene.box(vec3(-0.5f, -1, -0.6f), vec3(0, 0.2f, -0.1f), scene.material({0.6f, 0.2f, 0.2f}), false);
    scene.lamp({0.3f, 0.6f, 0.4f}, vec3(2));
    scene.camera.worldFromView[3].z = 0.9f;
    scene.camera.fovY = 1.4f;
    scene.size(40, 30);
  }
};

Settings small() {
  Settings s;
  s.smc.vpls = s.smc.points = 64;
  s.smc.warmup = 2;
  s.shadow.resolution = 16;
  s.shadow.maker = ShadowMaker::Raster;
  s.image.exposure = 1;
  return s;
}

/// Maps by rays: Mesa 22.3.6's Zink draws other maps in a context that shares objects than in one alone, run by run
/// others; neither it in a context of its own nor llvmpipe does.
Settings smallShared() {
  Settings s = small();
  s.shadow.maker = ShadowMaker::Rays;
  return s;
}

/// As the host reads it, with its own calls.
std::vector<float> texels(GLuint texture, int width, int height) {
  std::vector<float> values(size_t(4) * width * height);
  glGetTextureImage(texture, 0, GL_RGBA, GL_FLOAT, GLsizei(values.size() * sizeof(float)), values.data());
  return values;
}

std::string refusal() {
  try {
    const GiFrame gi(small());
  } catch (const RunError& e) {
    return e.what();
  }
  return {};
}

} // namespace

class HostTest : public ::testing::TestWithParam<std::unique_ptr<HostContext> (*)()> {
 protected:
  HostTest() : host(GetParam()()) {}
  void SetUp() override {
    if (!host) GTEST_SKIP() << "no such window system here";
    host->makeCurrent();
  }
  std::vector<float> drawnAlone(const Settings& settings) const {
    Viewer gi(settings);
    gi.run(box.scene.view());
    return texels(gi.texture(Buffer::Beauty), 40, 30);
  }

  std::unique_ptr<HostContext> host;
  LitBox box;
};

TEST_P(HostTest, FramesInItsContextLeaveItAsItWas) {
  const std::vector<float> alone = drawnAlone(small());
  HostState state;
  state.poison();
  const Snapshot before = snapshot();
  {
    GiFrame gi(small());
    expectUnchanged(before, "the construction of a frame");
    gi.run(box.scene.view());
    expectUnchanged(before, "a frame");
    EXPECT_TRUE(glIsTexture(gi.directIrradiance()));
    EXPECT_TRUE(glIsTexture(gi.indirectIrradiance()));
  }
  {
    Viewer gi(small());
    expectUnchanged(before, "its construction");
    gi.run(box.scene.view());
    expectUnchanged(before, "run");
    GLint bound = 0;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
    gi.present(Buffer::Beauty, GLuint(bound), 8, 8);
    expectUnchanged(before, "present");
    const Image image = gi.read(Buffer::Beauty);
    float sum = 0;
    for (const vec3& p : image.pixels) sum += p.x;
    EXPECT_GT(sum, 1);
    EXPECT_FLOAT_EQ(image.at(0, 29).x, alone[0]);
  }
  expectUnchanged(before, "its end");
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
}

TEST_P(HostTest, FramesInAContextThatSharesItsObjectsGiveItTextures) {
  const std::vector<float> alone = drawnAlone(smallShared());
  HostState state;
  state.poison();
  const Snapshot before = snapshot();
  const std::unique_ptr<HostContext> second = host->sharing();
  std::unique_ptr<Viewer> gi;
  GLuint texture = 0;
  const auto there = [&](const std::function<void()>& work) {
    std::thread([&] {
      second->makeCurrent();
      work();
      glFinish(); // the host's fence
      second->release();
    }).join();
  };
  there([&] {
    gi = std::make_unique<Viewer>(smallShared());
    gi->run(box.scene.view());
    texture = gi->texture(Buffer::Beauty);
  });
  expectUnchanged(before, "a frame in another context");
  EXPECT_TRUE(glIsTexture(texture)) << "it is the host's to read";
  GLuint shown = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &shown);
  glTextureStorage2D(shown, 1, GL_RGBA32F, 40, 30);
  glCopyImageSubData(texture, GL_TEXTURE_2D, 0, 0, 0, 0, shown, GL_TEXTURE_2D, 0, 0, 0, 0, 40, 30, 1);
  glFinish(); // as above
  there([&] {
    const std::vector<float> values = texels(shown, 40, 30);
    EXPECT_EQ(std::memcmp(values.data(), alone.data(), values.size() * sizeof(float)), 0);
    gi.reset();
  });
  glDeleteTextures(1, &shown);
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
}

/// Two scenes, each on a thread with a context of its own, at once.
TEST_P(HostTest, FramesOnTwoThreadsDrawWhatEachDrawsAlone) {
  LitBox boxes[2];
  boxes[1].scene.camera.worldFromView[3].x = 0.3f;
  const auto drawn = [&](int which, FrameStats& stats) {
    Viewer gi(smallShared(), 1 + which);
    for (int frame = 0; frame < 3; ++frame) stats = gi.run(boxes[which].scene.view());
    return gi.read(Buffer::Beauty).pixels;
  };
  std::vector<vec3> alone[2], together[2];
  FrameStats statsAlone[2], stats[2];
  for (int i = 0; i < 2; ++i) alone[i] = drawn(i, statsAlone[i]);
  EXPECT_NE(alone[0], alone[1]);
  const std::unique_ptr<HostContext> contexts[] = {host->sharing(), host->sharing()};
  std::thread threads[2];
  for (int i = 0; i < 2; ++i)
    threads[i] = std::thread([&, i] {
      contexts[i]->makeCurrent();
      together[i] = drawn(i, stats[i]);
      contexts[i]->release();
    });
  for (std::thread& thread : threads) thread.join();
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(together[i], alone[i]);
    EXPECT_EQ(stats[i].draws, statsAlone[i].draws) << "each counts its own";
  }
}

TEST_P(HostTest, WithoutACurrentContextItIsRefusedInOneLine) {
  EXPECT_EQ(refusal(), "");
  host->release();
  EXPECT_NE(refusal().find("no OpenGL context is current"), std::string::npos) << refusal();
  EXPECT_EQ(refusal().find('\n'), std::string::npos) << refusal();
  host->makeCurrent();
  EXPECT_EQ(refusal(), "");
}

INSTANTIATE_TEST_SUITE_P(Egl, HostTest, ::testing::Values(eglHost));
INSTANTIATE_TEST_SUITE_P(Glx, HostTest, ::testing::Values(glxHost));

TEST(EmbeddedHostTest, IsRefusedInOneLine) {
  const std::unique_ptr<HostContext> host = embeddedHost();
  if (!host) GTEST_SKIP() << "no OpenGL ES here";
  host->makeCurrent();
  EXPECT_NE(refusal().find("OpenGL ES"), std::string::npos) << refusal();
}

} // namespace lambent::test::host_test

// A host with settings of its own: frames inside its context find their conventions and leave its state as it was.
#include "engine/core/error.h"
#include "engine/gl/pulse.h"
#include "engine/gl/state_guard.h"
#include "gl_fixture.h"
#include "tests/support/host_state.h"

namespace lambent::test::state_guard_test {

/// A room with one of everything that passes have state for: lights of all types, something that glows, a textured
/// surface with a cut-out alpha, a shape of its own, and a sky.
struct FullRoom : Room {
  FullRoom() {
    scene.lights = {{.id = 1, .position = {0.3f, 0.6f, 0.5f}, .intensity = vec3(1)},
                    {.id = 2,
                     .type = LightType::Spot,
                     .position = {-0.5f, 0.8f, 0.2f},
                     .direction = {0, -1, 0},
                     .intensity = vec3(2)},
                    {.id = 3,
                     .type = LightType::Directional,
                     .direction = glm::normalize(vec3(0.2f, -1, -0.3f)),
                     .intensity = vec3(0.5f)}};
    scene.quad(vec3(-0.2f, 0.95f, -0.2f), vec3(0.4f, 0, 0), vec3(0, 0, 0.4f), scene.material(vec3(0), vec3(3)));
    scene.texture(2, {u8vec4(255), u8vec4(90, 200, 90, 0), u8vec4(90, 200, 90, 255), u8vec4(255)});
    const uint32_t textured = scene.material(vec3(1));
    Material& material = scene.assets.materials[textured];
    material.baseColorTexture.image = material.roughnessMetalnessTexture.image = 0;
    material.alphaMode = AlphaMode::Mask;
    material.roughness = 0.4f;
    scene.quad(vec3(0.1f, -0.9f, -0.5f), vec3(0.6f, 0, 0), vec3(0, 0.6f, 0), textured);
    const uint32_t waving = scene.add(sheet(4, scene.material(vec3(0.5f))),
                                      glm::scale(glm::translate(mat4(1), vec3(0.5f, -0.2f, -0.9f)), vec3(0.3f)));
    scene.reshape(waving, waves(scene.assets.meshes.back(), 0.2f, 0));
    scene.size(48, 32);
  }
};

/// A frame's settings as a change of those before.
struct Step {
  std::string name;
  std::function<void(Settings&)> edit;
  bool still = false; // nothing changed since the step before
};

Settings smallest() {
  Settings s;
  s.smc.vpls = s.smc.points = 64;
  s.smc.warmup = 2;
  s.smc.paths = 4;
  s.vpl.mirCandidates = s.vpl.tcasIterations = 2;
  s.shadow.resolution = 16;
  s.shadow.maker = ShadowMaker::Raster;
  s.shadow.skyMaps = s.shadow.emitterSamples = 4;
  s.shadow.skyResolution = s.shadow.emitterResolution = 32;
  s.shadow.sunResolution = s.shadow.pointResolution = s.shadow.spotResolution = 32;
  s.area.tracer = AreaTracer::Gpu;
  s.rsm.resolution = 32;
  s.rsm.finest = 32;
  s.rsm.coarsest = 8;
  s.rsm.vpls = 64;
  s.lpv.cells = 8;
  s.lpv.steps = 4;
  s.cube.resolution = 16;
  s.cube.hemicube = 16;
  s.hemicubes.maker = CubeMaker::Raster;
  s.image.exposure = 1;
  s.debug.timing = TimingMode::Finish;
  return s;
}

/// Every technique; every gather that goes with each kind of lights; and who has a choice of makers, each of them.
std::vector<Step> allSteps() {
  std::vector<Step> steps;
  for (const Technique& t : techniqueTable()) {
    steps.push_back({t.name, [&t](Settings& s) {
                       s = smallest();
                       applyTechnique(s, t);
                     }});
    steps.push_back({std::string(t.name) + ", still", [](Settings&) {}, true});
  }
  for (const char* technique : {"smc", "rsm", "isr", "hisr"})
    for (size_t g = 0; g < std::size(kGathers); ++g) {
      const auto edit = [=](Settings& s) {
        s = smallest();
        applyTechnique(s, technique);
        s.gather.mode = GatherMode(g);
      };
      Settings tried;
      edit(tried);
      const bool tooMany = tried.vpl.source == VplSource::Isr && tried.gather.mode == GatherMode::SplatPerVpl;
      const bool itsOwn = tried.gather.mode == techniqueByName(technique).axes.gather;
      if (!whyNot(tried).empty() || tooMany || itsOwn) continue;
      steps.push_back({std::string(technique) + ", gather " + kGathers[g].name, edit});
    }
  const auto smc = [&](const char* name, std::function<void(Settings&)> change) {
    steps.push_back({name, [change](Settings& s) {
                       s = smallest();
                       change(s);
                     }});
  };
  smc("maps by rays", [](Settings& s) { s.shadow.maker = ShadowMaker::Rays; });
  smc("visibility by rays", [](Settings& s) { s.vpl.visibility = VplVisibility::Rays; });
  smc("glossy", [](Settings& s) { s.gather.glossy = true; });
  smc("the filter at once", [](Settings& s) { s.filter.kernel = FilterKernel::Whole; });
  smc("rays by the CPU", [](Settings& s) {
    s.shadow.emitters = EmitterShadows::Patches;
    s.area.tracer = AreaTracer::Cpu;
  });
  smc("patches by neighbours", [](Settings& s) {
    s.shadow.emitters = EmitterShadows::Patches;
    s.area.refinement = AreaRefinement::Neighbours;
    s.area.upsample = AreaUpsample::Bilateral;
  });
  smc("hemicubes", [](Settings& s) {
    applyTechnique(s, "ibrr");
    s.cube.visibility = CubeVisibility::Hemicubes;
    s.cube.levels = 1;
    s.smc.vpls = 16;
  });
  return steps;
}

class StateGuardTest : public GlTest {
 protected:
  StateGuardTest() { settings.image.exposure = 1; }
  ~StateGuardTest() override { gl::setConventions(); } // after a host

  FullRoom room;
  Settings settings = smallest();
};

TEST_F(StateGuardTest, EveryTechniqueLeavesEveryBindingOfItsHost) {
  const std::vector<Step> steps = allSteps();
  Viewer gi(settings);
  const auto frame = [&](const Step& step) -> const FrameStats& {
    step.edit(gi.settings());
    return gi.run(room.scene.view(step.still ? kStill : SceneChanges{}));
  };
  const gl::Texture target("host/target", {.width = 64, .height = 48});
  const gl::Framebuffer framebuffer("host/target", {&target});
  const auto presented = [&](Buffer buffer) {
    gi.present(buffer, framebuffer.name(), 64, 48);
    const gl::StateGuard guard; // to read it
    return readTexture(target);
  };
  std::vector<Image> alone;
  for (const Step& step : steps) {
    frame(step);
    alone.push_back(gi.read(Buffer::Beauty));
  }
  std::map<std::string, Image8> shown;
  for (const std::string& buffer : bufferNames()) shown[buffer] = gi.readDisplay(bufferByName(buffer));
  const std::vector<vec4> window = presented(Buffer::Beauty);

  gi.restart();
  HostState host;
  host.poison();
  ASSERT_EQ(glGetError(), GLenum(GL_NO_ERROR));
  const Snapshot before = snapshot();
  bool raysByGpu = false;
  for (size_t i = 0; i < steps.size(); ++i) {
    const std::string& name = steps[i].name;
    const FrameStats& stats = frame(steps[i]);
    raysByGpu |= stats.areaTracer == "gpu";
    expectUnchanged(before, name);
    const Image picture = gi.read(Buffer::Beauty);
    expectUnchanged(before, name + ": read");
    EXPECT_TRUE(sameBits(picture, alone[i]))
        << name << " drew another image in a host's context: relative RMSE " << relativeRmse(picture, alone[i]);
    gi.present(Buffer::Beauty, framebuffer.name(), 64, 48);
    expectUnchanged(before, name + ": present");
    if (HasFailure()) return;
  }
  EXPECT_TRUE(raysByGpu);
  for (const std::string& buffer : bufferNames()) {
    const Image8 image = gi.readDisplay(bufferByName(buffer));
    EXPECT_TRUE(image.rgb == shown[buffer].rgb) << buffer << " is shown otherwise in a host's context";
    expectUnchanged(before, "readDisplay of " + buffer);
  }
  EXPECT_TRUE(presented(Buffer::Beauty) == window);
  gi.takeTruth(alone.back());
  expectUnchanged(before, "takeTruth");
  gi.presentBesideTruth(Buffer::Beauty, 0.5f, framebuffer.name(), 64, 48);
  expectUnchanged(before, "presentBesideTruth");
  gi.presentError(Buffer::Beauty, 1, framebuffer.name(), 64, 48);
  expectUnchanged(before, "presentError");
  gi.compareShadowMaps(room.scene.view(), 2, 16);
  expectUnchanged(before, "compareShadowMaps");
  GiFrame bare(smallest());
  for (const Technique& t : techniqueTable()) { // without a viewer, whose guard was around that of the frame
    bare.settings() = smallest();
    applyTechnique(bare.settings(), t);
    bare.run(room.scene.view());
    expectUnchanged(before, std::string(t.name) + " without a viewer");
  }
  gi.reloadShaders();
  gi.restart();
  expectUnchanged(before, "restart");
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
}

/// Whatever a pass is at.
TEST_F(StateGuardTest, WhatThrowsOutOfAFrameLeavesThemToo) {
  HostState host;
  host.poison();
  const Snapshot before = snapshot();
  for (const char* technique : {"multires-splat", "multires-gather", "isr", "lpv"}) {
    applyTechnique(settings, technique);
    Viewer gi(settings);
    for (int last = 1, beats = 0;; ++last, beats = 0) {
      bool thrown = false;
      try {
        const gl::Pulse pulse([&] {
          if (++beats == last) throw RunError("enough");
        });
        gi.run(room.scene.view());
      } catch (const RunError&) {
        thrown = true;
      }
      expectUnchanged(before, std::string(technique) + ", thrown at draw " + std::to_string(last));
      if (HasFailure()) return;
      if (!thrown) break;
    }
  }
}

/// A pass that goes further than guards do is a fault, in every build.
TEST_F(StateGuardTest, NoPassBindsWhatIsNotKept) {
  const gl::Texture texture("test/texture", {});
  const gl::Buffer buffer("test/buffer", 256, nullptr);
  EXPECT_THROW(texture.bind(gl::kTextureUnits), CheckFailure);
  EXPECT_THROW(gl::bindSampler(gl::kTextureUnits, 0), CheckFailure);
  EXPECT_THROW(buffer.bindUniform(gl::kUniformBindings), CheckFailure);
  EXPECT_THROW(buffer.bindUniform(gl::kUniformBindings, 0, 256), CheckFailure);
  EXPECT_THROW(buffer.bindStorage(gl::kStorageBindings), CheckFailure);
}

TEST_F(StateGuardTest, TransformFeedbackThatRunsIsPausedMeanwhile) {
  const gl::Buffer captured("host/captured", 4096, nullptr);
  const gl::TransformFeedback feedback("host/feedback", captured);
  const gl::Program& program = programs.get(
      {.vertex = "splat_refine.vert", .defines = {"FIRST"}, .geometry = "splat_refine.geom", .captured = {"patchOut"}});
  applyTechnique(settings, "isr");
  Viewer gi(settings);
  program.use();
  feedback.bind();
  glBeginTransformFeedback(GL_POINTS);
  gi.run(room.scene.view());
  GLint active = 0, paused = 0;
  glGetIntegerv(GL_TRANSFORM_FEEDBACK_ACTIVE, &active);
  glGetIntegerv(GL_TRANSFORM_FEEDBACK_PAUSED, &paused);
  EXPECT_TRUE(active);
  EXPECT_FALSE(paused);
  glEndTransformFeedback();
  gl::TransformFeedback::unbind();
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
}

TEST_F(StateGuardTest, OneInsideAnotherDoesNothingAndCallsOutAreHostsAgain) {
  const auto pointSize = [] {
    GLfloat size = 0;
    glGetFloatv(GL_POINT_SIZE, &size);
    return size;
  };
  glPointSize(3);
  {
    const gl::StateGuard outer;
    EXPECT_EQ(pointSize(), 1);
    glPointSize(4);
    {
      const gl::StateGuard inner;
      EXPECT_EQ(pointSize(), 4);
      glPointSize(5);
    }
    EXPECT_EQ(pointSize(), 5) << "an inner one does nothing";
    gl::callingOut(std::function<void(int, int)>([&](int, int) {
      const gl::StateGuard theirs;
      EXPECT_EQ(pointSize(), 1);
      glPointSize(6);
    }))(1, 2);
    EXPECT_EQ(pointSize(), 5) << "what is called out to keeps our state";
  }
  EXPECT_EQ(pointSize(), 3);
  {
    const gl::StateGuard next;
    EXPECT_EQ(pointSize(), 1);
  }
  EXPECT_EQ(pointSize(), 3);
  glPointSize(1);
}

/// A host that draws while it is told of progress, and wraps itself in a guard: the frame goes on as if it had not.
TEST_F(StateGuardTest, AHostMayDrawWhileItIsToldOfProgress) {
  Viewer plain(settings), told(settings);
  plain.run(room.scene.view());
  int times = 0;
  HostState host;
  const Snapshot before = snapshot();
  told.run(room.scene.view(), [&](int, int) {
    ++times;
    const gl::StateGuard guard;
    glClipControl(GL_UPPER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 7);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glBindSampler(2, 0);
  });
  EXPECT_GT(times, 0);
  expectUnchanged(before, "a host that draws");
  EXPECT_TRUE(sameBits(told.read(Buffer::Beauty), plain.read(Buffer::Beauty)));
}

/// Far from a frame's time even under sanitizers or a driver that answers slowly.
TEST_F(StateGuardTest, CostsLittle) {
  constexpr int kTimes = 100, kPasses = 20;
  const auto microseconds = [](const auto& work) { // the least of some passes: other work only adds
    double least = 1e30;
    for (int pass = 0; pass < kPasses; ++pass) {
      const auto begin = std::chrono::steady_clock::now();
      for (int i = 0; i < kTimes; ++i) work();
      const std::chrono::duration<double, std::micro> gone = std::chrono::steady_clock::now() - begin;
      least = std::min(least, gone.count() / kTimes);
    }
    return least;
  };
  const auto guarded = [] { const gl::StateGuard guard; };
  const double empty = microseconds(guarded), asked = microseconds([] {
                                                GLint value = 0;
                                                for (int i = 0; i < 100; ++i) glGetIntegerv(GL_ACTIVE_TEXTURE, &value);
                                              });
  HostState host;
  host.poison();
  const double full = microseconds(guarded);
  double inner = 0;
  {
    const gl::StateGuard outer;
    inner = microseconds(guarded);
  }
  RecordProperty("guard_us", std::to_string(empty));
  RecordProperty("guard_poisoned_us", std::to_string(full));
  RecordProperty("guard_inner_us", std::to_string(inner));
  std::printf("a guard takes %.1f us, %.1f us where every binding is taken, %.3f us inside another\n", empty, full,
              inner);
  // 100 us are 0.6 % of a frame at 60 Hz; a driver whose answers are slow may take 2000 of them.
  const double limit = std::max(100.0, 20 * asked);
  EXPECT_LT(empty, limit) << "of a hundred questions to GL, " << asked << " us";
  EXPECT_LT(full, limit);
  EXPECT_LT(inner, 0.05 * empty);
}

} // namespace lambent::test::state_guard_test

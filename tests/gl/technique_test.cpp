// Techniques as rows: every row draws, what does not go together is refused everywhere alike, a technique of one's own
// needs a file and a row, and a host may bring its surfaces.
#include "ambient.h"
#include "engine/core/error.h"
#include "engine/gl/pulse.h"
#include "gi/contract/frame_outputs.h"
#include "gi/frame/gi_frame.h"
#include "gi/measure/image_error.h"
#include "gl_fixture.h"
#include "progressive.h"
#include "tests/support/images.h"

namespace lambent::test {

class TechniqueTest : public GlTest {
 protected:
  TechniqueTest() {
    room.scene.lights.push_back({.type = LightType::Point, .position = {0.3f, 0.6f, 0.4f}, .intensity = vec3(2)});
    settings.smc.vpls = 128;
    settings.smc.points = 256;
    settings.smc.warmup = 4;
    settings.shadow.resolution = 32;
    settings.shadow.maker = ShadowMaker::Rays;
    settings.vpl.mirCandidates = 4;
    settings.rsm.resolution = 64;
    settings.cube.resolution = 32;
    settings.image.exposure = 1;
  }
  SceneView still() const {
    SceneView view = room.scene.view();
    view.changes = {false, false, false, false, false};
    return view;
  }

  Room room;
  Settings settings;
};

TEST_F(TechniqueTest, EveryRowHasItsAxesAndDraws) {
  for (const Technique& t : techniqueTable()) {
    Settings s = settings;
    applyTechnique(s, t);
    EXPECT_EQ(whyNot(t.axes), "") << t.name;
    EXPECT_EQ(whyNot(s), "") << t.name;
    const Axes axes = axesOf(s);
    EXPECT_EQ(axes.source, t.axes.source) << t.name;
    EXPECT_EQ(axes.visibility, t.axes.visibility) << t.name;
    EXPECT_EQ(axes.gather, t.axes.gather) << t.name;
    EXPECT_EQ(axes.reconstruction, t.axes.reconstruction) << t.name;
    EXPECT_EQ(std::string(techniqueOf(s).name), t.name);
    Viewer gi(s);
    const FrameStats& stats = gi.run(room.scene.view());
    const Image image = gi.read(Buffer::Irradiance);
    EXPECT_GT(meanLuminance(image), 0.01) << t.name;
    for (const vec3& e : image.pixels) ASSERT_TRUE(isFinite(e)) << t.name;
    EXPECT_EQ(stats.raysRadiosity.closest > 0,
              needsOf(t).sampled() && t.axes.source != VplSource::Tcas && t.axes.source != VplSource::Ir)
        << t.name;
  }
}

/// Nothing of a lamp stays in the frame in which it is switched off: alone it leaves the dark, beside a dim one what
/// that brings.
TEST_F(TechniqueTest, ALampThatIsSwitchedOffIsDarkAtOnce) {
  for (const Technique& t : techniqueTable())
    for (const bool another : {false, true}) {
      Settings s = settings;
      applyTechnique(s, t);
      std::vector<LightView>& lights = room.scene.lights;
      lights.resize(1);
      lights[0].intensity = vec3(4);
      if (another)
        lights.push_back(
            {.id = 7, .type = LightType::Point, .position = {-0.6f, -0.3f, 0.4f}, .intensity = vec3(0.5f)});
      Viewer gi(s);
      gi.run(room.scene.view());
      for (int frame = 0; frame < 12; ++frame) gi.run(still());
      const double lit = meanLuminance(gi.read(Buffer::Irradiance));
      lights[0].intensity = vec3(0);
      const auto without = [&](bool changed) {
        SceneView view = still();
        view.changes.lights = changed;
        lights[0].changed = changed;
        gi.run(view);
        lights[0].changed = false;
        return meanLuminance(gi.read(Buffer::Irradiance));
      };
      const double first = without(true);
      double later = 0;
      for (int frame = 0; frame < 20; ++frame) later = without(false);
      EXPECT_LT(later, 0.5 * lit) << t.name;
      if (another)
        EXPECT_NEAR(first / later, 1, 0.08) << t.name;
      else
        EXPECT_LT(first, 1e-4 * lit) << t.name;
    }
}

TEST_F(TechniqueTest, ATechniqueOfOnesOwnIsAFileAndARow) {
  applyTechnique(settings, kAmbient);
  EXPECT_EQ(&techniqueOf(settings), &kAmbient);
  Viewer gi(settings);
  const FrameStats& stats = gi.run(room.scene.view());
  for (const vec3& e : gi.read(Buffer::Irradiance).pixels) ASSERT_EQ(e, vec3(1));
  EXPECT_EQ(stats.vplsAlive, 0u);
  EXPECT_EQ(stats.mapsDrawn, 0u);
  EXPECT_FALSE(stats.plan.on(EffectId::Replace));
  EXPECT_TRUE(gi.vpls().slots.empty());
  // To a technique with lights and back.
  applyTechnique(gi.settings(), "smc");
  gi.run(still());
  const Image smc = gi.read(Buffer::Irradiance);
  EXPECT_GT(gi.vpls().slots.size(), 0u);
  applyTechnique(gi.settings(), kAmbient);
  gi.run(still());
  for (const vec3& e : gi.read(Buffer::Irradiance).pixels) ASSERT_EQ(e, vec3(1));
  EXPECT_NE(smc.pixels[0], vec3(1));
}

/// A path tracer is one file and one row: it converges in a still view, follows its own settings, and begins again
/// where something changes.
TEST_F(TechniqueTest, AProgressivePathTracerIsAFileAndARow) {
  room.scene.assets.materials[0].baseColor = vec4(0.8f, 0.5f, 0.2f, 1);
  applyTechnique(settings, kProgressive);
  EXPECT_EQ(settingText(settings, "progressive.paths"), "16");
  applySetting(settings, "progressive.paths", "64");
  EXPECT_THROW(applySetting(settings, "progressive.paths", "0"), InputError);
  EXPECT_THROW(applySetting(settings, "progressive.path", "1"), InputError);
  Settings other;
  EXPECT_THROW(applySetting(other, "progressive.paths", "1"), InputError) << "of this technique alone";
  Viewer gi(settings);
  const FrameStats* stats = &gi.run(room.scene.view());
  EXPECT_TRUE(stats->plan.on(EffectId::Bounces));
  EXPECT_FALSE(stats->plan.on(EffectId::History));
  const Image first = gi.read(Buffer::Irradiance);
  int frames = 1;
  while (stats->plan.on(EffectId::Redraw) && frames < 100) {
    stats = &gi.run(still());
    if (stats->plan.on(EffectId::Redraw)) {
      EXPECT_NE(stats->plan[EffectId::Redraw].reason.find("of 64 paths"), std::string::npos);
      ++frames;
    }
  }
  EXPECT_EQ(frames, 16) << "64 paths, 4 a frame, then it rests";
  // Two independent halves of the truth: it is as near to it as they are to each other.
  const SceneView view = room.scene.view();
  EmbreeQuery rays(room.scene.assets);
  rays.update(view);
  const LightSet lights = collectLights(view);
  const auto truthOf = [&](uint32_t seed) {
    ReferenceSums sums(view.camera.width, view.camera.height);
    RayCounts counts;
    const ReferenceInputs in{.rays = rays, .lights = lights, .camera = view.camera, .bounces = 2, .seed = seed};
    addSamples(sums, in, 64, counts);
    return readReference(sums, in, ReferenceBuffer::Irradiance).mean;
  };
  const Image truth = truthOf(7), half = truthOf(8), converged = gi.read(Buffer::Irradiance);
  const double noise = imageError(half, truth).rmse;
  EXPECT_LT(imageError(converged, truth).rmse, 1.1 * noise);
  EXPECT_GT(imageError(first, truth).rmse, 1.5 * noise) << "the first frame has a sixteenth of the paths";

  SceneView dimmed = room.scene.view();
  for (LightView& light : room.scene.lights) light.intensity *= 0.5f;
  dimmed = room.scene.view();
  dimmed.changes = {false, false, true, false, false};
  stats = &gi.run(dimmed);
  EXPECT_TRUE(stats->plan.on(EffectId::Redraw));
  EXPECT_NEAR(meanLuminance(gi.read(Buffer::Irradiance)), 0.5 * meanLuminance(converged),
              0.05 * meanLuminance(converged))
      << "nothing of before is left";
  applySetting(gi.settings(), "progressive.paths", "4");
  gi.run(still());
  EXPECT_FALSE(gi.run(still()).plan.on(EffectId::Redraw));
}

/// It begins again where camera or objects move, and not for what only shows the light.
TEST_F(TechniqueTest, AccumulatedLightBeginsAgainWhereTheWorldChanges) {
  applyTechnique(settings, kProgressive);
  applySetting(settings, "progressive.paths", "12");
  Viewer gi(settings);
  gi.run(room.scene.view());
  const auto reasonAfter = [&](const SceneChanges& changes, const std::function<void(SceneView&)>& edit) {
    for (int frame = 0; frame < 3; ++frame) gi.run(still());
    EXPECT_FALSE(gi.run(still()).plan.on(EffectId::Redraw)) << "it had converged";
    SceneView view = room.scene.view();
    view.changes = changes;
    edit(view);
    gi.run(view);
    return gi.run(still()).plan[EffectId::Redraw].reason;
  };
  const std::string begun = "4 of 12 paths per pixel";
  EXPECT_EQ(reasonAfter({false, true, false, false, false}, [](SceneView& v) { v.camera.worldFromView[3].x += 0.1f; }),
            begun);
  room.scene.instances.back().worldFromObject[3].x += 0.1f;
  EXPECT_EQ(reasonAfter({false, false, false, true, false}, [](SceneView&) {}), begun);
  for (int frame = 0; frame < 3; ++frame) gi.run(still());
  gi.settings().image.exposure = 2;
  gi.settings().image.toneMapper = ToneMapper::Filmic;
  gi.run(still());
  EXPECT_FALSE(gi.run(still()).plan.on(EffectId::Redraw)) << "exposure is the viewer's";
}

/// A host that draws its surfaces again in every frame does not keep it from converging, nor does it draw for ever
/// where there is no light.
TEST_F(TechniqueTest, AccumulatedLightConvergesOnAHostsSurfacesAndRestsInTheDark) {
  applyTechnique(settings, kProgressive);
  const SceneView view = room.scene.view();
  GpuScene gpu(passes, room.scene.assets);
  gpu.place(view.instances);
  SurfacePass surfaces(passes);
  const GBuffer drawn = surfaces.run({gpu, view.camera});
  const HostSurfaces host{drawn.depth->name(), drawn.normal->name(), drawn.albedo->name(), drawn.emission->name()};
  Viewer gi(settings), own(settings);
  gi.run(view, {}, &host);
  own.run(view);
  for (int frame = 0; frame < 6; ++frame) gi.run(still(), {}, &host), own.run(still());
  EXPECT_EQ(gi.read(Buffer::Irradiance).pixels, own.read(Buffer::Irradiance).pixels);

  room.scene.lights.clear();
  Viewer dark(settings);
  dark.run(room.scene.view());
  dark.run(still());
  EXPECT_FALSE(dark.run(still()).plan.on(EffectId::Redraw));
}

/// What somebody stops by throwing is no frame: the next one is as the first, and nothing shows what is gone.
TEST_F(TechniqueTest, AFrameThatSomethingIsThrownOutOfIsDrawnAgain) {
  for (const char* technique : {"smc", "ibrr", "rsm"}) {
    SCOPED_TRACE(technique);
    Settings s = settings;
    applyTechnique(s, technique);
    Viewer whole(s);
    whole.run(room.scene.view());
    const Image expected = whole.read(Buffer::Beauty);
    Viewer gi(s);
    struct Stop {};
    bool thrown = false;
    { // at a draw, as the walkthrough's loading screen does when it is cancelled
      int beats = 0;
      const gl::Pulse pulse([&] {
        if (++beats == 12) throw Stop();
      });
      try {
        gi.run(room.scene.view());
      } catch (const Stop&) {
        thrown = true;
      }
    }
    EXPECT_TRUE(thrown);
    EXPECT_TRUE(gi.read(Buffer::Beauty).pixels.empty());
    EXPECT_EQ(gi.texture(Buffer::Irradiance), 0u);
    gi.run(still());
    EXPECT_NEAR(meanLuminance(gi.read(Buffer::Beauty)), meanLuminance(expected), 0.1 * meanLuminance(expected));
    EXPECT_NEAR(meanLuminance(gi.read(Buffer::Irradiance)), meanLuminance(whole.read(Buffer::Irradiance)),
                0.15 * meanLuminance(whole.read(Buffer::Irradiance)));
  }
}

/// Settings that are refused change nothing: the last frame stays, and goes on.
TEST_F(TechniqueTest, ARefusedFrameLeavesTheLastOne) {
  applyTechnique(settings, "rsm");
  Viewer gi(settings);
  EXPECT_TRUE(gi.readDisplay(Buffer::Beauty).rgb.empty()) << "there is none yet";
  gi.run(room.scene.view());
  gi.run(still());
  const Image before = gi.read(Buffer::Beauty);
  gi.settings().gather.mode = GatherMode::Cube;
  EXPECT_THROW(gi.run(still()), InputError);
  EXPECT_EQ(gi.read(Buffer::Beauty).pixels, before.pixels);
  EXPECT_FALSE(gi.readDisplay(Buffer::Beauty).rgb.empty());
  gi.settings().gather.mode = settings.gather.mode;
  gi.run(still());
  EXPECT_EQ(gi.read(Buffer::Beauty).pixels, before.pixels);
}

/// Another gather while the last image is kept: what is shown lives until the next is there.
TEST_F(TechniqueTest, WhatTheLastFrameShowsOutlivesItsGather) {
  applyTechnique(settings, "rsm");
  Viewer gi(settings);
  gi.run(room.scene.view());
  const Image before = gi.read(Buffer::Irradiance);
  gi.settings().effects[EffectId::Redraw] = EffectMode::Off;
  applyTechnique(gi.settings(), "multires-gather");
  gi.run(still());
  EXPECT_EQ(gi.read(Buffer::Irradiance).pixels, before.pixels);
  EXPECT_NE(gi.gi().indirectIrradiance(), 0u);
}

TEST_F(TechniqueTest, DirectLightIsAProviderThatAHostLeavesOut) {
  Viewer gi(settings);
  gi.run(room.scene.view());
  const Image indirect = gi.read(Buffer::Irradiance);
  EXPECT_GT(meanLuminance(gi.read(Buffer::Direct)), 0.01);
  gi.settings().direct.on = false;
  EXPECT_EQ(gi.run(still()).lightMapsDrawn, 0u);
  EXPECT_EQ(gi.gi().directIrradiance(), 0u);
  EXPECT_NE(gi.gi().indirectIrradiance(), 0u);
  EXPECT_EQ(meanLuminance(gi.read(Buffer::Direct)), 0);
  EXPECT_NEAR(meanLuminance(gi.read(Buffer::Irradiance)), meanLuminance(indirect), 0.1 * meanLuminance(indirect));
  // What changes while it is off is not told to it.
  room.scene.lights[0].position = {-0.4f, 0.5f, 0.3f};
  SceneView moved = room.scene.view();
  moved.changes = {false, false, true, false, false};
  gi.run(moved);
  gi.settings().direct.on = true;
  gi.run(still());
  Viewer fresh(settings);
  fresh.run(room.scene.view());
  EXPECT_EQ(gi.read(Buffer::Direct).pixels, fresh.read(Buffer::Direct).pixels);
}

TEST_F(TechniqueTest, TexturesHoldWhatIsReadBack) {
  room.scene.quad({-0.2f, 0.95f, -0.2f}, {0.4f, 0, 0}, {0, 0, 0.4f}, room.scene.material(vec3(0), vec3(2)));
  Viewer gi(settings);
  EXPECT_EQ(gi.texture(Buffer::Beauty), 0u) << "there is no frame yet";
  gi.run(room.scene.view());
  for (Buffer buffer : {Buffer::Beauty, Buffer::Direct, Buffer::Indirect, Buffer::Irradiance, Buffer::Albedo,
                        Buffer::Normal, Buffer::Emission}) {
    SCOPED_TRACE(bufferNames()[size_t(buffer)]);
    const uint32_t name = gi.texture(buffer);
    ASSERT_NE(name, 0u);
    const Image image = gi.read(buffer);
    std::vector<vec4> texels(image.pixels.size());
    glGetTextureImage(name, 0, GL_RGBA, GL_FLOAT, GLsizei(texels.size() * sizeof(vec4)), texels.data());
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const vec3 texel = vec3(texels[size_t(image.height - 1 - y) * image.width + x]);
        ASSERT_LE(maxComponent(glm::abs(texel - image.at(x, y))), 1e-4f * (1 + maxComponent(image.at(x, y))))
            << x << ' ' << y;
      }
  }
  EXPECT_EQ(gi.texture(Buffer::Depth), 0u);
}

namespace {

/// Notes the depth of the middle of the frame before.
class PreviousDepth : public LightProvider {
 public:
  SurfaceLighting run(const Frame& frame, FrameStats&) override {
    seen = -1;
    if (frame.previous) {
      const std::vector<float> depth = depthOf(*frame.previous->depth);
      seen = depth[depth.size() / 2 + size_t(frame.previous->width) / 2];
    }
    return {};
  }
  static std::vector<float> depthOf(const gl::Texture& texture) {
    std::vector<float> values(size_t(texture.width()) * texture.height());
    texture.read(std::span(values), GL_DEPTH_COMPONENT, GL_FLOAT);
    return values;
  }
  static inline float seen = -1;
};

constexpr Technique kPrevious{
    .name = "previous",
    .help = "the frame before",
    .axes = {VplSource::None, VplVisibility::None, GatherMode::Own, Reconstruction::None},
    .make = [](PassContext) -> std::unique_ptr<LightProvider> { return std::make_unique<PreviousDepth>(); },
    .needs = {.previousSurfaces = true},
};

} // namespace

TEST_F(TechniqueTest, SurfacesOfTheFrameBeforeAreThereOnDemand) {
  applyTechnique(settings, kPrevious);
  Viewer gi(settings);
  gi.run(room.scene.view());
  EXPECT_EQ(PreviousDepth::seen, -1) << "there is none";
  const auto depthNow = [&] {
    const std::vector<float> depth = PreviousDepth::depthOf(*gi.gi().outputs().surfaces.depth);
    return depth[depth.size() / 2 + size_t(gi.gi().outputs().surfaces.width) / 2];
  };
  const float first = depthNow();
  SceneView moved = room.scene.view();
  moved.camera.worldFromView[3].z -= 0.5f;
  moved.changes = {false, true, false, false, false};
  gi.run(moved);
  EXPECT_EQ(PreviousDepth::seen, first);
  EXPECT_NE(depthNow(), first);
  const float second = depthNow();
  Settings& s = gi.settings();
  s.debug.nan = !s.debug.nan; // drawn again, though nothing moved: the frame before showed the same
  SceneView same = moved;
  same.changes = {false, false, false, false, false};
  gi.run(same);
  EXPECT_EQ(PreviousDepth::seen, second);
  moved.camera.width /= 2;
  gi.run(moved);
  EXPECT_EQ(PreviousDepth::seen, -1) << "of another size";
}

TEST_F(TechniqueTest, WhatDoesNotGoTogetherIsRefusedByTheFrame) {
  const auto refused = [&](const std::function<void(Settings&)>& edit) -> std::string {
    Settings s = settings;
    edit(s);
    Viewer gi(s);
    try {
      gi.run(room.scene.view());
    } catch (const InputError& e) {
      return e.what();
    }
    return {};
  };
  EXPECT_EQ(refused([](Settings&) {}), "");
  EXPECT_NE(refused([](Settings& s) { s.vpl.source = VplSource::Hisr; }).find("vpl.visibility maps"),
            std::string::npos);
  EXPECT_NE(refused([](Settings& s) {
              applyTechnique(s, "hisr");
              s.gather.mode = GatherMode::Splat;
            }).find("gather.mode splat"),
            std::string::npos);
  EXPECT_NE(refused([](Settings& s) { s.vpl.source = VplSource::None; }).find("vpl.source none"), std::string::npos);
  EXPECT_NE(refused([](Settings& s) { s.gather.mode = GatherMode::Own; }).find("gather.mode own"), std::string::npos);
  EXPECT_NE(refused([](Settings& s) {
              applyTechnique(s, kAmbient);
              s.gather.mode = GatherMode::Full;
            }).find("ambient has a provider of its own"),
            std::string::npos);
  EXPECT_NE(refused([](Settings& s) {
              applyTechnique(s, kAmbient);
              s.vpl.source = VplSource::Smc;
            }).find("ambient takes none"),
            std::string::npos);
  EXPECT_NE(refused([](Settings& s) {
              applyTechnique(s, kAmbient);
              s.vpl.visibility = VplVisibility::Maps;
            }).find("no virtual lights to see"),
            std::string::npos);
}

/// What one frame drew is another's host.
TEST_F(TechniqueTest, AHostsSurfacesGiveTheSamePicture) {
  const SceneView view = room.scene.view();
  GpuScene gpu(passes, room.scene.assets);
  gpu.place(view.instances);
  SurfacePass surfaces(passes);
  const GBuffer drawn = surfaces.run({gpu, view.camera});
  HostSurfaces host{drawn.depth->name(), drawn.normal->name(), drawn.albedo->name(), drawn.emission->name()};
  for (const char* technique : {"smc", "multires-gather"}) {
    applyTechnique(settings, technique);
    Viewer ours(settings), theirs(settings);
    ours.run(view);
    theirs.run(view, {}, &host);
    EXPECT_EQ(ours.read(Buffer::Beauty).pixels, theirs.read(Buffer::Beauty).pixels) << technique;
    EXPECT_NE(theirs.texture(Buffer::Beauty), 0u);
    EXPECT_NE(theirs.texture(Buffer::Irradiance), 0u);
  }
  EXPECT_TRUE(glIsTexture(host.depth)) << "a host's texture stays the host's";
  Viewer gi(settings);
  host.emission = 0;
  gi.run(view, {}, &host);
  for (const vec3& e : gi.read(Buffer::Emission).pixels) ASSERT_EQ(e, vec3(0));
  // In a still world too: a host may have drawn anew.
  const gl::Texture white("white", {.format = GL_RGBA16F, .width = view.camera.width, .height = view.camera.height});
  const float one[4] = {1, 1, 1, 1};
  glClearTexImage(white.name(), 0, GL_RGBA, GL_FLOAT, one);
  for (int frame = 0; frame < 3; ++frame) gi.run(still(), {}, &host);
  HostSurfaces other = host;
  other.emission = white.name();
  gi.run(still(), {}, &other);
  for (const vec3& e : gi.read(Buffer::Emission).pixels) ASSERT_EQ(e, vec3(1));
  gi.run(still());
  for (const vec3& e : gi.read(Buffer::Emission).pixels) ASSERT_EQ(e, vec3(0)) << "ours again";
  const auto refused = [&](HostSurfaces wrong) {
    EXPECT_THROW(gi.run(view, {}, &wrong), InputError);
    gi.run(view, {}, &host); // and goes on
  };
  refused({.depth = 0, .normal = host.normal, .albedo = host.albedo});
  const gl::Texture small("small", {.format = GL_RGBA16F, .width = 8, .height = 8});
  refused({.depth = host.depth, .normal = small.name(), .albedo = host.albedo});
  const gl::Texture compared("compared", {.format = GL_DEPTH_COMPONENT32F,
                                          .width = view.camera.width,
                                          .height = view.camera.height,
                                          .depthCompare = true});
  refused({.depth = compared.name(), .normal = host.normal, .albedo = host.albedo});
}

/// Rays from what a host stores in few bits begin above its surfaces, so no wall is in the way of its own light.
TEST_F(TechniqueTest, AHostsCoarseDepthsAreNoWalls) {
  room.scene.quad({-0.3f, 0, -0.3f}, {0.6f, 0, 0}, {0, 0, 0.6f},
                  room.scene.material(vec3(0.5f))); // so that there are edges of shadows
  settings.vpl.visibility = VplVisibility::Maps;
  settings.gather.mode = GatherMode::Interleaved;
  const SceneView view = room.scene.view();
  GpuScene gpu(passes, room.scene.assets);
  gpu.place(view.instances);
  SurfacePass surfaces(passes);
  const GBuffer drawn = surfaces.run({gpu, view.camera});
  std::vector<float> own(size_t(drawn.width) * size_t(drawn.height));
  drawn.depth->read(std::span(own), GL_DEPTH_COMPONENT, GL_FLOAT);
  GiFrame ours(settings);
  ours.run(view);
  const auto meanOf = [](const gl::Texture* texture) {
    std::vector<vec4> texels(size_t(texture->width()) * size_t(texture->height()));
    texture->read(std::span(texels), GL_RGBA, GL_FLOAT);
    float sum = 0;
    for (const vec4& t : texels) sum += luminance(vec3(t)) / float(texels.size());
    return sum;
  };
  const auto means = [&](const GiFrame& gi) {
    return vec2(meanOf(gi.outputs().direct.irradiance), meanOf(gi.outputs().indirect.irradiance));
  };
  const vec2 expected = means(ours);
  for (const auto& [format, near, kind] : {std::tuple(GL_DEPTH_COMPONENT24, 1e-4f, HostDepth::Forward),
                                           {GL_DEPTH_COMPONENT16, 5e-2f, HostDepth::Reversed},
                                           {GL_DEPTH_COMPONENT32F, 1e-4f, HostDepth::Forward},
                                           {GL_R16F, 1e-2f, HostDepth::Linear}}) {
    const bool linear = kind == HostDepth::Linear;
    GLuint depth = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &depth);
    glTextureStorage2D(depth, 1, GLenum(format), drawn.width, drawn.height);
    std::vector<float> stored(own.size());
    for (size_t i = 0; i < own.size(); ++i) {
      const double distance = double(view.camera.near) / double(own[i]);
      stored[i] = float(linear                       ? distance
                        : kind == HostDepth::Forward ? 1 - double(near) / distance
                                                     : double(near) / distance);
    }
    glTextureSubImage2D(depth, 0, 0, 0, drawn.width, drawn.height, linear ? GL_RED : GL_DEPTH_COMPONENT, GL_FLOAT,
                        stored.data());
    HostSurfaces host{depth, drawn.normal->name(), drawn.albedo->name(), drawn.emission->name()};
    host.conventions = {.depth = kind, .near = near, .far = kInfinity};
    GiFrame theirs(settings);
    theirs.run(view, {}, &host);
    const vec2 seen = means(theirs);
    EXPECT_NEAR(seen.x / expected.x, 1, 0.01) << "direct light, " << int(kind) << " of " << format;
    EXPECT_NEAR(seen.y / expected.y, 1, 0.01) << "indirect light, " << int(kind) << " of " << format;
    glDeleteTextures(1, &depth);
  }
}

/// What the table of settings says of the cost of a change is what a running frame pays.
TEST_F(TechniqueTest, ASettingCostsWhatItsRowSays) {
  room.scene.lights.push_back({.type = LightType::Directional, .direction = {0, -1, 0}});
  room.scene.lights.push_back(
      {.type = LightType::Spot, .position = {0, 0.9f, 0}, .direction = {0, -1, 0}, .intensity = vec3(1)});
  room.scene.sky = vec3(0.1f);
  room.scene.quad({-0.2f, 0.95f, -0.2f}, {0.4f, 0, 0}, {0, 0, 0.4f}, room.scene.material(vec3(0), vec3(2)));
  settings.smc.moves = 0; // what moves is the setting's doing
  for (const SettingRow& row : settingsTable()) {
    if (row.name.starts_with("debug.") || row.name == "shadow.maker") continue; // how it is done, not what
    Settings s = settings;
    if (row.name == "vpl.visibility") s.vpl.visibility = VplVisibility::Rays; // and back to maps
    if (row.name.starts_with("rsm."))
      applyTechnique(s, row.name == "rsm.vpls" ? "rsm" : row.name == "rsm.tau" ? "hisr" : "isr");
    if (row.name.starts_with("multires.")) applyTechnique(s, "multires-gather");
    if (row.name.starts_with("lpv.")) applyTechnique(s, "lpv");
    if (row.name.starts_with("cube.")) applyTechnique(s, "ibrr");
    if (row.name == "cube.hemicube" || row.name == "cube.maker") s.cube.visibility = CubeVisibility::Hemicubes;
    if (row.name == "cube.split") s.cube.levels = 1;
    if (row.name.starts_with("area.")) s.shadow.emitters = EmitterShadows::Patches;
    if (row.name.starts_with("shadow.emitter") || row.name.starts_with("shadow.sky")) s.direct.soft = SoftLightBy::Maps;
    Viewer gi(s);
    gi.run(room.scene.view());
    const double now = row.get(gi.settings());
    double other = row.choices.empty() ? (now > 0 ? now / 2 : 2) : (now == 0 ? 1 : 0);
    if (row.kind == SettingKind::Whole) other = std::max(row.low, std::floor(other));
    if (other == now) other = now + 1;
    row.set(gi.settings(), other);
    const FrameStats& stats = gi.run(still());
    ASSERT_EQ(glGetError(), GLenum(GL_NO_ERROR)) << row.name << " = " << row.text(other);
    const bool light = stats.vplsRelit >= 64 || stats.pathsTraced > 0 || stats.ms(StageId::ReflectiveLights) > 0;
    const bool maps = stats.mapsDrawn + stats.lightMapsDrawn > 0;
    switch (row.change) {
    case ChangeCost::Nothing:
      EXPECT_FALSE(light) << row.name << ": light";
      EXPECT_FALSE(maps) << row.name << ": maps";
      break;
    case ChangeCost::Light:
      EXPECT_TRUE(light) << row.name;
      EXPECT_LE(stats.mapsDrawn, 2u) << row.name << ": more than those of VPLs that were replaced";
      EXPECT_EQ(stats.lightMapsDrawn, 0u) << row.name;
      break;
    case ChangeCost::Maps:
      EXPECT_TRUE(maps) << row.name;
      break;
    case ChangeCost::Set:
      EXPECT_GE(stats.vplsMoved, 64u) << row.name;
      break;
    }
  }
}

} // namespace lambent::test

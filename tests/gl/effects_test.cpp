// The effect plan. For each effect: a scene without it, where its work is not done at all (counted) and the picture is,
// byte for byte, the one with everything forced on; and a scene with it, where leaving it out changes the picture.
#include "frames.h"
#include "tests/support/comparator_world.h"

namespace lambent::test::effects_test {

using enum EffectId;

class EffectsTest : public GlTest {
 protected:
  /// A grey room, open to +z, with a red wall and a block, lit by a small lamp.
  struct World {
    HandScene scene;
    uint32_t block = 0, lamp = 0;

    World() {
      const uint32_t grey = scene.material(vec3(0.6f));
      scene.quad({-1.5f, 0, -1.5f}, {0, 0, 3}, {3, 0, 0}, grey);
      scene.quad({-1.5f, 0, -1.5f}, {3, 0, 0}, {0, 2.5f, 0}, grey);
      scene.quad({-1.5f, 0, -1.5f}, {0, 2.5f, 0}, {0, 0, 3}, scene.material({0.7f, 0.1f, 0.1f}));
      block = uint32_t(scene.instances.size());
      scene.box({-0.4f, 0, -0.5f}, {0.4f, 0.9f, 0.2f}, grey, false);
      scene.lamp({0.9f, 2, 0.5f}, vec3(5));
      scene.camera = cameraAt({0.2f, 1.1f, 2.6f}, {0.2f, 1.1f, 0}, 1);
    }

    /// What a frame in which these things changed shows.
    SceneView view(const SceneChanges& changes) {
      scene.move(kNone, {});
      return scene.view(changes);
    }
    SceneView first() { return view({}); }
    SceneView still() { return view(kStill); }
    /// All boxes' faces from `block` on go by `by`.
    SceneView moveBlock(const vec3& by) {
      scene.move(block, by);
      return scene.view(kGeometryChanged);
    }
    void emissive(const vec3& radiance) {
      scene.quad({0.3f, 2.9f, 0.2f}, {0.8f, 0, 0}, {0, 0, 0.8f},
                 scene.material(vec3(0), radiance)); // out of the picture
    }
    /// A quad in the light's way whose texture is a chequer: green and half of it cut out, or green and blue.
    void textured(AlphaMode alpha) {
      const u8vec4 green(20, 200, 20, 255), other = alpha == AlphaMode::Opaque ? u8vec4(20, 20, 220, 255) : u8vec4(0);
      const uint32_t m = scene.material(vec3(1));
      scene.assets.materials[m].alphaMode = alpha;
      scene.assets.materials[m].baseColorTexture = scene.texture(2, {green, other, other, green});
      scene.quad({-0.2f, 1.3f, -0.6f}, {0, 0, 1.6f}, {1.4f, 0, 0}, m);
    }
  };

  static Settings quick() {
    Settings s;
    s.smc = {.vpls = 128, .moves = 8, .points = 256, .warmup = 5};
    s.shadow = {
        .resolution = 32, .maker = ShadowMaker::Rays, .emitterResolution = 64, .skyMaps = 8, .skyResolution = 64};
    s.debug.timing = TimingMode::Finish;
    s.image.exposure = 1;
    s.history.frames = 0; // history_test.cpp
    return s;
  }
  static Settings withAll(EffectMode mode, Settings s = quick()) {
    for (size_t i = 0; i < kEffects; ++i) s.effects[EffectId(i)] = mode;
    return s;
  }

  static bool same(const Image& a, const Image& b) {
    return a.pixels.size() == b.pixels.size() &&
           std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(vec3)) == 0;
  }

  /// Runs the frames that `views` yields until it yields none; the effect must do no work in those after the first
  /// `skip`, and the pictures must be those with everything forced on, where it must do some unless `hollow`.
  template <class Views>
  void withoutIt(EffectId id, Settings settings, const Views& viewsOf, int skip = 0, bool hollow = false) {
    Viewer plain(settings), all(withAll(EffectMode::On, settings));
    World a, b;
    uint64_t forcedWork = 0;
    for (int frame = 0;; ++frame) {
      const auto viewA = viewsOf(a, frame), viewB = viewsOf(b, frame);
      if (!viewA) break;
      const FrameStats& stats = plain.run(*viewA);
      const FrameStats& forcedStats = all.run(*viewB);
      if (frame >= skip) {
        EXPECT_FALSE(stats.plan.on(id)) << stats.plan[id].reason;
        EXPECT_EQ(stats.work[size_t(id)], 0u) << "frame " << frame;
        forcedWork += forcedStats.work[size_t(id)];
      }
      for (const Buffer buffer : {Buffer::Beauty, Buffer::Irradiance})
        ASSERT_TRUE(same(plain.read(buffer), all.read(buffer)))
            << "frame " << frame << ", plan " << stats.plan.oneLine();
    }
    EXPECT_EQ(forcedWork == 0, hollow) << "forced on it must really run";
  }

  /// How far the last of the frames is from that with the effect left out, relative RMSE; the effect must work in some.
  template <class Views> double lossWithout(EffectId id, const Settings& settings, const Views& viewsOf) {
    Settings off = settings;
    off.effects[id] = EffectMode::Off;
    Viewer plain(settings), without(off);
    World a, b;
    uint64_t work = 0;
    for (int frame = 0;; ++frame) {
      const auto viewA = viewsOf(a, frame), viewB = viewsOf(b, frame);
      if (!viewA) break;
      const FrameStats& stats = plain.run(*viewA);
      work += stats.plan.on(id) ? stats.work[size_t(id)] : 0;
      const FrameStats& offStats = without.run(*viewB);
      EXPECT_TRUE(frame == 0 || offStats.work[size_t(id)] == 0) << "frame " << frame; // the first fills the set
    }
    EXPECT_GT(work, 0u);
    return relativeRmse(without.read(Buffer::Beauty), plain.read(Buffer::Beauty));
  }

  using View = std::optional<SceneView>;
  /// Two frames of a world that `arrange` has arranged.
  template <class Arrange> static auto stillWorld(const Arrange& arrange, int frames = 2) {
    return [arrange, frames](World& w, int frame) -> View {
      if (frame == 0) arrange(w);
      return frame >= frames ? View() : frame == 0 ? w.first() : w.still();
    };
  }
  static auto asItIs(int frames = 2) {
    return stillWorld([](World&) {}, frames);
  }
};

/// Frames until nothing is done any more.
int framesToSettle(Viewer& gi, const SceneView& still, int most) {
  int frames = 0;
  while (frames < most && gi.run(still).plan.on(Redraw)) ++frames;
  return frames;
}

// Every effect has both a scene without it and one with it below

TEST_F(EffectsTest, IndirectNeedsLight) {
  const auto dark = stillWorld([](World& w) { w.scene.lights.clear(); });
  withoutIt(Indirect, quick(), dark);
  EXPECT_GT(lossWithout(Indirect, quick(), asItIs()), 0.05);
}

TEST_F(EffectsTest, IndirectNeedsSurfacesThatReflectToOneAnother) {
  const auto flat = [](World& w) {
    w.scene.instances.resize(1);
    w.block = 1;
  };
  withoutIt(Indirect, quick(), stillWorld(flat));
  const auto black = [](World& w) {
    for (Material& m : w.scene.assets.materials) m.baseColor = vec3(0);
  };
  withoutIt(Indirect, quick(), stillWorld(black));
}

/// Of a ground of 10 km, flat however it is turned, and one with a box of 10 cm on it.
TEST_F(EffectsTest, IndirectIsOfWhatIsSmallOnAWideGroundToo) {
  for (const bool box : {false, true}) {
    HandScene scene;
    const uint32_t grey = scene.material(vec3(0.5f));
    scene.quad({-5000, 0, -5000}, {0, 0, 10000}, {10000, 0, 0}, grey);
    scene.quad({5000, 0, -5000}, {0, 0, 10000}, {10000, 0, 0}, grey);
    if (box) scene.box({-0.05f, 0, -0.05f}, {0.05f, 0.1f, 0.05f}, grey, false);
    scene.turn(glm::rotate(mat4(1), 0.7f, glm::normalize(vec3(1, 2, 3))));
    scene.lamp(vec3(0, 3, 0));
    Viewer gi(quick());
    EXPECT_EQ(gi.run(scene.view()).plan.on(Indirect), box);
  }
}

TEST_F(EffectsTest, BouncesNeedSurfacesThatReflectToOneAnother) {
  Settings settings = quick();
  settings.effects[Indirect] = EffectMode::On;
  // A black wall stops the paths, so that none but the first vertex reflects.
  const auto flat = [](World& w) {
    for (Material& m : w.scene.assets.materials) m.baseColor = vec3(0);
    w.scene.assets.meshes[0].primitives[0].material = w.scene.material(vec3(0.6f));
  };
  withoutIt(Bounces, settings, stillWorld(flat));
  EXPECT_GT(lossWithout(Bounces, quick(), asItIs()), 0.01);
}

TEST_F(EffectsTest, EmissiveAndSoftShadowsNeedALamp) {
  withoutIt(Emissive, quick(), asItIs());
  withoutIt(SoftShadows, quick(), asItIs(), 0, true); // no lamp, no samples
  const auto lamp = stillWorld([](World& w) { w.emissive(vec3(60)); });
  EXPECT_GT(lossWithout(Emissive, quick(), lamp), 0.1);
  EXPECT_GT(lossWithout(SoftShadows, quick(), lamp), 0.02);
}

TEST_F(EffectsTest, SkyNeedsRadiance) {
  withoutIt(Sky, quick(), asItIs());
  EXPECT_GT(lossWithout(Sky, quick(), stillWorld([](World& w) { w.scene.sky = vec3(1); })), 0.1);
}

TEST_F(EffectsTest, AlphaNeedsAMask) {
  withoutIt(Alpha, quick(), asItIs());
  withoutIt(Alpha, quick(), stillWorld([](World& w) { w.textured(AlphaMode::Opaque); }));
  for (const AlphaMode mode : {AlphaMode::Mask, AlphaMode::Blend})
    EXPECT_GT(lossWithout(Alpha, quick(), stillWorld([&](World& w) { w.textured(mode); })), 0.02);
}

TEST_F(EffectsTest, TexturesNeedATexture) {
  withoutIt(Textures, quick(), asItIs(), 0, true); // no texture, no lookups
  EXPECT_GT(lossWithout(Textures, quick(), stillWorld([](World& w) { w.textured(AlphaMode::Opaque); })), 1e-3);
}

TEST_F(EffectsTest, MotionAndMapRefreshNeedAMover) {
  // The first frame places every object.
  withoutIt(Motion, quick(), asItIs(4), 1);
  withoutIt(MapRefresh, quick(), asItIs(4), 1);
  const auto moving = [](World& w, int frame) -> View {
    return frame > 4 ? View() : frame == 0 ? w.first() : w.moveBlock({0.15f, 0, 0.05f});
  };
  EXPECT_GT(lossWithout(Motion, quick(), moving), 0.05);
  Settings settings = quick();
  settings.shadow.refresh = 128;
  EXPECT_GT(lossWithout(MapRefresh, settings, moving), 2e-3);
}

TEST_F(EffectsTest, RelightNeedsAChangeOfLight) {
  withoutIt(Relight, quick(), asItIs(4), 1);
  const auto dimmed = [](World& w, int frame) -> View {
    if (frame > 1) return {};
    if (frame == 0) return w.first();
    w.scene.lights[0].intensity = vec3(1);
    return w.view(kLightsChanged);
  };
  EXPECT_GT(lossWithout(Relight, quick(), dimmed), 0.05);
}

TEST_F(EffectsTest, FilterNeedsAnInterleavedGather) {
  const auto dark = stillWorld([](World& w) { w.scene.lights.clear(); });
  withoutIt(Filter, quick(), dark);
  Settings full = quick();
  full.gather.mode = GatherMode::Full;
  withoutIt(Filter, full, asItIs(), 0, true); // nothing to mix
  EXPECT_GT(lossWithout(Filter, quick(), asItIs()), 0.01);
}

TEST_F(EffectsTest, GlossyNeedsAGlossyMaterial) {
  Settings glossy = quick();
  glossy.gather.glossy = true;
  withoutIt(Glossy, glossy, asItIs());
  const auto metal = stillWorld([](World& w) {
    for (Material& m : w.scene.assets.materials) m.metalness = 1, m.roughness = 0.4f;
  });
  Settings matt = quick();
  matt.gather.glossy = false;
  withoutIt(Glossy, matt, metal, 0, true); // nothing can force it
  EXPECT_GT(lossWithout(Glossy, glossy, metal), 0.1);
}

TEST_F(EffectsTest, MirrorsNeedASmoothMaterial) {
  const auto brushed = stillWorld([](World& w) {
    for (Material& m : w.scene.assets.materials) m.metalness = 1, m.roughness = 0.36f;
  });
  withoutIt(Mirrors, quick(), brushed, 0, true); // nor can anything force it
  // A texture may make a surface smooth.
  const auto polished = stillWorld([](World& w) {
    const uint32_t image = w.scene.texture(1, {{0, 40, 255, 255}}, false).image;
    for (Material& m : w.scene.assets.materials) m.metalness = 1, m.roughnessMetalnessTexture.image = image;
  });
  Settings none = quick();
  none.gather.mirrors = 0;
  withoutIt(Mirrors, none, polished, 0, true); // nothing can force it
  EXPECT_GT(lossWithout(Mirrors, quick(), polished), 0.01);
}

/// What mirrors show is averaged whether other light is or not, until the view rests; and where it goes off, it rests.
TEST_F(EffectsTest, MirrorsAreAveragedByEveryTechnique) {
  for (const VplSource source : {VplSource::Smc, VplSource::Rsm}) {
    Settings settings = quick();
    settings.vpl.source = source;
    settings.vpl.visibility = source == VplSource::Smc ? VplVisibility::Maps : VplVisibility::None;
    settings.gather.mode = GatherMode::Full;
    settings.gather.near = 0;
    settings.history.frames = 16;
    settings.smc.moves = 0;
    World w;
    for (Material& m : w.scene.assets.materials) m.metalness = 1, m.roughness = 0.15f;
    Viewer gi(settings);
    const Image first = nextFrame(gi, w.first(), Buffer::Indirect);
    EXPECT_TRUE(gi.stats().plan.on(Mirrors));
    EXPECT_FALSE(gi.gi().converged());
    const Image second = nextFrame(gi, w.still(), Buffer::Indirect);
    EXPECT_GT(relativeRmse(second, first), 1e-4) << "other rays";
    EXPECT_FALSE(gi.stats().plan.onlyDirect());
    const int frames = framesToSettle(gi, w.still(), 60);
    EXPECT_GE(frames, 13);
    EXPECT_LE(frames, 20);
    EXPECT_TRUE(gi.gi().converged());
    nextFrame(gi, w.view(kCameraChanged), Buffer::Indirect);
    gi.settings().smc.bounces = 0;
    EXPECT_LT(framesToSettle(gi, w.still(), 60), 6) << "without indirect light nothing is left to average";
  }
}

TEST_F(EffectsTest, IndirectReachesBlackGloss) {
  Settings glossy = quick();
  glossy.gather.glossy = true;
  // All that reflects lies in one plane; only the lobes of black walls can show its light.
  const auto varnished = stillWorld([](World& w) {
    for (Material& m : w.scene.assets.materials) m.roughness = 0.4f, m.baseColor = vec3(0);
    w.scene.assets.meshes[0].primitives[0].material = w.scene.material(vec3(0.6f));
  });
  World w;
  Settings matt = quick();
  matt.gather.glossy = false;
  Viewer lambert(matt);
  EXPECT_FALSE(lambert.run(*varnished(w, 0)).plan.on(Indirect));
  EXPECT_GT(lossWithout(Indirect, glossy, varnished), 1e-3);
}

// A still world

TEST_F(EffectsTest, AStillWorldSettlesAndSleeps) {
  World w;
  Viewer gi(quick());
  gi.run(w.first());
  const int frames = framesToSettle(gi, w.still(), 2000);
  std::printf("settled after %d frames, %u strong candidates\n", frames, gi.run(w.still()).vplsStrong);
  EXPECT_GE(frames, 32 * 4 - 5) << "too early: less than four windows were watched";
  ASSERT_LT(frames, 2000);
  const Image before = gi.read(Buffer::Beauty);
  for (int i = 0; i < 20; ++i) {
    const FrameStats& s = gi.run(w.still());
    for (const RayCounts& r : {s.raysPoints, s.raysValidation, s.raysCandidates, s.raysRadiosity, s.raysCells,
                               s.raysGather, s.raysNear, s.raysChecks, s.raysMapTests})
      EXPECT_EQ(r.closest + r.occlusion, 0u);
    EXPECT_EQ(s.mapsDrawn + s.lightMapsDrawn, 0u);
    for (size_t e = 0; e < kEffects; ++e) EXPECT_EQ(s.work[e], 0u) << effectRow(EffectId(e)).name;
  }
  EXPECT_TRUE(same(gi.read(Buffer::Beauty), before));

  // Whatever is forced on works and changes nothing.
  for (size_t i = 0; i < kEffects; ++i) gi.settings().effects[EffectId(i)] = EffectMode::On;
  gi.run(w.still()); // a change of settings wakes
  Viewer settled(quick()), forced(withAll(EffectMode::On));
  World a, b;
  settled.run(a.first()), forced.run(b.first());
  for (int i = 0; i < frames + 10; ++i) {
    settled.run(a.still());
    const FrameStats& s = forced.run(b.still());
    if (i < frames + 2) continue;
    EXPECT_GT(s.work[size_t(Replace)], 0u);
    EXPECT_GT(s.work[size_t(Relight)], 0u);
    EXPECT_GT(s.work[size_t(MapRefresh)], 0u);
    EXPECT_GT(s.work[size_t(Redraw)], 0u);
    EXPECT_TRUE(same(settled.read(Buffer::Beauty), forced.read(Buffer::Beauty)));
  }
}

TEST_F(EffectsTest, WakesInTheFrameInWhichAnythingChanges) {
  const auto wakes = [&](const char* what, const auto& change) {
    World w;
    Settings settings = quick();
    settings.smc.moves = 0; // settles at once
    Viewer gi(settings);
    gi.run(w.first());
    ASSERT_LT(framesToSettle(gi, w.still(), 20), 20) << what;
    const Image before = gi.read(Buffer::Beauty);
    const SceneView view = change(w, gi);
    EXPECT_TRUE(gi.run(view).plan.on(Redraw)) << what;
    EXPECT_FALSE(same(gi.read(Buffer::Beauty), before)) << what;
  };
  wakes("camera", [](World& w, Viewer&) {
    w.scene.camera.worldFromView[3].x += 0.1f;
    return w.view(kCameraChanged);
  });
  wakes("size", [](World& w, Viewer&) {
    w.scene.camera.width = 80;
    return w.view(kCameraChanged);
  });
  wakes("light", [](World& w, Viewer&) {
    w.scene.lights[0].intensity *= 2;
    return w.view(kLightsChanged);
  });
  wakes("object", [](World& w, Viewer&) { return w.moveBlock({0.2f, 0, 0}); });
  wakes("setting of drawing", [](World& w, Viewer& gi) {
    gi.settings().gather.disk = 0;
    return w.still();
  });
  wakes("setting of light", [](World& w, Viewer& gi) {
    gi.settings().smc.bounces = 1;
    return w.still();
  });
}

TEST_F(EffectsTest, ReplaceAndRedrawNeedAChange) {
  Settings settings = quick();
  settings.smc.moves = 0; // settles at once
  withoutIt(Replace, settings, asItIs(6), 3);
  withoutIt(Redraw, settings, asItIs(6), 3);
  const auto turned = [](World& w, int frame) -> View {
    if (frame > 6) return {};
    if (frame == 0) { // a second place, far from the first
      const uint32_t grey = w.scene.material(vec3(0.6f));
      w.scene.quad({18.5f, 0, -1.5f}, {0, 0, 3}, {3, 0, 0}, grey);
      w.scene.quad({18.5f, 0, -1.5f}, {3, 0, 0}, {0, 2.5f, 0}, grey);
      w.scene.lights.push_back(w.scene.lights[0]);
      w.scene.lights[1].position.x += 20;
      return w.first();
    }
    w.scene.camera.worldFromView[3].x = 20.2f;
    return w.view({false, frame == 1, false, false, false});
  };
  EXPECT_GT(lossWithout(Replace, quick(), turned), 0.01);
  EXPECT_GT(lossWithout(Redraw, quick(), turned), 0.05);
}

// Beside the GPU

TEST_F(EffectsTest, OverlapGivesTheSameVplsOneFrameLater) {
  Settings beside = quick();
  beside.frame.overlap = true;
  Viewer plain(quick()), overlapped(beside);
  World a, b;
  const auto viewOf = [](World& w, int frame) {
    if (frame == 0) return w.first();
    if (frame % 5 == 1) return w.moveBlock({0.1f, 0, 0});
    if (frame % 5 == 3) {
      w.scene.lights[0].position.x -= 0.1f;
      return w.view(kLightsChanged);
    }
    if (frame % 5 == 4) {
      w.scene.camera.worldFromView[3].x += 0.02f;
      return w.view(kCameraChanged);
    }
    return w.still();
  };
  for (int frame = 0; frame < 30; ++frame) {
    plain.run(viewOf(a, frame));
    overlapped.run(viewOf(b, frame));
    SCOPED_TRACE(frame);
    expectSame(plain.vpls().slots, overlapped.vpls().slots);
  }
  // At rest they show the same.
  for (int i = 0; i < 2000 && plain.run(a.still()).plan.on(Redraw); ++i) overlapped.run(b.still());
  for (int i = 0; i < 3; ++i) overlapped.run(b.still());
  EXPECT_TRUE(same(overlapped.read(Buffer::Irradiance), plain.read(Buffer::Irradiance)));
}

/// VPLs of reflective shadow maps cost nothing where nothing changed, and follow what did.
TEST_F(EffectsTest, ReflectiveMapsAreDrawnWhereSomethingChanged) {
  for (const char* technique : {"rsm", "multires-gather", "multires-splat", "isr", "hisr"}) {
    World world;
    Settings settings;
    applyTechnique(settings, technique);
    settings.image.exposure = 1;
    Viewer gi(settings);
    const FrameStats first = gi.run(world.first());
    EXPECT_TRUE(first.plan.on(Indirect)) << technique;
    EXPECT_FALSE(first.plan.on(Bounces)) << technique;
    EXPECT_EQ(first.raysRadiosity.occlusion + first.raysCandidates.closest, 0u) << technique;
    const Image before = gi.read(Buffer::Indirect);
    EXPECT_EQ(gi.run(world.still()).work[size_t(Redraw)], 0u) << technique;
    world.scene.lights[0].position.x -= 0.3f;
    const FrameStats moved = gi.run(world.view(kLightsChanged));
    EXPECT_GT(moved.work[size_t(Redraw)], 0u) << technique;
    EXPECT_NE(gi.read(Buffer::Indirect).pixels, before.pixels) << technique;
    EXPECT_EQ(gi.read(Buffer::Indirect).pixels, firstFrame(settings, world.first(), Buffer::Indirect).pixels)
        << technique;
    const FrameStats seen = gi.run(world.view(kCameraChanged)); // light is gathered again, its maps are not drawn
    EXPECT_LT(seen.work[size_t(Indirect)], moved.work[size_t(Indirect)]) << technique;
    world.scene.lights.clear();
    world.scene.sky = vec3(1);
    const FrameStats dark = gi.run(world.first());
    EXPECT_FALSE(dark.plan.on(Indirect)) << technique;
    EXPECT_EQ(dark.plan[Indirect].reason, "no punctual light, so no reflective shadow map");
  }
}

/// What moved while another technique was shown is not missed.
TEST_F(EffectsTest, ReflectiveMapsComeBackUpToDate) {
  World world;
  Settings settings;
  settings.smc.vpls = 64;
  settings.smc.warmup = 2;
  settings.image.exposure = 1;
  applyTechnique(settings, "isr");
  Viewer gi(settings);
  gi.run(world.first());
  applyTechnique(gi.settings(), "smc");
  gi.run(world.still());
  gi.run(world.moveBlock({0.3f, 0, 0.2f}));
  applyTechnique(gi.settings(), "isr");
  gi.run(world.still());
  EXPECT_EQ(gi.read(Buffer::Indirect).pixels, firstFrame(settings, world.first(), Buffer::Indirect).pixels);
}

/// The same VPLs with shadow maps and with a ray for every pair.
TEST_F(EffectsTest, VplsOfReflectiveMapsMayHaveShadows) {
  World world;
  Settings settings;
  applyTechnique(settings, "rsm");
  settings.rsm.vpls = 150;
  settings.gather.near = 0; // brings light where nobody shadows too
  settings.image.exposure = 1;
  const auto mean = [&](VplVisibility visibility) {
    settings.vpl.visibility = visibility;
    return meanLuminance(firstFrame(settings, world.first()));
  };
  const double none = mean(VplVisibility::None), maps = mean(VplVisibility::Maps), rays = mean(VplVisibility::Rays);
  EXPECT_LT(rays, 0.97 * none);
  EXPECT_NEAR(maps / rays, 1, 0.02);
}

} // namespace lambent::test::effects_test

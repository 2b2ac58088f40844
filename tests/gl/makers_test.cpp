// Who makes what two can make: as asked, by rule where files are written, by measure where a window asks for it.
#include "gi/contract/maker_choice.h"

#include "engine/gl/context.h"
#include "gl_fixture.h"

namespace lambent::test::makers_test {

class MakersTest : public GlTest {
 protected:
  MakersTest() {
    room.scene.lights.push_back({.type = LightType::Point, .position = {0.3f, 0.6f, 0.4f}, .intensity = vec3(2)});
    room.scene.quad({-0.2f, 0.95f, -0.2f}, {0.4f, 0, 0}, {0, 0, 0.4f}, room.scene.material(vec3(0), vec3(2)));
    room.scene.size(32, 24);
    settings.smc = {.vpls = 128, .warmup = 2};
    settings.shadow.resolution = 32;
    settings.history.frames = 0;
  }
  Settings with(const char* technique) const {
    Settings s = settings;
    applyTechnique(s, technique);
    s.cube = {.resolution = 16, .visibility = CubeVisibility::Hemicubes, .hemicube = 16};
    return s;
  }
  struct Result {
    std::string shadow, area, cube;       // who made
    std::string shadowReport, cubeReport; // and what was measured
    Image light, direct;
  };
  Result run(const Settings& s, Makers makers = Makers::ByRule) {
    Viewer gi(s, 1, makers);
    const FrameStats& stats = gi.run(room.scene.view());
    return {stats.shadowMaker,      stats.areaTracer,     stats.cubeMaker,
            stats.makerTimes,       stats.cubeMakerTimes, gi.read(Buffer::Irradiance),
            gi.read(Buffer::Direct)};
  }

  Room room;
  Settings settings;
  const bool cpu = gl::drawnByCpu();
};

TEST_F(MakersTest, WhatIsAskedForGoesBeforeTheMeasureAndThatBeforeTheRule) {
  int measured = 0;
  const auto times = [&](double gpuMs) {
    return [&measured, gpuMs]() -> std::optional<MakerTimes> {
      ++measured;
      return MakerTimes{10, gpuMs, "a map"};
    };
  };
  for (const bool onCpu : {false, true}) {
    MakerChoice ruled{{programs, profiler, Makers::ByRule, onCpu}, "rays", "raster"};
    EXPECT_EQ(ruled.maker(), "");
    ruled.take({}, times(4.9));
    EXPECT_EQ(ruled.gpu(), !onCpu);
    EXPECT_EQ(ruled.report(), onCpu ? "rays" : "raster");
    ruled.take(onCpu, times(4.9));
    EXPECT_EQ(ruled.gpu(), onCpu);
    EXPECT_EQ(measured, 0);
  }
  PassContext window{programs, profiler, Makers::Measured, true};
  MakerChoice of{window, "rays", "raster"};
  of.take({}, [] { return std::nullopt; });
  EXPECT_EQ(of.report(), "rays") << "nothing to measure yet";
  of.take({}, times(4.9));
  EXPECT_EQ(of.report(), "raster (4.90 ms a map, rays 10.00 ms)");
  of.take(false, times(4.9));
  EXPECT_FALSE(of.gpu());
  EXPECT_EQ(of.report(), "rays");
  of.take({}, times(4.9));
  EXPECT_TRUE(of.gpu());
  EXPECT_EQ(of.maker(), "raster");
  EXPECT_EQ(measured, 1) << "once";
  window.drawnByCpu = false;
  MakerChoice close{window, "rays", "raster"};
  close.take(true, times(5.1));
  EXPECT_EQ(measured, 1) << "asked for";
  close.take({}, times(5.1));
  EXPECT_EQ(close.report(), "rays (10.00 ms a map, raster 5.10 ms)");
}

/// No clock has a say: who makes is the rule's, is told as --set takes it, and asked for by that name makes the same.
TEST_F(MakersTest, FramesAreMadeByRule) {
  Settings s = with("smc");
  Result ruled = run(s);
  EXPECT_EQ(ruled.shadow, cpu ? "rays" : "raster");
  EXPECT_EQ(ruled.shadowReport, ruled.shadow);
  applySetting(s, "shadow.maker", ruled.shadow);
  EXPECT_EQ(run(s).light.pixels, ruled.light.pixels);

  s = with("area-multires");
  ruled = run(s);
  EXPECT_EQ(ruled.area, cpu ? "cpu" : "gpu");
  applySetting(s, "area.tracer", ruled.area);
  EXPECT_EQ(run(s).direct.pixels, ruled.direct.pixels);

  s = with("ibrr");
  ruled = run(s);
  EXPECT_EQ(ruled.cube, cpu ? "rays" : "raster");
  EXPECT_EQ(ruled.cubeReport, ruled.cube);
  applySetting(s, "cube.maker", ruled.cube);
  EXPECT_EQ(run(s).light.pixels, ruled.light.pixels);
}

TEST_F(MakersTest, AWindowMeasuresWhatNobodyAskedFor) {
  EXPECT_NE(run(with("smc"), Makers::Measured).shadowReport.find(" ms a map"), std::string::npos);
  EXPECT_NE(run(with("area-multires"), Makers::Measured).area.find(" ms a million rays"), std::string::npos);
  EXPECT_NE(run(with("ibrr"), Makers::Measured).cubeReport.find(" ms a hemicube"), std::string::npos);
  Settings asked = with("smc");
  asked.shadow.maker = ShadowMaker::Raster;
  EXPECT_EQ(run(asked, Makers::Measured).shadowReport, "raster");
}

/// Drawn maps miss a texel's direction by less than a texel of their faces. So they are as right as cast ones, and both
/// come to a ray's answers, and to each other's, as texels become smaller. (Faces of half as many texels: the makers
/// disagree in 0.55 to 0.62 of what cast maps get wrong, and drawn ones get 0.20 to 0.27 more wrong.)
TEST_F(MakersTest, BothMakersMapsComeToTheTruth) {
  room.scene.size(160, 120);
  settings.smc = {.vpls = 256, .warmup = 4};
  ShadowAgreement before;
  for (const int resolution : {64, 128, 256}) {
    settings.shadow.resolution = resolution;
    Viewer gi(settings);
    gi.run(room.scene.view());
    const ShadowAgreement now = gi.compareShadowMaps(room.scene.view(), 64, 8000);
    std::printf("%4d texels: makers %.3f %%, raster against rays %.3f %%, cast %.3f %%\n", resolution, 100 * now.makers,
                100 * now.rasterAgainstRays, 100 * now.castAgainstRays);
    EXPECT_GT(now.pairs, 100000u);
    EXPECT_LT(now.makers, 0.35 * now.castAgainstRays) << resolution;
    EXPECT_LT(now.rasterAgainstRays, 1.12 * now.castAgainstRays) << resolution;
    if (before.pairs > 0) {
      EXPECT_LT(now.makers, 0.7 * before.makers) << resolution;
      EXPECT_LT(now.rasterAgainstRays, 0.7 * before.rasterAgainstRays) << resolution;
      EXPECT_LT(now.castAgainstRays, 0.7 * before.castAgainstRays) << resolution;
    }
    before = now;
  }
}

} // namespace lambent::test::makers_test

// Paraboloid maps: the two makers agree, and both agree with closed forms.
#include "gi/visibility/paraboloid_maps.h"
#include "gl_fixture.h"

namespace lambent::test::maps_test {

class MapsTest : public GatherTest {
 protected:
  MapsTest() { gpu.place(room.scene.instances); }
  ParaboloidMapInputs inputs() const {
    return {.scene = gpu, .rays = &room.rays, .poses = poses, .jobs = jobs, .farDistance = 3.5f, .resolution = 64};
  }

  Room room;
  GpuScene gpu{passes, room.scene.assets};
  std::vector<MapPose> poses{{{0.5f, -1, 0.3f}, {0, 1, 0}, {0, 1, 0}}}; // on the floor
  std::vector<MapJob> jobs;
  ParaboloidMapPass pass{passes, StageId::VplMaps};
};

/// Rows of the rays' maps are packed as tightly as the convention says; another alignment for them was left behind.
TEST_F(MapsTest, MakersLeaveThePixelStoreAlone) {
  ParaboloidMapInputs in = inputs();
  in.maker = ShadowMaker::Rays;
  in.resolution = 33;
  pass.run(in);
  GLint alignment = 0;
  glGetIntegerv(GL_UNPACK_ALIGNMENT, &alignment);
  EXPECT_EQ(alignment, 1);
}

TEST_F(MapsTest, MakersAgree) {
  const ParaboloidMapInputs in = inputs();
  const vec3 tilted = glm::normalize(vec3(0.2f, 1, -0.3f));
  const MapPose all[] = {{{0.5f, -1, 0.3f}, {0, 1, 0}, {0, 1, 0}}, {{-1, 0.2f, 0.1f}, {1, 0, 0}, {1, 0, 0}},
                         {{1, 0, 0.5f}, {-1, 0, 0}, {-1, 0, 0}},   {{0.1f, 1, 0}, {0, -1, 0}, {0, -1, 0}},
                         {{0.2f, 0.3f, -1}, {0, 0, 1}, {0, 0, 1}}, {{0.2f, 0.1f, 1}, {0, 0, -1}, {0, 0, -1}},
                         {{0.5f, -1, 0.3f}, tilted, {0, 1, 0}}};
  for (const MapPose& pose : all) {
    const MakerComparison maps = pass.compareMakers(in, pose);
    int inside = 0, close = 0;
    for (const auto [x, y] : Pixels(maps.resolution, maps.resolution)) {
      const vec2 uv = (vec2(x, y) + 0.5f) / float(maps.resolution);
      if (directionFromParaboloid(uv).z < 0.1f) continue; // at the horizon a texel sees metres of the floor it is on
      ++inside;
      const size_t i = size_t(y) * maps.resolution + x;
      // A face's texel stands for up to 0.35 of a map's around it; on a surface at 80° to the ray that is 1 %.
      // Below a tilted map's own surface, distances are millimetres, and only their size means anything.
      if (std::abs(maps.raster[i] - maps.rays[i]) < 0.04f * maps.rays[i] + 0.005f) ++close;
    }
    EXPECT_GT(inside, 2000);
    // The rest lies on silhouettes, where the nearest texel falls to the other side.
    EXPECT_GT(double(close) / inside, 0.99)
        << "normal " << pose.normal.x << ' ' << pose.normal.y << ' ' << pose.normal.z;
  }
}

TEST_F(MapsTest, MapsHoldTheDistanceToTheRoom) {
  jobs = {{0, TexelRect::whole(64)}};
  for (const ShadowMaker maker : {ShadowMaker::Rays, ShadowMaker::Raster}) {
    ParaboloidMapInputs in = inputs();
    in.maker = maker;
    ParaboloidMapPass pass(passes, StageId::VplMaps); // nothing drawn yet
    const ParaboloidMaps maps = pass.run(in);
    EXPECT_EQ(pass.mapsDrawn(), 1u);
    ASSERT_EQ(maps.arrays.size(), 1u);
    const std::vector<float> distances = pass.readLayer(0);
    EXPECT_NEAR(distances[32 * 64 + 32], 2, 0.01f) << "straight up to the ceiling";
    in.farDistance = 400; // 16 bits in equal steps: 6 mm each
    pass.run(in);
    const std::vector<float> finely = pass.readLayer(0);
    for (size_t i = 0; i < finely.size(); i += 7)
      if (distances[i] > 0.1f && distances[i] < 3) {
        EXPECT_NEAR(finely[i], distances[i], 0.001f) << i;
      }
  }
}

/// Settings that were refused are taken back, and then the maps are those of before.
TEST_F(MapsTest, GoesOnAfterMapsThatFitNoMemory) {
  passes.drawnByCpu = true;
  ParaboloidMapPass pass(passes, StageId::VplMaps);
  const ParaboloidMapInputs in = inputs();
  pass.run(in);
  const std::vector<float> before = pass.readLayer(0);
  const std::vector<MapPose> many(size_t(1) << 20, poses[0]);
  ParaboloidMapInputs large = in;
  large.poses = many;
  large.resolution = 4096; // 32 TiB together; an array of them could be had
  EXPECT_THROW(pass.run(large), RunError);
  EXPECT_EQ(pass.run(in).arrays.size(), 1u);
  EXPECT_EQ(pass.readLayer(0), before);
}

TEST_F(MapsTest, AutoMeasuresBothMakersOnce) {
  poses.resize(20, poses[0]);
  const ParaboloidMapInputs in = inputs();
  ParaboloidMapPass pass({programs, profiler, Makers::Measured}, StageId::VplMaps);
  pass.run(in);
  EXPECT_EQ(pass.mapsDrawn(), 20u) << "a new array starts with all of its maps";
  const std::string report = pass.maker().report();
  EXPECT_NE(report.find("rays"), std::string::npos);
  EXPECT_NE(report.find("raster"), std::string::npos);
  jobs = {{3, TexelRect::whole(64)}, {4, {10, 20, 30, 25}}};
  ParaboloidMapInputs again = in;
  again.jobs = jobs;
  pass.run(again);
  EXPECT_EQ(pass.mapsDrawn(), 2u);
  EXPECT_EQ(pass.maker().report(), report);
}

/// Where the GPU draws whole maps, a part of one is cast.
TEST_F(MapsTest, PartsAreCastWhereTheGpuDraws) {
  passes.drawnByCpu = false;
  ParaboloidMapPass onGpu(passes, StageId::VplMaps);
  const auto at = [](const std::vector<float>& map, int x, int y) { return map[size_t(y) * 64 + size_t(x)]; };
  onGpu.run(inputs());
  const std::vector<float> drawn = onGpu.readLayer(0);
  const MakerComparison makers = onGpu.compareMakers(inputs(), poses[0]);
  EXPECT_EQ(drawn, makers.raster);
  const auto partIs = [&](const TexelRect& part, ShadowMaker maker, const std::vector<float>& wanted) {
    jobs = {{0, TexelRect::whole(64)}};
    onGpu.run(inputs());
    jobs = {{0, part}};
    ParaboloidMapInputs in = inputs();
    in.maker = maker;
    onGpu.run(in);
    const std::vector<float> map = onGpu.readLayer(0);
    int unlike = 0, outside = 0, told = 0;
    for (const auto [x, y] : Pixels(64, 64)) {
      const bool within = x >= part.x0 && x < part.x1 && y >= part.y0 && y < part.y1;
      unlike += within && at(map, x, y) != at(wanted, x, y);
      outside += !within && at(map, x, y) != at(drawn, x, y);
      told += within && at(makers.raster, x, y) != at(makers.rays, x, y);
    }
    EXPECT_EQ(unlike, 0);
    EXPECT_EQ(outside, 0);
    EXPECT_GT(told, 0) << "or the makers cannot be told apart";
  };
  partIs({24, 8, 40, 24}, ShadowMaker::Auto, makers.rays);
  partIs({16, 16, 48, 48}, ShadowMaker::Auto, makers.raster);
  partIs({24, 8, 40, 24}, ShadowMaker::Raster, makers.raster);
  for (const int step : {2, 4}) {
    jobs = {{0, TexelRect::whole(64), step}};
    onGpu.run(inputs());
    EXPECT_EQ(onGpu.readLayer(0), makers.raster) << "which nobody would make whole";
  }
}

TEST_F(MapsTest, MoreSlotsThanAnArrayHasLayers) {
  poses.resize(2100, poses[0]);
  ParaboloidMapInputs in = inputs();
  in.resolution = 8;
  in.maker = ShadowMaker::Rays;
  EXPECT_EQ(pass.run(in).arrays.size(), 2u);
  EXPECT_EQ(pass.readLayer(0), pass.readLayer(2099));
}

/// A VPL on the floor lights the room through its map exactly where a ray from it is free.
TEST_F(MapsTest, ShadowsFallWhereRaysAreBlocked) {
  room.scene.size(96, 72);
  const VirtualLight vpl = lightAt({0.6f, -1, 0}, {0, 1, 0}, vec3(1), 0.01f);
  poses = {vpl.pose(1e-4f)};
  for (const ShadowMaker maker : {ShadowMaker::Rays, ShadowMaker::Raster}) {
    ParaboloidMapInputs in = inputs();
    in.resolution = 128;
    in.maker = maker;
    ParaboloidMapPass mapPass(passes, StageId::VplMaps);
    const GBuffer gbuffer = surfaces(room.scene);
    const ParaboloidMaps maps = mapPass.run(in);
    const Settings full = with(GatherMode::Full);
    const Image lit = read(Buffer::Unfiltered, gbuffer, gathered(gbuffer, {&vpl, 1}, full, &maps));
    const Image open = read(Buffer::Unfiltered, gbuffer, gathered(gbuffer, {&vpl, 1}, full));
    const Image depth = read(Buffer::Depth, gbuffer, {});

    constexpr int kWidth = 96, kHeight = 72;
    enum Answer : int { None = -1, Free = 0, Blocked = 1 };
    std::vector<int> answers(kWidth * kHeight, None); // of rays
    std::vector<vec3> normals(kWidth * kHeight);
    const vec3 forward = -vec3(room.scene.camera.worldFromView[2]);
    for (const auto [x, y] : Pixels(kWidth, kHeight)) {
      if (!(open.at(x, y).x > 0)) continue;
      const CameraRay ray = pixelRay(room.scene.camera, x, y);
      const SurfaceHit hit = room.rays.closest(Ray{ray.origin, ray.direction});
      answers[y * kWidth + x] = room.rays.occluded(segment(offsetPoint(hit.position, hit.geometricNormal, 1e-4f),
                                                           offsetPoint(vpl.position, vpl.geometricNormal, 1e-4f)));
      normals[y * kWidth + x] = hit.geometricNormal;
      EXPECT_NEAR(depth.at(x, y).x, glm::dot(hit.position - ray.origin, forward), 0.3f);
    }
    const auto alike = [&](int x, int y, int reach) { // all around it on this surface have its answer
      for (int v = std::max(0, y - reach); v <= std::min(kHeight - 1, y + reach); ++v)
        for (int u = std::max(0, x - reach); u <= std::min(kWidth - 1, x + reach); ++u)
          if (answers[v * kWidth + u] != answers[y * kWidth + x] || normals[v * kWidth + u] != normals[y * kWidth + x])
            return false;
      return true;
    };
    struct Count {
      int pixels = 0, wrong = 0;
    } far[2], near[2], edge[2]; // by answer
    for (const auto [x, y] : Pixels(kWidth, kHeight)) {
      const int answer = answers[y * kWidth + x];
      if (answer == None) continue;
      Count& count = (alike(x, y, 4) ? far : alike(x, y, 2) ? near : edge)[answer];
      ++count.pixels;
      count.wrong += (lit.at(x, y).x > 0) == (answer == Blocked);
    }
    for (const Answer answer : {Free, Blocked}) {
      const std::string what = std::string(answer == Free ? "acne" : "leaks") + ", maker " + std::to_string(int(maker));
      EXPECT_GT(far[answer].pixels, answer == Free ? 2500 : 400) << what;
      EXPECT_EQ(far[answer].wrong, 0) << what;
      // A texel of the map is two or three pixels wide.
      EXPECT_EQ(near[answer].wrong, 0) << what;
      EXPECT_LT(edge[answer].wrong, 0.05 * edge[answer].pixels) << what << ": along a shadow's edge and the room's";
    }
  }
}

} // namespace lambent::test::maps_test

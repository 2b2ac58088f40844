// Which maps are drawn again where objects moved: the texels a box covers, a part drawn anew against the whole, who
// sees a mover, and the order of the queue.
#include "gi/visibility/map_schedule.h"
#include "gi/visibility/paraboloid_maps.h"
#include "gl_fixture.h"

namespace lambent::test::map_schedule_test {

/// The direction that a texel looks in, world space; nothing for those that see nothing (as castMap).
std::optional<vec3> texelDirection(const MapPose& pose, int x, int y, int resolution) {
  const vec3 d = directionFromParaboloid((vec2(x, y) + 0.5f) / float(resolution));
  if (d.z < -2.0f / float(resolution)) return {};
  vec3 tangent, bitangent;
  basisAround(pose.normal, tangent, bitangent);
  return d.x * tangent + d.y * bitangent + d.z * pose.normal;
}

/// Bounding rectangle of the texels whose rays meet the box, by looking at each.
TexelRect texelsMet(const MapPose& pose, const Aabb& box, int resolution) {
  const vec3 origin = offsetPoint(pose.position, pose.geometricNormal, 1e-4f);
  TexelRect met;
  for (const auto [x, y] : Pixels(resolution, resolution))
    if (const auto d = texelDirection(pose, x, y, resolution); d && crosses(Ray{origin, *d}, box))
      met.add({x, y, x + 1, y + 1});
  return met;
}

bool holds(const TexelRect& outer, const TexelRect& inner) {
  TexelRect both = outer;
  both.add(inner);
  return both == outer;
}

MapPose randomPose(Rng& rng) {
  MapPose pose;
  pose.position = 4.0f * rng.next3() - 2.0f;
  pose.geometricNormal = sampleSphere(rng.next2());
  pose.normal = glm::normalize(pose.geometricNormal + 0.4f * sampleSphere(rng.next2()));
  return pose;
}

Aabb boxAround(const vec3& centre, const vec3& size) { return {centre - 0.5f * size, centre + 0.5f * size}; }

TEST(TexelsCovered, HoldEveryTexelWhoseRayMeetsTheBox) {
  Rng rng(1, Stream::Test, 0);
  int met = 0, partlyBehind = 0;
  for (int i = 0; i < 6000; ++i) {
    const int resolution = i % 3 == 0 ? 16 : i % 3 == 1 ? 33 : 64;
    const MapPose pose = randomPose(rng);
    // Far and near, large and small, flat and long; some hold the light or begin right at it.
    const float scale = std::exp2(-5 + 7 * rng.next());
    const vec3 size = scale * vec3(std::exp2(-6 * rng.next()), std::exp2(-6 * rng.next()), std::exp2(-6 * rng.next()));
    const float distance = scale * std::exp2(-4 + 6 * rng.next());
    const Aabb box = boxAround(pose.position + distance * sampleSphere(rng.next2()), size);
    const TexelRect truth = texelsMet(pose, box, resolution), bound = texelsCovered(pose, box, resolution);
    ASSERT_TRUE(holds(bound, truth)) << "case " << i << ": [" << bound.x0 << ',' << bound.x1 << ")x[" << bound.y0 << ','
                                     << bound.y1 << ") lacks some of [" << truth.x0 << ',' << truth.x1 << ")x["
                                     << truth.y0 << ',' << truth.y1 << ')';
    ASSERT_TRUE(holds(TexelRect::whole(resolution), bound)) << "case " << i;
    met += !truth.empty();
    const float above = glm::dot(box.centre() - pose.position, pose.normal);
    partlyBehind += !truth.empty() && above < 0.5f * glm::dot(size, glm::abs(pose.normal));
  }
  EXPECT_GT(met, 2000);
  EXPECT_GT(partlyBehind, 500);
}

TEST(TexelsCovered, AreFewMoreThanNeeded) {
  constexpr int kResolution = 128;
  Rng rng(2, Stream::Test, 0);
  double bound = 0, needed = 0;
  int cases = 0;
  for (int i = 0; i < 1500; ++i) {
    const MapPose pose = randomPose(rng);
    const vec3 size = vec3(0.05f) + rng.next3();
    const Aabb box = boxAround(pose.position + (2 + 3 * rng.next()) * sampleSphere(rng.next2()), size);
    const TexelRect truth = texelsMet(pose, box, kResolution), covered = texelsCovered(pose, box, kResolution);
    if (truth.empty()) {
      // One that lies by the horizon may be met by no texel's centre.
      EXPECT_LT(covered.area(), 0.05 * kResolution * kResolution) << "case " << i;
      continue;
    }
    bound += covered.area();
    needed += truth.area();
    ++cases;
  }
  EXPECT_GT(cases, 500);
  std::printf("texels in rectangles over those needed: %.3f\n", bound / needed);
  EXPECT_LT(bound / needed, 1.15);
}

TEST(TexelsCovered, NothingBehindTheLightAndAllAroundIt) {
  const MapPose pose{{1, 2, 3}, {0, 1, 0}, {0, 1, 0}};
  EXPECT_TRUE(texelsCovered(pose, boxAround({1, 0.5f, 3}, vec3(0.8f)), 128).empty());
  EXPECT_TRUE(texelsCovered(pose, boxAround({4, 1.4f, 3}, vec3(0.4f)), 128).empty());
  EXPECT_TRUE(texelsCovered(pose, Aabb{}, 128).empty());
  EXPECT_EQ(texelsCovered(pose, boxAround(pose.position, vec3(0.5f)), 128), TexelRect::whole(128));
  EXPECT_EQ(texelsCovered(pose, boxAround({1, 2.25f, 3}, vec3(0.5f)), 128), TexelRect::whole(128));
  const TexelRect overhead = texelsCovered(pose, boxAround({1, 12, 3}, vec3(0.5f)), 128);
  EXPECT_FALSE(overhead.empty());
  EXPECT_LT(overhead.area(), 100);
  EXPECT_TRUE(holds(overhead, {64, 64, 65, 65}));
}

/// A closed room with a block in it that can be carried about.
struct RoomWithBlock {
  HandScene scene;
  uint32_t carried = 0;

  RoomWithBlock() {
    const uint32_t white = scene.material(vec3(0.7f));
    scene.box(vec3(-1), vec3(1), white, true);
    carried = scene.add(block(vec3(0.2f), white));
  }

  /// Carries the block and returns the view that tells of it.
  SceneView carry(const vec3& to, float turn) {
    const float c = std::cos(turn), s = std::sin(turn);
    scene.place(carried, mat4(vec4(c, 0, -s, 0), vec4(0, 1, 0, 0), vec4(s, 0, c, 0), vec4(to, 1)));
    return scene.view();
  }
};

class MapScheduleTest : public GlTest {
 protected:
  MapScheduleTest() { rays.update(room.carry(vec3(0), 0.3f)); }

  static std::vector<MapPose> posesOnWalls() {
    Rng rng(3, Stream::Test, 0);
    std::vector<MapPose> poses;
    for (int i = 0; i < 96; ++i) {
      const int axis = i % 3;
      vec3 p = 1.8f * rng.next3() - 0.9f, n(0);
      p[axis] = i % 2 ? 1.0f : -1.0f;
      n[axis] = -p[axis];
      poses.push_back({p, glm::normalize(n + 0.3f * sampleSphere(rng.next2())), n});
    }
    return poses;
  }

  GlContext& current = context(); // what follows needs one before SetUp
  RoomWithBlock room;
  EmbreeQuery rays{room.scene.assets};
  GpuScene gpu{passes, room.scene.assets};
  const std::vector<MapPose> poses = posesOnWalls();
  const std::vector<float> brightness = std::vector<float>(poses.size(), 1.0f);
  ParaboloidMapInputs in{.scene = gpu,
                         .rays = &rays,
                         .poses = poses,
                         .jobs = {},
                         .farDistance = 4,
                         .resolution = 64,
                         .maker = ShadowMaker::Rays};
};

TEST_F(MapScheduleTest, MapsDrawnInPartEqualMapsDrawnWhole) {
  ParaboloidMapPass parts(passes, StageId::VplMaps);
  parts.run(in);
  MapSchedule schedule;
  int odd = 0;
  size_t changed = 0;
  for (uint32_t frame = 0; frame < 4; ++frame) {
    const vec3 to[] = {{0.1f, 0, 0.05f}, {0.45f, -0.3f, 0.1f}, {-0.5f, 0.35f, -0.4f}, {-0.5f, 0.35f, -0.35f}};
    const SceneView view = room.carry(to[frame], 0.3f + 0.4f * float(frame));
    rays.update(view);
    gpu.place(view.instances);
    RayCounts counts;
    schedule.invalidate(poses, brightness, DirtyRegion(view), rays, 64, 0, 1, frame, counts);
    const std::vector<MapJob> jobs = schedule.take({}, brightness, 64, 1 << 30);
    int64_t texels = 0;
    for (const MapJob& job : jobs) {
      texels += texelsTraced(job.texels, job.step);
      odd += (job.texels.x1 - job.texels.x0) % 2;
    }
    EXPECT_LT(double(texels), 0.7 * double(poses.size()) * 64 * 64) << "frame " << frame;
    std::vector<std::vector<float>> before;
    for (uint32_t i = 0; i < poses.size(); ++i) before.push_back(parts.readLayer(i));
    in.jobs = jobs;
    parts.run(in);
    ParaboloidMapPass whole(passes, StageId::EmitterMaps);
    in.jobs = {};
    whole.run(in);
    for (uint32_t i = 0; i < poses.size(); ++i) {
      const std::vector<float> part = parts.readLayer(i);
      EXPECT_EQ(part, whole.readLayer(i)) << "frame " << frame << ", map " << i;
      changed += part != before[i];
    }
  }
  EXPECT_GT(odd, 50);
  EXPECT_GT(changed, 200u);
}

TEST_F(MapScheduleTest, CoarseMapsComeCloseAndAreMadeFineAtRest) {
  ParaboloidMapPass parts(passes, StageId::VplMaps);
  parts.run(in);
  const SceneView view = room.carry({0.45f, -0.3f, 0.1f}, 0.7f);
  rays.update(view);
  ParaboloidMapPass whole(passes, StageId::EmitterMaps);
  whole.run(in);
  const auto wrong = [&] { // share of texels whose distance is off by more than 2 %
    size_t differing = 0, all = 0;
    for (uint32_t i = 0; i < poses.size(); ++i) {
      const std::vector<float> a = parts.readLayer(i), b = whole.readLayer(i);
      for (size_t k = 0; k < a.size(); ++k)
        if (b[k] < kInfinity) ++all, differing += !(std::abs(a[k] - b[k]) <= 0.02f * b[k]);
    }
    return double(differing) / double(all);
  };
  const double stale = wrong();
  MapSchedule schedule;
  RayCounts counts;
  schedule.invalidate(poses, brightness, DirtyRegion(view), rays, 64, 0, 1, 0, counts);
  int64_t cost = 0;
  for (const MapJob& job : MapSchedule(schedule).take({}, brightness, 64, 1 << 30)) cost += job.texels.area();
  std::vector<MapJob> jobs = schedule.take({}, brightness, 64, cost / 3);
  EXPECT_EQ(jobs.size(), MapSchedule(schedule).waiting() +
                             std::count_if(jobs.begin(), jobs.end(), [](const MapJob& j) { return j.step == 1; }));
  in.jobs = jobs;
  parts.run(in);
  const double coarse = wrong();
  std::printf("texels off by 2 %%: stale %.1f %%, coarse %.2f %%\n", 100 * stale, 100 * coarse);
  EXPECT_GT(stale, 0.02);
  EXPECT_LT(coarse, 0.5 * stale); // what is left lies along silhouettes
  for (int frame = 0; frame < 10 && schedule.waiting() > 0; ++frame) {
    jobs = schedule.take({}, brightness, 64, cost / 3);
    in.jobs = jobs;
    parts.run(in);
  }
  EXPECT_EQ(schedule.waiting(), 0u);
  for (uint32_t i = 0; i < poses.size(); ++i) EXPECT_EQ(parts.readLayer(i), whole.readLayer(i)) << "map " << i;
}

// The queue ----------------------------------------------------------------------------------------------------------

constexpr int kResolution = 32, kMap = kResolution * kResolution;

std::vector<uint32_t> slotsOf(const std::vector<MapJob>& jobs) {
  std::vector<uint32_t> slots;
  for (const MapJob& job : jobs) slots.push_back(job.slot);
  return slots;
}

TEST(MapSchedule, OnlyMapsThatSeeTheMoverWait) {
  // A wall at x = 0 that reaches far; the mover is on its right side.
  AnalyticQuery rays;
  rays.addBox({-0.1f, -50, -50}, {0.1f, 50, 50}, {});
  const Aabb box = boxAround({2, 0, 0}, vec3(0.5f));
  const DirtyRegion moved(std::span(&box, 1));
  const MapPose poses[] = {
      {{-2, 0, 0}, {1, 0, 0}, {1, 0, 0}},   // behind the wall, turned towards the mover
      {{5, 0, 0}, {-1, 0, 0}, {-1, 0, 0}},  // in sight
      {{5, 0, 0}, {1, 0, 0}, {1, 0, 0}},    // turned away
      {{4, 1, 1}, {-1, 0, 0}, {-1, 0, 0}},  // in sight, but dark
      {{2, 0, 0.1f}, {0, 1, 0}, {0, 1, 0}}, // inside it
  };
  const float brightness[] = {1, 1, 1, 0, 1};
  for (const int raysPerBox : {16, 0}) {
    MapSchedule schedule;
    RayCounts counts;
    schedule.invalidate(poses, brightness, moved, rays, kResolution, raysPerBox, 1, 0, counts);
    EXPECT_EQ(schedule.waiting(), raysPerBox ? 2u : 3u);
    const std::vector<MapJob> jobs = schedule.take({}, brightness, kResolution, 100 * kMap);
    EXPECT_EQ(slotsOf(jobs), raysPerBox ? (std::vector<uint32_t>{1, 4}) : (std::vector<uint32_t>{0, 1, 4}));
    EXPECT_EQ(jobs.back().texels, TexelRect::whole(kResolution));
    const auto inSight = std::find_if(jobs.begin(), jobs.end(), [](const MapJob& job) { return job.slot == 1; });
    EXPECT_EQ(inSight->texels, texelsCovered(poses[1], moved.boxes()[0], kResolution));
    EXPECT_EQ(counts.occlusion > 0, raysPerBox > 0);
    EXPECT_EQ(schedule.waiting(), 0u);
  }
}

TEST(MapSchedule, APlaceSeenThroughASmallHoleIsFound) {
  // Screens that leave an eighth of the mover in sight: the light sees it in nearly every frame.
  AnalyticQuery rays;
  rays.addBox({1, -50, -50}, {1.1f, 50, 0.18f}, {}); // hides z < 0.189 of [-0.25, 0.25]
  const Aabb box = boxAround({2.25f, 0, 0}, vec3(0.5f));
  const DirtyRegion moved(std::span(&box, 1));
  const MapPose pose{{-20, 0, 0}, {1, 0, 0}, {1, 0, 0}};
  const float brightness[] = {1};
  int found = 0;
  for (uint32_t frame = 0; frame < 200; ++frame) {
    MapSchedule schedule;
    RayCounts counts;
    schedule.invalidate({&pose, 1}, brightness, moved, rays, 2048, 16, 1, frame, counts);
    found += schedule.waiting() == 1;
  }
  EXPECT_GT(found, 196); // 0.875^16 = 12 % would be missed by independent points
}

TEST(MapSchedule, BrightestFirstWithinTheBudgetAndMovedLightsAlways) {
  MapSchedule schedule;
  const std::vector<float> brightness{0.1f, 5, 0, 3, 4, 0.2f, 2, 1};
  schedule.invalidateAll(brightness.size(), kResolution);
  EXPECT_EQ(schedule.waiting(), 8u);
  const uint32_t first[] = {0, 5};
  // Two moved lights whatever the budget, then the brightest, coarsely, as long as something is left of it.
  const std::vector<MapJob> jobs = schedule.take(first, brightness, kResolution, kMap / 4 + 1);
  EXPECT_EQ(slotsOf(jobs), (std::vector<uint32_t>{0, 1, 4, 5}));
  for (const MapJob& job : jobs) {
    EXPECT_EQ(job.texels, TexelRect::whole(kResolution));
    EXPECT_EQ(job.step, job.slot == 1 || job.slot == 4 ? 2 : 1);
  }
  EXPECT_EQ(schedule.waiting(), 5u) << "3, 6, 7, and 1 and 4 to be drawn finely; the empty slot needs no map";
  EXPECT_EQ(slotsOf(schedule.take({}, brightness, kResolution, 0)), std::vector<uint32_t>{});
  EXPECT_EQ(schedule.waiting(), 5u);
  EXPECT_EQ(slotsOf(schedule.take({}, brightness, kResolution, kMap / 4)), std::vector<uint32_t>{3});
  EXPECT_EQ(slotsOf(schedule.take(first, brightness, kResolution, 0)), (std::vector<uint32_t>{0, 5}));
  // Enough for both that are stale, one of them finely, and not for the rough ones.
  const std::vector<MapJob> fine = schedule.take({}, brightness, kResolution, kMap + kMap / 4);
  EXPECT_EQ(slotsOf(fine), (std::vector<uint32_t>{6, 7}));
  EXPECT_EQ(fine[0].step, 1);
  EXPECT_EQ(fine[1].step, 2);
  // With nothing stale the rough ones follow, the brightest first.
  EXPECT_EQ(slotsOf(schedule.take({}, brightness, kResolution, kMap)), std::vector<uint32_t>{1});
  const std::vector<MapJob> last = schedule.take({}, brightness, kResolution, 100 * kMap);
  EXPECT_EQ(slotsOf(last), (std::vector<uint32_t>{3, 4, 7}));
  for (const MapJob& job : last) EXPECT_EQ(job.step, 1);
  EXPECT_EQ(schedule.waiting(), 0u);
  schedule.invalidateAll(brightness.size(), kResolution);
  schedule.clear();
  EXPECT_EQ(schedule.waiting(), 0u);
  EXPECT_TRUE(schedule.take({}, brightness, kResolution, 100 * kMap).empty());
}

TEST(MapSchedule, PartsAddUpUntilTheyAreDrawn) {
  const AnalyticQuery nothing;
  const MapPose pose{{0, 0, 0}, {0, 1, 0}, {0, 1, 0}};
  const float brightness[] = {1};
  const Aabb left = boxAround({-3, 4, 0}, vec3(0.5f)), right = boxAround({3, 4, 0}, vec3(0.5f));
  MapSchedule schedule;
  RayCounts counts;
  schedule.invalidate({&pose, 1}, brightness, DirtyRegion(std::span(&left, 1)), nothing, kResolution, 4, 1, 0, counts);
  EXPECT_TRUE(schedule.take({}, brightness, kResolution, 0).empty());
  schedule.invalidate({&pose, 1}, brightness, DirtyRegion(std::span(&right, 1)), nothing, kResolution, 4, 1, 1, counts);
  EXPECT_EQ(schedule.waiting(), 1u);
  const std::vector<MapJob> jobs = schedule.take({}, brightness, kResolution, 1);
  ASSERT_EQ(jobs.size(), 1u);
  EXPECT_TRUE(holds(jobs[0].texels, texelsCovered(pose, left, kResolution)));
  EXPECT_TRUE(holds(jobs[0].texels, texelsCovered(pose, right, kResolution)));
  EXPECT_LT(jobs[0].texels.area(), kMap);
}

TEST(MapSchedule, TexelsThatCarryMoreLightComeFirst) {
  // The mover is by the horizon of the first light and straight ahead of the second.
  const AnalyticQuery nothing;
  const MapPose poses[] = {{{-4, 0, 0}, {0, 1, 0}, {0, 1, 0}}, {{0, -4, 0}, {0, 1, 0}, {0, 1, 0}}};
  const Aabb box = boxAround({0, 0.6f, 0}, vec3(0.8f));
  const float equal[] = {1, 1}, muchBrighter[] = {100, 1};
  for (const auto& brightness : {equal, muchBrighter}) {
    MapSchedule schedule;
    RayCounts counts;
    schedule.invalidate(poses, {brightness, 2}, DirtyRegion(std::span(&box, 1)), nothing, kResolution, 0, 1, 0, counts);
    ASSERT_EQ(schedule.waiting(), 2u);
    EXPECT_EQ(slotsOf(schedule.take({}, {brightness, 2}, kResolution, 1)),
              std::vector<uint32_t>{brightness == equal ? 1u : 0u});
  }
}

TEST(MapSchedule, NoMapWaitsForEverAndTheBudgetHolds) {
  constexpr size_t kSlots = 64;
  constexpr int64_t kBudget = 2 * kMap; // 8 coarse maps
  std::vector<float> brightness;        // over ten decades, and some that bring next to nothing
  for (size_t i = 0; i < kSlots; ++i) brightness.push_back(i % 8 == 7 ? 1e-20f : std::pow(10.0f, -float(i % 11)));
  MapSchedule schedule;
  std::vector<int> drawn(kSlots, 0), since(kSlots, 0);
  int longest = 0;
  for (int frame = 0; frame < 200; ++frame) {
    schedule.invalidateAll(kSlots, kResolution);
    const std::vector<MapJob> jobs = schedule.take({}, brightness, kResolution, kBudget);
    int64_t texels = 0;
    for (int& s : since) ++s;
    for (const MapJob& job : jobs) {
      texels += texelsTraced(job.texels, job.step);
      ++drawn[job.slot];
      longest = std::max(longest, since[job.slot]);
      since[job.slot] = 0;
    }
    EXPECT_GE(texels, kBudget);
    EXPECT_LT(texels, kBudget + kMap);
    EXPECT_EQ(schedule.waiting(), kSlots) << "all were drawn coarsely at best";
  }
  EXPECT_GE(*std::min_element(drawn.begin(), drawn.end()), 2);
  EXPECT_LE(longest, 100);
  // Frames between turns go with 1/√brightness: of the lights of 1, 0.1 and 0.01.
  const auto turns = [&](size_t decade) {
    double sum = 0;
    int count = 0;
    for (size_t i = 0; i < kSlots; ++i)
      if (i % 8 != 7 && i % 11 == decade) sum += drawn[i], ++count;
    return sum / count;
  };
  EXPECT_GT(turns(0), 2 * turns(1));
  EXPECT_GT(turns(1), 1.5 * turns(2));
}

TEST(MapSchedule, TheSameForAnyNumberOfThreads) {
  const AnalyticQuery nothing;
  Rng rng(5, Stream::Test, 0);
  std::vector<MapPose> poses;
  for (int i = 0; i < 300; ++i) poses.push_back(randomPose(rng));
  const std::vector<float> brightness(poses.size(), 1.0f);
  std::vector<Aabb> boxes;
  for (int i = 0; i < 20; ++i) boxes.push_back(boxAround(4.0f * sampleSphere(rng.next2()), vec3(0.4f)));
  const auto run = [&] {
    MapSchedule schedule;
    RayCounts counts;
    schedule.invalidate(poses, brightness, DirtyRegion(boxes), nothing, kResolution, 8, 1, 0, counts);
    return schedule.take({}, brightness, kResolution, 100 * kMap);
  };
  const std::vector<MapJob> many = run();
  setThreadCount(1);
  const std::vector<MapJob> one = run();
  setThreadCount(0);
  ASSERT_EQ(many.size(), one.size());
  for (size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(many[i].slot, one[i].slot);
    EXPECT_EQ(many[i].texels, one[i].texels);
  }
}

/// All lights ride on walls that move, as in a lift.
TEST_F(MapScheduleTest, LightsThatRideKeepToTheBudgetToo) {
  Room room;
  room.scene.lamp(vec3(0.5f, 0.7f, 0.4f), vec3(2));
  room.scene.size(32, 24);
  Settings settings;
  settings.smc = {.vpls = 256, .moves = 0, .warmup = 4};
  settings.shadow = {.resolution = 32, .maker = ShadowMaker::Rays, .refresh = 4};
  Viewer gi(settings);
  gi.run(room.scene.view());
  uint64_t most = 0;
  for (int frame = 0; frame < 4; ++frame) {
    const vec4 step(0, 0.01f, 0, 0);
    room.scene.move(0, vec3(step));
    room.scene.lights[0].position += vec3(step);
    room.scene.camera.worldFromView[3] += step;
    const FrameStats& stats = gi.run(room.scene.view({false, true, true, true, false}));
    EXPECT_GT(stats.vplsAlive, 200u);
    EXPECT_GT(stats.mapsWaiting, 200u) << "or nothing rode";
    most = std::max(most, stats.mapTexelsDrawn);
  }
  EXPECT_GT(most, 0u);
  EXPECT_LE(most, 5u * 32 * 32); // the last map may pass the budget
}

/// A room whose lights have maps, seen by a viewer of its own for each way to draw the first ones.
class FirstMapsTest : public MapScheduleTest {
 protected:
  FirstMapsTest() {
    lit.scene.lamp(vec3(0.5f, 0.7f, 0.4f), vec3(2));
    lit.scene.size(32, 24);
    settings.smc = {.vpls = 256, .moves = 0, .warmup = 4};
    settings.shadow = {.resolution = 32, .maker = ShadowMaker::Rays, .refresh = 64};
    settings.history.frames = 1;
  }
  uint32_t waitingAtFirst(float rayWork = 0) {
    Viewer gi(settings);
    SceneView view = lit.scene.view();
    view.rayWork = rayWork;
    const FrameStats& stats = gi.run(view);
    EXPECT_GT(stats.vplsAlive, 50u);
    return stats.mapsWaiting;
  }
  Room lit;
  Settings settings;
};

/// Coarse at first, all whole some frames later, and then as if they had been.
TEST_F(FirstMapsTest, BecomeWhole) {
  settings.shadow.firstMaps = FirstMaps::Whole;
  Viewer whole(settings);
  EXPECT_EQ(whole.run(lit.scene.view()).mapsWaiting, 0u);
  const Image right = whole.read(Buffer::Irradiance);
  double before = 0;
  for (const FirstMaps first : {FirstMaps::Half, FirstMaps::Quarter}) {
    settings.shadow.firstMaps = first;
    Viewer coarse(settings);
    const FrameStats& stats = coarse.run(lit.scene.view());
    EXPECT_GT(stats.vplsAlive, 200u);
    EXPECT_EQ(stats.mapsWaiting, stats.vplsAlive);
    EXPECT_EQ(stats.mapTexelsDrawn, stats.vplsAlive * (first == FirstMaps::Half ? 256u : 64u));
    const double off = relativeDifference(coarse.read(Buffer::Irradiance), right);
    std::printf("a first frame's irradiance is off by %.2f %%\n", 100 * off);
    EXPECT_GT(off, before);
    EXPECT_LT(off, first == FirstMaps::Half ? 0.15 : 0.4); // of maps that have 16 and 8 texels a side
    before = off;
    int frames = 0;
    for (; frames < 8 && stats.mapsWaiting > 0; ++frames) coarse.run(lit.scene.view(kStill));
    EXPECT_EQ(frames, first == FirstMaps::Half ? 4 : 5); // of a quarter, all with half the rays a side before
    EXPECT_EQ(coarse.read(Buffer::Irradiance).pixels, right.pixels);
  }
}

TEST_F(FirstMapsTest, AreCoarseWhereRaysAreSlow) {
  EXPECT_EQ(waitingAtFirst(12), 0u);
  EXPECT_GT(waitingAtFirst(12.1f), 0u);
}

TEST_F(FirstMapsTest, AreWholeWhereNoneWouldFollow) {
  settings.shadow.firstMaps = FirstMaps::Quarter;
  EXPECT_GT(waitingAtFirst(), 0u);
  settings.shadow.refresh = 0;
  EXPECT_EQ(waitingAtFirst(), 0u);
  settings.shadow.refresh = 64;
  settings.effects[EffectId::MapRefresh] = EffectMode::Off;
  EXPECT_EQ(waitingAtFirst(), 0u);
}

/// Maps of another resolution follow good ones: they are not a scene's first.
TEST_F(FirstMapsTest, AreThoseOfAnotherScene) {
  settings.shadow.firstMaps = FirstMaps::Quarter;
  Viewer gi(settings);
  const FrameStats& stats = gi.run(lit.scene.view());
  while (stats.mapsWaiting > 0) gi.run(lit.scene.view(kStill));
  gi.settings().shadow.resolution = 16;
  gi.run(lit.scene.view(kStill));
  EXPECT_EQ(stats.mapsWaiting, 0u);
}

/// The GPU draws whole maps, so none has to follow.
TEST_F(FirstMapsTest, AreWholeByRaster) {
  settings.shadow.firstMaps = FirstMaps::Quarter;
  settings.shadow.maker = ShadowMaker::Raster;
  EXPECT_EQ(waitingAtFirst(), 0u);
}

} // namespace lambent::test::map_schedule_test

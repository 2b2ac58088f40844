// Light at points that no image shows, against the path tracer.
#include "engine/core/rng.h"
#include "frames.h"
#include "gi/reference/path_tracer.h"

namespace lambent::test::points_test {

using PointsTest = GlTest;
constexpr uint32_t kSamples = 512; // paths from each point

TEST_F(PointsTest, AThousandPointsHaveTheLightOfThePathTracer) {
  Room room;
  room.scene.size(48, 32);
  room.scene.lamp(vec3(0.5f, 0.7f, 0.4f), vec3(2));
  Settings settings;
  settings.smc.vpls = 1024;
  settings.smc.warmup = 20;
  Viewer gi(settings);
  gi.run(room.scene.view());
  const TracedScene traced(room.scene);
  // Anywhere in the room's air, facing anywhere: what is drawn forward does not stand on surfaces.
  std::vector<SurfaceHit> points;
  const Aabb box = traced.view.boundsWorld;
  for (uint32_t i = 0; points.size() < 1000; ++i) {
    Rng rng(5, Stream::NearLight, i);
    SurfaceHit& h = points.emplace_back();
    h.t = 0;
    h.position = box.lo + (0.05f + 0.9f * rng.next3()) * box.size();
    h.normal = h.geometricNormal = sampleSphere({rng.next(), rng.next()});
  }
  const auto meanOf = [](const std::vector<vec3>& values) {
    double sum = 0;
    for (const vec3& v : values) sum += double(luminance(v)) / double(values.size());
    return sum;
  };
  // gi/reference, as at the pixels of an image.
  const CameraView camera;
  RayCounts counts;
  std::vector<vec3> truth, direct;
  for (const PixelSums& s : sampleSurfaces(
           points, {.rays = traced.rays, .lights = traced.lights, .camera = camera, .bounces = settings.smc.bounces},
           kSamples, counts)) {
    truth.push_back(kPi * vec3(s.indirect / double(kSamples)));
    direct.push_back(kPi * vec3(s.direct / double(kSamples)));
  }
  const double expected = meanOf(truth);
  const double indirect = meanOf(gi.gi().indirectAt(points));
  std::printf("1000 points: indirect %+.2f %% of paths, direct %+.2f %%\n", 100 * (indirect / expected - 1),
              100 * (meanOf(gi.gi().directAt(points)) / meanOf(direct) - 1));
  EXPECT_NEAR(indirect / expected, 1, 0.02);
  // Of single points: against the mean of all, as dark ones have large ratios. A part of it is the paths' own noise.
  std::vector<double> off;
  const std::vector<vec3> found = gi.gi().indirectAt(points);
  for (size_t i = 0; i < points.size(); ++i)
    off.push_back(std::abs(double(luminance(found[i]) - luminance(truth[i]))) / expected);
  std::ranges::sort(off);
  std::printf("off by %.3f of the mean at the median point, %.3f at the 95th of 100\n", off[500], off[950]);
  EXPECT_LT(off[500], 0.05);
  EXPECT_LT(off[950], 0.25);
  // The lamp is known by hand where nothing stands between.
  SurfaceHit below;
  below.t = 0;
  below.position = {0.5f, 0.2f, 0.4f};
  below.normal = below.geometricNormal = {0, 1, 0};
  EXPECT_NEAR(gi.gi().directAt({&below, 1})[0].y, 2 / 0.25, 0.02);
  EXPECT_NEAR(meanOf(gi.gi().directAt(points)) / meanOf(direct), 1, 0.02);
}

} // namespace lambent::test::points_test

// The measuring engine on runners that draw nothing: whose turn it is, what counts, what comes back.
#include "engine/core/error.h"
#include "gi/measure/runs/runs.h"

#include "tests/support/test.h"

namespace lambent::test::runs_test {

/// In which order who ran which frame, and who lives.
struct Diary {
  std::string turns;
  std::vector<bool> first; // SceneChanges::first of each turn
  int alive = 0, mostAlive = 0;
};

/// In frame f its gather takes `scale`·(f+1) ms.
class Clerk final : public Runner {
 public:
  Clerk(Diary& diary, const Variant& v) : diary_(diary), name_(v.name), scale_(v.seed) {
    diary_.mostAlive = std::max(diary_.mostAlive, ++diary_.alive);
  }
  ~Clerk() override { --diary_.alive; }

  const FrameStats& run(const SceneView& view) override {
    diary_.turns += name_;
    diary_.first.push_back(view.changes.first);
    stats_.stages = {{key(StageId::Gather), scale_ * (view.time + 1), 0}};
    if (view.time == 3) stats_.stages.push_back({key(StageId::Filter), 7, 9});
    stats_.wallMs = 100 - view.time;
    return stats_;
  }
  Image image(Buffer) const override { return Image(1, 1, vec3(float(stats_.wallMs))); }
  float exposure() const override { return 2; }
  std::vector<TrackedValue> at(std::span<const vec2> points) const override {
    std::vector<TrackedValue> out;
    for (const vec2& p : points) out.push_back({vec3(p.x * float(stats_.wallMs)), vec3(0)});
    return out;
  }

 private:
  Diary& diary_;
  std::string name_;
  double scale_;
  FrameStats stats_;
};

class RunsTest : public ::testing::Test {
 protected:
  std::vector<Variant> variants(const std::string& names) {
    std::vector<Variant> out;
    for (char name : names)
      out.push_back({std::string(1, name), {}, uint32_t(out.size() + 1), [this](const Variant& v) {
                       return std::make_unique<Clerk>(diary, v);
                     }});
    return out;
  }
  RunPlan plan(int frames) {
    return {.view =
                [](int frame) {
                  SceneView view;
                  view.time = frame;
                  view.changes.first = false;
                  return view;
                },
            .frames = frames};
  }

  Diary diary;
};

TEST_F(RunsTest, WhoBeginsAFrameIsNotTheOneWhoBeganTheLast) {
  measure(variants("abc"), plan(4));
  EXPECT_EQ(diary.turns, "abc"
                         "bca"
                         "cab"
                         "abc");
  EXPECT_EQ(diary.mostAlive, 3);
  EXPECT_EQ(diary.alive, 0);
}

TEST_F(RunsTest, OneAfterTheOtherOnlyOneLives) {
  RunPlan p = plan(3);
  p.inTurn = false;
  measure(variants("ab"), p);
  EXPECT_EQ(diary.turns, "aaabbb");
  EXPECT_EQ(diary.mostAlive, 1);
  EXPECT_EQ(diary.first, std::vector<bool>({true, false, false, true, false, false})); // each starts from nothing
}

TEST_F(RunsTest, FramesThatAreSkippedDoNotCount) {
  RunPlan p = plan(5);
  p.skip = 2;
  const std::vector<Measured> m = measure(variants("ab"), p);
  ASSERT_EQ(m.size(), 2u);
  EXPECT_EQ(m[1].variant.name, "b");
  EXPECT_EQ(m[1].frames.size(), 3u);
  const Spread gather = m[1].ms(StageId::Gather); // 2·3, 2·4, 2·5
  EXPECT_EQ(gather.least, 6);
  EXPECT_EQ(gather.median, 8);
  EXPECT_EQ(gather.most, 10);
  EXPECT_EQ(m[0].ms(StageId::Gather).median, 4);
  EXPECT_EQ(m[0].of([](const FrameStats& s) { return s.wallMs; }).median, 97);
}

TEST_F(RunsTest, AStageCountsInTheFramesInWhichItRan) {
  const Measured m = measure(variants("a"), plan(6))[0];
  EXPECT_EQ(m.ms(StageId::Filter).count, 1u);
  EXPECT_EQ(m.ms(StageId::Filter).median, 9); // the longer of CPU and GPU
  EXPECT_EQ(m.ms(StageId::Splat).count, 0u);
  EXPECT_EQ(m.stages(), std::vector<StageId>({StageId::Gather, StageId::Filter}));
}

TEST_F(RunsTest, PointsAreReadInEveryFrameAndThePictureAfterTheLast) {
  RunPlan p = plan(3);
  const std::vector<vec2> points{{1, 0}, {0.5f, 0}};
  p.skip = 1;
  p.points = points;
  p.buffer = Buffer::Indirect;
  const Measured m = measure(variants("ab"), p)[1];
  ASSERT_EQ(m.series.size(), 3u);
  EXPECT_EQ(m.series[0][0].radiance.x, 100);
  EXPECT_EQ(m.series[2][1].radiance.x, 49);
  EXPECT_EQ(m.image.at(0, 0).x, 98);
  EXPECT_EQ(m.exposure, 2);
}

TEST_F(RunsTest, CancelledItEndsAndGivesNothing) {
  RunPlan p = plan(10);
  int asked = 0, told = 0, all = 0;
  p.cancelled = [&] { return ++asked > 5; };
  p.progress = [&](int done, int total) { told = done, all = total; };
  EXPECT_THROW(measure(variants("ab"), p), RunError);
  EXPECT_EQ(diary.turns, "abbaa");
  EXPECT_EQ(told, 5);
  EXPECT_EQ(all, 20);
  EXPECT_EQ(diary.alive, 0);
}

} // namespace lambent::test::runs_test

// The governor against simulated machines: what a frame costs is a constant, pixels, virtual lights, and noise.
#include "gi/plan/governor.h"

#include "tests/support/test.h"

namespace lambent::test::governor_test {

struct Machine {
  double constant = 4, pixels = 20, lights = 6; // ms of a frame at scale 1, with the default's lights
  double load = 1;                              // on all of it: another program
  double noise = 0.05;                          // relative standard deviation
  uint32_t seed = 1;

  double ms(const Governed& g, int frame) const {
    Rng random(seed, Stream::Test, 0, uint32_t(frame));
    // Twelve uniform numbers make a normal one.
    double normal = -6;
    for (int i = 0; i < 12; ++i) normal += double(random.next());
    const double lightsNow = double(g.settings.smc.vpls) / SmcSettings{}.vpls;
    return load * (constant + pixels * double(g.scale) * double(g.scale) + lights * lightsNow) * (1 + noise * normal);
  }
};

/// Runs for so many seconds of simulated time; what each frame took, and where the scale changed.
struct Trace {
  std::vector<double> ms, at; // at: seconds at which the frame began
  std::vector<double> changes;

  double meanAfter(double from) const {
    double sum = 0, count = 0;
    for (size_t i = 0; i < ms.size(); ++i)
      if (at[i] >= from) sum += ms[i], count += 1;
    return sum / count;
  }
  size_t changesAfter(double from) const {
    return size_t(std::ranges::count_if(changes, [&](double t) { return t >= from; }));
  }
};

Trace run(Governed& g, const Machine& machine, double targetMs, double seconds, int firstFrame = 0) {
  Trace trace;
  double time = 0;
  for (int frame = firstFrame; time < seconds; ++frame) {
    const double ms = machine.ms(g, frame);
    trace.ms.push_back(ms), trace.at.push_back(time);
    time += ms / 1000;
    const Governed before = g;
    g = governed(std::move(g), ms, targetMs);
    EXPECT_TRUE(!before.calibrated || g.settings == before.settings) << "another preset while frames run";
    if (g.scale != before.scale) trace.changes.push_back(time);
    EXPECT_FALSE(g.pace == Pace::TooSlow && before.scale > GovernorGains{}.least) << "a smaller image is left";
    EXPECT_FALSE(g.pace == Pace::Idle && before.scale < 1) << "a larger image is left";
  }
  return trace;
}

constexpr double kTarget = 16.7;
constexpr uint32_t kSeeds = 40;

void expectSettled(const Trace& trace, double targetMs, double after = 1) {
  EXPECT_NEAR(trace.meanAfter(after), targetMs, 0.2 * targetMs);
  EXPECT_LE(trace.changesAfter(after), 1u);
}

TEST(Governor, ReturnsToTheTargetWithinASecondAndStays) {
  for (double target : {kTarget, 33.0})
    for (uint32_t seed = 1; seed <= kSeeds; ++seed) {
      SCOPED_TRACE(seed);
      Machine machine{0.15 * target, target, 0.03 * target, 1, 0.05, seed};
      Governed g;
      expectSettled(run(g, machine, target, 12, 0), target);
      machine.pixels *= 2; // the window doubled
      expectSettled(run(g, machine, target, 12, 10000), target);
      machine.load = 1.7; // another program takes a core
      expectSettled(run(g, machine, target, 12, 20000), target, 1.2);
      machine.load = 1, machine.pixels /= 2; // all of it passes
      expectSettled(run(g, machine, target, 12, 30000), target);
      machine.constant += 0.2 * target; // lamps with shadows
      expectSettled(run(g, machine, target, 12, 40000), target);
    }
}

TEST(Governor, DoesNotOscillateWhateverTheCostIsMadeOf) {
  for (double constant : {0.0, 4.0, 12.0})
    for (double pixels : {8.0, 40.0, 200.0})
      for (uint32_t seed = 1; seed <= 10; ++seed) {
        SCOPED_TRACE(testing::Message() << constant << " " << pixels << " " << seed);
        Governed g;
        const Trace trace = run(g, {constant, pixels, 0.5, 1, 0.08, seed}, kTarget, 20);
        EXPECT_LE(trace.changesAfter(3), 1u);
      }
}

TEST(Governor, SaysWhatCannotBeReached) {
  Governed slow;
  run(slow, {.pixels = 2000}, kTarget, 60);
  EXPECT_EQ(slow.scale, GovernorGains{}.least);
  EXPECT_EQ(slow.preset, presetTable().front().name);
  EXPECT_EQ(slow.pace, Pace::TooSlow);
  Governed fast;
  run(fast, {0.1, 0.5, 0.2}, kTarget, 5);
  EXPECT_EQ(fast.scale, 1);
  EXPECT_EQ(fast.preset, presetTable().back().name);
  EXPECT_EQ(fast.pace, Pace::Idle);
  Governed can;
  run(can, {}, kTarget, 3);
  run(can, {.load = 2}, kTarget, 5, 1000);
  EXPECT_EQ(can.pace, Pace::Holding);
}

TEST(Governor, LooksAwayWhileFramesWarmUp) {
  Governed g;
  g.choosesPreset = false; // one dearer than the default would fit a smaller image
  for (int i = 0; i < GovernorGains{}.warmup; ++i) g = governed(std::move(g), 3000, kTarget);
  for (int i = 0; i < 50; ++i) g = governed(std::move(g), 0.93 * kTarget, kTarget);
  EXPECT_EQ(g.scale, 1);
}

TEST(Governor, ASingleSlowFrameChangesNothing) {
  Governed g;
  run(g, {.noise = 0}, kTarget, 3);
  const float scale = g.scale;
  for (int i = 0; i < 60; ++i) g = governed(std::move(g), i % 20 == 0 ? 200 : 0.95 * kTarget, kTarget);
  EXPECT_EQ(g.scale, scale);
}

TEST(Governor, LeavesThePresetToThePerson) {
  Governed g;
  g.choosesPreset = false;
  const Settings before = g.settings;
  run(g, {.pixels = 100}, kTarget, 3);
  EXPECT_TRUE(g.settings == before);
  EXPECT_EQ(g.preset, "");
  EXPECT_LT(g.scale, 0.7f);
}

TEST(Governor, LeavesWhatSomebodySetOtherwise) {
  Governed g;
  g.settings.smc.vpls = 777;
  const Settings before = g.settings;
  run(g, {.pixels = 100}, kTarget, 3);
  EXPECT_TRUE(g.settings == before);
}

/// A machine whose time grows with a preset as measured: each preset is chosen where the next is too dear.
TEST(Governor, ChoosesTheDearestPresetThatFits) {
  for (size_t i = 0; i < presetTable().size(); ++i) {
    // Of the default's frames: at the least easy scale preset i takes a little less than the target.
    const double easy = double(GovernorGains{}.easy);
    const double ms = 0.98 * GovernorGains{}.aim * kTarget / (easy * easy * presetTable()[i].time);
    Governed g;
    for (int frame = 0; frame < 20 && !g.calibrated; ++frame) g = governed(std::move(g), ms, kTarget);
    EXPECT_EQ(g.preset, presetTable()[i].name);
  }
}

TEST(Governor, IsAPureFunction) {
  Governed g;
  run(g, {.pixels = 60}, kTarget, 2);
  const Governed a = governed(g, 40, kTarget), b = governed(g, 40, kTarget);
  EXPECT_EQ(a.scale, b.scale);
  EXPECT_EQ(a.ms, b.ms);
  EXPECT_EQ(a.frames, b.frames);
}

} // namespace lambent::test::governor_test

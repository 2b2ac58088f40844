// Key frame interpolation against values worked out by hand, and what animate() does with a scene.

#include "tests/cpu/scene/support.h"

namespace lambent::test::animation_test {

constexpr float kHalfRoot2 = 0.70710678f;

AnimationChannel translation(Interpolation interpolation, std::vector<float> times, std::vector<vec4> values) {
  return {Entity(0, 0), ChannelPath::Translation, interpolation, std::move(times), std::move(values)};
}

TEST(SampleChannel, StepHoldsAndLinearMixes) {
  const std::vector<vec4> values = {{0, 0, 0, 0}, {4, 8, 0, 0}, {4, 0, 0, 0}};
  const auto step = translation(Interpolation::Step, {1, 2, 4}, values);
  const auto linear = translation(Interpolation::Linear, {1, 2, 4}, values);
  expectNear(vec3(sampleChannel(step, 1.9f)), {0, 0, 0});
  expectNear(vec3(sampleChannel(step, 2.0f)), {4, 8, 0});
  expectNear(vec3(sampleChannel(linear, 1.25f)), {1, 2, 0});
  expectNear(vec3(sampleChannel(linear, 3)), {4, 4, 0});
  for (const auto& channel : {step, linear}) { // held outside
    expectNear(vec3(sampleChannel(channel, -5)), {0, 0, 0});
    expectNear(vec3(sampleChannel(channel, 9)), {4, 0, 0});
  }
}

TEST(SampleChannel, CubicSplineFollowsHermite) {
  // In-tangent, value, out-tangent per key; tangents are per second, the span is two seconds.
  const auto channel =
      translation(Interpolation::CubicSpline, {0, 2},
                  {{9, 9, 9, 0}, {0, 0, 0, 0}, {1, 0, 2, 0}, {1, 0, -2, 0}, {2, 4, 0, 0}, {9, 9, 9, 0}});
  // x: tangent equal to the slope everywhere gives the straight line; y: zero tangents give the smooth step;
  // z: rises with 2, falls with 2: a parabola through 0 with height 1 in the middle.
  for (const float t : {0.0f, 0.5f, 1.0f, 1.5f, 2.0f}) {
    const float u = t / 2;
    expectNear(vec3(sampleChannel(channel, t)), {t, 4 * u * u * (3 - 2 * u), 4 * u * (1 - u)});
  }
}

TEST(SampleChannel, RotationsTakeTheShorterArcAndStayUnit) {
  AnimationChannel channel{Entity(0, 0), ChannelPath::Rotation, Interpolation::Linear, {0, 1}, {}};
  channel.values = {{0, 0, 0, 1}, {0, kHalfRoot2, 0, kHalfRoot2}}; // 90 degrees about Y
  const vec4 half = sampleChannel(channel, 0.5f);
  EXPECT_NEAR(half.y, std::sin(kPi / 8), 1e-5f);
  EXPECT_NEAR(half.w, std::cos(kPi / 8), 1e-5f);
  channel.values[1] = -channel.values[1]; // the same rotation
  EXPECT_NEAR(std::abs(glm::dot(sampleChannel(channel, 0.5f), half)), 1, 1e-5f);
  channel.values[1] = {0, 0, 0, 0}; // not a rotation: must not give NaN
  EXPECT_NEAR(glm::length(sampleChannel(channel, 1)), 1, 1e-5f);
}

TEST(SampleChannel, EqualKeysHoldToTheBit) {
  const vec4 place(5.2f, 0.9f, -0.4f, 0), turn = glm::normalize(vec4(0.3f, -0.2f, 0.7f, 0.4f)), none(0);
  const AnimationChannel channels[] = {
      translation(Interpolation::Linear, {0, 3}, {place, place}),
      translation(Interpolation::CubicSpline, {0, 3}, {none, place, none, none, place, none}),
      {Entity(0, 0), ChannelPath::Rotation, Interpolation::Linear, {0, 3}, {turn, turn}},
      {Entity(0, 0), ChannelPath::Rotation, Interpolation::Linear, {0, 3}, {turn, -turn}}}; // the same rotation
  for (const AnimationChannel& channel : channels)
    for (int frame = 0; frame < 90; ++frame)
      EXPECT_EQ(sampleChannel(channel, float(frame) / 30), sampleChannel(channel, 0)) << frame;
  const WeightsChannel weights{Entity(0, 0), Interpolation::Linear, 1, {0, 3}, {0.37f, 0.37f}};
  std::vector<float> now;
  for (int frame = 0; frame < 90; ++frame) {
    sampleChannel(weights, float(frame) / 30, now);
    EXPECT_EQ(now, std::vector<float>{0.37f}) << frame;
  }
}

TEST(SampleChannel, EqualTimesJump) {
  const auto channel = translation(Interpolation::Linear, {0, 1, 1, 2}, {vec4(0), vec4(1), vec4(5), vec4(6)});
  expectNear(vec3(sampleChannel(channel, 0.5f)), vec3(0.5f));
  expectNear(vec3(sampleChannel(channel, 1)), vec3(5));
}

TEST(Animate, ClipsLoopAndLeaveOtherPropertiesAtRest) {
  TemporaryFolder folder;
  GltfBuilder b = oneTriangle();
  b.json["nodes"][0]["name"] = "mover";
  b.json["nodes"][0]["scale"] = {2, 2, 2};
  const int times = b.floats({0, 2});
  b.animate(0, "translation", times, b.floats({0, 0, 0, 2, 0, 0}, "VEC3"));
  Scene scene = b.load(folder);
  ASSERT_EQ(scene.animations.size(), 1u);
  EXPECT_DOUBLE_EQ(scene.animations[0].duration, 2);
  const Entity mover = *findByName(scene, "mover");
  const auto at = [&](double time) {
    animate(scene, time);
    return vec3(scene.registry.get<WorldTransform>(mover).worldFromNode * vec4(1, 0, 0, 1));
  };
  expectNear(at(0.5), {2.5f, 0, 0}); // scaled by 2, moved by 0.5
  expectNear(at(2.5), {2.5f, 0, 0});
  expectNear(at(1000000.5), {2.5f, 0, 0}, 1e-3f);
  expectNear(at(-0.5), {3.5f, 0, 0});
  scene.registry.get<Transform>(mover).scale = vec3(100);
  expectNear(at(0.5), {2.5f, 0, 0}); // back to the rest pose
}

TEST(Animate, ScriptedMotionSpinsAndSwingsFromWhereItStands) {
  Scene scene;
  const Entity e = scene.registry.create();
  scene.registry.emplace<Transform>(e).translation = vec3(5, 0, 0);
  Motion motion;
  motion.spinSpeed = kPi / 2;
  motion.swing = vec3(0, 3, 0);
  motion.swingPeriod = 4;
  scene.registry.emplace<Motion>(e, motion);
  for (int repeat = 0; repeat < 2; ++repeat) { // the same time gives the same pose
    animate(scene, 1);
    const dmat4 world = scene.registry.get<WorldTransform>(e).worldFromNode;
    expectNear(vec3(world[3]), {5, 3, 0});  // a quarter of the swing
    expectNear(vec3(world[0]), {0, 0, -1}); // a quarter turn about +Y takes +X to -Z
  }
}

} // namespace lambent::test::animation_test

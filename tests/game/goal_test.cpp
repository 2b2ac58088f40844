// The thing that waits for light: what is measured on it, by closed forms, and that content/shrine takes a door and two
// boards.
#include "game/rules/goal.h"
#include "game/rules/movers.h"
#include "game/rules/shapes.h"
#include "game/rules/things.h"

#include "tests/support/test.h"

namespace lambent::test::goal_test {

constexpr float kFrame = 1.0f / 30;

float measured(Goal& goal, int passes = 32) {
  for (int i = 0; i < passes; ++i) goal.update();
  return goal.irradiance();
}

/// A plate under a sun, thin as paper: half of its surface faces up.
struct Plate {
  explicit Plate(const std::string& name = "plate, goal 0.5") {
    addInstance(scene, name, addBoxMesh(scene.assets, "plate", {1, 1e-4f, 1}, vec3(0.5f)), {});
    // Above and aside: in nobody's way until it is moved.
    roof = addInstance(scene, "roof", addBoxMesh(scene.assets, "roof", {1.5f, 0.1f, 1.5f}, vec3(0)), at({0, 1, 90}));
    addLight(scene, {.type = LightType::Directional, .direction = {0.6f, -0.8f, 0}, .intensity = vec3(5)}, "sun");
    goal = Goal::find(scene);
  }
  static Transform at(const dvec3& place) { return {.translation = place, .matrix = {}}; }
  void moveRoof(const dvec3& place) {
    scene.registry.get<Transform>(roof) = at(place);
    updateWorldTransforms(scene);
  }

  Scene scene;
  Entity roof;
  std::unique_ptr<Goal> goal;
};

constexpr float kHalfCosine = 0.5f * 5 * 0.8f; // W/m²: of both sides of the plate

TEST(Goal, IsANodeWhoseNameSaysHowMuchItWants) {
  const Plate plate;
  ASSERT_TRUE(plate.goal);
  EXPECT_EQ(plate.goal->what(), "plate");
  EXPECT_EQ(plate.goal->wanted(), 0.5f);
  for (const char* name : {"plate", "goal 1", "plate, goal", "plate, goal -1", "plate, goal 0", "plate, goal x",
                           "plate, goal inf", "plate, goal nan"})
    EXPECT_FALSE(Plate(name).goal) << name;
}

TEST(Goal, HasOfTheSunWhatTheCosineLeaves) {
  const Plate plate;
  EXPECT_NEAR(measured(*plate.goal), kHalfCosine, 1e-3f);
  EXPECT_LT(plate.goal->error(), 1e-3f);
}

TEST(Goal, HasOfASkyAllOfIt) {
  Plate plate;
  plate.scene.sky = Sky(vec3(2));
  plate.moveRoof({0, 1e4, 0});
  EXPECT_NEAR(measured(*plate.goal), kHalfCosine + 2 * kPi, 0.02f) << "from above and from below";
}

TEST(Goal, LampsDoNotCount) {
  Plate plate;
  LightView lamp{.position = {0, 1, 0}, .intensity = vec3(100)};
  addLight(plate.scene, lamp, "lamp");
  lamp.type = LightType::Spot;
  addLight(plate.scene, lamp, "torch");
  EXPECT_NEAR(measured(*plate.goal), kHalfCosine, 1e-3f);
}

TEST(Goal, ForgetsWhatWasBeforeAnythingMoved) {
  Plate plate;
  measured(*plate.goal, 100);
  plate.moveRoof({-0.75, 1, 0}); // whence the sun comes
  const float soon = measured(*plate.goal, 1);
  EXPECT_LT(soon, kHalfCosine);
  EXPECT_GT(soon, 0.1f) << "not at once: a number that flickers cannot be read";
  EXPECT_EQ(measured(*plate.goal), 0);
}

TEST(Goal, IsReachedForCertainOnceAndUntilTheStart) {
  Plate plate;
  measured(*plate.goal, 7);
  EXPECT_FALSE(plate.goal->reached()) << "too soon to be sure";
  measured(*plate.goal, 1);
  EXPECT_TRUE(plate.goal->reached());
  plate.moveRoof({-0.75, 1, 0});
  measured(*plate.goal);
  EXPECT_TRUE(plate.goal->reached());
  plate.goal->reset();
  EXPECT_FALSE(plate.goal->reached());
  measured(*plate.goal);
  EXPECT_FALSE(plate.goal->reached()) << "dark now";
}

/// content/shrine and somebody in it.
struct Shrine {
  Shrine() : scene(loadScene("content/shrine/shrine.gltf")), movers(scene), things(scene, 1.75f), solids(scene) {
    goal = Goal::find(scene);
  }
  void openDoor() {
    movers.use(findByName(scene, "door leaf")->id());
    for (float t = 0; t < 3; t += kFrame) movers.update(kFrame);
  }
  /// Puts down what somebody there carries who looks ahead.
  void put(ThingKind kind, const vec3& eye, const vec3& ahead) {
    solids.update();
    const Player player(lookAt(eye, eye + ahead, 1), worldBounds(scene));
    ASSERT_TRUE(things.take(kind, player));
    things.update(solids, player, kFrame);
    things.putDown();
    for (float t = 0; t < 2; t += kFrame) {
      solids.update();
      things.update(solids, player, kFrame);
    }
  }

  Scene scene;
  Movers movers;
  Things things;
  Solids solids;
  std::unique_ptr<Goal> goal;
};

const vec3 kBeforeDoor{0, 1.6f, 3}, kAtCorner{0.4f, 1.6f, -0.8f}, kNorthWest{-1, 0, -1};

TEST(Shrine, TakesADoorAndTwoBoards) {
  Shrine s;
  ASSERT_TRUE(s.goal);
  const float wanted = s.goal->wanted();
  EXPECT_EQ(measured(*s.goal), 0) << "the door lets no light through";
  s.openDoor();
  EXPECT_LT(measured(*s.goal), 0.1f * wanted) << "an open door is not enough";
  s.put(ThingKind::WhiteBoard, kBeforeDoor, {0, 0, -1});
  const float one = measured(*s.goal);
  EXPECT_GT(one, 0.3f * wanted) << "one board helps";
  EXPECT_LT(one, 0.8f * wanted) << "but not enough";
  EXPECT_FALSE(s.goal->reached());
  s.put(ThingKind::WhiteBoard, kAtCorner, kNorthWest);
  EXPECT_GT(measured(*s.goal), 1.3f * wanted);
  EXPECT_TRUE(s.goal->reached());
}

TEST(Shrine, BoardsCountOnlyWhereTheyHaveLight) {
  Shrine s;
  s.put(ThingKind::WhiteBoard, kBeforeDoor, {0, 0, -1});
  s.put(ThingKind::WhiteBoard, kAtCorner, kNorthWest);
  EXPECT_EQ(measured(*s.goal), 0) << "behind a shut door";
  Shrine open;
  open.openDoor();
  open.put(ThingKind::WhiteBoard, kAtCorner, kNorthWest);
  EXPECT_LT(measured(*open.goal), 0.2f * open.goal->wanted());
}

TEST(Shrine, NoLampReachesTheGoal) {
  Shrine s;
  s.things.lampIntensity = vec3(10);
  s.put(ThingKind::Lamp, {1.8f, 1.6f, -1.8f}, {1, 0, 0});
  EXPECT_EQ(s.things.count(), 1u);
  EXPECT_EQ(measured(*s.goal), 0);
}

TEST(Shrine, WhatIsCarriedCounts) {
  Shrine s;
  s.openDoor();
  s.put(ThingKind::WhiteBoard, kBeforeDoor, {0, 0, -1});
  const float one = measured(*s.goal);
  const Player player(lookAt(kAtCorner, kAtCorner + kNorthWest, 1), worldBounds(s.scene));
  s.things.take(ThingKind::WhiteBoard, player);
  s.things.update(s.solids, player, kFrame);
  EXPECT_GT(measured(*s.goal), 2 * one);
}

TEST(Shrine, IsMeasuredAlikeEveryTime) {
  float values[2];
  for (float& value : values) {
    Shrine s;
    s.openDoor();
    s.put(ThingKind::WhiteBoard, kBeforeDoor, {0, 0, -1});
    value = measured(*s.goal, 5);
    s.goal->reset();
    EXPECT_EQ(measured(*s.goal, 5), value);
  }
  EXPECT_EQ(values[0], values[1]);
  EXPECT_GT(values[0], 0);
}

} // namespace lambent::test::goal_test

// What is carried, thrown and put down: where it goes, and what it leaves behind. And what moves when it is used.
#include "game/rules/movers.h"
#include "game/rules/shapes.h"
#include "game/rules/things.h"

#include "tests/support/test.h"

namespace lambent::test::things_test {

constexpr float kFrame = 1.0f / 30;

CameraView cameraAt(const vec3& eye, const vec3& target) { return lookAt(eye, target, 1); }

/// A room of 8 × 3 × 8 m with a table, and somebody in it who looks along -Z.
class Room {
 public:
  Room() {
    box("floor", {-5, -0.5f, -5}, {5, 0, 5});
    box("north", {-5, 0, -5}, {5, 3, -4});
    box("south", {-5, 0, 4}, {5, 3, 5});
    box("west", {-5, 0, -5}, {-4, 3, 5});
    box("east", {4, 0, -5}, {5, 3, 5});
    table = box("table", {-1, 0, -3}, {1, 0.8f, -2});
    things.emplace(scene, 1.75f);
    solids.emplace(scene);
    player.emplace(cameraAt({0, 1.61f, 0}, {0, 1.61f, -1}), worldBounds(scene));
    player->home(solids->rays());
    run(0.2f);
  }
  Entity box(const std::string& name, const vec3& lo, const vec3& hi) {
    return addInstance(scene, name, addBoxMesh(scene.assets, name, 0.5f * (hi - lo), vec3(0.5f)),
                       {.translation = dvec3(0.5f * (lo + hi)), .matrix = {}});
  }
  void run(float seconds, const MoveInput& input = {}) {
    for (float t = 0; t < seconds; t += kFrame) {
      solids->update();
      player->move(solids->rays(), solids->view(), input, kFrame);
      things->update(*solids, *player, kFrame);
    }
  }
  std::optional<uint32_t> lookedAt() const {
    const SurfaceHit hit = solids->rays().closest(Ray{player->position(), player->forward(), 3});
    return hit.valid() ? std::optional(solids->view().instances[hit.instance].id) : std::nullopt;
  }

  Scene scene;
  Entity table;
  std::optional<Things> things;
  std::optional<Solids> solids;
  std::optional<Player> player;
};

TEST(Things, WhatIsPutDownFallsAndComesToRest) {
  Room room;
  ASSERT_TRUE(room.things->take(ThingKind::RedBox, *room.player));
  room.run(0.3f);
  EXPECT_TRUE(room.things->carries());
  EXPECT_LT(room.things->position(0).z, -0.8f) << "before the eyes";
  EXPECT_GT(room.things->position(0).y, 1);
  room.things->putDown();
  room.run(2);
  EXPECT_TRUE(room.things->resting(0));
  EXPECT_NEAR(room.things->position(0).y, 0.14f * 1.75f, 0.02f) << "on the floor";
  const vec3 before = room.things->position(0);
  room.run(1);
  EXPECT_EQ(room.things->position(0), before) << "and stays there to the bit, so that nothing is drawn anew";
}

TEST(Things, NothingThrownPassesAWallAndAllComesToRest) {
  Room room;
  for (int i = 0; i < 12; ++i) {
    MoveInput turn{.look = {1.1f, i % 3 == 0 ? 0.2f : -0.1f}};
    room.run(kFrame, turn);
    ASSERT_TRUE(room.things->take(ThingKind(i % int(kThingKinds)), *room.player));
    room.run(2 * kFrame);
    room.things->hurl(*room.player);
    room.run(0.1f);
  }
  room.run(5);
  for (size_t i = 0; i < room.things->count(); ++i) {
    const vec3 p = room.things->position(i);
    EXPECT_LT(std::max(std::abs(p.x), std::abs(p.z)), 4) << i;
    EXPECT_GT(p.y, 0) << i;
    EXPECT_TRUE(room.things->resting(i)) << i;
  }
}

TEST(Things, WhatIsCarriedIsInNobodysWayAndNotInWalls) {
  Room room;
  room.things->take(ThingKind::WhiteBoard, *room.player);
  MoveInput right{.look = {0.5f * kPi, 0}};
  room.run(kFrame, right);
  MoveInput ahead{.direction = {0, 0, -1}};
  room.run(4, ahead);
  EXPECT_NEAR(room.player->position().x, 4 - room.player->body().size().radius(), 0.05f);
  EXPECT_LT(room.things->position(0).x, 3.97f) << "its front is at the wall, not its middle";
  ASSERT_TRUE(room.lookedAt().has_value());
  EXPECT_FALSE(room.things->kindOf(*room.lookedAt()).has_value()) << "sees past what it carries";
}

TEST(Things, WhatRestsIsPickedUpAgainAndBearsAPerson) {
  Room room;
  room.things->take(ThingKind::BlueBox, *room.player);
  room.run(0.2f);
  room.things->putDown();
  room.run(1);
  MoveInput down{.look = {0, -0.86f}};
  room.run(kFrame, down);
  const auto seen = room.lookedAt();
  ASSERT_TRUE(seen && room.things->kindOf(*seen) == ThingKind::BlueBox);
  ASSERT_TRUE(room.things->pick(*seen, *room.player));
  room.run(0.2f);
  EXPECT_GT(room.things->position(0).y, 0.2f);
  room.things->putDown();
  room.run(1);
  MoveInput jump{.direction = {0, 0, -0.35f}};
  jump.jump = true;
  float highest = 0;
  for (int i = 0; i < 60; ++i) {
    room.run(kFrame, jump);
    if (room.player->body().grounded()) highest = std::max(highest, room.player->body().feet().y);
  }
  EXPECT_NEAR(highest, 0.49f, 0.02f) << "stood on the box";
}

TEST(Things, ALampShinesWhereItStandsAndGoesWithIt) {
  Room room;
  room.things->lampIntensity = {3, 2, 1};
  room.things->take(ThingKind::Lamp, *room.player);
  room.run(0.2f);
  SceneExtractor extractor;
  SceneView view = extractor.extract(room.scene, {}, 0);
  ASSERT_EQ(view.lights.size(), 1u);
  EXPECT_EQ(view.lights[0].intensity, vec3(3, 2, 1));
  EXPECT_NEAR(glm::distance(view.lights[0].position, room.things->position(0)), 0.235f, 0.01f);
  EXPECT_FALSE(room.solids->rays().occluded(Ray{view.lights[0].position, {0, 1, 0}, 1})) << "above its stand";
  room.things->removeCarried();
  view = extractor.extract(room.scene, {}, 0);
  EXPECT_TRUE(view.lights.empty());
  EXPECT_EQ(room.things->count(), 0u);
}

TEST(Things, OfBoxesEveryKindIsOfferedOnce) {
  Room room;
  room.things->take(ThingKind::WhiteBoard, *room.player);
  size_t kinds = 0;
  for (; room.things->carries(); ++kinds) room.things->exchangeCarried(*room.player);
  EXPECT_EQ(kinds, kThingKinds - 1);
  EXPECT_EQ(room.things->count(), 0u);
}

TEST(Things, TheirNumberIsBounded) {
  Room room;
  for (size_t i = 0; i < Things::kMost; ++i) ASSERT_TRUE(room.things->take(ThingKind::WhiteBox, *room.player));
  EXPECT_FALSE(room.things->take(ThingKind::WhiteBox, *room.player));
  EXPECT_EQ(room.things->count(), Things::kMost);
}

/// A door leaf in a doorway, as content/door names it.
class MoversTest : public testing::Test {
 protected:
  MoversTest() {
    Transform at;
    at.translation = {0.5, 0, 0};
    door_ = addInstance(scene_, "door leaf", addBoxMesh(scene_.assets, "leaf", {0.5f, 1, 0.03f}, vec3(0.5f)), at);
    at.translation = {-1.5, 0.15, 0};
    cabin_ = addInstance(scene_, "cabin", addBoxMesh(scene_.assets, "cabin", {0.8f, 0.1f, 0.8f}, vec3(0.5f)), at);
  }
  double height() const { return scene_.registry.get<WorldTransform>(cabin_).worldFromNode[3].y; }
  float angle() const {
    const dvec3 x(scene_.registry.get<WorldTransform>(door_).worldFromNode[0]);
    return float(std::atan2(-x.z, x.x));
  }
  uint32_t buttonWith(const Movers& movers, const std::string& offer) const {
    uint32_t found = kNone;
    scene_.registry.each<Name>([&](Entity e, const Name& n) {
      if (n.value == "button" && movers.offer(e.id()) == offer) found = e.id();
    });
    return found;
  }
  Scene scene_;
  Entity door_, cabin_;
};

TEST_F(MoversTest, ADoorOpensAndShutsWithoutAJump) {
  Movers movers(scene_);
  EXPECT_EQ(movers.offer(door_.id()), "open the door");
  EXPECT_EQ(movers.offer(12345), "");
  EXPECT_FALSE(movers.use(12345));
  ASSERT_TRUE(movers.use(door_.id()));
  EXPECT_EQ(movers.offer(door_.id()), "shut the door");
  float before = angle(), most = 0;
  double seconds = 0;
  for (; movers.update(kFrame) || seconds < 0.1; seconds += kFrame) {
    most = std::max(most, std::abs(angle() - before));
    before = angle();
    ASSERT_LT(seconds, 5);
  }
  EXPECT_NEAR(angle(), kPi / 2, 1e-3f);
  EXPECT_GT(seconds, 0.8);
  EXPECT_LT(most, 0.08f) << "radians per frame";
  movers.use(door_.id());
  for (int i = 0; i < 15; ++i) movers.update(kFrame);
  const float halfway = angle();
  EXPECT_LT(halfway, kPi / 2 - 0.2f);
  movers.turnBack(); // somebody stands there
  for (int i = 0; i < 90; ++i) movers.update(kFrame);
  EXPECT_NEAR(angle(), kPi / 2, 1e-3f);
}

TEST_F(MoversTest, ALiftGoesToTheStoreyThatCallsItAndItsRidersToTheNext) {
  Movers movers(scene_);
  const uint32_t call = buttonWith(movers, "call the lift"),
                 inside = buttonWith(movers, "send the lift to the next storey");
  ASSERT_NE(call, kNone); // the last of them: the highest storey's
  ASSERT_NE(inside, kNone);
  const auto settle = [&] {
    for (int i = 0; i < 300; ++i) movers.update(kFrame);
  };
  ASSERT_TRUE(movers.use(inside));
  settle();
  EXPECT_NEAR(height(), 3.12, 1e-3);
  ASSERT_TRUE(movers.use(call));
  settle();
  EXPECT_NEAR(height(), 6.12, 1e-3);
  ASSERT_TRUE(movers.use(inside)) << "its button rides along";
  settle();
  EXPECT_NEAR(height(), 0.12, 1e-3);
  movers.use(inside);
  movers.update(0.5);
  movers.reset();
  updateWorldTransforms(scene_);
  EXPECT_NEAR(height(), 0.15, 1e-6) << "as in the file";
}

TEST_F(MoversTest, TheFrameRateChangesNoWayAndNobodyTouchesWhatIsNotUsed) {
  double at[2];
  for (int i = 0; i < 2; ++i) {
    Movers movers(scene_);
    movers.use(cabin_.id());
    const double frame = i ? 0.2 : 1.0 / 120;
    for (double t = 0; t < 1.2 - 1e-9; t += frame) movers.update(frame);
    at[i] = movers.place("cabin");
    movers.reset();
  }
  EXPECT_NEAR(at[0], at[1], 2e-3);
  EXPECT_GT(at[0], 0.1);
  Movers movers(scene_);
  scene_.registry.get<Transform>(cabin_).translation.y = 2; // a shot moves it
  movers.update(kFrame);
  EXPECT_NEAR(height(), 2, 1e-9);
}

} // namespace lambent::test::things_test

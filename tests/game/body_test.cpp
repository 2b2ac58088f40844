// A body among boxes: what it may pass, where it comes to stand, and what moves it.
#include "game/rules/player.h"

#include "engine/core/rng.h"
#include "engine/trace/analytic_query.h"
#include "engine/trace/embree_query.h"
#include "tests/support/hand_scene.h"

namespace lambent::test::body_test {

constexpr float kFrame = 1.0f / 30;

/// Boxes in a closed room of 10 × 4 × 10 m around the origin, its floor at y = 0.
class Room {
 public:
  Room() {
    box({-6, -1, -6}, {6, 0, 6});
    box({-6, 4, -6}, {6, 5, 6});
    box({-6, -1, -6}, {-5, 5, 6});
    box({5, -1, -6}, {6, 5, 6});
    box({-6, -1, -6}, {6, 5, -5});
    box({-6, -1, 5}, {6, 5, 6});
  }
  void box(const vec3& lo, const vec3& hi) { rays.addBox(lo, hi, {}); }

  AnalyticQuery rays;
};

Body standing(const RayQuery& rays, const vec3& feet, const BodySize& size = {}) {
  Body body(size);
  EXPECT_TRUE(body.stand(rays, feet + vec3(0, size.eye(), 0)));
  body.move(rays, {}, {}, kFrame);
  EXPECT_TRUE(body.grounded());
  return body;
}

void walk(Body& body, const RayQuery& rays, const vec3& velocity, float seconds, float frame = kFrame) {
  for (float t = 0; t < seconds - 0.5f * frame; t += frame) body.move(rays, {}, {velocity}, frame);
}

/// Jumps, and goes on for so many frames; the highest that its feet were.
float jump(Body& body, const RayQuery& rays, const vec3& velocity, int frames) {
  float highest = 0;
  for (int i = 0; i < frames; ++i) {
    body.move(rays, {}, {velocity, i == 0}, kFrame);
    highest = std::max(highest, body.feet().y);
  }
  return highest;
}

TEST(Body, FallsToTheFloorAndStands) {
  const Room room;
  Body body;
  body.place({0, 3.5f, 0});
  EXPECT_FALSE(body.grounded());
  float seconds = 0;
  for (; !body.grounded() && seconds < 3; seconds += kFrame) body.move(room.rays, {}, {}, kFrame);
  const float height = 3.5f - body.size().eye();
  EXPECT_NEAR(seconds, std::sqrt(2 * height / body.size().gravity()), 1.1f * kFrame);
  EXPECT_NEAR(body.feet().y, 0, 1e-4f);
  EXPECT_NEAR(body.eye().y, body.size().eye(), 1e-3f);
}

TEST(Body, StopsAWallsRadiusOffAndSlidesAlongIt) {
  const Room room;
  Body body = standing(room.rays, {0, 0, 0});
  walk(body, room.rays, {3, 0, 0}, 4);
  EXPECT_NEAR(body.feet().x, 5 - body.size().radius(), 0.03f * body.size().radius());
  EXPECT_NEAR(body.feet().z, 0, 1e-4f);
  walk(body, room.rays, {2, 0, 1}, 2);
  EXPECT_NEAR(body.feet().x, 5 - body.size().radius(), 0.03f * body.size().radius());
  EXPECT_NEAR(body.feet().z, 2, 0.05f);
}

TEST(Body, GoesAsFarInFewFramesAsInMany) {
  const Room room;
  for (const float frame : {1.0f / 144, 1.0f / 30, 1.0f / 4}) {
    Body body = standing(room.rays, {-4, 0, 0});
    walk(body, room.rays, {2, 0, 0.5f}, 3, frame);
    EXPECT_NEAR(body.feet().x, 2, 0.02f) << "frames of " << frame << " s";
    EXPECT_NEAR(body.feet().z, 1.5f, 0.02f);
  }
}

TEST(Body, ClimbsStairsUpAndDownButNoWallOfAThirdOfItsHeight) {
  Room room;
  for (int i = 0; i < 8; ++i) room.box({0.3f * float(i), -0.5f, -1}, {3, 0.18f * float(i + 1), 1}); // to 1.44 m
  room.box({-4, -0.5f, -1}, {-3, 0.6f, 1});
  Body body = standing(room.rays, {-1, 0, 0});
  walk(body, room.rays, {1.5f, 0, 0}, 2.3f);
  EXPECT_NEAR(body.feet().y, 1.44f, 0.01f);
  EXPECT_NEAR(body.feet().x, 2.45f, 0.1f) << "stairs slow nobody down";
  bool fell = false;
  for (int i = 0; i < 60; ++i) {
    body.move(room.rays, {}, {{-1.5f, 0, 0}}, kFrame);
    fell |= !body.grounded();
  }
  EXPECT_NEAR(body.feet().y, 0, 0.01f);
  EXPECT_FALSE(fell) << "down stairs on foot";
  walk(body, room.rays, {-1.5f, 0, 0}, 4);
  EXPECT_GT(body.feet().x, -3) << "before the wall";
  EXPECT_NEAR(body.feet().y, 0, 0.01f);
}

TEST(Body, JumpsOntoWhatItCannotStepOnto) {
  Room room;
  room.box({1, -0.5f, -5}, {5, 0.5f, 5});
  Body body = standing(room.rays, {0, 0, 0});
  walk(body, room.rays, {2, 0, 0}, 1);
  EXPECT_LT(body.feet().x, 1);
  EXPECT_NEAR(jump(body, room.rays, {2, 0, 0}, 60), body.size().jump(), 0.02f);
  EXPECT_NEAR(body.feet().y, 0.5f, 0.01f);
  EXPECT_GT(body.feet().x, 2);
}

TEST(Body, HitsItsHeadAndGoesUnderNothingTooLow) {
  Room room;
  room.box({1, 1.5f, -5}, {5, 3, 5});
  room.box({-5, 1.9f, -5}, {-1, 3, 5});
  Body body = standing(room.rays, {0, 0, 0});
  walk(body, room.rays, {2, 0, 0}, 2);
  EXPECT_LT(body.feet().x, 1);
  walk(body, room.rays, {-2, 0, 0}, 2);
  EXPECT_LT(body.feet().x, -2) << "below 1.9 m";
  EXPECT_NEAR(jump(body, room.rays, vec3(0), 30), 1.9f - body.size().height, 0.02f);
}

TEST(Body, WalksUpAGentleSlopeAndNoSteepOne) {
  HandScene scene;
  const uint32_t grey = scene.material(vec3(0.5f));
  scene.quad({-10, 0, -10}, {0, 0, 20}, {20, 0, 0}, grey);
  scene.quad({1, 0, -2}, {0, 0, 4}, {4, 2, 0}, grey);   // 27 degrees
  scene.quad({-1, 0, -2}, {-2, 4, 0}, {0, 0, 4}, grey); // 63 degrees
  EmbreeQuery rays(scene.assets);
  rays.update(scene.view());
  Body body = standing(rays, {0, 0, 0});
  walk(body, rays, {1, 0, 0}, 3);
  EXPECT_NEAR(body.feet().y, 0.5f * (body.feet().x - 1), 0.15f);
  EXPECT_GT(body.feet().y, 0.8f);
  walk(body, rays, {-1, 0, 0}, 6);
  EXPECT_LT(body.feet().y, 0.2f);
}

TEST(Body, APoleThatIsThinnerThanAnArmStopsIt) {
  for (float z = -0.2f; z <= 0.2f; z += 0.01f) {
    Room room;
    room.box({1, 0, z - 0.04f}, {1.08f, 4, z + 0.04f});
    Body body = standing(room.rays, {0, 0, 0});
    for (int i = 0; i < 25; ++i) {
      body.move(room.rays, {}, {{2, 0, 0}}, kFrame);
      const vec2 nearest(glm::clamp(body.feet().x, 1.0f, 1.08f), glm::clamp(body.feet().z, z - 0.04f, z + 0.04f));
      EXPECT_GT(glm::distance(vec2(body.feet().x, body.feet().z), nearest), 0.85f * body.size().radius()) << z;
    }
  }
}

/// Whatever it does, at whatever rate: it stays in the room and out of the boxes, and never gets stuck for good. A
/// corner may come between two rays, and so a third of the radius in.
TEST(Body, NeverPassesAWall) {
  Room room;
  struct Box {
    vec3 lo, hi;
  };
  std::vector<Box> boxes;
  for (uint32_t i = 0; i < 14; ++i) {
    Rng r(7, Stream::Test, i, 0);
    const vec3 lo(-4.5f + 8 * r.next(), 0, -4.5f + 8 * r.next());
    boxes.push_back({lo, lo + vec3(0.05f + r.next(), 0.2f + 3 * r.next(), 0.05f + r.next())});
    room.box(boxes.back().lo, boxes.back().hi);
  }
  for (const Gait gait : {Gait::Walk, Gait::Fly}) {
    for (uint32_t seed = 0; seed < 5; ++seed) {
      Body body;
      body.place({0, 3.9f - 0.25f, 0});
      body.setGait(gait);
      vec3 velocity(0);
      float way = 0;
      for (uint32_t frame = 0; frame < 600; ++frame) {
        Rng r(seed, Stream::Test, 100, frame);
        if (frame % 10 == 0) velocity = 12.0f * (vec3(r.next(), r.next(), r.next()) - 0.5f);
        const vec3 before = body.feet();
        body.move(room.rays, {}, {velocity, r.next() < 0.1f}, 0.01f + 0.24f * r.next() * r.next());
        way += glm::distance(before, body.feet());
        const vec3 at = gait == Gait::Walk ? body.feet() : body.eye();
        ASSERT_TRUE(isFinite(at));
        const float r0 = 0.9f * body.size().radius();
        ASSERT_LT(std::max(std::abs(at.x), std::abs(at.z)), 5 - r0) << "seed " << seed << " frame " << frame;
        ASSERT_GT(at.y, -0.01f);
        ASSERT_LT(body.eye().y, 4);
        for (const Box& b : boxes) {
          const vec3 nearest = glm::clamp(at, b.lo, b.hi);
          if (gait == Gait::Walk && b.hi.y < at.y + body.size().step()) continue; // stands on it, or over its edge
          vec3 off = at - nearest;
          if (gait == Gait::Walk) off.y = 0;
          ASSERT_GT(glm::length(off), 0.65f * body.size().radius()) << "seed " << seed << " frame " << frame;
        }
      }
      EXPECT_GT(way, 60) << "seed " << seed;
    }
  }
}

TEST(Body, AGhostPassesWallsAndADollIsStoppedAsAPersonIs) {
  const Room room;
  Body ghost;
  ghost.place({0, 2, 0});
  ghost.setGait(Gait::Ghost);
  walk(ghost, room.rays, {10, 0, 0}, 2);
  EXPECT_GT(ghost.eye().x, 19);
  Body doll = standing(room.rays, {4, 0, 0}, {0.2f});
  walk(doll, room.rays, {1, 0, 0}, 4);
  EXPECT_NEAR(doll.feet().x, 5 - doll.size().radius(), 0.03f * doll.size().radius());
}

/// A platform that the test moves, as the extraction of a scene would.
class Platform {
 public:
  Platform() {
    lift = scene.add(block({1, 0.1f, 1}, scene.material(vec3(0.5f))), glm::translate(mat4(1), vec3(0, 0.1f, 0)));
    scene.quad({-10, 0, -10}, {0, 0, 20}, {20, 0, 0}, 0);
    rays = std::make_unique<EmbreeQuery>(scene.assets);
    rays->update(scene.view());
  }
  SceneView moveTo(const mat4& pose) {
    InstanceView& i = scene.instances[lift];
    scene.place(lift, pose);
    i.moved = i.worldFromObject != i.worldFromObjectBefore;
    const SceneView view = scene.view({false, false, false, i.moved, false});
    rays->update(view);
    return view;
  }

  HandScene scene;
  uint32_t lift = 0;
  std::unique_ptr<EmbreeQuery> rays;
};

TEST(Body, ALiftTakesItAlongAndTurnsIt) {
  Platform p;
  Body body;
  ASSERT_TRUE(body.stand(*p.rays, {0.5f, 0.2f + body.size().eye(), 0}));
  SceneView view = p.moveTo(glm::translate(mat4(1), vec3(0, 0.1f, 0)));
  body.move(*p.rays, view, {}, kFrame);
  ASSERT_TRUE(body.grounded());
  EXPECT_EQ(body.ground(), p.scene.instances[p.lift].id);
  float turned = 0;
  for (int i = 1; i <= 60; ++i) { // 3 m up, 6 m aside, a quarter round; then down
    const float u = float(i <= 30 ? i : 60 - i) / 30;
    const mat4 pose = glm::translate(mat4(1), vec3(6 * u, 0.1f + 3 * u, 0)) *
                      glm::mat4_cast(glm::angleAxis(0.5f * kPi * u, vec3(0, 1, 0)));
    view = p.moveTo(pose);
    body.ride(view);
    turned += body.turn();
    body.move(*p.rays, view, {}, kFrame);
    ASSERT_TRUE(body.grounded()) << i;
    ASSERT_NEAR(glm::distance(body.feet(), vec3(pose * vec4(0.5f, 0.1f, 0, 1))), 0, 1e-3f) << i;
    if (i == 30) {
      EXPECT_NEAR(turned, 0.5f * kPi, 1e-3f);
    }
  }
  EXPECT_NEAR(turned, 0, 1e-3f);
}

TEST(Body, WhatMovesAgainstItPushesIt) {
  Platform p;
  const mat4 upright = glm::mat4_cast(glm::angleAxis(0.5f * kPi, vec3(0, 0, 1)));
  SceneView view = p.moveTo(glm::translate(mat4(1), vec3(-2, 1, 0)) * upright); // a wall of 2 × 2 m, 0.2 m thick
  Body body = standing(*p.rays, {0, 0, 0});
  for (int i = 1; i <= 30; ++i) {
    view = p.moveTo(glm::translate(mat4(1), vec3(-2 + 0.1f * float(i), 1, 0)) * upright);
    body.ride(view);
    body.move(*p.rays, view, {}, kFrame);
  }
  EXPECT_NEAR(body.feet().x, 1.1f + body.size().radius(), 0.03f);
  EXPECT_NEAR(body.feet().y, 0, 1e-3f);
}

CameraView cameraAt(const vec3& eye) {
  CameraView view;
  view.worldFromView[3] = vec4(eye, 1);
  return view;
}

TEST(Player, WalksWhereThereIsAFloorAndFliesElsewhere) {
  const Room room;
  Player inside(cameraAt({0, 1.6f, 0}), {vec3(-5, 0, -5), vec3(5, 4, 5)});
  inside.home(room.rays);
  EXPECT_EQ(inside.gait(), Gait::Walk);
  Player outside(cameraAt({0, 9, 20}), {vec3(-5, 0, -5), vec3(5, 4, 5)});
  outside.home(room.rays);
  EXPECT_EQ(outside.gait(), Gait::Fly);
  EXPECT_EQ(outside.position(), vec3(0, 9, 20));
  const MoveInput ahead{.direction = {0, 0, -1}};
  for (int i = 0; i < 300; ++i) outside.move(room.rays, {}, ahead, kFrame);
  EXPECT_LT(outside.position().z, 20 - 5) << "flies along the view";
  EXPECT_NEAR(outside.position().y, 9, 1e-3f) << "and does not fall";
}

TEST(Player, WhoFallsOutOfTheSceneComesHome) {
  AnalyticQuery island;
  island.addBox({-1, -0.5f, -1}, {1, 0, 1}, {});
  Player player(cameraAt({0, 1.61f, 0}), {vec3(-10, -0.5f, -10), vec3(10, 3, 10)});
  player.home(island);
  ASSERT_EQ(player.gait(), Gait::Walk);
  const MoveInput ahead{.direction = {0, 0, -1}};
  bool lost = false;
  for (int i = 0; i < 300 && !lost; ++i) lost = player.move(island, {}, ahead, kFrame);
  EXPECT_TRUE(lost);
  EXPECT_NEAR(glm::distance(player.position(), vec3(0, 1.61f, 0)), 0, 1e-3f);
  EXPECT_EQ(player.gait(), Gait::Walk);
}

} // namespace lambent::test::body_test

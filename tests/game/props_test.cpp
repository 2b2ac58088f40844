// What somebody played with, written into a shot and shown again in the scene as it was loaded.
#include "game/rules/props.h"

#include "engine/scene/gltf_import.h"
#include "game/rules/solids.h"

#include "tests/support/files.h"

namespace lambent::test::props_test {

struct Room {
  Room() : scene(loadScene("content/door/door.gltf")), props(scene), solids(scene) { animate(scene, 0); }
  Scene scene;
  Props props;
  Solids solids;
};

/// Where everything is and how it shines.
SceneView seen(const Room& room, SceneExtractor& extractor) { return extractor.extract(room.scene, CameraView{}, 0); }

void expectSame(const Room& a, const Room& b) {
  SceneExtractor ofA, ofB;
  const SceneView first = seen(a, ofA), second = seen(b, ofB);
  ASSERT_EQ(first.instances.size(), second.instances.size());
  for (size_t i = 0; i < first.instances.size(); ++i) {
    EXPECT_EQ(first.instances[i].mesh, second.instances[i].mesh) << i;
    EXPECT_EQ(first.instances[i].worldFromObject, second.instances[i].worldFromObject) << i;
  }
  ASSERT_EQ(first.lights.size(), second.lights.size());
  for (size_t i = 0; i < first.lights.size(); ++i) {
    const LightView &p = first.lights[i], &q = second.lights[i];
    EXPECT_EQ(p.type, q.type) << i;
    EXPECT_EQ(p.position, q.position) << i;
    EXPECT_EQ(p.direction, q.direction) << i;
    EXPECT_EQ(p.intensity, q.intensity) << i;
    EXPECT_EQ(p.range, q.range) << i;
    EXPECT_EQ(p.innerConeCos, q.innerConeCos) << i;
    EXPECT_EQ(p.outerConeCos, q.outerConeCos) << i;
    EXPECT_EQ(p.angularRadius, q.angularRadius) << i;
  }
}

TEST(PropsTest, AreShownAgainToTheBit) {
  Room played;
  Player player(lookAt({0, 1.6f, 1.2f}, {0, 1.2f, 0}, 1), played.solids.view().boundsWorld);
  PlayedMoment before = played.props.moment(0);
  const SurfaceHit door = played.solids.rays().closest({player.position(), player.forward(), 3});
  ASSERT_TRUE(door.valid());
  ASSERT_TRUE(played.props.movers.use(played.solids.view().instances[door.instance].id));
  played.props.day.set(10.5);
  played.props.day.apply();
  played.props.movers.update(0.5);
  const Player turned(lookAt({0.5f, 1.6f, 1.2f}, {-1, 1.2f, 0.9f}, 1), played.solids.view().boundsWorld);
  played.props.things.lampIntensity = {3, 2, 1};
  played.props.things.take(ThingKind::WhiteBoard, turned);
  played.props.things.update(played.solids, turned, 0.03f);
  played.props.things.take(ThingKind::Lamp, turned); // the board falls
  played.props.things.update(played.solids, turned, 0.07f);
  played.props.setTorch(PlayedMoment::Torch{{0.1f, 1.5f, 1}, glm::normalize(vec3(0.1f, -0.3f, -1)), vec3(3, 2, 1)});

  Shot shot;
  shot.scene = "door.gltf";
  shot.seconds = 1;
  shot.played = {before, played.props.moment(1)};
  const TemporaryFolder folder;
  saveShot(shot, folder / "props.json");
  const Shot read = loadShot(folder / "props.json");
  EXPECT_EQ(read.played, shot.played);

  Room anew;
  anew.props.show(playedAt(read, 1), "shot");
  EXPECT_GT(anew.props.movers.place("door leaf"), 0.1);
  expectSame(played, anew);
  anew.props.show(playedAt(read, 0), "shot");
  expectSame(anew, Room());
}

TEST(PropsTest, BetweenTwoMomentsIsMixed) {
  Shot shot;
  PlayedMoment a, b;
  a.movers["door leaf"] = 0.25;
  b.movers["door leaf"] = 0.75;
  a.things = {{3, "lamp", {0, 1, 0}, 3.1f}, {4, "red box", {5, 0, 0}, 0}};
  b.things = {{3, "lamp", {2, 1, 0}, -3.1f}};
  b.t = 2;
  shot.played = {a, b};
  const PlayedMoment half = playedAt(shot, 1);
  EXPECT_DOUBLE_EQ(half.movers.at("door leaf"), 0.5);
  ASSERT_EQ(half.things.size(), 2u);
  EXPECT_EQ(half.things[0].centre, vec3(1, 1, 0));
  EXPECT_NEAR(std::abs(half.things[0].yaw), kPi, 1e-5); // the short way round
  EXPECT_EQ(half.things[1].centre, vec3(5, 0, 0));
  EXPECT_EQ(playedAt(shot, 2), b);
  EXPECT_EQ(playedAt(shot, 9).things, b.things);
  EXPECT_EQ(playedAt(shot, -1).things, a.things);
}

TEST(PropsTest, RefuseWhatTheyDoNotKnow) {
  Room room;
  PlayedMoment moment;
  moment.things = {{0, "grand piano", {0, 1, 0}, 0}};
  EXPECT_THROW(room.props.show(moment, "shot"), InputError);
  moment.things = {{2, "lamp", {0, 1, 0}, 0}, {2, "lamp", {0, 2, 0}, 0}};
  EXPECT_THROW(room.props.show(moment, "shot"), InputError);
  Shot late; // told before the first moment is shown
  late.played.resize(2);
  EXPECT_NO_THROW(room.props.check(late));
  late.played[1].movers["drawbridge"] = 1;
  EXPECT_THROW(room.props.check(late), InputError);
  moment = {};
  moment.movers["drawbridge"] = 1;
  EXPECT_THROW(room.props.show(moment, "shot"), InputError);
}

} // namespace lambent::test::props_test

// A recorded walk, read back from its file: the camera where it was in every frame.
#include "game/rules/path_recorder.h"

#include "tests/support/files.h"

namespace lambent::test::path_recorder_test {

class PathRecorderTest : public testing::Test {
 protected:
  TemporaryFolder temporary_;
  const fs::path folder_ = temporary_ / "walks";
};

PlayedMoment momentAt(double t) {
  PlayedMoment moment;
  moment.t = t;
  return moment;
}

CameraView at(double t) {
  const vec3 eye(std::cos(t), 1.6 + 0.1 * t, std::sin(t));
  return lookAt(eye, eye + vec3(std::sin(t), 0.2f, 1), 0.9f);
}

TEST_F(PathRecorderTest, EveryFrameIsWhereItWasWhateverTheFrameRate) {
  PathRecorder recorder;
  const dvec3 origin(1000, 0, -8);
  recorder.begin("a.gltf", nullptr, 30, {});
  ASSERT_TRUE(recorder.recording());
  std::vector<double> times;
  for (double t = 0; t < 4; t += 0.01 + 0.2 * std::abs(std::sin(7 * t))) times.push_back(t);
  for (const double t : times) {
    EXPECT_TRUE(recorder.add(at(t), origin, momentAt(t)));
    EXPECT_FALSE(recorder.add(at(t + 1), origin, momentAt(t))); // no time has passed
  }
  const std::optional<Shot> walk = recorder.end(folder_);
  ASSERT_TRUE(walk.has_value());
  EXPECT_FALSE(recorder.recording());
  const Shot read = loadShot(walk->file);
  EXPECT_EQ(read.scene, fs::absolute("a.gltf"));
  EXPECT_EQ(read.played.size(), 1u) << "nothing was touched: buttons are there all the same";
  EXPECT_NEAR(read.seconds, times.back() + 1.0 / 30, 1e-9);
  for (const double t : times) {
    const CameraView camera = shotCamera(read, t, origin);
    for (int column = 0; column < 4; ++column)
      EXPECT_LT(glm::distance(camera.worldFromView[column], at(t).worldFromView[column]), 2e-4f) << t;
    EXPECT_NEAR(camera.fovY, 0.9f, 1e-5f);
  }
}

TEST_F(PathRecorderTest, KeepsWhatMovesAndOverwritesNothing) {
  Shot moving;
  moving.lights["sun"] = {{0, {}, {}, vec3(0, -1, 0), {}}};
  moving.pixels = {vec2(0.5f)};
  PathRecorder recorder;
  for (int i = 1; i <= 2; ++i) {
    recorder.begin("a.gltf", &moving, 30, {{"smc.vpls", "64"}});
    recorder.add(at(0), dvec3(0), {});
    const std::optional<Shot> walk = recorder.end(folder_);
    ASSERT_TRUE(walk.has_value());
    EXPECT_EQ(walk->file.filename(), "walk-" + std::to_string(i) + ".json");
    const Shot read = loadShot(walk->file);
    EXPECT_EQ(read.lights.count("sun"), 1u);
    EXPECT_EQ(read.set.at("smc.vpls"), "64");
    EXPECT_TRUE(read.pixels.empty());
  }
}

TEST_F(PathRecorderTest, SaysWhereItCannotWriteAndWritesNothingWithoutAFrame) {
  PathRecorder recorder;
  recorder.begin("a.gltf", nullptr, 30, {});
  EXPECT_FALSE(recorder.end(folder_).has_value());
  EXPECT_FALSE(fs::exists(folder_));
  writeBytes(folder_, "a file by the folder's name");
  recorder.begin("a.gltf", nullptr, 30, {});
  recorder.add(at(0), dvec3(0), {});
  EXPECT_THROW(recorder.end(folder_), RunError);
  EXPECT_TRUE(recorder.recording()) << "it can be tried again";
  fs::remove(folder_);
  EXPECT_TRUE(recorder.end(folder_).has_value());
  EXPECT_FALSE(recorder.recording());
}

} // namespace lambent::test::path_recorder_test

// A recorded walk, read back from its file: the camera where it was in every frame.
#include "game/rules/path_recorder.h"

#include "tests/support/files.h"

#include <nlohmann/json.hpp>

#include <algorithm>

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
  recorder.begin("a.gltf", nullptr, 30, {}, folder_);
  ASSERT_TRUE(recorder.recording());
  std::vector<double> times;
  for (double t = 0; t < 4; t += 0.01 + 0.2 * std::abs(std::sin(7 * t))) times.push_back(t);
  for (const double t : times) {
    EXPECT_TRUE(recorder.add(at(t), origin, momentAt(t)));
    EXPECT_FALSE(recorder.add(at(t + 1), origin, momentAt(t))); // no time has passed
  }
  const std::optional<Shot> walk = recorder.end();
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
    recorder.begin("a.gltf", &moving, 30, {{"smc.vpls", "64"}}, folder_);
    recorder.add(at(0), dvec3(0), {});
    const std::optional<Shot> walk = recorder.end();
    ASSERT_TRUE(walk.has_value());
    EXPECT_EQ(walk->file.filename(), "walk-" + std::to_string(i) + ".json");
    const Shot read = loadShot(walk->file);
    EXPECT_EQ(read.lights.count("sun"), 1u);
    EXPECT_EQ(read.set.at("smc.vpls"), "64");
    EXPECT_TRUE(read.pixels.empty());
  }
}

TEST_F(PathRecorderTest, EndsAfterADayWithWhatIsRead) {
  PathRecorder recorder;
  recorder.begin("a.gltf", nullptr, 30, {}, folder_);
  EXPECT_TRUE(recorder.add(at(0), dvec3(0), momentAt(0)));
  EXPECT_TRUE(recorder.add(at(1), dvec3(0), momentAt(kLongestShot - 2.0 / 30)));
  EXPECT_THROW(recorder.add(at(2), dvec3(0), momentAt(kLongestShot - 1.0 / 30)), RunError);
  const std::optional<Shot> walk = recorder.end();
  ASSERT_TRUE(walk.has_value());
  EXPECT_EQ(loadShot(walk->file).camera.size(), 2u);
}

TEST_F(PathRecorderTest, SaysWhereItCannotWriteAndWritesNothingWithoutAFrame) {
  PathRecorder recorder;
  recorder.begin("a.gltf", nullptr, 30, {}, folder_);
  EXPECT_FALSE(recorder.end().has_value());
  EXPECT_FALSE(fs::exists(folder_));
  writeBytes(folder_, "a file by the folder's name");
  recorder.begin("a.gltf", nullptr, 30, {}, folder_);
  EXPECT_THROW(recorder.add(at(0), dvec3(0), {}), RunError);
  EXPECT_FALSE(recorder.end().has_value());
  EXPECT_FALSE(recorder.recording());
}

/// What somebody does, moment by moment, in a walk of `frames`.
PlayedMoment playedIn(int frame) {
  PlayedMoment moment = momentAt(frame / 30.0);
  moment.movers["door"] = frame < 3 ? 0 : frame < 6 ? 0.1 * frame : 1;
  if (frame > 4) moment.things.push_back({7, "lamp", vec3(0.1f * float(frame), 1, 2), 0.3f});
  return moment;
}

/// Whatever ends a program at whatever byte, the file has every frame before, and the next program ends it.
TEST_F(PathRecorderTest, AWalkThatIsCutShortHasEveryWholeFrame) {
  PathRecorder recorder;
  recorder.begin("a.gltf", nullptr, 30, {{"smc.vpls", "64"}}, folder_);
  constexpr int kFrames = 10;
  std::vector<size_t> sizes;
  for (int i = 0; i < kFrames; ++i) {
    ASSERT_TRUE(recorder.add(at(i / 30.0), dvec3(0), playedIn(i)));
    sizes.push_back(fs::file_size(recorder.file()));
    EXPECT_EQ(loadShot(recorder.file()).camera.size(), size_t(i + 1)) << "while it is recorded";
    EXPECT_TRUE(endCutShots(folder_).empty()) << "somebody writes it";
  }
  const Shot whole = *recorder.end();
  const std::string text = readBytes(whole.file);
  EXPECT_EQ(nlohmann::json::parse(text).at("camera").at("keys").size(), size_t(kFrames));
  for (size_t size = sizes[0]; size <= text.size(); size += size + 40 < text.size() ? 7 : 1) {
    writeBytes(whole.file, text.substr(0, size));
    const size_t frames = size_t(std::upper_bound(sizes.begin(), sizes.end(), size) - sizes.begin());
    const Shot cut = loadShot(whole.file);
    ASSERT_EQ(cut.camera.size(), frames) << size;
    ASSERT_NEAR(cut.seconds, double(frames) / 30, 1e-9) << size;
    for (size_t i = 0; i < frames; ++i) {
      const PlayedMoment now = playedIn(int(i)), kept = playedAt(cut, cut.camera[i].t);
      ASSERT_EQ(kept.movers, now.movers) << size << ' ' << i;
      ASSERT_EQ(kept.things, now.things) << size << ' ' << i;
    }
    ASSERT_EQ(endCutShots(folder_).size(), size + 1 >= text.size() ? 0u : 1u) << size;
    ASSERT_EQ(nlohmann::json::parse(readBytes(whole.file)).at("camera").at("keys").size(), frames) << size;
    ASSERT_TRUE(endCutShots(folder_).empty());
    ASSERT_EQ(loadShot(whole.file).seconds, cut.seconds);
  }
}

/// What could not be read once it has its end is not given one.
TEST_F(PathRecorderTest, AWalkOfNoTimeThatAShotHasStaysAsItIs) {
  fs::create_directory(folder_);
  Shot shot;
  shot.scene = "a.gltf";
  for (const char* t : {"-1.0", "1000000.0"}) {
    const fs::path file = folder_ / "walk-1.json";
    ShotWriter(shot, file).add({-1, dvec3(0), dvec3(0, 0, -2), 1}, {});
    std::string text = readBytes(file);
    text.replace(text.find("-1.0"), 4, t);
    writeBytes(file, text);
    EXPECT_NE(inputErrorOf([&] { loadShot(file); }).find("seconds: is out of range"), std::string::npos) << t;
    EXPECT_TRUE(endCutShots(folder_).empty()) << t;
    EXPECT_EQ(readBytes(file), text);
    fs::remove(file);
  }
}

/// A file that has its end is not touched, whatever somebody has written on it since.
TEST_F(PathRecorderTest, WhatHasItsEndStaysAsItIs) {
  PathRecorder recorder;
  recorder.begin("a.gltf", nullptr, 30, {}, folder_);
  for (int i = 0; i < 3; ++i) recorder.add(at(i / 30.0), dvec3(0), playedIn(i));
  const fs::path file = recorder.end()->file;
  const std::string text = readBytes(file), pretty = nlohmann::json::parse(text).dump(2);
  for (const std::string& now : {text, text + "\n", text + "\n\n", text.substr(0, text.size() - 1), pretty,
                                 pretty + "\n", text.substr(0, text.size() - 2) + ",\n\"pixels\":[]}\n"}) {
    writeBytes(file, now);
    EXPECT_EQ(loadShot(file).camera.size(), 3u) << now;
    EXPECT_NEAR(loadShot(file).seconds, 0.1, 1e-9);
    EXPECT_TRUE(endCutShots(folder_).empty()) << now;
    EXPECT_EQ(readBytes(file), now);
  }
}

/// Nothing of a recording without a frame stays, whoever ended it.
TEST_F(PathRecorderTest, AFileWithoutAFrameGoes) {
  fs::create_directory(folder_);
  Shot shot;
  shot.scene = "a.gltf";
  { ShotWriter cut(shot, folder_ / "walk-1.json"); }
  ASSERT_TRUE(fs::exists(folder_ / "walk-1.json"));
  EXPECT_TRUE(endCutShots(folder_).empty());
  EXPECT_FALSE(fs::exists(folder_ / "walk-1.json"));
  writeBytes(folder_ / "walk-2.json", "something else");
  EXPECT_TRUE(endCutShots(folder_).empty());
  EXPECT_TRUE(fs::exists(folder_ / "walk-2.json"));
  shot.scene = "\xff.gltf";
  EXPECT_THROW(ShotWriter(shot, folder_ / "walk-3.json"), RunError) << "no UTF-8";
  EXPECT_FALSE(fs::exists(folder_ / "walk-3.json"));
}

} // namespace lambent::test::path_recorder_test

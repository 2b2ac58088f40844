// What a command opens, and how long its file is watched.
#include "gi/viewer/viewer.h"
#include "gl_fixture.h"
#include "tests/support/files.h"
#include "tools/launch/launch.h"

namespace lambent::test::launch_test {

class Launch : public GlTest {};

TEST_F(Launch, IsWatchedUntilItsFirstPictureByWhoDrawsOne) {
  LaunchOptions options;
  options.scene = "content/cornell/cornell.gltf";
  options.size = "32x18";
  options.set = {"smc.vpls=16", "smc.warmup=1", "smc.points=16", "shadow.resolution=16"};
  { // who traces rays alone may go on for hours
    const auto opened = openLaunch(options);
    EXPECT_FALSE(OpenWatch::any());
  }
  {
    const auto opened = openLaunch(options, WatchUntil::FirstPicture);
    EXPECT_TRUE(OpenWatch::any());
    Viewer viewer(opened->settings);
    viewer.run(opened->at(0));
    EXPECT_FALSE(OpenWatch::any());
  }
  options.trust.large = true;
  const auto opened = openLaunch(options, WatchUntil::FirstPicture);
  EXPECT_FALSE(OpenWatch::any());
}

/// Settings that contradict each other but for those of the shot.
TEST_F(Launch, WhatAPersonAsksForIsJudgedWithTheShot) {
  const TemporaryFolder folder;
  const std::string scene = fs::absolute("content/cornell/cornell.gltf");
  writeBytes(folder / "shot.json", R"({"shot": 1, "scene": ")" + scene +
                                       R"(", "fps": 30, "seconds": 1, "set": {"vpl.source": "ir",)"
                                       R"( "vpl.visibility": "none"}})");
  LaunchOptions options;
  options.scene = folder / "shot.json";
  options.set = {"gather.mode=cube"};
  EXPECT_EQ(openLaunch(options, WatchUntil::FirstPicture)->settings.vpl.source, VplSource::Ir);
}

} // namespace lambent::test::launch_test

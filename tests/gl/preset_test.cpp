// Every preset draws.
#include "frames.h"
#include "gi/plan/presets.h"

namespace lambent::test::preset_test {

using PresetTest = GlTest;

/// The settings whose text differs.
std::set<std::string> differing(const Settings& a, const Settings& b) {
  std::set<std::string> names;
  for (const SettingRow& row : settingsTable())
    if (settingText(a, row.name) != settingText(b, row.name)) names.insert(row.name);
  return names;
}

TEST_F(PresetTest, EveryPresetDrawsARoomAndSetsOnlyWhatItIsAbout) {
  Room room;
  room.scene.size(48, 32);
  room.scene.lamp(vec3(0.5f, 0.7f, 0.4f), vec3(2));
  const std::set<std::string> about{"smc.vpls",          "smc.points",  "smc.paths",
                                    "shadow.resolution", "gather.near", "gather.mode"};
  Settings odd; // no preset's values
  odd.smc = {.vpls = 77, .moves = 3, .paths = 79, .points = 78, .warmup = 4};
  odd.shadow = {.resolution = 80, .maker = ShadowMaker::Rays};
  odd.gather.mode = GatherMode::SplatPerVpl;
  odd.gather.near = 5;
  odd.filter.normalPower = 7;
  for (const std::string& name : presetNames()) {
    SCOPED_TRACE(name);
    Settings settings = odd;
    applyPreset(settings, name);
    EXPECT_EQ(differing(settings, odd), about);
    Viewer gi(settings);
    const Image indirect = nextFrame(gi, room.scene.view(), Buffer::Indirect);
    ASSERT_EQ(indirect.pixels.size(), 48u * 32);
    for (const vec3& p : indirect.pixels) ASSERT_TRUE(isFinite(p) && std::min({p.x, p.y, p.z}) >= 0);
    EXPECT_GT(meanLuminance(indirect), 0.01);
    for (const vec3& p : gi.read(Buffer::Beauty).pixels) ASSERT_TRUE(isFinite(p));
  }
}

} // namespace lambent::test::preset_test

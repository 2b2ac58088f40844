// Every preset draws.
#include "gi/viewer/viewer.h"
#include "gi/plan/presets.h"
#include "gl_fixture.h"

#include <set>

namespace lambent::test {

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
  room.scene.camera.width = 48;
  room.scene.camera.height = 32;
  LightView lamp;
  lamp.position = vec3(0.5f, 0.7f, 0.4f);
  lamp.intensity = vec3(2);
  room.scene.lights.push_back(lamp);
  const std::set<std::string> about{"smc.vpls", "smc.points", "smc.paths", "shadow.resolution", "gather.mode"};
  Settings odd; // no preset's values
  odd.smc.vpls = 77;
  odd.smc.points = 78;
  odd.smc.paths = 79;
  odd.shadow.resolution = 80;
  odd.gather.mode = GatherMode::SplatPerVpl;
  odd.smc.warmup = 4;
  odd.smc.moves = 3;
  odd.shadow.maker = ShadowMaker::Rays;
  odd.filter.normalPower = 7;
  for (const std::string& name : presetNames()) {
    SCOPED_TRACE(name);
    Settings settings = odd;
    applyPreset(settings, name);
    EXPECT_EQ(differing(settings, odd), about);
    Viewer gi(settings);
    gi.run(room.scene.view());
    const Image indirect = gi.read(Buffer::Indirect);
    ASSERT_EQ(indirect.pixels.size(), 48u * 32);
    double sum = 0;
    for (const vec3& p : indirect.pixels) {
      ASSERT_TRUE(isFinite(p));
      ASSERT_GE(std::min({p.x, p.y, p.z}), 0);
      sum += luminance(p);
    }
    EXPECT_GT(sum / double(indirect.pixels.size()), 0.01);
    for (const vec3& p : gi.read(Buffer::Beauty).pixels) ASSERT_TRUE(isFinite(p));
  }
}

} // namespace lambent::test

// Every preset draws.
#include "frames.h"
#include "gi/plan/presets.h"

namespace lambent::test::preset_test {

using PresetTest = GlTest;

TEST_F(PresetTest, EveryPresetDrawsARoom) {
  Room room;
  room.scene.size(48, 32);
  room.scene.lamp(vec3(0.5f, 0.7f, 0.4f), vec3(2));
  for (const std::string& name : presetNames()) {
    SCOPED_TRACE(name);
    Settings settings;
    settings.smc.warmup = 4;
    settings.shadow.maker = ShadowMaker::Rays;
    applyPreset(settings, name);
    Viewer gi(settings);
    const Image indirect = nextFrame(gi, room.scene.view(), Buffer::Indirect);
    ASSERT_EQ(indirect.pixels.size(), 48u * 32);
    for (const vec3& p : indirect.pixels) ASSERT_TRUE(isFinite(p) && std::min({p.x, p.y, p.z}) >= 0);
    EXPECT_GT(meanLuminance(indirect), 0.01);
    for (const vec3& p : gi.read(Buffer::Beauty).pixels) ASSERT_TRUE(isFinite(p));
  }
}

} // namespace lambent::test::preset_test

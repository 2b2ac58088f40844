#include "gi/measure/runs/sweeps.h"

#include "gi/plan/techniques.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace lambent {
namespace {

TEST(Sweeps, EverySettingIsAKnobOrSaysWhyNot) {
  std::set<std::string> listed;
  for (const Knob& knob : knobTable()) EXPECT_TRUE(listed.insert(knob.setting).second) << knob.setting;
  for (const NoKnob& none : noKnobTable())
    for (const char* setting : none.settings) EXPECT_TRUE(listed.insert(setting).second) << setting;
  for (const SettingRow& row : settingsTable()) EXPECT_EQ(listed.erase(row.name), 1u) << row.name;
  EXPECT_TRUE(listed.empty()) << *listed.begin();
}

TEST(Sweeps, AKnobHasItsDefaultAmongItsValues) {
  for (const Knob& knob : knobTable()) {
    if (!knob.with.empty()) continue;
    const SettingRow& row = settingRow(knob.setting);
    const std::string standard = row.text(row.standard);
    const bool followsPicture = standard == "0" && knob.light == KnobLight::Direct;
    EXPECT_TRUE(followsPicture || std::ranges::count(knob.values, standard)) << knob.setting;
  }
}

TEST(Sweeps, PointsCanBeSetAndDiffer) {
  std::set<std::string> names;
  for (const SweepPoint& point : sweepPoints(SweepPart::All)) {
    EXPECT_TRUE(names.insert(point.name).second) << point.name;
    Settings settings;
    if (!point.technique.empty()) applyTechnique(settings, point.technique);
    for (const auto& [setting, value] : point.set) applySetting(settings, setting, value);
    EXPECT_EQ(whyNot(settings), "") << point.name;
    EXPECT_EQ(settings == Settings{}, point.kind == SweepPoint::Kind::Default) << point.name;
  }
  for (const Knob& knob : knobTable())
    for (const char* value : knob.values) EXPECT_TRUE(names.count(knobPoint(knob, value))) << knob.setting << value;
  for (SweepPart part : {SweepPart::Joint, SweepPart::Quick})
    for (const SweepPoint& point : sweepPoints(part)) EXPECT_TRUE(names.count(point.name)) << point.name;
}

} // namespace
} // namespace lambent

#include "gi/measure/runs/sweeps.h"

#include "gi/measure/front.h"
#include "gi/plan/techniques.h"

#include "tests/support/test.h"

namespace lambent::test::sweeps_test {

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
    if (knob.setting == std::string("smc.neighbours")) continue; // 0 there: as many as the number of lights asks for
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

/// What the report measured when presets were last chosen (docs/measurements/presets.md).
TEST(Presets, AreTheLadderOfWhatWasMeasured) {
  std::ifstream in("docs/measurements/presets.csv");
  ASSERT_TRUE(in) << "run from the root of the source tree";
  const auto cells = [](const std::string& line) {
    std::vector<std::string> out;
    std::istringstream rest(line);
    for (std::string cell; std::getline(rest, cell, ',');) out.push_back(cell);
    return out;
  };
  std::string line;
  std::getline(in, line);
  const std::vector<std::string> head = cells(line);
  const auto column = [&](const char* name) { return size_t(std::ranges::find(head, name) - head.begin()); };
  std::vector<std::string> names;
  std::vector<CostError> points;
  while (std::getline(in, line)) {
    const std::vector<std::string> row = cells(line);
    ASSERT_GT(row.size(), std::max({column("point"), column("time"), column("error")})) << line;
    names.push_back(row[column("point")]);
    points.push_back({std::stod(row[column("time")]), std::stod(row[column("error")])});
  }
  const std::vector<size_t> ladder = ladderOf(points);
  ASSERT_EQ(ladder.size(), presetTable().size());
  for (size_t i = 0; i < ladder.size(); ++i) {
    const Preset& preset = presetTable()[i];
    EXPECT_EQ(presetPoint(preset), names[ladder[i]]);
    EXPECT_NEAR(preset.time, points[ladder[i]].cost, 0.005) << preset.name;
    EXPECT_NEAR(preset.error, points[ladder[i]].error, 0.005) << preset.name;
  }
}

TEST(Presets, ArePointsOfTheJointSweep) {
  const std::vector<SweepPoint> points = sweepPoints(SweepPart::Joint);
  for (const Preset& preset : presetTable())
    EXPECT_TRUE(std::ranges::count(points, presetPoint(preset), &SweepPoint::name)) << preset.name;
}

} // namespace lambent::test::sweeps_test

// Which settings the steps have by which an error is taken apart, and what parts come of the errors after them.
#include "gi/measure/error_parts.h"

#include "tests/support/test.h"

namespace lambent::test::error_parts_test {

using Texts = std::vector<std::string>;

/// "name=value" of each that differs from `before`.
Texts changesOf(const Settings& settings, const Settings& before) {
  Texts changes;
  for (const SettingRow& row : settingRows(settings))
    if (row.get(settings) != row.get(before)) changes.push_back(row.name + "=" + row.text(row.get(settings)));
  return changes;
}

TEST(ErrorParts, EachStepMakesOneThingExact) {
  const Settings asSet;
  for (const bool lightChanges : {true, false}) {
    const std::vector<ExactStep> steps = exactSteps(asSet, lightChanges);
    const std::vector<std::pair<std::string, Texts>> wanted{
        {"near light", {"gather.near=256"}},
        {"reconstruction", {"filter.on=off"}},
        {"choice of lights", {"gather.mode=full", lightChanges ? "gather.near=24" : "gather.near=32"}},
        {"maps", {"vpl.visibility=rays"}},
        {"history", lightChanges ? Texts{"gather.near=48", "history.frames=0"} : Texts{"history.frames=0"}}};
    ASSERT_EQ(steps.size(), wanted.size());
    const Settings* before = &asSet;
    for (size_t i = 0; i < steps.size(); ++i) {
      EXPECT_EQ(steps[i].part, wanted[i].first);
      EXPECT_EQ(changesOf(steps[i].settings, *before), wanted[i].second) << steps[i].part;
      EXPECT_EQ(whyNot(steps[i].settings), "") << steps[i].part;
      before = &steps[i].settings;
    }
  }
}

/// Their noise must not move from part to part.
TEST(ErrorParts, APixelCastsAsManyNearRaysInEachStep) {
  for (const char* mode : {"lists", "interleaved", "full", "multires", "multires-interleaved"})
    for (const char* frames : {"64", "0"})
      for (const char* visibility : {"maps", "rays"})
        for (const bool lightChanges : {true, false}) {
          Settings asSet;
          applySetting(asSet, "gather.mode", mode);
          applySetting(asSet, "history.frames", frames);
          applySetting(asSet, "vpl.visibility", visibility);
          const std::vector<ExactStep> steps = exactSteps(asSet, lightChanges);
          const double rays = nearRaysOfPixel(steps[0].settings, lightChanges);
          EXPECT_GT(rays, 15) << mode;
          EXPECT_LE(rays, 48) << mode;
          for (const ExactStep& step : steps)
            EXPECT_EQ(nearRaysOfPixel(step.settings, lightChanges), rays) << mode << ' ' << frames << ' ' << step.part;
        }
}

TEST(ErrorParts, AreWhatErrorsLoseFromStepToStep) {
  const std::vector<ExactStep> steps{{"first", "one", {}}, {"second", "two", {}}};
  const std::vector<std::vector<double>> errors{{10, 21}, {8, 18}, {9, 19}}; // two seeds, far apart
  const std::vector<ErrorPart> parts = errorParts(steps, errors, 0.5);
  const std::vector<std::pair<std::string, UncertainValue>> wanted{
      {"first", {2.5, 0.5}}, {"second", {-1, 0}}, {"set of lights", {13.5, 5}}, {"truth", {0.5, 0}}};
  ASSERT_EQ(parts.size(), wanted.size());
  double sum = 0;
  for (size_t i = 0; i < parts.size(); ++i) {
    EXPECT_EQ(parts[i].part, wanted[i].first);
    EXPECT_DOUBLE_EQ(parts[i].error.value, wanted[i].second.value) << parts[i].part;
    if (i + 1 < parts.size()) {
      EXPECT_DOUBLE_EQ(parts[i].error.error, wanted[i].second.error) << parts[i].part;
    }
    sum += parts[i].error.value;
  }
  EXPECT_DOUBLE_EQ(sum, 15.5) << "as set";
  EXPECT_EQ(parts[0].by, "one");
  const std::vector<std::vector<double>> once{{10}, {8}, {9}};
  EXPECT_TRUE(std::isnan(errorParts(steps, once, 0.5)[0].error.error)) << "of one seed";
}

} // namespace lambent::test::error_parts_test

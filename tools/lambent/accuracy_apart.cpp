#include "gi/measure/error_parts.h"
#include "tools/lambent/accuracy.h"

#include <cmath>

namespace lambent {

void accuracyApart(const AccuracyOptions& options, const Study& study) {
  const int seeds = options.seeds.value_or(options.quick ? 1 : 3);
  std::vector<std::vector<double>> errors; // by step, as set first; then by seed
  bool lightChanges = false;
  const auto draw = [&](Variant variant) {
    std::vector<double>& of = errors.emplace_back();
    for (const Measured& m : study.drawUpTo(options.frame, seeded({std::move(variant)}, seeds), Buffer::Irradiance)) {
      of.push_back(study.outcome(m).error.relMse);
      lightChanges = m.frames.back().plan.lightChanges();
    }
  };
  const Variant asSet = study.variant("as set");
  draw(asSet);
  const std::vector<ExactStep> steps = exactSteps(asSet.settings, lightChanges);
  for (const ExactStep& step : steps) draw({step.part, step.settings, asSet.seed});

  const std::vector<Column> columns{{{"part", "part of the error"}},
                                    {{"rel_mse", "relMSE", "%+.4f"}},
                                    {{"error", "±", "%.4f"}},
                                    {{"share", "share", "%+.0f %%", 100}},
                                    {{"by", "left out by"}}};
  const UncertainValue all = meanOver(errors.front());
  Value rows = Value::list();
  const auto add = [&](const std::string& part, const UncertainValue& relMse, const std::string& by) {
    Value& row = rows.add(Value::of("part", part, "rel_mse", relMse.value));
    if (!std::isnan(relMse.error)) row["error"] = relMse.error;
    row["share"] = all.value > 0 ? relMse.value / all.value : 0.0;
    row["by"] = by;
  };
  const double ofTruth = expectedRelMse(study.traced->image.mean, study.traced->image.error);
  for (const ErrorPart& part : errorParts(steps, errors, ofTruth)) add(part.part, part.error, part.by);
  add("all, as set", all, "");
  study.report(columns, rows, Value::of("near_rays", nearRaysOfPixel(steps.front().settings, lightChanges)));
}

} // namespace lambent

// Which part of the error of indirect light in motion comes from what: each approximation is replaced by the exact
// thing, one after the other, and what the error loses is that part's. Squared errors add up where parts are
// independent.
#include "gi/measure/image_error.h"
#include "tools/lambent/accuracy.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

/// What a step makes exact, on top of the steps before it.
struct ExactPart {
  const char *part, *means;
  Assignments set;
};

// All near rays come before all lights, as every light at every pixel brings near rays of its own.
const std::vector<ExactPart>& exactParts() {
  static const std::vector<ExactPart> steps{
      {"near light", "so many near rays that none are missed", {{"gather.near", "256"}}},
      {"choice of lights", "every light at every pixel", {{"gather.mode", "full"}, {"gather.near", "32"}}},
      {"maps", "a ray for every pair", {{"vpl.visibility", "rays"}}},
      {"history", "one frame, without a mean over frames and its lag", {{"history.frames", "0"}}}};
  return steps;
}

} // namespace

void accuracyApart(const AccuracyOptions& options) {
  Study study(options, options.launch.scene, {.size = "160x90"});
  if (!study.opened->shot) throw InputError(study.launch.scene, "is no shot (--frame needs one)");
  study.trace(2048, ReferenceBuffer::Irradiance, false, {}, options.frame);
  const int seeds = options.seeds.value_or(options.quick ? 1 : 3);

  // By step, as set first; then by seed.
  std::vector<std::vector<double>> errors;
  Assignments set;
  const auto measure = [&](const char* name) {
    const std::vector<Variant> variants = seeded({study.variant(name, set)}, seeds);
    std::vector<double>& of = errors.emplace_back();
    for (const Measured& m : study.drawUpTo(options.frame, variants, Buffer::Irradiance))
      of.push_back(study.outcome(m).error.relMse);
  };
  measure("as set");
  for (const ExactPart& step : exactParts()) {
    for (const auto& [name, value] : step.set) {
      std::erase_if(set, [&](const auto& old) { return old.first == name; });
      set.emplace_back(name, value);
    }
    measure(step.part);
  }

  const double truth = expectedRelMse(study.traced->image.mean, study.traced->image.error);
  const std::vector<Column> columns{{{"part", "part of the error"}},
                                    {{"rel_mse", "relMSE", "%+.4f"}},
                                    {{"error", "±", "%.4f"}},
                                    {{"share", "share", "%+.0f %%", 100}},
                                    {{"by", "left out by"}}};
  const double all = meanOver(errors.front()).value;
  Value rows = Value::list();
  const auto add = [&](const std::string& part, const UncertainValue& relMse, const std::string& by) {
    Value row = Value::of();
    row["part"] = part;
    row["rel_mse"] = relMse.value;
    if (!std::isnan(relMse.error)) row["error"] = relMse.error;
    row["share"] = all > 0 ? relMse.value / all : 0.0;
    row["by"] = by;
    rows.add(row);
  };
  for (size_t i = 0; i < exactParts().size(); ++i) {
    std::vector<double> taken; // paired: the same seed
    for (int seed = 0; seed < seeds; ++seed) taken.push_back(errors[i][size_t(seed)] - errors[i + 1][size_t(seed)]);
    add(exactParts()[i].part, meanOver(taken), exactParts()[i].means);
  }
  std::vector<double> left = errors.back();
  for (double& error : left) error -= truth;
  add("set of lights", meanOver(left), "what is left");
  add("truth", {.value = truth}, "its own noise");
  add("all, as set", meanOver(errors.front()), "");
  study.report(columns, rows);
}

} // namespace lambent

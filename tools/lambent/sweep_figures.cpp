#include "tools/lambent/sweep.h"

#include "engine/core/error.h"
#include "gi/measure/statistics.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace lambent {

namespace {

/// Standard deviation over the mean; 0 of one value.
double relativeDeviation(const std::vector<double>& values) {
  double mean = 0, square = 0;
  for (double v : values) mean += v / double(values.size());
  for (double v : values) square += (v - mean) * (v - mean);
  return values.size() > 1 && mean > 0 ? std::sqrt(square / double(values.size() - 1)) / mean : 0;
}

constexpr double kUnknown = 0.25; // share, where too little was measured to know a noise

bool isControl(const Value& run) { return run.has("control"); }

/// What brings a run's times to the pace of all: the median control over those before and after it, of its session.
double paceOf(const Value::List& runs, size_t index, double all) {
  const auto ms = [](const Value& run) { return run["moving"]["ms"].number(); };
  if (isControl(runs[index])) return all / ms(runs[index]); // itself is the nearest
  double sum = 0;
  int count = 0;
  for (int step : {-1, 1})
    for (int i = int(index); i >= 0 && i < int(runs.size()); i += step) {
      const Value& run = runs[size_t(i)];
      if (run["session"].number() != runs[index]["session"].number()) break;
      if (!isControl(run)) continue;
      sum += ms(run), ++count;
      break;
    }
  return count ? all / (sum / count) : 1;
}

/// Relative spread of relMSE over seeds, root of the mean square over the points that have several.
double pooledSpread(const std::map<std::string, std::vector<Value>>& runs, const char* state, KnobLight light) {
  std::map<std::string, KnobLight> lights;
  for (const SweepPoint& p : sweepPoints(SweepPart::All)) lights[p.name] = p.light;
  double squares = 0, degrees = 0;
  for (const auto& [name, own] : runs) {
    std::map<int, double> errors; // by seed
    for (const Value& run : own)
      if (run.has(state)) errors[int(run["seed"].number())] = run[state]["rel_mse"].number();
    const auto known = lights.find(name);
    if (errors.size() < 2 || known == lights.end() || known->second != light) continue;
    std::vector<double> values;
    for (const auto& [seed, error] : errors) values.push_back(error);
    squares += std::pow(relativeDeviation(values), 2) * double(values.size() - 1);
    degrees += double(values.size() - 1);
  }
  return degrees > 0 ? std::sqrt(squares / degrees) : kUnknown;
}

/// Mean of a figure over runs: of a state, or of the run itself where that is empty.
double meanOf(const std::vector<Value>& runs, const std::string& state, const char* key) {
  double sum = 0;
  for (const Value& run : runs) sum += (state.empty() ? run : run[state])[key].number() / double(runs.size());
  return sum;
}

/// Both at once: error is the geometric mean of moving and standing, cost that of frames in motion. What presets are
/// chosen by.
CostError bothOf(const PointFigures& p) {
  if (p.still.cost <= 0) return {};
  return {p.moving.cost, std::sqrt(p.moving.error * p.still.error), p.moving.costNoise,
          0.5 * std::hypot(p.moving.errorNoise, p.still.errorNoise)};
}

} // namespace

const std::vector<TableColumn> kPointColumns{{"point", "point"},
                                             {"moving_ms", "ms", "%.1f"},
                                             {"moving_rel_mse", "relMSE", "%.4f"},
                                             {"moving_noise", "±", "%.0f %%", 100},
                                             {"moving_bias", "bias", "%+.1f %%", 100},
                                             {"error", "\\|E\\|", "%.4f"},
                                             {"change", "\\|E'\\|", "%.4f"},
                                             {"still_ms", "still: ms", "%.1f"},
                                             {"still_rel_mse", "still: relMSE", "%.4f"},
                                             {"still_noise", "±", "%.0f %%", 100},
                                             {"still_bias", "still: bias", "%+.1f %%", 100},
                                             {"rays", "rays a frame", "%.0f"},
                                             {"gpu_mib", "GPU MiB", "%.0f"},
                                             {"seeds", "seeds"}};

Figures figuresOf(const SweptScene& scene) {
  std::vector<double> controlMs;
  for (const Value& run : scene.runs.items())
    if (isControl(run)) controlMs.push_back(run["moving"]["ms"].number());
  const double all = spreadOf(controlMs).median;
  // Neighbouring controls differ by what is left once the slow changes of pace are out; a run's time has its own noise
  // and that of the two controls beside it.
  double turns = 0;
  for (size_t i = 1; i < controlMs.size(); ++i) turns += std::pow(std::log(controlMs[i] / controlMs[i - 1]), 2);
  const double costNoise =
      controlMs.size() > 1 ? std::sqrt(1.5 * 0.5 * turns / double(controlMs.size() - 1)) : kUnknown;

  std::map<std::string, std::vector<Value>> runs;
  for (size_t i = 0; i < scene.runs.size(); ++i) {
    Value run = scene.runs.items()[i];
    const double pace = paceOf(scene.runs.items(), i, all);
    for (const char* state : {"moving", "still"})
      if (run.has(state)) run[state]["ms"] = pace * run[state]["ms"].number();
    if (run.has("stages"))
      for (auto& [stage, ms] : run["stages"].fields()) ms = pace * ms.number();
    runs[run["point"].text()].push_back(std::move(run));
  }

  const double movingNoise = pooledSpread(runs, "moving", KnobLight::Indirect);
  const double stillNoise = pooledSpread(runs, "still", KnobLight::Indirect);
  const double directNoise = pooledSpread(runs, "moving", KnobLight::Direct);

  Figures figures;
  for (const SweepPoint& point : sweepPoints(SweepPart::All)) {
    const auto found = runs.find(point.name);
    if (found == runs.end()) continue;
    const std::vector<Value>& own = found->second;
    std::set<double> ownSeeds;
    for (const Value& run : own) ownSeeds.insert(run["seed"].number());
    const double perTime = costNoise / std::sqrt(double(own.size())), perSeed = 1 / std::sqrt(double(ownSeeds.size()));
    PointFigures& f = figures[point.name];
    f.point = point;
    Value& row = f.row;
    row = Value::of("point", point.name, "seeds", ownSeeds.size(), "cost_noise", perTime, "rays",
                    meanOf(own, "", "rays"), "gpu_mib", meanOf(own, "", "gpu_mib"));
    const auto addState = [&](const std::string& state, double noise) {
      const CostError p{meanOf(own, state, "ms"), meanOf(own, state, "rel_mse"), perTime, perSeed * noise};
      row[state + "_ms"] = p.cost;
      row[state + "_rel_mse"] = p.error;
      row[state + "_noise"] = p.errorNoise;
      for (const std::string key : {"bias", "rmse_share"}) row[state + "_" + key] = meanOf(own, state, key.c_str());
      return p;
    };
    const bool direct = point.light == KnobLight::Direct;
    f.moving = addState("moving", direct ? directNoise : movingNoise);
    for (const char* key : {"error", "change"})
      if (!direct) row[key] = meanOf(own, "moving", key);
    if (own[0].has("still")) {
      f.still = addState("still", stillNoise);
      f.picture = own[0]["picture"].text();
    }
    for (const auto& [stage, ms] : own[0]["stages"].fields()) row["ms_" + stage] = ms;
  }
  return figures;
}

Figures overScenes(const std::vector<Figures>& scenes) {
  Figures all;
  const auto reference = [](const Figures& figures, const PointFigures& point) -> const PointFigures& {
    for (const auto& [name, f] : figures)
      if (f.point.kind == SweepPoint::Kind::Default && f.point.light == point.point.light) return f;
    throw RunError("sweep: the default lacks");
  };
  for (const auto& [name, first] : scenes.front()) {
    std::vector<CostError> points[2], references[2]; // moving, still
    for (const Figures& scene : scenes) {
      const auto found = scene.find(name);
      if (found == scene.end()) break;
      const PointFigures &own = found->second, &standard = reference(scene, own);
      points[0].push_back(own.moving), references[0].push_back(standard.moving);
      if (own.still.cost > 0) points[1].push_back(own.still), references[1].push_back(standard.still);
    }
    if (points[0].size() < scenes.size()) continue;
    PointFigures& f = all[name];
    f.point = first.point;
    f.moving = overScenes(points[0], references[0]);
    if (points[1].size() == scenes.size()) f.still = overScenes(points[1], references[1]);
  }
  return all;
}

Choice choiceOf(const Figures& figures, const std::function<CostError(const PointFigures&)>& take) {
  Choice choice;
  for (const auto& [name, figure] : figures) {
    const CostError taken = take(figure);
    if (taken.cost <= 0) continue;
    choice.names.push_back(name);
    choice.points.push_back(taken);
  }
  return choice;
}

Choice presetChoice(const Figures& figures) {
  return choiceOf(figures, [](const PointFigures& f) {
    using enum SweepPoint::Kind;
    const bool candidate = f.point.light == KnobLight::Indirect && (f.point.kind == Default || f.point.kind == Joint);
    return candidate ? bothOf(f) : CostError{};
  });
}

} // namespace lambent

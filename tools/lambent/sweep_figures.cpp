#include "tools/lambent/sweep_figures.h"

#include "engine/core/error.h"
#include "gi/measure/statistics.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

using Json = nlohmann::json;

/// Standard deviation over the mean; 0 of one value.
double relativeDeviation(const std::vector<double>& values) {
  double mean = 0, square = 0;
  for (double v : values) mean += v / double(values.size());
  for (double v : values) square += (v - mean) * (v - mean);
  return values.size() > 1 && mean > 0 ? std::sqrt(square / double(values.size() - 1)) / mean : 0;
}

constexpr double kUnknown = 0.25; // share, where too little was measured to know a noise

bool isControl(const Json& run) { return run.contains("control"); }

/// What brings a run's times to the pace of all: the median control over those before and after it, of its session.
double paceOf(const Json& runs, size_t index, double all) {
  const auto ms = [](const Json& run) { return run["moving"]["ms"].get<double>(); };
  if (isControl(runs[index])) return all / ms(runs[index]); // itself is the nearest
  double sum = 0;
  int count = 0;
  for (int step : {-1, 1})
    for (int i = int(index); i >= 0 && i < int(runs.size()); i += step) {
      const Json& run = runs[size_t(i)];
      if (run["session"] != runs[index]["session"]) break;
      if (!isControl(run)) continue;
      sum += ms(run), ++count;
      break;
    }
  return count ? all / (sum / count) : 1;
}

/// Relative spread of relMSE over seeds, root of the mean square over the points that have several.
double pooledSpread(const std::map<std::string, std::vector<Json>>& runs, const char* state, KnobLight light) {
  std::map<std::string, KnobLight> lights;
  for (const SweepPoint& p : sweepPoints(SweepPart::All)) lights[p.name] = p.light;
  double squares = 0, degrees = 0;
  for (const auto& [name, own] : runs) {
    std::map<int, double> errors; // by seed
    for (const Json& run : own)
      if (run.contains(state)) errors[run["seed"]] = run[state]["rel_mse"];
    const auto known = lights.find(name);
    if (errors.size() < 2 || known == lights.end() || known->second != light) continue;
    std::vector<double> values;
    for (const auto& [seed, error] : errors) values.push_back(error);
    squares += std::pow(relativeDeviation(values), 2) * double(values.size() - 1);
    degrees += double(values.size() - 1);
  }
  return degrees > 0 ? std::sqrt(squares / degrees) : kUnknown;
}

/// Mean of a figure over runs, "moving/ms".
double meanOf(const std::vector<Json>& runs, const char* path) {
  double sum = 0;
  for (const Json& run : runs) sum += run.at(Json::json_pointer(path)).get<double>() / double(runs.size());
  return sum;
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
  for (const Json& run : scene.runs)
    if (isControl(run)) controlMs.push_back(run["moving"]["ms"]);
  const double all = spreadOf(controlMs).median;
  // Neighbouring controls differ by what is left once the slow changes of pace are out; a run's time has its own noise
  // and that of the two controls beside it.
  double turns = 0;
  for (size_t i = 1; i < controlMs.size(); ++i) turns += std::pow(std::log(controlMs[i] / controlMs[i - 1]), 2);
  const double costNoise =
      controlMs.size() > 1 ? std::sqrt(1.5 * 0.5 * turns / double(controlMs.size() - 1)) : kUnknown;

  std::map<std::string, std::vector<Json>> runs;
  for (size_t i = 0; i < scene.runs.size(); ++i) {
    Json run = scene.runs[i];
    const double pace = paceOf(scene.runs, i, all);
    for (const char* state : {"moving", "still"})
      if (run.contains(state)) run[state]["ms"] = pace * run[state]["ms"].get<double>();
    if (run.contains("stages"))
      for (Json& ms : run["stages"]) ms = pace * ms.get<double>();
    runs[run["point"]].push_back(std::move(run));
  }

  const double movingNoise = pooledSpread(runs, "moving", KnobLight::Indirect);
  const double stillNoise = pooledSpread(runs, "still", KnobLight::Indirect);
  const double directNoise = pooledSpread(runs, "moving", KnobLight::Direct);

  Figures figures;
  for (const SweepPoint& point : sweepPoints(SweepPart::All)) {
    const auto found = runs.find(point.name);
    if (found == runs.end()) continue;
    const std::vector<Json>& own = found->second;
    std::map<int, bool> ownSeeds;
    for (const Json& run : own) ownSeeds[run["seed"]] = true;
    const double perTime = costNoise / std::sqrt(double(own.size())), perSeed = 1 / std::sqrt(double(ownSeeds.size()));
    PointFigures& f = figures[point.name];
    f.point = point;
    const bool direct = point.light == KnobLight::Direct;
    f.moving = {meanOf(own, "/moving/ms"), meanOf(own, "/moving/rel_mse"), perTime,
                perSeed * (direct ? directNoise : movingNoise)};
    Json& row = f.row;
    row = {{"point", point.name},
           {"seeds", ownSeeds.size()},
           {"moving_ms", f.moving.cost},
           {"moving_rel_mse", f.moving.error},
           {"moving_noise", f.moving.errorNoise},
           {"cost_noise", perTime},
           {"moving_bias", meanOf(own, "/moving/bias")},
           {"moving_rmse_share", meanOf(own, "/moving/rmse_share")},
           {"rays", meanOf(own, "/rays")},
           {"gpu_mib", meanOf(own, "/gpu_mib")}};
    if (!direct) row.update({{"error", meanOf(own, "/moving/error")}, {"change", meanOf(own, "/moving/change")}});
    if (own[0].contains("still")) {
      f.still = {meanOf(own, "/still/ms"), meanOf(own, "/still/rel_mse"), perTime, perSeed * stillNoise};
      row.update({{"still_ms", f.still.cost},
                  {"still_rel_mse", f.still.error},
                  {"still_noise", f.still.errorNoise},
                  {"still_bias", meanOf(own, "/still/bias")},
                  {"still_rmse_share", meanOf(own, "/still/rmse_share")}});
      f.picture = own[0]["picture"];
    }
    for (const auto& [stage, ms] : own[0]["stages"].items()) row["ms_" + stage] = ms;
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

CostError bothOf(const PointFigures& p) {
  if (p.still.cost <= 0) return {};
  return {p.moving.cost, std::sqrt(p.moving.error * p.still.error), p.moving.costNoise,
          0.5 * std::hypot(p.moving.errorNoise, p.still.errorNoise)};
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

// lambent accuracy SCENE... --report: what accuracy costs in time. Measures the sweeps of gi/measure/runs/sweeps.h in
// each scene (sweep.cpp), and writes one page with everything in it (index.html), and points.csv.
#include "engine/core/error.h"
#include "engine/core/files.h"
#include "tools/lambent/picture.h"
#include "tools/lambent/plot.h"
#include "tools/lambent/sweep.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

namespace lambent {

namespace fs = std::filesystem;

namespace {

constexpr float kBlackAt = 0.5f; // of heat maps: relative error

enum class State { Moving, Still };
CostError of(const PointFigures& f, State state) { return state == State::Moving ? f.moving : f.still; }
constexpr State kStates[] = {State::Moving, State::Still};
const char* titleOf(State state) { return state == State::Moving ? "in motion" : "standing still"; }

/// Without those that were measured over a few frames alone: their histories are shorter than the others'.
Choice indirectPoints(const Figures& figures, State state) {
  return choiceOf(figures, [&](const PointFigures& f) {
    return f.point.light == KnobLight::Indirect && !f.point.slow ? of(f, state) : CostError{};
  });
}

/// Names of the front, cheapest first.
std::vector<std::string> frontNames(const Choice& choice) {
  std::vector<std::string> names;
  for (size_t i : frontOf(choice.points)) names.push_back(choice.names[i]);
  return names;
}

Shape shapeOf(SweepPoint::Kind kind) {
  constexpr Shape kShapes[] = {Shape::Diamond, Shape::Square, Shape::Dot, Shape::Triangle};
  return kShapes[int(kind)];
}

Plot frontPlot(const std::string& title, const Figures& figures, State state, bool relative) {
  Plot plot{title + ", " + titleOf(state), relative ? "time of a frame, of the default's" : "milliseconds a frame",
            relative ? "relMSE, of the default's" : "relMSE of indirect irradiance", true, true};
  plot.legend = {{Shape::Diamond, "default"},
                 {Shape::Square, "one setting changed"},
                 {Shape::Dot, "joint sweep"},
                 {Shape::Triangle, "technique"}};
  const Choice choice = indirectPoints(figures, state);
  const std::vector<size_t> front = frontOf(choice.points);
  PlotLine& line = plot.lines.emplace_back();
  line.stairs = true;
  for (size_t i : front) line.x.push_back(choice.points[i].cost), line.y.push_back(choice.points[i].error);
  for (size_t i = 0; i < choice.points.size(); ++i) {
    const CostError& p = choice.points[i];
    const SweepPoint::Kind kind = figures.at(choice.names[i]).point.kind;
    const auto place = std::ranges::find(front, i);
    const bool onFront = place != front.end();
    plot.marks.push_back({.x = p.cost,
                          .y = p.error,
                          .xNoise = onFront ? p.costNoise : 0,
                          .yNoise = onFront ? p.errorNoise : 0,
                          .name = choice.names[i] + format(": %.3g %s, %.3g", p.cost, relative ? "x" : "ms", p.error),
                          .label = onFront ? std::to_string(place - front.begin() + 1) : "",
                          .shape = shapeOf(kind),
                          .filled = onFront || kind == SweepPoint::Kind::Default});
  }
  return plot;
}

std::string frontPlots(const std::string& title, const Figures& figures, bool relative, int height) {
  return svgOf({frontPlot(title, figures, State::Moving, relative), frontPlot(title, figures, State::Still, relative)},
               2, 540, height);
}

/// Of a knob: its points in each scene, in the order in which they should become dearer.
struct KnobCurve {
  std::string scene;
  std::vector<std::string> values;
  std::vector<CostError> points;
};
std::vector<KnobCurve> curvesOf(const Knob& knob, const std::vector<std::string>& scenes,
                                const std::vector<Figures>& figures, State state) {
  std::vector<KnobCurve> curves;
  for (size_t s = 0; s < scenes.size(); ++s) {
    KnobCurve curve{scenes[s], {}, {}};
    for (const char* value : knob.values) {
      const auto found = figures[s].find(knobPoint(knob, value));
      if (found == figures[s].end() || of(found->second, state).cost <= 0 || found->second.point.slow) continue;
      curve.values.push_back(value);
      curve.points.push_back(of(found->second, state));
    }
    if (curve.points.size() >= 2) curves.push_back(std::move(curve));
  }
  return curves;
}

Plot knobPlot(const Knob& knob, const std::vector<KnobCurve>& curves, State state) {
  Plot plot{std::string(knob.setting) + ", " + titleOf(state), "milliseconds a frame", "relMSE", true, true};
  for (size_t s = 0; s < curves.size(); ++s) {
    const KnobCurve& curve = curves[s];
    const Shape shape = Shape(s % 4);
    PlotLine& line = plot.lines.emplace_back();
    line.dashed = s % 2 == 1;
    for (size_t i = 0; i < curve.points.size(); ++i) {
      const CostError& p = curve.points[i];
      line.x.push_back(p.cost), line.y.push_back(p.error);
      plot.marks.push_back({p.cost, p.error, 0, p.errorNoise, curve.scene + ": " + knob.setting + "=" + curve.values[i],
                            curve.values[i], shape});
    }
    plot.legend.emplace_back(shape, curve.scene);
  }
  return plot;
}

/// What a knob does in each scene, in words.
void addVerdicts(Value& rows, const Knob& knob, const std::vector<KnobCurve>& curves, State state) {
  const SettingRow& setting = settingRow(knob.setting);
  const std::string standard = setting.text(setting.standard);
  for (const KnobCurve& curve : curves) {
    const KnobVerdict v = knobVerdict(curve.points);
    const char* buys = v.buys ? "less error" : v.costs ? "nothing here" : "nothing, and costs nothing";
    const bool meant = v.buys || !v.costs || standard == curve.values.front();
    rows.add(Value::of("knob", knob.setting, "scene", curve.scene, "state", titleOf(state), "values",
                       curve.values.front() + " to " + curve.values.back(), "dearer", v.dearer, "nearer", v.nearer,
                       "buys", buys, "default", standard + (meant ? "" : ", not the cheap end"), "monotone",
                       v.monotone ? "yes" : "no"));
  }
}

const std::vector<TableColumn> kVerdictColumns{
    {"knob", "setting"}, {"values", "from, to"},       {"scene", "scene"},
    {"state", "state"},  {"dearer", "time", "%.2f x"}, {"nearer", "error", "%.2f x"},
    {"buys", "buys"},    {"default", "default"},       {"monotone", "dearer at each step"}};

/// Relative error as relMSE counts it: white 0, black kBlackAt and more.
Image heatOf(const Image& picture, const Image& truth) {
  Image heat = truth;
  for (size_t i = 0; i < heat.pixels.size(); ++i) {
    const float b = luminance(truth.pixels[i]), d = luminance(picture.pixels[i]) - b;
    heat.pixels[i] = vec3(1 - std::min(std::abs(d) / std::sqrt(b * b + 0.01f) / kBlackAt, 1.0f));
  }
  return heat;
}

std::string frontPictures(const SweptScene& scene, const Figures& figures, const fs::path& folder) {
  std::string out = htmlPicture(folder, scene.name + "-truth", shownImage(scene.truths[0], scene.exposure), "truth");
  int number = 0;
  for (const std::string& name : frontNames(indirectPoints(figures, State::Still))) {
    const PointFigures& f = figures.at(name);
    const Image picture = readExr(scene.pictures / f.picture);
    const std::string file = scene.name + format("-%d", ++number);
    out += "<span class='pair'>" +
           htmlPicture(folder, file, shownImage(picture, scene.exposure),
                       format("%d: %.0f ms, relMSE %.4f: ", number, f.still.cost, f.still.error) + name) +
           htmlPicture(folder, file + "-error", heatOf(picture, scene.truths[0]), "its error") + "</span>";
  }
  return out;
}

/// Milliseconds of each stage in motion, at the points of the front: those of a hundredth of a frame and more.
std::string frontStages(const Figures& figures) {
  Value rows;
  std::vector<TableColumn> columns{{"number", ""}, {"point", "point"}, {"moving_ms", "frame", "%.1f"}};
  std::set<std::string> listed;
  for (const std::string& name : frontNames(indirectPoints(figures, State::Moving))) {
    const Value& row = figures.at(name).row;
    const double all = row["moving_ms"].number();
    Value& times = rows.add(Value::of("number", rows.size() + 1, "point", name, "moving_ms", all));
    for (const char* stage : kStageNames) {
      const double ms = row.numberOr(std::string("ms_") + stage, 0);
      times[stage] = ms;
      if (ms >= 0.01 * all && listed.insert(stage).second) columns.push_back({stage, stage, "%.1f", 1, ""});
    }
  }
  return htmlTable(columns, rows);
}

Value frontRows(const Figures& figures, State state, bool relative) {
  Value rows;
  for (const std::string& name : frontNames(indirectPoints(figures, state))) {
    const CostError p = of(figures.at(name), state);
    Value& row = rows.add(relative ? Value::of("point", name, "time", p.cost, "error", p.error) : figures.at(name).row);
    row["number"] = rows.size();
  }
  return rows;
}

/// Milliseconds of path tracing over those of the default's frame, for the same relMSE.
Value pathRow(const SweptScene& scene, const Figures& figures, State state) {
  const CostError p = of(figures.at(sweepPoints(SweepPart::Quick)[0].name), state);
  const Value& truth = scene.truth["indirect"];
  const double ofTruth = truth["rel_mse"].number(); // was taken off
  Value row = Value::of("scene", scene.name, "state", titleOf(state), "ms", p.cost, "rel_mse", p.error);
  const std::optional<double> ms =
      pathTracingMs(p.error + ofTruth, ofTruth, truth["sample_ms"].number() * truth["spp"].number());
  row["holds"] = "the truth is too noisy";
  if (!ms) return row;
  const double times = *ms / p.cost;
  row["paths_ms"] = *ms;
  row["times"] = times;
  row["holds"] = holdsBar({times, times * std::hypot(p.costNoise, p.errorNoise)});
  return row;
}

const std::vector<TableColumn> kPathColumns{{"scene", "scene"},
                                            {"state", "state"},
                                            {"ms", "ms a frame", "%.1f"},
                                            {"rel_mse", "relMSE", "%.4f"},
                                            {"paths_ms", "path tracing, ms", "%.0f"},
                                            {"times", "times the frame", "%.0f"},
                                            {"holds", "20 or more"}};

const std::vector<TableColumn> kLadderColumns{{"preset", "preset"},
                                              {"point", "point"},
                                              {"time", "time", "%.2f x"},
                                              {"error", "error", "%.2f x"},
                                              {"step_time", "of the step below: time", "%.2f x"},
                                              {"step_error", "error", "%.2f x"}};

Value pointRow(const Choice& choice, size_t i, const char* noPreset) {
  const CostError& p = choice.points[i];
  Value row = Value::of("point", choice.names[i], "time", p.cost, "error", p.error);
  if (noPreset) row["preset"] = noPreset;
  for (const Preset& preset : presetTable())
    if (presetPoint(preset) == choice.names[i]) row["preset"] = preset.name;
  return row;
}

Value ladderRows(const Choice& choice) {
  Value rows;
  const CostError* below = nullptr;
  for (size_t i : ladderOf(choice.points)) {
    const CostError& p = choice.points[i];
    Value& row = rows.add(pointRow(choice, i, "(none is this)"));
    if (below) row.update(Value::of("step_time", p.cost / below->cost, "step_error", p.error / below->error));
    below = &p;
  }
  return rows;
}

/// What presets are chosen among; which of them are presets, and whether these have left the front.
Value presetRows(const Choice& choice) {
  Value rows;
  for (size_t i = 0; i < choice.points.size(); ++i)
    rows.add(pointRow(choice, i, nullptr))
        .update(Value::of("time_noise", choice.points[i].costNoise, "error_noise", choice.points[i].errorNoise,
                          "off_front", offFront(choice.points, i) ? 1 : 0));
  return rows;
}

/// What the page is about: one scene each, and all together.
struct Report {
  std::vector<SweptScene> scenes;
  std::vector<Figures> figures; // by scene
  std::vector<std::string> names;
  Figures all;
};

Value verdictRows(const Report& r) {
  std::vector<std::string> names = r.names;
  std::vector<Figures> figures = r.figures;
  names.push_back("all together"), figures.push_back(r.all);
  Value rows;
  for (const Knob& knob : knobTable())
    for (State state : kStates) addVerdicts(rows, knob, curvesOf(knob, names, figures, state), state);
  return rows;
}

std::string openingOf(const Report& r, const AccuracyOptions& options, const SweepFrames& frames,
                      const std::string& front) {
  std::string slow, command = "lambent accuracy";
  for (const SweepPoint& p : sweepPoints(options.sweepPart()))
    if (p.slow) slow += (slow.empty() ? "" : ", ") + p.name;
  for (const std::string& file : options.scenes) command += " " + file;
  std::string page = htmlHead("What accuracy costs in time") + "<p>";
  for (const std::string& name : r.names) page += (name == r.names[0] ? "" : ", ") + escaped(name);
  page +=
      format(". %d frames along each shot, then %d standing where these end; error is relMSE of indirect irradiance "
             "against path tracing of that view, time the median of a frame. Bars: one standard error. ",
             frames.moving, frames.still) +
      escaped(machineText(GlContext::headless())) + ".</p>\n<p>Made by <code>" + escaped(command) +
      " --report</code>.</p>\n" + front + "<p>Points of the front, left of and below which there is none:</p>";
  if (!slow.empty())
    page += format("<p>Over %d frames alone, with shorter histories, and so in no plot: ", frames.slow) +
            escaped(slow) + " (all points).</p>";
  const std::vector<TableColumn> columns{
      {"number", ""}, {"point", "point"}, {"time", "time", "%.2f x"}, {"error", "error", "%.2f x"}};
  for (State state : kStates)
    page += "<p>" + std::string(titleOf(state)) + "</p>" + htmlTable(columns, frontRows(r.all, state, true));
  return page;
}

/// Writes the pictures of its front.
std::string sectionOf(const std::string& name, const SweptScene& scene, const Figures& figures,
                      const fs::path& folder) {
  std::vector<TableColumn> columns{{"number", ""}};
  columns.insert(columns.end(), kPointColumns.begin(), kPointColumns.end());
  std::string page =
      "<h2>" + escaped(name) + "</h2>" + frontPlots(name, figures, false, 340) + "<p>The front in motion</p>" +
      htmlTable(columns, frontRows(figures, State::Moving, false)) + "<p>Milliseconds of its stages</p>" +
      frontStages(figures) + "<p>The front standing still</p>" +
      htmlTable(columns, frontRows(figures, State::Still, false)) +
      format("<p>Truth: %d paths a pixel, which leaves a relMSE of %.2g. Errors below: white 0, black %.0f %% "
             "and more.</p>",
             int(scene.truth["indirect"]["spp"].number()), scene.truth["indirect"]["rel_mse"].number(),
             100 * kBlackAt) +
      frontPictures(scene, figures, folder);
  for (const std::string& left : scene.leftOut) page += "<p>Left out: " + escaped(left) + "</p>";
  Value rows;
  for (const auto& [point, f] : figures) rows.add(f.row);
  return page + "<details open><summary>All points</summary>" + htmlTable(kPointColumns, rows) + "</details>\n";
}

std::string knobSection(const Report& r, const Value& verdicts) {
  std::string page =
      "<h2>Setting by setting</h2><p>Each alone, the others at their defaults; values from those that should be "
      "cheap to those that should be dear. A setting that buys nothing leaves errors within their noise (two standard "
      "errors).</p>";
  for (KnobLight light : {KnobLight::Indirect, KnobLight::Direct}) {
    std::vector<Plot> plots;
    for (const Knob& knob : knobTable())
      for (State state : kStates) {
        if (knob.light != light) continue;
        const std::vector<KnobCurve> curves = curvesOf(knob, r.names, r.figures, state);
        if (!curves.empty()) plots.push_back(knobPlot(knob, curves, state));
      }
    if (plots.empty()) continue;
    page += std::string("<h3>") + (light == KnobLight::Direct ? "Direct light" : "Indirect light") + "</h3>" +
            svgOf(plots, 3, 340, 230);
  }
  return page + htmlTable(kVerdictColumns, verdicts);
}

} // namespace

void accuracyReport(const AccuracyOptions& options) {
  refuseNamesakes(options.scenes);
  const fs::path folder = reportFolder(options.output, "out/accuracy",
                                       {"index.html", "front.svg", "points.csv", "knobs.csv", "presets.csv"});
  const FolderLock alone(folder);
  if (!alone.held()) throw RunError(folder.string() + ": another program measures here (--out names another folder)");
  const SweepFrames frames = options.quick ? SweepFrames{4, 2, 6} : SweepFrames{};
  Report r;
  for (const std::string& file : options.scenes) {
    r.scenes.push_back(sweepScene(options, file, folder, frames));
    r.names.push_back(r.scenes.back().name);
    r.figures.push_back(figuresOf(r.scenes.back()));
  }
  r.all = overScenes(r.figures);
  const Choice presets = presetChoice(r.all);
  const Value verdicts = verdictRows(r);
  Value points, paths;
  for (size_t s = 0; s < r.scenes.size(); ++s) {
    for (const auto& [name, f] : r.figures[s]) {
      points.add(f.row)["scene"] = r.names[s];
    }
    for (State state : kStates) paths.add(pathRow(r.scenes[s], r.figures[s], state));
  }
  const std::string front = frontPlots("All scenes", r.all, true, 380);
  std::string page =
      openingOf(r, options, frames, front) +
      format("<h2>Presets by rule</h2><p>Among the default and the joint sweep: the longest ladder of the front whose "
             "steps take at least %g times the time and leave at most %g times the error, over all scenes, moving and "
             "still.</p>",
             LadderRule{}.dearer, LadderRule{}.nearer) +
      htmlTable(kLadderColumns, ladderRows(presets)) +
      "<h2>Beside path tracing</h2><p>Time in which our own path tracer comes as near as a frame of the default.</p>" +
      htmlTable(kPathColumns, paths);
  for (size_t s = 0; s < r.scenes.size(); ++s) page += sectionOf(r.names[s], r.scenes[s], r.figures[s], folder);
  page += knobSection(r, verdicts) + "</html>\n";

  writeText(folder / "index.html", page);
  writeText(folder / "front.svg", front);
  writeText(folder / "points.csv", csvText(points));
  writeText(folder / "knobs.csv", csvText(verdicts));
  writeText(folder / "presets.csv", csvText(presetRows(presets)));
  writeJson(options.output.json,
            Value::of("points", points, "knobs", verdicts, "ladder", ladderRows(presets), "presets",
                      presetRows(presets), "paths", paths, "front_moving", frontRows(r.all, State::Moving, true),
                      "front_still", frontRows(r.all, State::Still, true)));
  if (options.output.quiet) return;
  std::printf("%s\n%s\nreport: %s\n", tableText(kLadderColumns, ladderRows(presets)).c_str(),
              tableText(kPathColumns, paths).c_str(), (folder / "index.html").c_str());
}

} // namespace lambent

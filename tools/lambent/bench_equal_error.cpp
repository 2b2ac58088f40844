// lambent bench --equal-error SCENE|SHOT...: of each preset and the default the error of indirect irradiance, in a
// still view after averaging and in shots in motion, and the time that our path tracer takes to the same error
// (relMSE).
#include "engine/core/error.h"
#include "gi/plan/presets.h"
#include "tools/lambent/bench.h"
#include "tools/lambent/html.h"
#include "tools/lambent/study.h"

#include <algorithm>
#include <cstdio>

namespace lambent {

namespace fs = std::filesystem;

namespace {

constexpr const char* kDefault = "default"; // no preset

/// What one preset reached over the seeds, in one kind of view.
nlohmann::json rowOf(std::span<const Measured> seeds, const TracedPicture& truth) {
  std::vector<double> errors, frameMs, allMs, pathMs, times, timesAll;
  for (const Measured& m : seeds) {
    errors.push_back(pictureError(m.picture, truth.picture.mean).relMse);
    frameMs.push_back(steadyMs(m.frames).value_or(m.frames.back().wallMs));
    allMs.push_back(0);
    for (const FrameStats& s : m.frames) allMs.back() += s.wallMs;
    if (const auto ms = pathsMs(truth, errors.back())) {
      pathMs.push_back(*ms);
      times.push_back(*ms / frameMs.back());
      timesAll.push_back(*ms / allMs.back());
    }
  }
  nlohmann::json row{{"preset", seeds[0].variant.name}, {"seeds", seeds.size()}, {"pictures", seeds[0].frames.size()}};
  const auto add = [&](const std::string& key, const std::vector<double>& values) {
    const UncertainValue mean = meanOver(values);
    row[key] = mean.value;
    if (!std::isnan(mean.error)) row[key + "_error"] = mean.error;
  };
  add("rel_mse", errors);
  add("ms", frameMs);
  row["truth_rel_mse"] = expectedRelMse(truth.picture.mean, truth.picture.error);
  if (pathMs.size() < seeds.size()) {
    row["holds"] = "truth too noisy";
    return row;
  }
  add("paths_ms", pathMs);
  add("times", times);
  add("times_all_pictures", timesAll);
  row["holds"] = holdsBar(meanOver(times));
  return row;
}

std::vector<Variant> variantsOf(const BenchOptions& options, const Study& study) {
  std::vector<std::string> presets = presetNames();
  presets.push_back(kDefault);
  if (!options.launch.preset.empty()) presets = {options.launch.preset};
  std::vector<Variant> variants;
  for (const std::string& preset : presets) {
    LaunchOptions launch = study.launch;
    launch.preset = preset == kDefault ? "" : preset; // under what the command line sets
    for (int k = 0; k < options.seeds; ++k)
      variants.push_back({preset, chosenSettings(launch, study.stage->shot), study.stage->seed + uint32_t(k)});
  }
  return variants;
}

void addRows(const BenchOptions& options, const std::string& file, nlohmann::json& rows) {
  AccuracyOptions accuracy;
  accuracy.launch = options.launch;
  accuracy.launch.scene = file;
  accuracy.output = options.output;
  accuracy.quick = options.quick;
  accuracy.samples = options.samples;
  Study study(accuracy, "160x90");
  if (study.stage->settings.frame.overlap)
    throw InputError("setting frame.overlap", "cannot be on here (pictures would show the light of the frame before)");
  const std::vector<Variant> variants = variantsOf(options, study);
  const auto add = [&](const std::string& motion, const std::vector<Measured>& runs) {
    for (size_t i = 0; i < runs.size(); i += size_t(options.seeds)) {
      rows.push_back(rowOf(std::span(runs).subspan(i, size_t(options.seeds)), *study.truth));
      rows.back().update({{"scene", fs::path(file).stem().string()}, {"motion", motion}});
    }
  };
  const int last = study.stage->shot ? study.stage->shot->frameCount() - 1 : 0; // 0: nothing moves
  const int frame = options.frame > 0 ? options.frame : std::min(options.quick ? 3 : 30, last);
  if (last > 0 && frame > last) throw InputError("--frame", "the shot has only " + std::to_string(last + 1));
  constexpr int kPaths = 2048;
  study.trace(kPaths, ReferenceBuffer::Irradiance, false);
  const int averaged = std::max(2, study.stage->settings.history.frames);
  add("still", study.draw(variants, Buffer::Irradiance, options.quick ? 4 : averaged));
  if (last < 1) return;
  study.trace(kPaths, ReferenceBuffer::Irradiance, false, {}, frame);
  add("frame " + std::to_string(frame), study.drawUpTo(frame, variants, Buffer::Irradiance));
}

/// As "12.3 ± 0.4".
std::string withError(const nlohmann::json& row, const std::string& key, const char* pattern) {
  if (!row.contains(key)) return "";
  std::string text = format(pattern, row[key].get<double>());
  if (row.contains(key + "_error")) text += " ± " + format(pattern, row[key + "_error"].get<double>());
  return text;
}

std::string tableOf(const nlohmann::json& rows) {
  nlohmann::json cells = rows;
  for (nlohmann::json& row : cells) {
    for (const auto& [key, pattern] : {std::pair{"rel_mse", "%.4f"},
                                       {"ms", "%.1f"},
                                       {"paths_ms", "%.0f"},
                                       {"times", "%.1f"},
                                       {"times_all_pictures", "%.2f"}})
      row[key] = withError(row, key, pattern);
  }
  return tableText({{"scene", "scene"},
                    {"motion", "motion"},
                    {"preset", "preset"},
                    {"rel_mse", "relMSE"},
                    {"truth_rel_mse", "of the truth", "%.4f"},
                    {"ms", "ms a frame"},
                    {"paths_ms", "ms of path tracing to that error"},
                    {"times", "times the frame"},
                    {"pictures", "pictures"},
                    {"times_all_pictures", "times all pictures"},
                    {"holds", "20 times or more"}},
                   cells);
}

} // namespace

void benchEqualError(const BenchOptions& options) {
  for (const std::string& file : options.scenes) // before minutes are spent on those before it
    if (!fs::exists(file)) throw InputError(file, "no such file");
  const fs::path folder = reportFolder(options.output.out, "out/bench");
  nlohmann::json rows = nlohmann::json::array();
  for (const std::string& file : options.scenes) addRows(options, file, rows);

  const std::string judged = options.launch.preset.empty() ? kDefault : options.launch.preset;
  std::vector<std::string> otherwise;
  size_t of = 0;
  for (const nlohmann::json& row : rows) {
    if (row["preset"] != judged) continue;
    ++of;
    if (row["holds"] != "yes")
      otherwise.push_back(row["scene"].get<std::string>() + ", " + row["motion"].get<std::string>() + " (" +
                          row["holds"].get<std::string>() + ")");
  }
  std::string verdict = format("A frame at %s takes at most 1/%.0f of path tracing's time to its error in %zu "
                               "of %zu views",
                               (judged == kDefault ? "the defaults" : "preset " + judged).c_str(), kPathTracingTimes,
                               of - otherwise.size(), of);
  for (const std::string& view : otherwise)
    verdict += (&view == otherwise.data() ? "; not so or not known: " : "; ") + view;
  verdict += otherwise.empty() ? ": the bar holds.\n" : ".\n";
  const std::string conditions =
      "Error of indirect irradiance against path tracing, whose time to the same follows from its variance and pace. "
      "Means over " +
      std::to_string(options.seeds) +
      " seeds ± standard errors. Still: after as many pictures as are "
      "averaged; \"times all pictures\" counts the time of each of them, the first with all that it makes.\n";
  const std::string table = tableOf(rows);
  writeJson(options.output.json,
            {{"rows", rows}, {"bar", kPathTracingTimes}, {"preset", judged}, {"holds", otherwise.empty() && of > 0}});
  writeText(folder / "equal-error.md",
            escaped("# Path tracing's time to the same error\n\n" + conditions + "\n" + table + "\n" + verdict));
  writeText(folder / "equal-error.csv", csvText(rows));
  if (!options.output.quiet)
    std::printf("%s%s%sreport: %s\n", conditions.c_str(), table.c_str(), verdict.c_str(),
                (folder / "equal-error.md").c_str());
}

} // namespace lambent

// lambent bench --equal-error SCENE|SHOT...: of each preset and the default the error of indirect irradiance, in a
// still view after averaging and in shots in motion, and the time that our path tracer takes to the same error
// (relMSE).
#include "engine/core/error.h"
#include "tools/lambent/bench.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace lambent {

namespace fs = std::filesystem;

namespace {

constexpr const char* kDefault = "default"; // no preset

/// Means over the seeds, shown with their standard errors.
constexpr TableColumn kMeans[] = {{"rel_mse", "relMSE", "%.4f"},
                                  {"ms", "ms a frame", "%.1f"},
                                  {"paths_ms", "ms of path tracing to that error", "%.0f"},
                                  {"times", "times the frame", "%.1f"},
                                  {"times_all_pictures", "times all pictures", "%.2f"}};

/// What one preset reached over the seeds, in one kind of view.
Value presetRow(std::span<const Measured> seeds, const TracedImage& truth) {
  std::map<std::string, std::vector<double>> values; // by column
  for (const Measured& m : seeds) {
    const double error = imageError(m.image, truth.image.mean).relMse;
    const double ms = steadyMs(m.frames).value_or(m.frames.back().wallMs);
    double allMs = 0;
    for (const FrameStats& s : m.frames) allMs += s.wallMs;
    values["rel_mse"].push_back(error);
    values["ms"].push_back(ms);
    if (const auto paths = pathsMs(truth, error)) {
      values["paths_ms"].push_back(*paths);
      values["times"].push_back(*paths / ms);
      values["times_all_pictures"].push_back(*paths / allMs);
    }
  }
  const bool known = values["paths_ms"].size() == seeds.size();
  Value row = Value::of("preset", seeds[0].variant.name, "seeds", seeds.size(), "pictures", seeds[0].frames.size(),
                        "truth_rel_mse", expectedRelMse(truth.image.mean, truth.image.error), "holds",
                        known ? holdsBar(meanOver(values["times"])) : "truth too noisy");
  for (const auto& [key, own] : values) {
    if (own.size() < seeds.size()) continue;
    const UncertainValue mean = meanOver(own);
    row[key] = mean.value;
    if (!std::isnan(mean.error)) row[key + "_error"] = mean.error;
  }
  return row;
}

void addRows(const BenchOptions& options, const std::string& file, int seeds, Value& rows) {
  Study study(options, file, {.size = "160x90"});
  if (study.opened->settings.frame.overlap)
    throw InputError("setting frame.overlap", "cannot be on here (pictures would show the light of the frame before)");
  std::vector<std::string> presets = presetNames();
  presets.push_back(kDefault);
  if (!options.launch.preset.empty()) presets = {options.launch.preset};
  std::vector<Variant> variants;
  for (const std::string& preset : presets) {
    LaunchOptions launch = study.launch;
    launch.preset = preset == kDefault ? "" : preset; // under what the command line sets
    variants.push_back({preset, chosenSettings(launch, study.opened->shot), study.opened->seed});
  }
  variants = seeded(variants, seeds);
  const auto add = [&](const std::string& motion, const std::vector<Measured>& runs) {
    for (size_t i = 0; i < runs.size(); i += size_t(seeds)) {
      Value& row = rows.add(presetRow(std::span(runs).subspan(i, size_t(seeds)), *study.traced));
      row["scene"] = nameOf(file);
      row["motion"] = motion;
    }
  };
  const int last = study.opened->shot ? study.opened->shot->frameCount() - 1 : 0; // 0: nothing moves
  const int frame = options.frame > 0 ? options.frame : std::min(options.quick ? 3 : 30, last);
  if (last > 0 && frame > last) throw InputError("--frame", "the shot has only " + std::to_string(last + 1));
  constexpr int kPaths = 2048;
  study.trace(kPaths, ReferenceBuffer::Irradiance);
  const int averaged = std::max(2, study.opened->settings.history.frames);
  add("still", study.draw(variants, Buffer::Irradiance, options.quick ? 4 : averaged));
  if (last < 1) return;
  study.trace(kPaths, ReferenceBuffer::Irradiance, false, {}, frame);
  add("frame " + std::to_string(frame), study.drawUpTo(frame, variants, Buffer::Irradiance));
}

std::string equalErrorText(const Value& rows) {
  Value cells = rows;
  for (Value& row : cells.items())
    for (const TableColumn& c : kMeans) { // as "12.3 ± 0.4"
      if (!row.has(c.key)) continue;
      const std::string error = std::string(c.key) + "_error";
      row[c.key] = format(c.pattern, row[c.key].number()) +
                   (row.has(error) ? " ± " + format(c.pattern, row[error].number()) : "");
    }
  return tableText({{"scene", "scene"},
                    {"motion", "motion"},
                    {"preset", "preset"},
                    kMeans[0],
                    {"truth_rel_mse", "of the truth", "%.4f"},
                    kMeans[1],
                    kMeans[2],
                    kMeans[3],
                    {"pictures", "pictures"},
                    kMeans[4],
                    {"holds", "20 times or more"}},
                   cells);
}

} // namespace

void benchEqualError(const BenchOptions& options) {
  const fs::path folder = reportFolder(options.output, "out/bench", {"equal-error.csv", "equal-error.md"});
  const int seeds = options.seeds.value_or(3);
  Value rows = Value::list();
  for (const std::string& file : options.scenes) addRows(options, file, seeds, rows);

  const std::string judged = options.launch.preset.empty() ? kDefault : options.launch.preset;
  std::string otherwise;
  int views = 0, held = 0;
  for (const Value& row : rows.items()) {
    if (row["preset"].text() != judged) continue;
    ++views;
    if (row["holds"].text() == "yes")
      ++held;
    else
      otherwise += (otherwise.empty() ? "; not so or not known: " : "; ") + row["scene"].text() + ", " +
                   row["motion"].text() + " (" + row["holds"].text() + ")";
  }
  const std::string verdict =
      format("A frame at %s takes at most 1/%.0f of path tracing's time to its error in %d of %d views",
             (judged == kDefault ? "the defaults" : "preset " + judged).c_str(), kPathTracingTimes, held, views) +
      (otherwise.empty() ? ": the bar holds" : otherwise) + ".\n";
  const std::string conditions =
      format("Error of indirect irradiance against path tracing, whose time to the same follows from its variance and "
             "pace. Means over %d seeds ± standard errors. ",
             seeds) +
      "Still: after as many pictures as are averaged; \"times all pictures\" counts the time of each of them, the "
      "first "
      "with all that it makes.\n";
  writeReport(
      options.output, folder, "equal-error", "Path tracing's time to the same error",
      conditions + "\n" + equalErrorText(rows) + "\n" + verdict, csvText(rows),
      Value::of("rows", rows, "bar", kPathTracingTimes, "preset", judged, "holds", otherwise.empty() && views > 0));
}

} // namespace lambent

#include "engine/core/error.h"
#include "tools/lambent/commands.h"

#include <cstdio>
#include <fstream>

namespace lambent {

void addOutputOptions(CLI::App& command, OutputOptions& options, const std::string& outHelp) {
  if (!outHelp.empty()) command.add_option("--out", options.out, outHelp);
  command.add_option("--json", options.json, "write the figures to this file, for programs")
      ->check([](const std::string& file) { // before the work
        checkWritable(file);
        return std::string();
      });
  command.add_flag("--quiet", options.quiet, "print nothing but errors");
}

void sayWarning(const FrameStats& stats) {
  if (!stats.warning.empty()) std::fprintf(stderr, "warning: %s\n", printable(stats.warning).c_str());
}

void addBufferOption(CLI::App& command, std::string& buffer, const std::string& doing) {
  std::string names, views;
  for (const std::string& name : bufferNames()) {
    std::string& list = bufferByName(name) <= Buffer::Depth ? names : views;
    list += (list.empty() ? "" : ", ") + name + (name == buffer ? " (default)" : "");
  }
  command.add_option("--buffer", buffer, "what to " + doing + ": " + names + "; to look inside: " + views);
}

void say(const LaunchContext& stage, bool quiet) {
  if (quiet) return;
  for (const std::string& w : stage.scene.warnings) std::fprintf(stderr, "warning: %s\n", printable(w).c_str());
  for (const std::string& n : stage.notes) std::fprintf(stderr, "note: %s\n", printable(n).c_str());
}

void writeJson(const std::string& file, const nlohmann::json& figures) {
  if (file.empty()) return;
  writeAtomically(file, [&](const std::filesystem::path& temporary) {
    std::ofstream out(temporary);
    out << figures.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
    if (!out.flush()) throw RunError(file + ": cannot be written");
  });
}

void checkPictureName(const std::string& file) {
  const std::string extension = std::filesystem::path(file).extension().string();
  if (extension != ".png" && extension != ".exr")
    throw InputError(file, "not a picture format that can be written (.png or .exr)");
  checkWritable(file);
}

void writeBuffer(const std::string& file, const Viewer& gi, Buffer buffer, int width, int height) {
  checkPictureName(file);
  if (std::filesystem::path(file).extension() == ".exr") return writeExr(file, gi.read(buffer));
  const Image8 picture = gi.readDisplay(buffer);
  const bool fits = width == 0 || (picture.width == width && picture.height == height);
  writePng(file, fits ? picture : resized(picture, width, height));
}

namespace {

template <class Value> nlohmann::json jsonOf(const Value& value) { return value; }
nlohmann::json jsonOf(const RayCounts& c) { return {{"closest", c.closest}, {"occlusion", c.occlusion}}; }

} // namespace

nlohmann::json figuresOf(const FrameStats& s) {
  nlohmann::json figures;
  for (const FigureRow& row : figureTable()) {
    const std::string name = row.name;
    const size_t dot = name.find('.');
    nlohmann::json& at = dot == std::string::npos ? figures[name] : figures[name.substr(0, dot)][name.substr(dot + 1)];
    at = std::visit([](const auto& value) { return jsonOf(value); }, row.value(s));
  }
  figures["shadow_maker_times"] = s.makerTimes;
  figures["area_tracer"] = s.areaTracer;
  figures["cube"]["maker_times"] = s.cubeMakerTimes;
  for (const StageTime& t : s.stages)
    figures["stages"].push_back({{"name", t.stage.name}, {"cpu_ms", t.cpuMs}, {"gpu_ms", t.gpuMs}});
  for (size_t i = 0; i < kEffects; ++i) {
    const Effect& e = s.plan[EffectId(i)];
    const EffectRow& row = effectRow(EffectId(i));
    figures["effects"].push_back({{"name", row.name}, {"on", e.on}, {"reason", e.reason}, {row.work, s.work[i]}});
  }
  return figures;
}

RunPlan planOf(LaunchContext& stage, Progress& progress, int frames) {
  const int all = stage.shot ? stage.shot->frameCount() : 60;
  const double fps = stage.shot ? stage.shot->fps : 30;
  return {.view = [&stage, fps](int frame) { return stage.at(frame / fps); },
          .frames = frames > 0 ? std::min(frames, all) : all,
          .cancelled = [] { return interrupted.load(); },
          .progress = [&progress](int done, int total) { progress.update(done, total); }};
}

} // namespace lambent

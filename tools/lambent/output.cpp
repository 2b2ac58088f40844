#include "engine/core/error.h"
#include "engine/core/rng.h"
#include "engine/gl/program.h"
#include "engine/scene/sky_file.h"
#include "tools/lambent/commands.h"
#include "tools/lambent/picture.h"

#include <algorithm>
#include <cstdio>

namespace lambent {

namespace fs = std::filesystem;

namespace {

uint64_t hashOf(const std::string& text, uint64_t hash = 0) {
  for (char c : text) hash = mix64(hash ^ uint8_t(c));
  return hash;
}

/// The program with its shaders: what another one made is not ours.
uint64_t hashOfProgram() {
  uint64_t hash = hashOf(readText("/proc/self/exe"));
  std::vector<fs::path> files;
  if (!gl::shaderFolder().empty())
    for (const fs::directory_entry& e : fs::recursive_directory_iterator(gl::shaderFolder()))
      if (e.is_regular_file()) files.push_back(e.path());
  std::ranges::sort(files);
  for (const fs::path& file : files) hash = hashOf(readText(file), hash);
  return hash;
}

} // namespace

std::string bufferHelp(const std::string& standard, const std::string& doing) {
  std::string names, views;
  for (const std::string& name : bufferNames()) {
    std::string& list = bufferByName(name) <= Buffer::Depth ? names : views;
    list += (list.empty() ? "" : ", ") + name + (name == standard ? " (default)" : "");
  }
  return "what to " + doing + ": " + names + "; to look inside: " + views;
}

std::unique_ptr<LaunchContext> openAndSay(const LaunchOptions& launch, bool quiet, WatchUntil until) {
  std::unique_ptr<LaunchContext> opened = openLaunch(launch, until);
  say(*opened, quiet);
  return opened;
}

void say(const LaunchContext& opened, bool quiet) {
  if (quiet) return;
  for (const std::string& w : opened.scene.warnings) std::fprintf(stderr, "warning: %s\n", printable(w).c_str());
  for (const std::string& n : opened.notes) std::fprintf(stderr, "note: %s\n", printable(n).c_str());
}

void sayWarning(const FrameStats& stats) {
  if (!stats.warning.empty()) std::fprintf(stderr, "warning: %s\n", printable(stats.warning).c_str());
}

void writeBuffer(const std::string& file, const Viewer& gi, Buffer buffer) {
  checkPictureName(file);
  if (fs::path(file).extension() == ".exr") return writeExr(file, gi.read(buffer));
  writePng(file, gi.readDisplay(buffer));
}

Value figuresOf(const FrameStats& s) {
  Value figures;
  for (const FigureRow& row : figureTable()) {
    const std::string name = row.name;
    const size_t dot = name.find('.');
    Value& at = dot == std::string::npos ? figures[name] : figures[name.substr(0, dot)][name.substr(dot + 1)];
    at = std::visit(
        [](const auto& figure) -> Value {
          if constexpr (std::is_same_v<decltype(figure), const RayCounts&>)
            return Value::of("closest", figure.closest, "occlusion", figure.occlusion);
          else
            return figure;
        },
        row.value(s));
  }
  figures["shadow_maker_times"] = s.makerTimes;
  figures["area_tracer"] = s.areaTracer;
  figures["cube"]["maker_times"] = s.cubeMakerTimes;
  for (const StageTime& t : s.stages)
    figures["stages"].add(Value::of("name", t.stage.name, "cpu_ms", t.cpuMs, "gpu_ms", t.gpuMs));
  for (size_t i = 0; i < kEffects; ++i) {
    const Effect& e = s.plan[EffectId(i)];
    const EffectRow& row = effectRow(EffectId(i));
    figures["effects"].add(Value::of("name", row.name, "on", e.on, "reason", e.reason, row.work, s.work[i]));
  }
  return figures;
}

std::string conditionsOf(const LaunchContext& opened, const LaunchOptions& o, const std::string& more) {
  std::string text = more + '\n' + o.scene + '\n' + readText(o.scene);
  for (const std::string& option :
       {std::string(o.trust.outside ? "outside" : ""), std::string(o.twoSided ? "two-sided" : ""), o.camera, o.eye,
        o.target, o.size, o.sky, o.daylight, o.sceneName, std::to_string(o.fovDegrees.value_or(0)),
        std::to_string(o.sunSize.value_or(-1)), std::to_string(o.seed),
        format("%.17g %.17g %.17g", o.skyScale, o.skyTurn, opened.unit)})
    text += '\n' + option;
  if (namesSky(o.sky)) text += readText(o.sky);
  for (const SettingRow& row : settingRows(opened.settings)) text += '\n' + settingText(opened.settings, row.name);
  for (const std::string& light : o.suns) text += "\nsun " + light;
  for (const std::string& light : o.points) text += "\npoint " + light;
  uint64_t hash = hashOf(text, hashOfProgram());
  for (const fs::path& file : opened.scene.files) hash = hashOf(readText(file), hash);
  return format("%016llx", static_cast<unsigned long long>(hash));
}

} // namespace lambent

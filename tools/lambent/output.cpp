#include "engine/core/error.h"
#include "tools/lambent/commands.h"

#include <cstdio>
#include <fstream>

namespace lambent {

void addOutputOptions(CLI::App& command, OutputOptions& options, const std::string& outHelp) {
  if (!outHelp.empty()) command.add_option("--out", options.out, outHelp);
  command.add_option("--json", options.json, "write the figures to this file, for programs");
  command.add_flag("--quiet", options.quiet, "print nothing but errors");
}

void say(const Stage& stage, bool quiet) {
  if (quiet) return;
  for (const std::string& w : stage.scene.warnings) std::fprintf(stderr, "warning: %s\n", w.c_str());
  for (const std::string& n : stage.notes) std::fprintf(stderr, "note: %s\n", n.c_str());
}

void writeJson(const std::string& file, const nlohmann::json& figures) {
  if (file.empty()) return;
  writeAtomically(file, [&](const std::filesystem::path& temporary) {
    std::ofstream out(temporary);
    out << figures.dump(2) << "\n";
    if (!out.flush()) throw RunError(file + ": cannot be written");
  });
}

void checkPictureName(const std::string& file) {
  const std::string extension = std::filesystem::path(file).extension().string();
  if (extension != ".png" && extension != ".exr")
    throw InputError(file, "not a picture format that can be written (.png or .exr)");
}

void writeBuffer(const std::string& file, const GiFrame& gi, Buffer buffer) {
  checkPictureName(file);
  if (std::filesystem::path(file).extension() == ".exr")
    writeExr(file, gi.read(buffer));
  else
    writePng(file, gi.readDisplay(buffer));
}

nlohmann::json figuresOf(const FrameStats& s) {
  const auto rays = [](const RayCounts& c) {
    return nlohmann::json{{"closest", c.closest}, {"occlusion", c.occlusion}};
  };
  nlohmann::json stages = nlohmann::json::array();
  for (const StageTime& t : s.stages) stages.push_back({{"name", t.name}, {"cpu_ms", t.cpuMs}, {"gpu_ms", t.gpuMs}});
  nlohmann::json effects = nlohmann::json::array();
  for (size_t i = 0; i < kEffects; ++i) {
    const Effect& e = s.plan[EffectId(i)];
    const EffectRow& row = effectRow(EffectId(i));
    effects.push_back({{"name", row.name}, {"on", e.on}, {"reason", e.reason}, {row.work, s.work[i]}});
  }
  return {{"frame", s.frame},
          {"wall_ms", s.wallMs},
          {"stages", stages},
          {"rays",
           {{"points", rays(s.raysPoints)},
            {"validation", rays(s.raysValidation)},
            {"candidates", rays(s.raysCandidates)},
            {"radiosity", rays(s.raysRadiosity)},
            {"cells", rays(s.raysCells)},
            {"map_tests", rays(s.raysMapTests)},
            {"gather", rays(s.raysGather)}}},
          {"vpls",
           {{"alive", s.vplsAlive},
            {"kept", s.vplsKept},
            {"moved", s.vplsMoved},
            {"invalid", s.vplsInvalid},
            {"relit", s.vplsRelit}}},
          {"paths", {{"held", s.pathsHeld}, {"traced", s.pathsTraced}, {"retraced", s.pathsRetraced}}},
          {"maps_drawn", s.mapsDrawn},
          {"maps_waiting", s.mapsWaiting},
          {"light_maps_drawn", s.lightMapsDrawn},
          {"burst", s.burst},
          {"effects", effects},
          {"shadow_maker", s.shadowMaker},
          {"timing", s.timing}};
}

} // namespace lambent

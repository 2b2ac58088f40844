// The commands of `lambent`, one file each. A declare… function adds the command to the app; its callback runs it and
// throws InputError (exit 2) or RunError (exit 1).
#pragma once

#include "engine/core/progress.h"
#include "gi/measure/runs/runs.h"
#include "tools/launch/launch.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <atomic>
#include <string>

namespace lambent {

/// What every command has.
struct OutputOptions {
  std::string out, json;
  bool quiet = false;
};

void declareDoctor(CLI::App& app);
void declareInspect(CLI::App& app);
void declareRender(CLI::App& app);
void declareRecord(CLI::App& app);
void declareAccuracy(CLI::App& app);
void declareReference(CLI::App& app);
void declareCompare(CLI::App& app);
void declareStability(CLI::App& app);
void declareBench(CLI::App& app);
void declareSoak(CLI::App& app);
void declareContent(CLI::App& app);
void declareSettings(CLI::App& app);
void declareTechniques(CLI::App& app);

void addOutputOptions(CLI::App& command, OutputOptions& options, const std::string& outHelp);
/// --buffer with the names of all that can be looked at. `doing`: "draw", "record".
void addBufferOption(CLI::App& command, std::string& buffer, const std::string& doing);
/// Notes and warnings of a stage on stderr, unless quiet.
void say(const LaunchContext& stage, bool quiet);
/// What a frame warns of, if anything: also where quiet.
void sayWarning(const FrameStats& stats);
/// Writes figures for programs; nothing when `file` is empty.
void writeJson(const std::string& file, const nlohmann::json& figures);
/// What to write for a buffer by the file's extension: .exr linear, .png as a display shows it. Throws InputError for
/// others. A .png is brought to this size where one is given.
void writeBuffer(const std::string& file, const Viewer& gi, Buffer buffer, int width = 0, int height = 0);
/// Checks before long work that `file` has an extension that can be written, and a folder that takes it.
void checkPictureName(const std::string& file);
nlohmann::json figuresOf(const FrameStats& stats);

/// A run over the first frames of the stage's shot (0: all; of a scene 60), until Ctrl-C.
RunPlan planOf(LaunchContext& stage, Progress& progress, int frames);

/// Set by Ctrl-C: long work ends after the present frame.
extern std::atomic<bool> interrupted;

} // namespace lambent

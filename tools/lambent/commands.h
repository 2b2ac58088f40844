// The commands of `lambent`. A declare… function adds the command to the app.
#pragma once

#include "engine/core/interrupt.h"
#include "gi/measure/runs/runs.h"
#include "gi/reference/traced_image.h"
#include "tools/lambent/command_line.h"
#include "tools/lambent/report.h"

#include <string>

namespace lambent {

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

/// Of --buffer: the names of all that can be looked at. `doing`: "draw", "record".
std::string bufferHelp(const std::string& standard, const std::string& doing);
/// Opens what the options say; its notes and warnings go to stderr, unless quiet.
std::unique_ptr<LaunchContext> openAndSay(const LaunchOptions& launch, bool quiet,
                                          WatchUntil until = WatchUntil::Opened);
/// Notes and warnings on stderr, unless quiet.
void say(const LaunchContext& opened, bool quiet);
/// What a frame warns of, if anything: also where quiet.
void sayWarning(const FrameStats& stats);
/// What to write for a buffer by the file's extension: .exr linear, .png as a display shows it. Throws InputError for
/// others.
void writeBuffer(const std::string& file, const Viewer& gi, Buffer buffer);
Value figuresOf(const FrameStats& stats);

/// Hash of the program with its shaders, of the files of scene and shot, of what was opened and how, and of `more`; 16
/// hexadecimal digits. Not of pictures and buffers next to a scene's file. Work that was interrupted goes on under the
/// same conditions only.
std::string conditionsOf(const LaunchContext& opened, const LaunchOptions& options, const std::string& more);

} // namespace lambent

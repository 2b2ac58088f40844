// lambent record SHOT: every frame of a shot → images, frame log, video.
#include "engine/core/error.h"
#include "engine/core/progress.h"
#include "engine/platform/gl_context.h"
#include "gi/plan/governor.h"
#include "tools/lambent/commands.h"
#include "tools/lambent/conditions.h"
#include "tools/lambent/text.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <optional>
#include <sstream>

namespace lambent {

namespace fs = std::filesystem;

namespace {

struct RecordOptions {
  LaunchOptions launch;
  OutputOptions output;
  std::string buffer = "beauty", format = "png";
  int frames = 0; // 0 = the whole shot
  bool video = false, resume = false;
  std::optional<double> targetMs;
};

/// Keeps the log in memory and writes it whole, so that it is never half-written.
class FrameLog {
 public:
  /// `governed`: of the frame; null: nothing governs.
  void add(double time, const FrameStats& s, double writeMs, const Governed* governed) {
    rows_.push_back({time, s, writeMs, governed ? governed->scale : 1, governed ? governed->preset : ""});
    governed_ |= governed != nullptr;
    for (const StageTime& t : s.stages) stages_[t.stage.id] = true;
  }

  /// Columns are those of the table of figures, and scene time and time to write a picture.
  void write(const fs::path& file) const {
    writeAtomically(file, [&](const fs::path& temporary) {
      std::ofstream out(temporary);
      for (size_t i = 0; i < std::max<size_t>(1, rows_.size()); ++i) {
        const Row row = rows_.empty() ? Row{} : rows_[i];
        const std::vector<FigureColumn> columns = columnsOf(row.stats, stages_);
        if (i == 0) {
          out << "time_s,write_ms" << (governed_ ? ",scale,preset" : "");
          for (const FigureColumn& c : columns) out << ',' << c.name;
          out << '\n';
          if (rows_.empty()) break;
        }
        out << format("%.6f,%.3f", row.time, row.writeMs);
        if (governed_) out << format(",%.4f,", double(row.scale)) << row.preset;
        for (const FigureColumn& c : columns) out << ',' << c.text;
        out << '\n';
      }
      if (!out.flush()) throw RunError(file.string() + ": cannot be written");
    });
  }

  /// Frames per second over all frames but the first (which warms the set up), pictures on disk included.
  double framesPerSecond() const {
    double ms = 0;
    for (size_t i = 1; i < rows_.size(); ++i) ms += rows_[i].stats.wallMs + rows_[i].writeMs;
    return ms > 0 ? 1000 * double(rows_.size() - 1) / ms : 0;
  }

 private:
  struct Row {
    double time = 0;
    FrameStats stats;
    double writeMs = 0;
    float scale = 1;
    std::string preset = {};
  };

  std::vector<Row> rows_;
  bool governed_ = false;
  std::array<bool, kStages> stages_{}; // that ran in any frame
};

/// In the folder: whose pictures they are, and how many are whole.
class RecordingMark {
 public:
  RecordingMark(const fs::path& folder, std::string conditions)
      : file_(folder / "recording.json"), conditions_(std::move(conditions)) {}

  /// Pictures that an interrupted recording left here. Throws InputError where they are another one's.
  int kept() const {
    removeLeftovers(file_);
    const nlohmann::json mark = nlohmann::json::parse(std::ifstream(file_), nullptr, false);
    const auto conditions = mark.is_object() ? mark.find("conditions") : mark.end();
    const auto frames = mark.is_object() ? mark.find("frames") : mark.end();
    if (conditions == mark.end() || frames == mark.end() || !frames->is_number_unsigned()) return 0;
    if (*conditions != conditions_)
      throw InputError("--resume", file_.parent_path().string() + " holds a recording of another shot, size, buffer, " +
                                       "setting or program (without --resume it is recorded anew)");
    return frames->get<int>();
  }

  void write(int frames) const {

    writeAtomically(file_, [&](const fs::path& temporary) {
      std::ofstream out(temporary);
      out << nlohmann::json{{"conditions", conditions_}, {"frames", frames}} << '\n';
      if (!out.flush()) throw RunError(file_.string() + ": cannot be written");
    });
  }

 private:
  const fs::path file_;
  const std::string conditions_;
};

/// A path as ffmpeg's image readers take it: neither an option nor a pattern of its own.
std::string forFfmpeg(const fs::path& path) {
  std::string out;
  for (char c : fs::absolute(path).string()) out += c == '%' ? std::string("%%") : std::string(1, c);
  return out;
}

/// Of the first `frames` pictures: an earlier, longer recording may have left more. Runs ffmpeg without a shell. Throws
/// RunError when it is missing or fails.
void encodeVideo(const fs::path& folder, int frames, double fps, const fs::path& video) {
  const fs::path temporary = fs::absolute(folder) / ".video.mp4";
  const pid_t child = fork();
  if (child == 0) {
    std::ostringstream rate;
    rate << fps;
    const std::string pictures = forFfmpeg(folder) + "/%06d.png";
    execlp("ffmpeg", "ffmpeg", "-nostdin", "-y", "-loglevel", "error", "-framerate", rate.str().c_str(), "-i",
           pictures.c_str(), "-frames:v", std::to_string(frames).c_str(), "-pix_fmt", "yuv420p", "-vf",
           "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-crf", "18", temporary.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw RunError(video.string() +
                   (WIFEXITED(status) && WEXITSTATUS(status) == 127
                        ? ": ffmpeg is not installed (the frames are written; install ffmpeg for a video)"
                        : ": ffmpeg failed (the frames are written)"));
  }
  fs::rename(temporary, video);
}

double peakMemoryMiB() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return double(usage.ru_maxrss) / 1024;
}

void record(const RecordOptions& options) {
  const Buffer buffer = bufferByName(options.buffer);
  if (options.format != "png" && options.format != "exr" && options.format != "none")
    throw InputError("--format " + options.format, "no such format (png, exr or none)");
  if (options.video && options.format != "png") throw InputError("--video", "needs --format png");
  if (options.targetMs && options.format == "exr")
    throw InputError("--target-ms", "changes the size at which pictures are computed (--format png or none)");
  if (options.targetMs && options.resume)
    throw InputError("--resume", "cannot go on with --target-ms: what a frame costs is never the same");
  const auto stage = openStage(options.launch);
  if (!stage->shot) throw InputError(options.launch.scene, "not a shot (a .json file; lambent render draws scenes)");
  say(*stage, options.output.quiet);
  const fs::path folder = options.output.out.empty() ? fs::path("out") / fs::path(options.launch.scene).stem()
                                                     : fs::path(options.output.out);
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure) throw RunError(folder.string() + ": cannot be made: " + failure.message());

  const int total =
      options.frames > 0 ? std::min(options.frames, stage->shot->frameCount()) : stage->shot->frameCount();
  const RecordingMark mark(folder, conditionsOf(*stage, options.launch, options.buffer + options.format));
  const auto picture = [&](int frame) {
    char name[32];
    std::snprintf(name, sizeof name, "%06d.%s", frame, options.format.c_str());
    return folder / name;
  };
  int kept = 0;
  for (const int marked = options.resume ? mark.kept() : 0; kept < marked; ++kept) // as far as none is missing
    if (!fs::exists(picture(kept))) break;
  if (options.resume) removeLeftovers(picture(kept));
  if (kept == 0) mark.write(0);
  GlContext context = GlContext::headless();
  GiFrame gi(stage->settings, stage->seed);
  FrameLog log;
  const CameraView whole = stage->camera;
  std::optional<Governed> governor;
  if (options.targetMs) governor = {.settings = stage->settings, .choosesPreset = options.launch.preset.empty()};
  int done = 0;
  {
    Progress progress("recording", options.output.quiet);
    for (; done < total && !interrupted; ++done) {
      const double t = done / stage->shot->fps;
      if (governor) stage->camera = whole.scaled(governor->scale);
      const FrameStats& stats = gi.run(stage->at(t));
      sayWarning(stats);
      const auto begin = std::chrono::steady_clock::now();
      if (options.format != "none" && done >= kept) { // frames of before are computed: later ones build on them
        writeBuffer(picture(done).string(), gi, buffer, whole.width, whole.height);
        mark.write(done + 1);
      }
      const std::chrono::duration<double, std::milli> writing = std::chrono::steady_clock::now() - begin;
      log.add(t, stats, writing.count(), governor ? &*governor : nullptr);
      if (governor && stats.plan.on(EffectId::Redraw)) {
        governor = governed(std::move(*governor), stats.costMs(), *options.targetMs);
        gi.settings() = governor->settings;
      }
      progress.update(done + 1, total);
    }
  }
  log.write(folder / "frames.csv");
  std::string video;
  if (options.video && done > 0) {
    video = (folder / "video.mp4").string();
    encodeVideo(folder, done, stage->shot->fps, video);
  }
  writeJson(options.output.json, {{"folder", folder.string()},
                                  {"frames", done},
                                  {"frames_per_second", log.framesPerSecond()},
                                  {"peak_memory_mib", peakMemoryMiB()},
                                  {"exposure", gi.exposure()},
                                  {"video", video}});
  if (!options.output.quiet) {
    std::printf("%s: %d of %d frames, %.2f frames per second after the first, peak memory %.0f MiB\n", folder.c_str(),
                done, total, log.framesPerSecond(), peakMemoryMiB());
    if (!video.empty()) std::printf("video: %s\n", video.c_str());
  }
  if (interrupted)
    throw RunError("interrupted: " + std::to_string(done) + " frames and the log are whole" +
                   (options.targetMs ? "" : " (--resume goes on)"));
}

} // namespace

void declareRecord(CLI::App& app) {
  auto options = std::make_shared<RecordOptions>();
  CLI::App* command = app.add_subcommand("record", "every frame of a shot: pictures, frames.csv, video");
  command->add_option("SHOT", options->launch.scene, "shot file (.json)")->required();
  addLaunchOptions(*command, options->launch);
  addOutputOptions(*command, options->output, "folder (default out/NAME)");
  command->add_option("--buffer", options->buffer, "what to record (default beauty)");
  command->add_option("--format", options->format, "png, exr or none (default png)");
  command->add_option("--frames", options->frames, "only the first so many")->check(CLI::Range(1, 1000000));
  command->add_flag("--video", options->video, "also make video.mp4 with ffmpeg");
  command->add_flag("--resume", options->resume,
                    "go on where the same command was interrupted: pictures that are there stay, frames before them "
                    "are computed but not written");
  command
      ->add_option(
          "--target-ms", options->targetMs,
          "choose the preset (where none is given) that fits this time of a frame, and hold it by the scale at "
          "which pictures are computed; frames.csv tells both")
      ->check(CLI::Range(1.0, 10000.0));
  command->callback([options] { record(*options); });
}

} // namespace lambent

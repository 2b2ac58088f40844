// lambent record SHOT: every frame of a shot → images, frame log, video; two techniques side by side, a contact sheet.
#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/progress.h"
#include "engine/platform/gl_context.h"
#include "gi/plan/governor.h"
#include "tools/kept/recording_folder.h"
#include "tools/lambent/commands.h"
#include "tools/lambent/picture.h"
#include "tools/launch/frame_log.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <thread>

namespace lambent {

namespace fs = std::filesystem;

namespace {

struct RecordOptions {
  LaunchOptions launch;
  OutputOptions output;
  std::string buffer = "beauty", format = "png", beside;
  int frames = 0; // 0 = the whole shot
  int sheet = 0;  // pictures on the contact sheet; 0 = none
  bool video = false, captions = false, resume = false;
  std::optional<double> targetMs;
};

constexpr int kSheetWidth = 320; // pixels, of a picture on the contact sheet at most

double peakMemoryMiB() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return double(usage.ru_maxrss) / 1024;
}

constexpr int kNotInstalled = 127; // as a shell says it

/// A path as ffmpeg's image readers take it: neither an option nor a pattern of its own.
std::string forFfmpeg(const fs::path& path) {
  std::string out;
  for (char c : fs::absolute(path).string()) out += c == '%' ? std::string("%%") : std::string(1, c);
  return out;
}

struct NotInstalled {};

/// Writes `video` from the first `frames` pictures of the folder (with --resume and fewer --frames it holds more).
/// False where ffmpeg is not installed. Runs it without a shell. Throws RunError where it fails.
bool encodeVideo(const fs::path& folder, int frames, double fps, const fs::path& video) {
  const auto encode = [&](const fs::path& temporary) {
    const pid_t child = fork();
    if (child == 0) {
      const std::string rate = format("%g", fps), pictures = forFfmpeg(folder) + "/%06d.png";
      execlp("ffmpeg", "ffmpeg", "-nostdin", "-y", "-loglevel", "error", "-framerate", rate.c_str(), "-i",
             pictures.c_str(), "-frames:v", std::to_string(frames).c_str(), "-pix_fmt", "yuv420p", "-vf",
             "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-crf", "18", fs::absolute(temporary).c_str(),
             static_cast<char*>(nullptr));
      _exit(kNotInstalled);
    }
    int status = 0;
    pid_t done = child < 0 ? -1 : 0;
    while (done == 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      if (interrupted) kill(child, SIGKILL); // its film is of no use
      done = waitpid(child, &status, WNOHANG);
    }
    const bool ended = done == child && WIFEXITED(status);
    if (ended && WEXITSTATUS(status) == 0) return;
    if (ended && WEXITSTATUS(status) == kNotInstalled) throw NotInstalled();
    throw RunError(video.string() + ": ffmpeg failed (the frames are written)");
  };
  try {
    writeAtomically(video, encode);
    return true;
  } catch (const NotInstalled&) {
    return false;
  }
}

/// As a shell takes it for one word.
std::string quoted(const std::string& word) {
  if (word.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789/._-%") == word.npos)
    return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// What a person does about it who has ffmpeg, in one line.
std::string videoCommand(const fs::path& folder, double fps) {
  return format("ffmpeg -framerate %g -i ", fps) + quoted(forFfmpeg(folder) + "/%06d.png") + " -pix_fmt yuv420p " +
         quoted(fs::absolute(folder / "video.mp4").string());
}

/// Whether a picture is one that record wrote, to its end: nobody has emptied, cut or damaged it, or put one of another
/// size in its place.
bool isPicture(const fs::path& file, int width, int height) {
  std::error_code none;
  if (!fs::is_regular_file(fs::symlink_status(file, none))) return false;
  try {
    if (file.extension() != ".exr") return isWholePng(file, width, height);
    const Image image = readExr(file);
    return image.width == width && image.height == height;
  } catch (const std::exception&) {
    return false;
  }
}

/// One technique that is recorded: alone, or one of two beside each other.
struct Side {
  std::string technique;
  std::unique_ptr<Viewer> gi;
  FrameLog log = {};
  const FrameStats* stats = nullptr; // of the last frame
  std::string logName = "frames.csv";
};

/// Of each side, from left to right.
std::vector<Settings> settingsOf(const RecordOptions& options, LaunchContext& opened) {
  std::vector<Settings> all = {opened.settings};
  if (options.beside.empty()) return all;
  LaunchOptions right = options.launch;
  right.technique = options.beside;
  all.push_back(chosenSettings(right, opened.shot));
  tellWhatIsLeftOut(opened, all[1]);
  return all;
}

/// What the pictures depend on besides what was opened.
std::string choicesOf(const RecordOptions& options, const std::vector<Settings>& sides) {
  std::string text = options.buffer + ' ' + options.format + (options.captions ? " captions" : "");
  if (sides.size() > 1)
    for (const SettingRow& row : settingRows(sides[1])) text += ' ' + settingText(sides[1], row.name);
  return text;
}

/// Of both sides as they are shown, each of this size.
Image8 shownImage(const std::vector<Side>& sides, Buffer buffer, int frame, int width, int height, bool captions) {
  Image8 all;
  for (const Side& side : sides) {
    Image8 picture = side.gi->readDisplay(buffer);
    if (picture.width != width || picture.height != height) picture = resized(picture, width, height);
    if (captions)
      writeCaption(picture, format("%s  frame %d  %.0f ms", side.technique.c_str(), frame, side.stats->costMs()));
    all = &side == &sides[0] ? std::move(picture) : beside(all, picture);
  }
  return all;
}

void writeFrame(const fs::path& file, const std::vector<Side>& sides, const RecordOptions& options, int frame,
                const CameraView& whole) {
  const Buffer buffer = bufferByName(options.buffer);
  if (options.format == "png")
    return writePng(file, shownImage(sides, buffer, frame, whole.width, whole.height, options.captions));
  const Image left = sides[0].gi->read(buffer);
  writeExr(file, sides.size() > 1 ? beside(left, sides[1].gi->read(buffer)) : left);
}

/// Options that do not go together, before anything is opened.
void checkOptions(const RecordOptions& o) {
  bufferByName(o.buffer);
  if (o.format != "png" && o.format != "exr" && o.format != "none")
    throw InputError("--format " + o.format, "no such format (png, exr or none)");
  if (o.video && o.format != "png") throw InputError("--video", "needs --format png");
  if (o.captions && o.format == "exr") throw InputError("--captions", "are burnt into what is shown (--format png)");
  if (o.targetMs && o.format == "exr")
    throw InputError("--target-ms", "changes the size at which pictures are computed (--format png or none)");
  if (o.targetMs && !o.beside.empty())
    throw InputError("--target-ms", "holds the time of one technique (leave out --beside)");
  if (o.targetMs && o.resume)
    throw InputError("--resume", "cannot go on with --target-ms: what a frame costs is never the same");
}

void tell(const RecordOptions& options, const std::vector<Side>& sides, const fs::path& folder, int done, int total,
          bool filmed) {
  const std::string video = filmed ? (folder / "video.mp4").string() : "";
  Value figures =
      Value::of("folder", folder.string(), "frames", done, "frames_per_second", sides[0].log.framesPerSecond(),
                "peak_memory_mib", peakMemoryMiB(), "exposure", sides[0].gi->exposure(), "video", video);
  for (const Side& side : sides)
    figures["sides"].add(Value::of("technique", side.technique, "log", (folder / side.logName).string(),
                                   "frames_per_second", side.log.framesPerSecond()));
  writeJson(options.output.json, figures);
  if (options.output.quiet) return;
  for (const Side& side : sides)
    std::printf("%s: %s, %d of %d frames, %.2f frames per second after the first\n", printable(folder.string()).c_str(),
                side.technique.c_str(), done, total, side.log.framesPerSecond());
  std::printf("peak memory %.0f MiB\n", peakMemoryMiB());
  if (filmed) std::printf("video: %s\n", printable(video).c_str());
}

/// What it writes into its folder, but the pictures and recording.json.
std::vector<std::string> ownNames(const RecordOptions& options) {
  std::vector<std::string> names = {"frames.csv"};
  if (!options.beside.empty()) names.push_back("frames-" + options.beside + ".csv");
  if (options.video) names.emplace_back("video.mp4");
  if (options.sheet > 0) names.emplace_back("contact-sheet.png");
  return names;
}

/// Throws InputError where what is read, or another result, is a file that the recording writes into its folder.
void refuseLosses(const RecordOptions& options, const Scene& scene, const fs::path& folder) {
  std::vector<fs::path> others = scene.files;
  for (const std::string& named : {options.launch.scene, options.launch.cube, options.output.json})
    if (!named.empty()) others.emplace_back(named);
  std::vector<std::string> own = ownNames(options);
  own.emplace_back("recording.json");
  const auto isOwn = [&](const fs::path& name) {
    return std::ranges::count(own, name.string()) > 0 ||
           (name.extension() == "." + options.format && RecordingFolder::isNamedAsPicture(name));
  };
  const auto refuse = [&](const fs::path& file) {
    throw InputError(file.string(), "the recording writes this file itself (--out names another folder)");
  };
  std::error_code none;
  for (const fs::path& other : others)
    if (isOwn(other.filename()) && fs::equivalent(fs::absolute(other).parent_path(), folder, none)) refuse(other);
  for (const fs::path& other : others)
    for (const fs::path name : own)
      if (sameFile(folder / name, other)) refuse(other); // by a link of its own to what is not there yet
}

void record(const RecordOptions& options) {
  checkOptions(options);
  const auto opened = openLaunch(options.launch, WatchUntil::FirstPicture);
  if (!opened->shot) throw InputError(options.launch.scene, "not a shot (a .json file; lambent render draws scenes)");
  const std::vector<Settings> settings = settingsOf(options, *opened);
  if (!options.beside.empty() && opened->settings.image.adaptation > 0)
    throw InputError("image.adaptation", "cannot be with --beside (both are shown by one exposure; 0 leaves it)");
  say(*opened, options.output.quiet);
  const fs::path folder = resultFolder(options.output, "out/" + nameOf(options.launch.scene));

  const int total =
      options.frames > 0 ? std::min(options.frames, opened->shot->frameCount()) : opened->shot->frameCount();
  refuseLosses(options, opened->scene, folder);
  RecordingFolder mark(folder, conditionsOf(*opened, options.launch, choicesOf(options, settings)), options.format,
                       {total, ownNames(options)});
  const int kept = options.resume ? mark.kept() : 0; // but those that are no pictures any more
  mark.write(kept);                                  // with what this one writes besides
  GlContext context = GlContext::headless();
  std::vector<Side> sides;
  for (const Settings& s : settings) sides.push_back({techniqueOf(s).name, std::make_unique<Viewer>(s, opened->seed)});
  if (sides.size() > 1) sides[1].logName = "frames-" + options.beside + ".csv";
  for (Side& side : sides) side.log.begin(folder / side.logName);
  Viewer& gi = *sides[0].gi;
  const CameraView whole = opened->camera;
  const int small = std::min(whole.width, kSheetWidth), smallHeight = std::max(1, whole.height * small / whole.width);
  ContactSheet sheet(options.sheet, total, small * int(sides.size()), smallHeight);
  std::optional<Governed> governor;
  if (options.targetMs) governor = {.settings = opened->settings, .choosesPreset = options.launch.preset.empty()};
  int done = 0;
  {
    Progress progress("recording", options.output.quiet);
    for (; done < total && !interrupted; ++done) {
      const double t = done / opened->shot->fps;
      if (governor) opened->camera = whole.scaled(governor->scale);
      const SceneView view = opened->at(t);
      for (size_t i = 0; i < sides.size(); ++i) { // in turn, so that none has the caches to itself
        Side& side = sides[(i + size_t(done)) % sides.size()];
        if (done > 0) side.gi->passTime(1 / opened->shot->fps);
        side.stats = &side.gi->run(view);
        sayWarning(*side.stats);
        if (done == 0 && i == 0 && sides.size() > 1) sides[1].gi->settings().image.exposure = gi.exposure(); // one eye
      }
      const auto begin = std::chrono::steady_clock::now();
      // Frames of before are computed: later ones build on them.
      if (options.format != "none" &&
          !(done < kept && isPicture(mark.picture(done), whole.width * int(sides.size()), whole.height))) {
        writeFrame(mark.picture(done), sides, options, done, whole);
        mark.write(std::max(kept, done + 1));
      }
      const std::chrono::duration<double, std::milli> writing = std::chrono::steady_clock::now() - begin;
      for (Side& side : sides) side.log.add(t, *side.stats, writing.count(), governor ? &*governor : nullptr);
      if (sheet.wants(done))
        sheet.add(shownImage(sides, bufferByName(options.buffer), done, small, smallHeight, options.captions));
      if (governor && sides[0].stats->plan.on(EffectId::Redraw)) {
        governor = governed(std::move(*governor), sides[0].stats->costMs(), *options.targetMs);
        gi.settings() = governor->settings;
      }
      progress.update(done + 1, total);
    }
  }
  for (Side& side : sides) side.log.end();
  if (options.format != "none" && !interrupted) mark.end(std::max(kept, total));
  if (const Image8 all = sheet.sheet(); all.width > 0) writePng(folder / "contact-sheet.png", all);
  const fs::path video = folder / "video.mp4";
  const bool films = options.video && done > 0 && !interrupted;
  if (films) removeLeftovers(video);
  const bool filmed = films && encodeVideo(folder, done, opened->shot->fps, video);
  tell(options, sides, folder, done, total, filmed);
  if (films && !filmed && !options.output.quiet)
    std::printf("ffmpeg is not installed: the film stays a sequence of pictures (%s makes it)\n",
                videoCommand(folder, opened->shot->fps).c_str());
  if (interrupted)
    throw RunError("interrupted: " + std::to_string(done) + " frames and the log are whole" +
                   (options.targetMs ? "" : " (--resume goes on)"));
}

} // namespace

void declareRecord(CLI::App& app) {
  auto options = std::make_shared<RecordOptions>();
  Command command(app, "record", "every frame of a shot: pictures, frames.csv, video");
  command.reads("SHOT", options->launch.scene, "shot file (.json)", true);
  command.launch(options->launch);
  command.output(options->output, "folder (default out/NAME)");
  command.text("--buffer", options->buffer, bufferHelp(options->buffer, "record"));
  command.text("--format", options->format, "png, exr or none (default png)");
  command.number("--frames", &options->frames, 1, 1000000, "only the first so many");
  command.flag("--video", options->video, "also make video.mp4, where ffmpeg is installed");
  command.flag("--captions", options->captions, "burn technique, frame and milliseconds into the pictures");
  command.text("--beside", options->beside,
               "a second technique: both see the same frames, and stand side by side in one picture; its log is "
               "frames-NAME.csv");
  command.number("--contact-sheet", &options->sheet, 1, 1000,
                 "also make contact-sheet.png of so many frames, evenly spaced");
  command.flag("--resume", options->resume,
               "go on where the same command was interrupted: pictures that are there stay, frames before them "
               "are computed but not written");
  command.number("--target-ms", &options->targetMs, 1.0, 10000.0,
                 "choose the preset (where none is given) that fits this time of a frame, and hold it by the scale at "
                 "which pictures are computed; frames.csv tells both");
  command.run([options] { record(*options); });
}

} // namespace lambent

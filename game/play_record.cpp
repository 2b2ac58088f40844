// What is kept of a walk: recordings, which can be followed again, and screenshots.
#include "engine/core/error.h"
#include "engine/gl/objects.h"
#include "game/play.h"

#include <algorithm>

namespace lambent {

namespace fs = std::filesystem;

namespace {
constexpr double kRecordedFps = 30; // of a walk, when lambent record plays it
} // namespace

/// Shows the person what `action` did, or why it failed; a full disk must not end the walk.
template <class Action> void Play::report(Action&& action) {
  try {
    hud_.say(action());
  } catch (const RunError& e) {
    hud_.say(e.what());
  }
}

void Play::toggleFollowing() {
  if (!path_) {
    hud_.say("there is no camera path to follow: R records one, or open a shot (.json)");
    return;
  }
  model_.followPath = !model_.followPath;
  if (!model_.followPath) player_.takeOver(solids_->rays());
  hud_.say(model_.followPath ? "following " + path_->file.filename().string() + " (any step ends it)"
                             : "you have the camera");
}

/// The person's hands and feet go on from where the path has led.
void Play::takeOver() {
  model_.followPath = false;
  player_.takeOver(solids_->rays());
}

/// As it was played at this time of the path; who takes over goes on from there.
void Play::followMoment() {
  const PlayedMoment now = playedAt(*path_, model_.time);
  props_.show(now, path_->file.string());
  model_.hour = now.hour;
  model_.torch = now.torch.has_value();
  if (!now.things.empty()) model_.lampIntensity = now.lampIntensity;
}

/// Scene time begins with the recording, so that everything in it moves as it did; at fixed steps the lights do too, so
/// that its replay is the same to the last ray.
void Play::toggleRecording() {
  if (recorder_.recording()) return endRecording("");
  model_.time = 0;
  model_.paused = false;
  std::map<std::string, std::string> set;
  for (const SettingRow& row : settingRows(gi_.settings()))
    if (const double value = row.get(gi_.settings()); value != row.standard) set[row.name] = row.text(value);
  if (adapts_ && gi_.settings().image.adaptation == stage_->settings.image.adaptation)
    set.erase("image.adaptation"); // the window's own
  recorder_.begin(scene_.file, shot_ ? &*shot_ : nullptr, options_.fps.value_or(kRecordedFps), std::move(set),
                  fs::absolute("out"), stage_->unit);
  if (options_.fps) {
    gi_.restart();
    extractor_ = {};
  }
  hud_.say("recording: every frame is a camera key (R ends it)");
}

/// Keeps the frame that comes, and says whether it is one of the recording.
bool Play::recordFrame() {
  if (!recorder_.recording()) return false;
  try {
    const bool first = recorder_.frames() == 0;
    if (!recorder_.add(player_.view(1, 1), scene_.origin, props_.moment(model_.time))) return false;
    if (first) log_.begin(fs::path(recorder_.file()).replace_extension(".csv"));
    return true;
  } catch (const RunError& e) {
    endRecording(e.what());
    return false;
  }
}

void Play::logFrame() {
  try {
    log_.add(model_.time, gi_.stats(), 0, nullptr);
  } catch (const RunError& e) {
    endRecording(e.what());
  }
}

/// `why`: what went wrong; empty: the person wants it.
void Play::endRecording(const std::string& why) {
  const std::string before = why.empty() ? "" : "recording ended: " + why + "; ";
  report([&]() -> std::string {
    log_.end();
    const std::string frames = std::to_string(recorder_.frames()) + " frames in " + recorder_.file().string();
    std::optional<Shot> walk;
    try {
      walk = recorder_.end();
    } catch (const std::exception& e) {
      throw RunError(before + frames + " (" + e.what() + ")");
    }
    if (!walk) return before + "nothing was recorded";
    if (why.empty()) {
      path_ = *walk;
      model_.duration = std::max(model_.duration, walk->seconds);
      model_.followPath = true;
      model_.time = 0;
    }
    return before + frames + ": " + (why.empty() ? "shown now (any step ends it), " : "") +
           "lambent record makes images of it";
  });
}

/// What the window shows now, the panel included.
void Play::writeScreenshot(const fs::path& png) const {
  const auto [width, height] = context_.framebufferSize();
  Image8 image;
  image.width = width;
  image.height = height;
  image.rgb = gl::readWindow(width, height);
  const size_t row = size_t(3) * width;
  for (int y = 0; y < height / 2; ++y) // GL's first row is the lowest
    std::swap_ranges(image.rgb.begin() + y * row, image.rgb.begin() + (y + 1) * row,
                     image.rgb.begin() + (height - 1 - y) * row);
  writePng(png, image);
}

void Play::saveScreenshot() {
  report([&] {
    std::error_code ignored; // writePng says it when the folder is missing
    fs::create_directories("out", ignored);
    int number = 1;
    const auto name = [&] { return fs::absolute("out/screenshot-" + std::to_string(number) + ".png"); };
    while (fs::exists(name(), ignored)) ++number;
    const fs::path png = name();
    writeScreenshot(png);
    writeExr(fs::path(png).replace_extension(".exr"), gi_.read(Buffer::Beauty));
    return "screenshot in " + png.string() + ", its light next to it as .exr";
  });
}

} // namespace lambent

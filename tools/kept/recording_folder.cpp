#include "tools/kept/recording_folder.h"

#include "engine/core/error.h"
#include "tools/kept/text_file.h"
#include "tools/kept/value.h"

#include <algorithm>
#include <cstdio>
#include <optional>

namespace lambent {

namespace fs = std::filesystem;

namespace {
constexpr double kMostFrames = 1e9; // more than any shot has

int countIn(const Value& mark, const std::string& key) {
  const double frames = mark.numberOr(key, 0);
  return mark.has("conditions") && frames >= 0 && frames <= kMostFrames ? int(frames) : 0;
}

/// The key that counts what recordings of one format may have left.
std::string before(const std::string& format) { return "before_" + format; }

/// The frame that a file is named after; nothing where it is no picture of this format.
std::optional<int> frameOf(const fs::path& file, const std::string& format) {
  const std::string name = file.stem().string();
  if (file.extension() != "." + format || name.size() < 6 || name.size() > 9) return {};
  if (name.size() > 6 && name[0] == '0') return {}; // no picture of ours is called so
  if (name.find_first_not_of("0123456789") != name.npos) return {};
  return std::stoi(name);
}

/// Pictures whose temporaries are there: .000007.4711.png is one of 000007.png.
std::vector<fs::path> tornPictures(const fs::path& folder, const std::string& format) {
  std::vector<fs::path> torn;
  std::error_code none;
  for (fs::directory_iterator at(folder, none), end; !none && at != end; at.increment(none)) {
    const std::string name = at->path().filename().string();
    const size_t dot = name.find('.', 1);
    if (name[0] != '.' || dot == name.npos) continue;
    const fs::path picture = folder / (name.substr(1, dot - 1) + at->path().extension().string());
    if (frameOf(picture, format)) torn.push_back(picture);
  }
  return torn;
}
} // namespace

RecordingFolder::RecordingFolder(fs::path folder, std::string conditions, std::string format, RecordedFiles own)
    : folder_(std::move(folder)), file_(folder_ / "recording.json"), alone_(folder_),
      conditions_(std::move(conditions)), format_(std::move(format)) {
  if (!alone_.held()) throw RunError(folder_.string() + ": another program records here (--out names another folder)");
  requireFileOrNothing(file_);
  const Value mark = Value::parsed(readText(file_));
  for (const char* each : {"png", "exr"}) {
    const bool last = mark.has("format") && mark["format"].text() == each;
    before_[each] = std::max(last ? countIn(mark, "frames") : 0, countIn(mark, before(each)));
  }
  const bool known = mark.has("conditions");
  if (known) names_.insert(file_.filename().string());
  if (known && mark.has("files"))
    for (const Value& name : mark["files"].items()) names_.insert(name.text());
  else if (known)
    names_.insert(own.names.begin(), own.names.end()); // a mark of before there were such lists
  const bool same = known && mark.has("format") && mark["format"].text() == format_;
  const int written = format_ == "none" ? 0 : before_[format_] + same; // and one that a kill came before the count of
  own.names.push_back(file_.filename().string());
  std::error_code none;
  for (fs::directory_iterator at(folder_, none), end; !none && at != end; at.increment(none)) {
    const std::string name = at->path().filename().string();
    const std::optional<int> frame = frameOf(name, format_);
    if (std::ranges::count(own.names, name) == 0 && !(frame && *frame < own.pictures)) continue;
    requireFileOrNothing(at->path());
    if (frame ? *frame >= written : !names_.contains(name))
      throw InputError(at->path().string(),
                       "was not recorded here, and would be replaced (--out names another folder)");
  }
  names_.insert(own.names.begin(), own.names.end());
  removeLeftovers(file_);
  for (const fs::path& picture : tornPictures(folder_, format_)) removeLeftovers(picture);
}

bool RecordingFolder::isNamedAsPicture(const fs::path& file) { return frameOf(file, "png") || frameOf(file, "exr"); }

fs::path RecordingFolder::picture(int frame) const {
  char name[16];
  std::snprintf(name, sizeof name, "%06d", frame);
  return folder_ / (std::string(name) + "." + format_);
}

int RecordingFolder::kept() const {
  const Value mark = Value::parsed(readText(file_));
  const int frames = countIn(mark, "frames");
  if (frames > 0 && mark["conditions"].text() != conditions_)
    throw InputError("--resume", folder_.string() + " holds a recording of another shot, size, buffer, setting or " +
                                     "program (without --resume it is recorded anew)");
  return frames;
}

void RecordingFolder::write(int frames) const {
  Value mark = Value::of("conditions", conditions_, "format", format_, "frames", frames);
  for (const auto& [format, pictures] : before_) mark[before(format)] = pictures;
  if (const Value last = Value::parsed(readText(file_)); format_ == "none" && last.has("conditions"))
    mark = last; // the pictures' own stays
  mark["files"] = std::vector<std::string>(names_.begin(), names_.end());
  writeText(file_, mark.json(-1) + "\n");
}

void RecordingFolder::end(int frames) {
  std::error_code none;
  for (fs::directory_iterator at(folder_, none), end; !none && at != end; at.increment(none)) {
    std::error_code kept;
    const std::optional<int> frame = frameOf(at->path(), format_);
    if (frame && *frame >= frames && *frame < before_[format_] && fs::is_regular_file(at->symlink_status(kept)))
      fs::remove(at->path(), kept);
  }
  before_[format_] = frames;
  write(frames);
}

} // namespace lambent

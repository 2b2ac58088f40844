#include "tools/kept/recording_mark.h"

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "tools/kept/text_file.h"
#include "tools/kept/value.h"

#include <algorithm>
#include <optional>

namespace lambent {

namespace fs = std::filesystem;

namespace {
constexpr double kMostFrames = 1e9; // more than any shot has

/// Pictures that a mark counts; 0 where it counts none.
int framesOf(const Value& mark, const char* counted = "frames") {
  const double frames = mark.numberOr(counted, 0);
  return mark.has("conditions") && frames >= 0 && frames <= kMostFrames ? int(frames) : 0;
}

/// The frame that a file is named after as a picture; nothing where it is not.
std::optional<int> frameOf(const fs::path& file) {
  const std::string name = file.stem().string(), format = file.extension().string();
  if ((format != ".png" && format != ".exr") || name.size() < 6 || name.size() > 9) return {};
  if (name.find_first_not_of("0123456789") != name.npos) return {};
  return std::stoi(name);
}
} // namespace

RecordingMark::RecordingMark(const fs::path& folder, std::string conditions)
    : alone_(folder), file_(folder / "recording.json"), conditions_(std::move(conditions)) {
  if (!alone_.held()) throw RunError(folder.string() + ": another program records here (--out names another folder)");
  const Value mark = Value::parsed(readText(file_));
  before_ = std::max(framesOf(mark), framesOf(mark, "before"));
}

int RecordingMark::kept() const {
  removeLeftovers(file_);
  const Value mark = Value::parsed(readText(file_));
  const int frames = framesOf(mark);
  if (frames > 0 && mark["conditions"].text() != conditions_)
    throw InputError("--resume", file_.parent_path().string() + " holds a recording of another shot, size, buffer, " +
                                     "setting or program (without --resume it is recorded anew)");
  return frames;
}

void RecordingMark::write(int frames) const {
  writeText(file_, Value::of("conditions", conditions_, "frames", frames, "before", before_).json(-1) + "\n");
}

void RecordingMark::end(int frames) {
  std::error_code none;
  for (fs::directory_iterator at(file_.parent_path(), none), end; !none && at != end; at.increment(none)) {
    std::error_code kept;
    const std::optional<int> frame = frameOf(at->path());
    if (frame && *frame >= frames && *frame < before_ && fs::is_regular_file(at->symlink_status(kept)))
      fs::remove(at->path(), kept);
  }
  before_ = frames;
  write(frames);
}

} // namespace lambent

#include "tools/kept/recording_mark.h"

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "tools/kept/text_file.h"
#include "tools/kept/value.h"

namespace lambent {

namespace {
constexpr double kMostFrames = 1e9; // more than any shot has
} // namespace

RecordingMark::RecordingMark(const std::filesystem::path& folder, std::string conditions)
    : file_(folder / "recording.json"), conditions_(std::move(conditions)) {}

int RecordingMark::kept() const {
  removeLeftovers(file_);
  const Value mark = Value::parsed(readText(file_));
  const double frames = mark.numberOr("frames", 0);
  if (!mark.has("conditions") || !(frames >= 0 && frames <= kMostFrames)) return 0;
  if (mark["conditions"].text() != conditions_)
    throw InputError("--resume", file_.parent_path().string() + " holds a recording of another shot, size, buffer, " +
                                     "setting or program (without --resume it is recorded anew)");
  return int(frames);
}

void RecordingMark::write(int frames) const {
  writeText(file_, Value::of("conditions", conditions_, "frames", frames).json(-1) + "\n");
}

} // namespace lambent

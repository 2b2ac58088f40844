// The folder of a recording: locked while it lives; whose pictures are in it, and how many are whole.
#pragma once

#include "engine/core/files.h"

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace lambent {

/// What a recording writes besides its mark.
struct RecordedFiles {
  int pictures = 0;               // numbers below this
  std::vector<std::string> names; // of what else
};

/// Its state is in recording.json: which pictures and other files recordings wrote, and how many pictures are whole.
class RecordingFolder {
 public:
  /// `format`: "png" or "exr"; "none" where no pictures are written. Throws RunError while another program records into
  /// the folder; InputError where what would be replaced was written by no recording, or is no file.
  RecordingFolder(std::filesystem::path folder, std::string conditions, std::string format, RecordedFiles own = {});

  /// Whether a file is named as a frame's picture is.
  static bool isNamedAsPicture(const std::filesystem::path& file);
  /// Of a frame, whether it is there or not.
  std::filesystem::path picture(int frame) const;
  /// Pictures that an interrupted recording left here. Throws InputError where they are another one's.
  int kept() const;
  /// So many are whole. Throws RunError where it cannot be written.
  void write(int frames) const;
  /// All are whole: removes pictures of this format that a longer recording left behind them. Throws as write().
  void end(int frames);

 private:
  const std::filesystem::path folder_, file_;
  const FolderLock alone_;
  const std::string conditions_, format_;
  std::set<std::string> names_;       // that recordings wrote, this one included
  std::map<std::string, int> before_; // pictures of each format that recordings before it may have left
};

} // namespace lambent

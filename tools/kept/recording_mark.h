// In the folder of a recording: whose pictures they are, and how many are whole.
#pragma once

#include "engine/core/files.h"

#include <filesystem>
#include <string>

namespace lambent {

class RecordingMark {
 public:
  /// Throws RunError while another program records into the folder.
  RecordingMark(const std::filesystem::path& folder, std::string conditions);

  /// Pictures that an interrupted recording left here. Throws InputError where they are another one's.
  int kept() const;
  /// Throws RunError where it cannot be written.
  void write(int frames) const;
  /// All are whole: removes what a longer recording before it left behind them. Throws as write().
  void end(int frames);

 private:
  const FolderLock alone_;
  const std::filesystem::path file_;
  const std::string conditions_;
  int before_; // pictures that recordings before it may have left
};

} // namespace lambent

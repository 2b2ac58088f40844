// In the folder of a recording: whose pictures they are, and how many are whole.
#pragma once

#include <filesystem>
#include <string>

namespace lambent {

class RecordingMark {
 public:
  RecordingMark(const std::filesystem::path& folder, std::string conditions);

  /// Pictures that an interrupted recording left here. Throws InputError where they are another one's.
  int kept() const;
  /// Throws RunError where it cannot be written.
  void write(int frames) const;

 private:
  const std::filesystem::path file_;
  const std::string conditions_;
};

} // namespace lambent

// Progress of long work on stderr: a bar with the time left on a terminal, a plain line every few seconds elsewhere.
#pragma once

#include <chrono>
#include <string>

namespace lambent {

class Progress {
 public:
  /// `quiet`: says nothing.
  Progress(std::string what, bool quiet);
  ~Progress(); // ends the bar's line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void update(int done, int total);

 private:
  std::string what_;
  bool quiet_, terminal_, drawn_ = false;
  std::chrono::steady_clock::time_point begin_, last_;
};

} // namespace lambent

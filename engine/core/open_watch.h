// The last bound on what a stranger's file takes while it is opened.
#pragma once

#include <atomic>
#include <cstddef>
#include <string>
#include <thread>

namespace lambent {

/// While one lives, the program ends with exit code 2 and one line that names the file, where it has spent more
/// processor time (of all threads) or got more memory since than the size of what is read explains. What reads files
/// counts what it can by itself, and refuses by name before: this is for what nobody thought of, in decoders above all.
/// Nothing may be half written while one lives. The budgets are ten times as large under sanitizers.
class OpenWatch {
 public:
  struct Budget {
    double seconds;
    size_t bytes;
  };
  /// Of a file, with all that it names, of so many bytes: 3 MB have 14 s and 900 MB, each byte beyond 4 us and 256.
  static Budget of(size_t bytesRead);

  /// `share` of the budget, for tests.
  explicit OpenWatch(std::string file, double share = 1);
  ~OpenWatch();
  OpenWatch(const OpenWatch&) = delete;

  /// Tells the one that lives, if any, that so many more bytes are read.
  static void read(size_t bytes);

 private:
  void watch(const std::stop_token& end) const;

  std::string file_;
  double share_;
  double secondsBefore_;
  size_t bytesBefore_;
  std::atomic<size_t> read_{0};
  std::jthread thread_;
};

} // namespace lambent

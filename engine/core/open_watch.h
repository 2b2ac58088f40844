// The last bound on what a stranger's file takes until its first picture.
#pragma once

#include <atomic>
#include <cstddef>
#include <string>
#include <thread>

namespace lambent {

/// From when it is made until `end`, the program ends with exit code 2 and one line that names the file, where it has
/// spent more processor time (of all threads) or got more memory since than the size of what is read explains. What
/// reads files and plans frames counts what it can by itself, and refuses by name before: this is for what nobody
/// thought of, in decoders and drivers above all. Nothing may be half written meanwhile. Budgets are ten times as large
/// under sanitizers.
class OpenWatch {
 public:
  struct Budget {
    double seconds;
    size_t bytes;
  };
  /// Of a file, with all that it names, of so many bytes: 3 MB have 14 s until it is open, 18 s until it is drawn, and
  /// 900 MB; each byte beyond 4 us more, and 256.
  static Budget of(size_t bytesRead, bool open);

  /// Ends the one before. `share`: of the budget, for tests.
  explicit OpenWatch(std::string file, double share = 1);
  ~OpenWatch();
  OpenWatch(const OpenWatch&) = delete;

  /// Tells the one that watches, if any, that so many more bytes are read.
  static void read(size_t bytes);
  /// The file is open: a first frame of `times` the work of the defaults' may take as much more.
  void opened(double times);
  /// Says whether one watches.
  static bool any();
  /// The first picture is there, or what comes now takes what was asked for.
  static void end();

 private:
  void watch(const std::stop_token& ended) const;

  std::string file_;
  double share_;
  double secondsBefore_;
  size_t bytesBefore_;
  std::atomic<size_t> read_{0};
  std::atomic<double> times_{0}; // 0: not open yet
  std::jthread thread_;
};

} // namespace lambent

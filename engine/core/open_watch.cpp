#include "engine/core/open_watch.h"

#include "engine/core/text.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <mutex>

#include <unistd.h>

namespace lambent {

namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int kSlower = 10;
#else
constexpr int kSlower = 1;
#endif

std::atomic<OpenWatch*> living{nullptr};

/// Of all threads of this process.
double processorSeconds() {
  timespec spent{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &spent);
  return double(spent.tv_sec) + 1e-9 * double(spent.tv_nsec);
}

/// What this process holds of the machine's memory beside parts of files.
size_t heldBytes() {
  size_t addresses = 0, resident = 0, ofFiles = 0; // pages
  std::ifstream("/proc/self/statm") >> addresses >> resident >> ofFiles;
  return (resident - std::min(resident, ofFiles)) * size_t(sysconf(_SC_PAGESIZE));
}

} // namespace

OpenWatch::Budget OpenWatch::of(size_t bytesRead) {
  constexpr size_t kSmall = size_t(3) << 20;
  const size_t beyond = bytesRead - std::min(bytesRead, kSmall);
  return {kSlower * (14 + 4e-6 * double(beyond)), kSlower * (size_t(900'000'000) + 256 * beyond)};
}

OpenWatch::OpenWatch(std::string file, double share)
    : file_(std::move(file)), share_(share), secondsBefore_(processorSeconds()), bytesBefore_(heldBytes()) {
  living = this;
  thread_ = std::jthread([this](const std::stop_token& end) { watch(end); });
}

OpenWatch::~OpenWatch() { living = nullptr; }

void OpenWatch::read(size_t bytes) {
  if (OpenWatch* one = living) one->read_ += bytes;
}

void OpenWatch::watch(const std::stop_token& end) const {
  std::mutex mutex;
  std::condition_variable_any ended;
  for (std::unique_lock lock(mutex); !end.stop_requested();) {
    ended.wait_for(lock, end, std::chrono::milliseconds(20), [] { return false; });
    Budget budget = of(read_);
    budget = {share_ * budget.seconds, size_t(share_ * double(budget.bytes))};
    const double seconds = processorSeconds() - secondsBefore_;
    const size_t held = heldBytes(), bytes = held - std::min(held, bytesBefore_);
    if (end.stop_requested() || (seconds <= budget.seconds && bytes <= budget.bytes)) continue;
    const std::string most = seconds > budget.seconds
                                 ? std::to_string(std::lround(budget.seconds)) + " s of processor time"
                                 : std::to_string(budget.bytes / 1'000'000) + " MB of memory";
    const std::string line =
        printable(file_ + ": takes more to open than a file of its size may: " + most + " (--allow-large lets it)");
    std::fprintf(stderr, "error: %s\n", line.c_str());
    _exit(2);
  }
}

} // namespace lambent

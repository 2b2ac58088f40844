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
#include <utility>

#include <unistd.h>

namespace lambent {

namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int kSlower = 10;
#else
constexpr int kSlower = 1;
#endif

std::mutex mutex; // of the pointer
OpenWatch* living = nullptr;

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

OpenWatch::Budget OpenWatch::of(size_t bytesRead, bool open) {
  constexpr size_t kSmall = size_t(3) << 20;
  const size_t beyond = bytesRead - std::min(bytesRead, kSmall);
  return {kSlower * ((open ? 18 : 14) + 4e-6 * double(beyond)), kSlower * (size_t(900'000'000) + 256 * beyond)};
}

OpenWatch::OpenWatch(std::string file, double share)
    : file_(std::move(file)), share_(share), secondsBefore_(processorSeconds()), bytesBefore_(heldBytes()) {
  end();
  const std::lock_guard lock(mutex);
  living = this;
  thread_ = std::jthread([this](const std::stop_token& ended) { watch(ended); });
}

OpenWatch::~OpenWatch() {
  const std::lock_guard lock(mutex);
  if (living == this) living = nullptr;
}

void OpenWatch::read(size_t bytes) {
  const std::lock_guard lock(mutex);
  if (living) living->read_ += bytes;
}

void OpenWatch::opened(double times) { times_ = times; }

bool OpenWatch::any() {
  const std::lock_guard lock(mutex);
  return living;
}

void OpenWatch::end() {
  const std::lock_guard lock(mutex);
  if (OpenWatch* one = std::exchange(living, nullptr)) one->thread_.request_stop();
}

void OpenWatch::watch(const std::stop_token& ended) const {
  std::mutex own;
  std::condition_variable_any wake;
  for (std::unique_lock lock(own); !ended.stop_requested();) {
    wake.wait_for(lock, ended, std::chrono::milliseconds(20), [] { return false; });
    const double times = times_, factor = share_ * std::max(1.0, times);
    const Budget budget = of(read_, times > 0);
    const double most = factor * budget.seconds, mostBytes = factor * double(budget.bytes);
    const double seconds = processorSeconds() - secondsBefore_;
    const double bytes = double(heldBytes()) - double(bytesBefore_);
    if (ended.stop_requested() || (seconds <= most && bytes <= mostBytes)) continue;
    const std::string what = seconds > most ? std::to_string(std::lround(most)) + " s of processor time"
                                            : std::to_string(std::lround(mostBytes * 1e-6)) + " MB of memory";
    const std::string line =
        printable(file_ + ": takes more until its first picture than a file of its size may: " + what +
                  " (--allow-large lets it)");
    std::fprintf(stderr, "error: %s\n", line.c_str());
    _exit(2);
  }
}

} // namespace lambent

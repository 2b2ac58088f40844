#include "engine/core/progress.h"

#include <cstdio>
#include <unistd.h>

namespace lambent {

using Clock = std::chrono::steady_clock;

Progress::Progress(std::string what, bool quiet)
    : what_(std::move(what)), quiet_(quiet), terminal_(isatty(STDERR_FILENO)), begin_(Clock::now()), last_(begin_) {}

Progress::~Progress() {
  if (terminal_ && drawn_) std::fputs("\n", stderr);
}

void Progress::update(int done, int total) {
  const auto now = Clock::now();
  const std::chrono::duration<double> pause = now - last_, spent = now - begin_;
  if (quiet_ || total <= 0 || (pause.count() < (terminal_ ? 0.1 : 5.0) && (done < total || !terminal_))) return;
  last_ = now;
  drawn_ = true;
  const double left = done > 0 ? spent.count() * (total - done) / done : 0;
  if (!terminal_) {
    std::fprintf(stderr, "%s: %d of %d, %.0f s left\n", what_.c_str(), done, total, left);
    return;
  }
  constexpr int kWidth = 30;
  const int filled = kWidth * done / total;
  std::fprintf(stderr, "\r%s [%.*s%*s] %d/%d  %.0f s left ", what_.c_str(), filled, "##############################",
               kWidth - filled, "", done, total, left);
  std::fflush(stderr);
}

} // namespace lambent

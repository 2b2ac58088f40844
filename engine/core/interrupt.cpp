#include "engine/core/interrupt.h"

#include <algorithm>
#include <csignal>
#include <string_view>
#include <thread>

#include <sys/time.h>
#include <unistd.h>

namespace lambent {

std::atomic<bool> interrupted{false};

namespace {

std::atomic<int> unbroken{0}, deferred{0};
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free); // in handlers

void alarmIn(int which, int ms) {
  itimerval timer{};
  timer.it_value = {ms / 1000, ms % 1000 * 1000};
  setitimer(which, &timer, nullptr);
}

void cutOff(int) {
  constexpr int kMostDeferred = 50; // 5 s: a file that never ends
  if (unbroken > 0 && deferred++ < kMostDeferred) return alarmIn(ITIMER_PROF, 100), alarmIn(ITIMER_REAL, 1000);
  constexpr std::string_view kSaid = "\nerror: interrupted, in the midst of work\n";
  [[maybe_unused]] const ssize_t written = write(2, kSaid.data(), kSaid.size());
  _exit(1);
}

int cpuMs = 0; // of all threads

void startTimers() {
  constexpr int kMs = 10'000;
  alarmIn(ITIMER_PROF, cpuMs);
  alarmIn(ITIMER_REAL, kMs);
}

void request(int) {
  interrupted = true;
  for (const int second : {SIGINT, SIGTERM}) std::signal(second, SIG_DFL);
  std::signal(SIGHUP, SIG_IGN); // a terminal that closes can send two
  startTimers();
}

} // namespace

void endOnRequest() {
  constexpr int kOfTwo = 1700; // threads: a second of each, less what freeing memory takes
  cpuMs = kOfTwo * std::max(1, int(std::thread::hardware_concurrency()) / 2);
  for (const int signal : {SIGPROF, SIGALRM}) std::signal(signal, cutOff);
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, request);
  if (std::signal(SIGHUP, request) == SIG_IGN) std::signal(SIGHUP, SIG_IGN); // under nohup
}

void endSoon() {
  if (cpuMs > 0) startTimers();
}

void endedInOrder() {
  for (const int which : {ITIMER_PROF, ITIMER_REAL}) alarmIn(which, 0);
}

Unbroken::Unbroken() { ++unbroken; }
Unbroken::~Unbroken() { --unbroken; }

} // namespace lambent

#include "engine/gl/pulse.h"

#include "engine/gl/state_guard.h"

#include <utility>

namespace lambent::gl {

namespace {
thread_local std::function<void()> beating; // as its context, a thread's own
} // namespace

Pulse::Pulse(std::function<void()> beat) : before_(std::exchange(beating, std::move(beat))) {}
Pulse::~Pulse() { beating = std::move(before_); }

void pulse() {
  if (!beating) return;
  struct Silence { // its own draws are no work
    std::function<void()> beat = std::exchange(beating, nullptr);
    ~Silence() { beating = std::move(beat); }
  } silence;
  const CallOut out;
  silence.beat();
}

} // namespace lambent::gl

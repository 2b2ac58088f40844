// A sign of life out of long work on the thread that draws: before each draw, texture and program that it makes.
#pragma once

#include <functional>

namespace lambent::gl {

/// While it lives, `beat` is called by that work. It may draw, with all state of the context as it was found afterwards
/// (StateGuard), and may throw, which ends the work. Of several on a thread the last made counts.
class Pulse {
 public:
  explicit Pulse(std::function<void()> beat);
  ~Pulse();
  Pulse(const Pulse&) = delete;
  Pulse& operator=(const Pulse&) = delete;

 private:
  std::function<void()> before_;
};

/// Calls the pulse, where there is one and it is not itself the caller.
void pulse();

} // namespace lambent::gl

// Requests to end: INT, TERM and HUP.
#pragma once

#include <atomic>

namespace lambent {

/// Somebody asked the program to end: work looks at this between its parts, and ends with what it has.
extern std::atomic<bool> interrupted;

/// From now on the first request sets `interrupted`. What is not at its end a second of work on all cores later (10 s,
/// where it waits) is cut off, exit code 1: files are written whole or not at all, and logs line by line. A second
/// request ends it at once. HUP stays ignored under `nohup`.
void endOnRequest();
/// Cuts off what is not at its end as late as after a request: the program is to end by itself.
void endSoon();
/// The work is done: what is left is not cut off.
void endedInOrder();

/// While one lives, such as while a file is written, work is not cut off.
class Unbroken {
 public:
  Unbroken();
  ~Unbroken();
  Unbroken(const Unbroken&) = delete;
};

} // namespace lambent

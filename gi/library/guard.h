// What makes every failure inside a call of a C interface a status with a message, and knows which handles live.
#pragma once

#include "engine/core/error.h"
#include "gi/lambent.h"

#include <cstring>
#include <mutex>
#include <new>
#include <set>
#include <string>

namespace lambent::library {

/// Those that live, so that a pointer to none is an error and not a crash.
template <class Handle> class Live {
 public:
  static void add(const Handle* handle) {
    const std::lock_guard lock(mutex());
    all().insert(handle);
  }
  static void remove(const Handle* handle) {
    const std::lock_guard lock(mutex());
    all().erase(handle);
  }
  static bool has(const Handle* handle) {
    const std::lock_guard lock(mutex());
    return all().contains(handle);
  }

 private:
  static std::mutex& mutex() {
    static std::mutex m;
    return m;
  }
  static std::set<const Handle*>& all() {
    static std::set<const Handle*> live;
    return live;
  }
};

/// A failure with its status.
struct Refusal {
  lambent_status status;
  std::string message;
};
[[noreturn]] inline void refuse(lambent_status status, const std::string& message) { throw Refusal{status, message}; }
[[noreturn]] inline void refuse(const std::string& message) { refuse(LAMBENT_INVALID_ARGUMENT, message); }
inline void require(bool holds, const char* message) {
  if (!holds) refuse(message);
}

/// Runs work that may throw. Says what went wrong in `message`.
template <class Work> lambent_status guarded(std::string& message, const Work& work) noexcept {
  try {
    try {
      work();
      return LAMBENT_OK;
    } catch (const Refusal& r) {
      message = r.message;
      return r.status;
    } catch (const InputError& e) {
      message = e.what();
      return LAMBENT_INVALID_ARGUMENT;
    } catch (const CheckFailure& e) {
      message = std::string("a fault in the library, please report it: ") + e.what();
      return LAMBENT_DEVICE_LOST;
    } catch (const std::bad_alloc&) {
      message = "out of memory";
      return LAMBENT_OUT_OF_MEMORY;
    } catch (const std::exception& e) {
      message = e.what();
      return LAMBENT_FAILED;
    }
  } catch (...) { // even the message found no memory
    return LAMBENT_OUT_OF_MEMORY;
  }
}

/// Runs a call on a handle that lives and that no other thread is in. `outside` says what another finds.
template <class Handle, class Work>
lambent_status alone(Handle* handle, const char* what, std::string& outside, const Work& work) noexcept {
  if (!Live<Handle>::has(handle))
    return guarded(outside, [&] { refuse(LAMBENT_INVALID_HANDLE, std::string("no such ") + what); });
  if (handle->busy.exchange(true))
    return guarded(outside, [&] { refuse(LAMBENT_BUSY, std::string("the ") + what + " is busy with another call"); });
  const lambent_status status = handle->dead ? LAMBENT_DEVICE_LOST : work();
  handle->busy = false;
  return status;
}

} // namespace lambent::library

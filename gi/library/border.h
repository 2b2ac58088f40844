// What every call of lambent.h does at the border: checks what comes, makes every failure a status, and finds what a
// number names.
#pragma once

#include "engine/core/error.h"
#include "gi/library/device.h"

#include <cstring>
#include <new>
#include <span>

namespace lambent::library {

/// Those that live, so that a pointer to none is an error and not a crash.
struct LiveDevices {
  static void add(const lambent_device* device);
  static void remove(const lambent_device* device);
  static bool has(const lambent_device* device);
};
/// What this thread's last call without a device, or to a busy one, said.
std::string& messageWithoutDevice();

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
      return LAMBENT_DEAD;
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

/// Refuses where no context of OpenGL 4.5 is current; where it is another one than the device's.
void requireContext();
void requireContext(const lambent_device& device);

enum class Gl { NotNeeded, Needed };

/// Runs a call on a device, on its threads and its account.
template <class Work> lambent_status call(lambent_device* device, Gl needs, const Work& work) noexcept {
  if (!LiveDevices::has(device)) {
    guarded(messageWithoutDevice(), [] { refuse("no such device"); });
    return LAMBENT_INVALID_HANDLE;
  }
  if (device->busy.exchange(true)) {
    guarded(messageWithoutDevice(), [] { refuse("the device is busy with another call"); });
    return LAMBENT_BUSY;
  }
  lambent_status status = LAMBENT_DEAD;
  if (!device->dead) {
    status = guarded(device->message, [&] {
      if (needs == Gl::Needed) requireContext(*device);
      const MemoryAccount::Scope account(device->account);
      device->workers.run(work);
    });
    device->dead = status == LAMBENT_DEAD;
    if (status != LAMBENT_OK) guarded(device->message, [&] { device->log(LAMBENT_ERROR, device->message); });
  }
  device->busy = false;
  return status;
}

/// The defaults of a descriptor, but for its size.
template <class Desc> Desc standard();
template <> lambent_output standard(); // as the others in device_calls.cpp

/// Checks a descriptor's size: that of a version so far, which is one. (A later one lets the sizes of older hosts pass,
/// and fills up what these do not know.)
template <class Desc> Desc read(const Desc* given, const char* what) {
  if (!given) refuse(std::string(what) + " is NULL");
  size_t size = 0;
  std::memcpy(&size, given, sizeof size);
  if (size != sizeof(Desc))
    refuse(std::string(what) + " has a size field of " + std::to_string(size) + " (LAMBENT_DEFAULTS sets it; " +
           std::to_string(sizeof(Desc)) + " in version " + lambent_version_text() + ")");
  return *given;
}

inline vec3 vec3Of(const float v[3]) { return {v[0], v[1], v[2]}; }
mat4 mat4Of(const float* m);
template <class T> std::span<const T> spanOf(const void* data, size_t count) {
  return data ? std::span(static_cast<const T*>(data), count) : std::span<const T>();
}
void requireWithin(int value, int count, const char* what);

// Numbers of things, from the top: 8 bits what it is, 24 bits which scene or view of the device, 32 bits its number
// there, from 1.
enum class Kind : uint64_t { Scene = 1, View, Texture, Material, Mesh, Instance, Light };
constexpr uint64_t kMostGiven = (1u << 24) - 1;

inline uint64_t idOf(Kind kind, uint64_t scene, uint64_t number) {
  return uint64_t(kind) << 56 | scene << 32 | (number + 1);
}
inline uint64_t serialOf(uint64_t id) { return id >> 32 & kMostGiven; }
uint64_t nextSerial(lambent_device& device);

Scene& sceneOf(lambent_device& device, lambent_scene id);
View& viewOf(lambent_device& device, lambent_view id);
/// The number in its scene of a thing that is there.
uint32_t numberOf(Kind kind, lambent_scene scene, uint64_t id, const char* what, const HostScene& in,
                  bool (HostScene::*has)(uint32_t) const);

} // namespace lambent::library

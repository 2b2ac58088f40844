// What every call of lambent.h does at the border: checks what comes, and finds what a number names.
#pragma once

#include "gi/library/descriptors.h"
#include "gi/library/device.h"

#include <span>

namespace lambent::library {

/// What this thread's last call without a device, or to a busy one, said.
std::string& messageWithoutDevice();

/// Refuses where no context of OpenGL 4.5 is current; where it is another one than the device's.
void requireContext();
void requireContext(const lambent_device& device);

enum class Gl { NotNeeded, Needed };

/// Runs a call on a device, on its threads and its account.
template <class Work> lambent_status call(lambent_device* device, Gl needs, const Work& work) noexcept {
  return alone(device, "device", messageWithoutDevice(), [&] {
    const lambent_status status = guarded(device->message, [&] {
      if (needs == Gl::Needed) requireContext(*device);
      const MemoryAccount::Scope account(device->account);
      device->workers.run(work);
    });
    device->dead = status == LAMBENT_DEVICE_LOST;
    if (status != LAMBENT_OK) guarded(device->message, [&] { device->log(LAMBENT_LOG_ERROR, device->message); });
    return status;
  });
}

/// The defaults of a descriptor, but for its size.
template <class Desc> Desc standard();
template <> lambent_output standard(); // as the others in device_calls.cpp

template <class T> std::span<const T> spanOf(const void* data, size_t count) {
  return data ? std::span(static_cast<const T*>(data), count) : std::span<const T>();
}

// Numbers of things, from the top: 8 bits what it is, 24 bits which scene or view of the process, 32 bits its number
// there, from 1.
enum class Kind : uint64_t { Scene = 1, View, Texture, Material, Mesh, Instance, Light };
constexpr uint64_t kMostGiven = (1u << 24) - 1;

inline uint64_t idOf(Kind kind, uint64_t scene, uint64_t number) {
  return uint64_t(kind) << 56 | scene << 32 | (number + 1);
}
inline uint64_t serialOf(uint64_t id) { return id >> 32 & kMostGiven; }
uint64_t nextSerial();

Scene& sceneOf(lambent_device& device, lambent_scene id);
View& viewOf(lambent_device& device, lambent_view id);
/// The number in its scene of a thing that is there.
uint32_t numberOf(Kind kind, lambent_scene scene, uint64_t id, const char* what, const HostScene& in,
                  bool (HostScene::*has)(uint32_t) const);

} // namespace lambent::library

#include "gi/library/border.h"

#include "engine/gl/context.h"

namespace lambent::library {

namespace {

[[noreturn]] void unknown(const char* what) { refuse(LAMBENT_INVALID_HANDLE, std::string("no such ") + what); }

} // namespace

std::string& messageWithoutDevice() {
  thread_local std::string message;
  return message;
}

void requireContext() {
  try {
    gl::requireContext();
  } catch (const RunError& e) {
    refuse(LAMBENT_NO_CONTEXT, e.what());
  }
}

void requireContext(const lambent_device& device) {
  requireContext();
  char label[64] = "";
  if (glIsVertexArray(device.mark.name()))
    glGetObjectLabel(GL_VERTEX_ARRAY, device.mark.name(), sizeof label, nullptr, label);
  if (label != device.markLabel)
    refuse(LAMBENT_NO_CONTEXT, "another OpenGL context is current than the one in which the device was created");
}

uint64_t nextSerial() {
  static std::atomic<uint64_t> given = 0;
  const uint64_t serial = ++given;
  if (serial > kMostGiven) refuse(LAMBENT_FAILED, "a process gives 16 million scenes and views at most");
  return serial;
}

Scene& sceneOf(lambent_device& device, lambent_scene id) {
  const auto found = device.scenes.find(id);
  if (found == device.scenes.end()) unknown("scene");
  return found->second;
}
View& viewOf(lambent_device& device, lambent_view id) {
  const auto found = device.views.find(id);
  if (found == device.views.end()) unknown("view");
  return *found->second;
}
uint32_t numberOf(Kind kind, lambent_scene scene, uint64_t id, const char* what, const HostScene& in,
                  bool (HostScene::*has)(uint32_t) const) {
  const uint32_t number = uint32_t(id) - 1;
  if (id >> 56 != uint64_t(kind) || serialOf(id) != serialOf(scene) || uint32_t(id) == 0 || !(in.*has)(number))
    unknown(what);
  return number;
}

} // namespace lambent::library

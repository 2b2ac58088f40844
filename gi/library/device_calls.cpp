// Calls of lambent.h about devices, descriptors and drivers.
#include "engine/gl/state_guard.h"
#include "gi/library/border.h"
#include "gi/library/driver_check.h"

using namespace lambent;
using namespace lambent::library;

namespace lambent::library {

template <> lambent_device_desc standard() {
  lambent_device_desc d{};
  d.seed = 1;
  return d;
}
template <> lambent_texture_desc standard() {
  lambent_texture_desc d{};
  d.srgb = 1;
  return d;
}
template <> lambent_material_desc standard() {
  lambent_material_desc d{};
  for (float& c : d.base_color) c = 0.8f;
  d.alpha = 1;
  d.alpha_cutoff = 0.5f;
  for (float* m : {d.base_uv, d.emission_uv}) m[0] = m[4] = 1;
  return d;
}
template <> lambent_mesh_desc standard() { return {}; }
template <> lambent_light_desc standard() {
  lambent_light_desc d{};
  d.direction[1] = -1;
  for (float& c : d.intensity) c = 1;
  d.range = kInfinity;
  d.outer_cone_angle = kPi / 4;
  return d;
}
template <> lambent_sky_desc standard() {
  lambent_sky_desc d{};
  d.towards_sun[1] = 1;
  d.turbidity = 3;
  d.scale = 1;
  return d;
}
template <> lambent_view_desc standard() {
  lambent_view_desc d{};
  d.width = 320;
  d.height = 180;
  return d;
}
template <> lambent_frame standard() {
  lambent_frame f{};
  for (int i = 0; i < 4; ++i) f.world_from_view[5 * i] = 1;
  f.fov_y = 1;
  f.near_plane = 0.05f;
  f.far_plane = kInfinity;
  return f;
}
template <> lambent_output standard() { return {}; }

} // namespace lambent::library

namespace {
template <class Desc> void writeStandard(void* to, size_t size) {
  Desc d = standard<Desc>();
  d.size = size;
  std::memcpy(to, &d, size);
}
} // namespace

lambent_device::lambent_device(const lambent_device_desc& from)
    : desc(from), shaders(from.shader_folder ? from.shader_folder : ""), workers(from.threads),
      account(from.memory ? [d = from](int64_t bytes) { return d.memory(d.user, bytes) != 0; }
                          : std::function<bool(int64_t)>()) {
  const MemoryAccount::Scope scope(account);
  static std::atomic<uint64_t> last = 0;
  markLabel = "lambent/mark " + std::to_string(++last) + " " + std::to_string(uintptr_t(this));
  mark = gl::VertexArray(markLabel);
}

extern "C" {

uint32_t lambent_version(void) { return LAMBENT_VERSION; }

#define LAMBENT_TEXT_(x) #x
#define LAMBENT_TEXT(x) LAMBENT_TEXT_(x)
const char* lambent_version_text(void) {
  return LAMBENT_TEXT(LAMBENT_VERSION_MAJOR) "." LAMBENT_TEXT(LAMBENT_VERSION_MINOR) "." LAMBENT_TEXT(
      LAMBENT_VERSION_PATCH);
}

const char* lambent_status_text(int status) {
  switch (status) {
  case LAMBENT_OK:
    return "ok";
  case LAMBENT_INVALID_ARGUMENT:
    return "invalid argument";
  case LAMBENT_INVALID_HANDLE:
    return "invalid handle";
  case LAMBENT_NO_CONTEXT:
    return "no OpenGL context";
  case LAMBENT_OUT_OF_MEMORY:
    return "out of memory";
  case LAMBENT_FAILED:
    return "failed";
  case LAMBENT_DEVICE_LOST:
    return "dead device";
  case LAMBENT_BUSY:
    return "busy device";
  }
  return "no status";
}

lambent_status lambent_defaults(int kind, void* desc, size_t size) {
  struct Row {
    size_t size;
    void (*write)(void*, size_t);
  };
  static constexpr Row kRows[] = {{sizeof(lambent_device_desc), writeStandard<lambent_device_desc>},
                                  {sizeof(lambent_texture_desc), writeStandard<lambent_texture_desc>},
                                  {sizeof(lambent_material_desc), writeStandard<lambent_material_desc>},
                                  {sizeof(lambent_mesh_desc), writeStandard<lambent_mesh_desc>},
                                  {sizeof(lambent_light_desc), writeStandard<lambent_light_desc>},
                                  {sizeof(lambent_sky_desc), writeStandard<lambent_sky_desc>},
                                  {sizeof(lambent_view_desc), writeStandard<lambent_view_desc>},
                                  {sizeof(lambent_frame), writeStandard<lambent_frame>},
                                  {sizeof(lambent_output), writeStandard<lambent_output>}};
  return guarded(messageWithoutDevice(), [&] {
    requireWithin(kind, std::size(kRows), "kind");
    require(desc != nullptr, "descriptor is NULL");
    const Row& row = kRows[kind];
    if (size != row.size)
      refuse("a descriptor of this kind has " + std::to_string(row.size) + " bytes in version " +
             lambent_version_text() + ", not " + std::to_string(size));
    row.write(desc, size);
  });
}

lambent_status lambent_create(const lambent_device_desc* given, lambent_device** device) {
  if (device) *device = nullptr;
  return guarded(messageWithoutDevice(), [&] {
    require(device != nullptr, "device is NULL");
    const lambent_device_desc desc = given ? read(given, "device") : standard<lambent_device_desc>();
    require(desc.threads >= 0 && desc.threads <= 1024, "device: threads is not within 0 and 1024");
    requireContext();
    auto made = std::make_unique<lambent_device>(desc);
    Live<lambent_device>::add(made.get());
    *device = made.release();
  });
}

void lambent_destroy(lambent_device* device) {
  if (!device || !Live<lambent_device>::has(device) || device->busy.exchange(true)) return;
  const lambent_status context = guarded(messageWithoutDevice(), [&] { requireContext(*device); });
  Live<lambent_device>::remove(device);
  if (context != LAMBENT_OK) { // without its context nothing of it can be given back
    guarded(messageWithoutDevice(),
            [&] { device->log(LAMBENT_LOG_ERROR, "destroyed without its OpenGL context: its memory stays"); });
    return;
  }
  guarded(messageWithoutDevice(), [&] {
    const gl::StateGuard guard;
    const std::unique_ptr<lambent_device> gone(device);
    const MemoryAccount::Scope account(gone->account);
    gone->workers.run([&] { gone->views.clear(); });
    gone->mark = {};
  });
}

const char* lambent_message(const lambent_device* device) {
  return device && Live<lambent_device>::has(device) ? device->message.c_str() : messageWithoutDevice().c_str();
}

lambent_status lambent_memory(lambent_device* device, lambent_memory_row* rows, size_t* count) {
  return call(device, Gl::NotNeeded, [&] {
    require(count != nullptr && (rows != nullptr || *count == 0), "rows or count is NULL");
    std::vector<MemoryAccount::Row> held = device->account.rows();
    uint64_t scenes = 0;
    for (const auto& [id, scene] : device->scenes) scenes += scene.host.bytes();
    if (scenes > 0) held.push_back({"scenes", false, scenes});
    for (size_t i = 0; i < std::min(*count, held.size()); ++i) {
      rows[i] = {};
      held[i].owner.copy(rows[i].owner, sizeof rows[i].owner - 1);
      rows[i].gpu = held[i].gpu;
      rows[i].bytes = held[i].bytes;
    }
    *count = held.size();
  });
}

lambent_status lambent_reload_shaders(lambent_device* device) {
  return call(device, Gl::Needed, [&] {
    require(!device->shaders.empty(), "the device has no shader_folder: its shaders are those in the library");
    const gl::StateGuard guard;
    std::string failed;
    for (const auto& [id, view] : device->views)
      for (const std::string& message : view->gi.reloadShaders()) {
        const bool compiled = message.starts_with("reloaded "); // else the compiler's log
        device->log(compiled ? LAMBENT_LOG_INFO : LAMBENT_LOG_WARNING, message);
        if (!compiled) failed = message;
      }
    if (!failed.empty()) refuse(LAMBENT_FAILED, failed);
  });
}

lambent_status lambent_check(lambent_check_function report, void* user) {
  bool works = true;
  const lambent_status status = guarded(messageWithoutDevice(), [&] {
    requireContext();
    works = checkDriver([&](bool ok, const std::string& line) {
      if (report) report(user, ok, line.c_str());
    });
    if (!works) refuse(LAMBENT_FAILED, "something does not work with this driver (see the report)");
  });
  return status == LAMBENT_DEVICE_LOST ? LAMBENT_FAILED : status;
}

} // extern "C"

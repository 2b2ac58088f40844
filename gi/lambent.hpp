// Lambent for C++11 and newer: lambent.h with owners and exceptions. Nothing here that a host could not write itself.
#pragma once

#include "lambent.h"

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace lambent_cpp {

/// A call that failed: its status, and what the library said.
struct Error : std::runtime_error {
  lambent_status status;
  Error(lambent_status s, const std::string& message)
      : std::runtime_error(std::string(lambent_status_text(s)) + ": " + message), status(s) {}
};

/// A descriptor with its defaults: `auto mesh = defaults<lambent_mesh_desc>();`
template <class Desc> struct KindOf;
template <> struct KindOf<lambent_device_desc> { static constexpr lambent_kind kind = LAMBENT_DEVICE_DESC; };
template <> struct KindOf<lambent_texture_desc> { static constexpr lambent_kind kind = LAMBENT_TEXTURE_DESC; };
template <> struct KindOf<lambent_material_desc> { static constexpr lambent_kind kind = LAMBENT_MATERIAL_DESC; };
template <> struct KindOf<lambent_mesh_desc> { static constexpr lambent_kind kind = LAMBENT_MESH_DESC; };
template <> struct KindOf<lambent_light_desc> { static constexpr lambent_kind kind = LAMBENT_LIGHT_DESC; };
template <> struct KindOf<lambent_sky_desc> { static constexpr lambent_kind kind = LAMBENT_SKY_DESC; };
template <> struct KindOf<lambent_view_desc> { static constexpr lambent_kind kind = LAMBENT_VIEW_DESC; };
template <> struct KindOf<lambent_frame> { static constexpr lambent_kind kind = LAMBENT_FRAME; };
template <> struct KindOf<lambent_output> { static constexpr lambent_kind kind = LAMBENT_OUTPUT; };
template <class Desc> Desc defaults() {
  Desc desc;
  lambent_defaults(KindOf<Desc>::kind, &desc, sizeof desc);
  return desc;
}

/// Owns a device. Member calls are those of lambent.h that are about one, and throw Error.
class Device {
 public:
  explicit Device(const lambent_device_desc& desc = defaults<lambent_device_desc>()) : device_(nullptr) {
    const lambent_status status = lambent_create(&desc, &device_);
    if (status != LAMBENT_OK) throw Error(status, lambent_message(nullptr));
  }
  ~Device() { lambent_destroy(device_); }
  Device(Device&& from) noexcept : device_(from.device_) { from.device_ = nullptr; }
  Device& operator=(Device&& from) noexcept {
    std::swap(device_, from.device_);
    return *this;
  }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  lambent_device* get() const { return device_; }
  /// Throws what a call to this device said, where it failed: check(lambent_instance_move(device.get(), …)).
  void check(lambent_status status) const {
    if (status != LAMBENT_OK) throw Error(status, lambent_message(status == LAMBENT_BUSY ? nullptr : device_));
  }

  // What is made, and ended; `s` is its scene.
  lambent_scene scene() const { return made<lambent_scene>(lambent_scene_create); }
  void destroyScene(lambent_scene s) const { check(lambent_scene_destroy(device_, s)); }
  lambent_texture texture(lambent_scene s, const lambent_texture_desc& d) const {
    return made<lambent_texture>(lambent_texture_create, s, &d);
  }
  void destroyTexture(lambent_scene s, lambent_texture t) const { check(lambent_texture_destroy(device_, s, t)); }
  lambent_material material(lambent_scene s, const lambent_material_desc& d) const {
    return made<lambent_material>(lambent_material_create, s, &d);
  }
  void setMaterial(lambent_scene s, lambent_material m, const lambent_material_desc& d) const {
    check(lambent_material_set(device_, s, m, &d));
  }
  void destroyMaterial(lambent_scene s, lambent_material m) const { check(lambent_material_destroy(device_, s, m)); }
  lambent_mesh mesh(lambent_scene s, const lambent_mesh_desc& d) const {
    return made<lambent_mesh>(lambent_mesh_create, s, &d);
  }
  void destroyMesh(lambent_scene s, lambent_mesh m) const { check(lambent_mesh_destroy(device_, s, m)); }
  lambent_instance instance(lambent_scene s, lambent_mesh m, const float place[16]) const {
    return made<lambent_instance>(lambent_instance_create, s, m, place);
  }
  void move(lambent_scene s, lambent_instance i, const float place[16]) const {
    check(lambent_instance_move(device_, s, i, place));
  }
  void deform(lambent_scene s, lambent_instance i, const float* positions, const float* normals,
              uint32_t vertices) const {
    check(lambent_instance_deform(device_, s, i, positions, normals, vertices));
  }
  void destroyInstance(lambent_scene s, lambent_instance i) const { check(lambent_instance_destroy(device_, s, i)); }
  lambent_light light(lambent_scene s, const lambent_light_desc& d) const {
    return made<lambent_light>(lambent_light_create, s, &d);
  }
  void setLight(lambent_scene s, lambent_light l, const lambent_light_desc& d) const {
    check(lambent_light_set(device_, s, l, &d));
  }
  void destroyLight(lambent_scene s, lambent_light l) const { check(lambent_light_destroy(device_, s, l)); }
  void setSky(lambent_scene s, const lambent_sky_desc& d) const { check(lambent_scene_set_sky(device_, s, &d)); }

  lambent_view view(lambent_scene s, const lambent_view_desc& d) const {
    return made<lambent_view>(lambent_view_create, s, &d);
  }
  void destroyView(lambent_view v) const { check(lambent_view_destroy(device_, v)); }
  void resize(lambent_view v, int width, int height) const { check(lambent_view_resize(device_, v, width, height)); }
  void preset(lambent_view v, const char* name) const { check(lambent_view_preset(device_, v, name)); }
  void set(lambent_view v, const char* setting, const char* value) const {
    check(lambent_view_set(device_, v, setting, value));
  }
  std::string setting(lambent_view v, const char* name) const {
    char value[256];
    check(lambent_view_get(device_, v, name, value, sizeof value));
    return value;
  }
  lambent_output render(lambent_view v, const lambent_frame& frame) const {
    lambent_output output = defaults<lambent_output>();
    check(lambent_render(device_, v, &frame, &output));
    return output;
  }
  void irradiance(lambent_view v, const float* points, const float* normals, size_t count, float* indirect,
                  float* direct) const {
    check(lambent_irradiance(device_, v, points, normals, count, indirect, direct));
  }
  void irradianceTexture(lambent_view v, const float* points, const float* normals, size_t count, int width,
                         uint32_t* indirect, uint32_t* direct) const {
    check(lambent_irradiance_texture(device_, v, points, normals, count, width, indirect, direct));
  }
  std::vector<lambent_memory_row> memory() const {
    size_t count = 0;
    check(lambent_memory(device_, nullptr, &count));
    std::vector<lambent_memory_row> rows(count);
    check(lambent_memory(device_, rows.data(), &count));
    return rows;
  }
  void reloadShaders() const { check(lambent_reload_shaders(device_)); }

 private:
  template <class Id, class Create, class... Args> Id made(Create create, Args... args) const {
    Id id = 0;
    check(create(device_, args..., &id));
    return id;
  }

  lambent_device* device_;
};

} // namespace lambent_cpp

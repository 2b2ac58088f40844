// A small lit room told to the library, and frames of it. Only lambent.h is used.
#pragma once

#include "gi/lambent.h"
#include "tests/host/in_host.h"

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

namespace lambent::test {

inline const float kIdentity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

/// A device with one scene: a closed box of 2 m with a block and a lamp in it.
class Room {
 public:
  static constexpr int kWidth = 32, kHeight = 24;
  lambent_device* device = nullptr;
  lambent_scene scene = 0;
  lambent_mesh walls = 0;
  lambent_instance block = 0;
  lambent_light lamp = 0;

  explicit Room(const lambent_device_desc* desc = nullptr) {
    EXPECT_EQ(lambent_create(desc, &device), LAMBENT_OK) << lambent_message(nullptr);
    ok(lambent_scene_create(device, &scene));
    walls = box(1, true, 0);
    lambent_instance instance;
    ok(lambent_instance_create(device, scene, walls, kIdentity, &instance));
    ok(lambent_instance_create(device, scene, box(0.3f, false, 0), kIdentity, &block));
    place(-0.4f);
    lambent_light_desc light;
    LAMBENT_DEFAULTS(LAMBENT_LIGHT_DESC, &light);
    light.position[0] = 0.5f, light.position[1] = 0.6f, light.position[2] = 0.3f;
    ok(lambent_light_create(device, scene, &light, &lamp));
  }
  ~Room() { lambent_destroy(device); }
  Room(const Room&) = delete;

  void ok(lambent_status status) const { EXPECT_EQ(status, LAMBENT_OK) << lambent_message(device); }

  lambent_mesh box(float half, bool inward, lambent_material material) const {
    std::vector<float> positions;
    std::vector<uint32_t> indices;
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) {
        const uint32_t first = uint32_t(positions.size() / 3);
        for (int corner = 0; corner < 4; ++corner) {
          float p[3];
          p[axis] = side ? half : -half;
          p[(axis + 1) % 3] = corner == 1 || corner == 2 ? half : -half;
          p[(axis + 2) % 3] = corner >= 2 ? half : -half;
          positions.insert(positions.end(), p, p + 3);
        }
        const bool turned = (side == 0) != inward;
        for (const uint32_t k : {0, 1, 2, 0, 2, 3}) indices.push_back(first + (turned ? (k == 0 ? 0 : 4 - k) : k));
      }
    lambent_mesh_desc desc;
    LAMBENT_DEFAULTS(LAMBENT_MESH_DESC, &desc);
    desc.vertex_count = uint32_t(positions.size() / 3);
    desc.triangle_count = uint32_t(indices.size() / 3);
    desc.positions = positions.data();
    desc.indices = indices.data();
    desc.material = material;
    lambent_mesh mesh = 0;
    ok(lambent_mesh_create(device, scene, &desc, &mesh));
    return mesh;
  }
  void place(float x) const {
    float at[16];
    std::copy(kIdentity, kIdentity + 16, at);
    at[12] = x, at[13] = -0.7f;
    ok(lambent_instance_move(device, scene, block, at));
  }

  /// A view with few lights, so that it starts at once.
  lambent_view view(int width = kWidth, int height = kHeight) const {
    lambent_view_desc desc;
    LAMBENT_DEFAULTS(LAMBENT_VIEW_DESC, &desc);
    desc.width = width;
    desc.height = height;
    lambent_view made = 0;
    ok(lambent_view_create(device, scene, &desc, &made));
    for (const auto& [setting, value] :
         {std::pair("smc.vpls", "64"), {"smc.points", "64"}, {"smc.warmup", "2"}, {"shadow.resolution", "16"}})
      ok(lambent_view_set(device, made, setting, value));
    return made;
  }
  static lambent_frame frame() {
    lambent_frame f;
    LAMBENT_DEFAULTS(LAMBENT_FRAME, &f);
    f.world_from_view[14] = 0.9f;
    f.world_from_view[13] = 0.1f;
    f.fov_y = 1.2f;
    return f;
  }
  lambent_output render(lambent_view v, const lambent_frame& f = frame()) const {
    lambent_output out;
    LAMBENT_DEFAULTS(LAMBENT_OUTPUT, &out);
    ok(lambent_render(device, v, &f, &out));
    return out;
  }

  /// Channels of all texels as floats, rows as stored.
  static std::vector<float> read(GLuint texture, GLenum format, int width = kWidth, int height = kHeight) {
    const int channels = format == GL_RGB ? 3 : format == GL_RGBA ? 4 : 1;
    std::vector<float> texels(size_t(channels * width * height));
    glGetTextureImage(texture, 0, format, GL_FLOAT, GLsizei(texels.size() * sizeof(float)), texels.data());
    return texels;
  }
  static double mean(const std::vector<float>& values) {
    double sum = 0;
    for (const float v : values) sum += double(v) / double(values.size());
    return sum;
  }
};

/// A texture of floats; `channels` a texel.
inline GLuint textureOf(GLenum format, int width, int height, int channels, const std::vector<float>& texels) {
  GLuint texture = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &texture);
  glTextureStorage2D(texture, 1, format, width, height);
  const GLenum layout = channels == 1 ? GL_RED : channels == 2 ? GL_RG : GL_RGB;
  glTextureSubImage2D(texture, 0, 0, 0, width, height, layout, GL_FLOAT, texels.data());
  return texture;
}

/// In a context of its own, of the core profile.
class Library : public InHost {};

} // namespace lambent::test

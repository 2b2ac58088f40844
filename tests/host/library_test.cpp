// The library beside the frame that it is made of: the same light to the bit, in the same time. And what a second view
// and a second scene hold.
#include "contexts.h"
#include "gi/frame/gi_frame.h"
#include "gi/host/host_scene.h"
#include "gi/lambent.h"
#include "tests/support/test.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>

namespace lambent::test::library_test {

namespace {

constexpr int kWidth = 160, kHeight = 90;

/// A grid of n × n quads over [-1,1]², at z = height, bent.
struct Sheet {
  std::vector<vec3> positions;
  std::vector<uvec3> triangles;
  Sheet(uint32_t n, float height) {
    for (uint32_t y = 0; y <= n; ++y)
      for (uint32_t x = 0; x <= n; ++x) {
        const vec2 at = vec2(x, y) * (2.0f / float(n)) - 1.0f;
        positions.push_back({at.x, at.y, height + 0.1f * std::sin(7 * at.x) * std::cos(5 * at.y)});
      }
    for (uint32_t y = 0; y < n; ++y)
      for (uint32_t x = 0; x < n; ++x) {
        const uint32_t a = y * (n + 1) + x, b = a + n + 1;
        triangles.insert(triangles.end(), {uvec3(a, a + 1, b + 1), uvec3(a, b + 1, b)});
      }
  }
};

mat4 turned(int axis) { // the sheet as a wall of a room
  mat4 m(1);
  if (axis == 1) std::swap(m[0], m[2]);
  if (axis == 2) std::swap(m[1], m[2]);
  return m;
}

/// The same room told to both.
struct Both {
  HostScene scene;
  ViewChanges changes;
  GiFrame frame{Settings()};
  uint32_t lamp;
  LightView light;

  lambent_device* device = nullptr;
  lambent_scene told = 0;
  lambent_view view = 0;
  lambent_light toldLamp = 0;

  Both() {
    EXPECT_EQ(lambent_create(nullptr, &device), LAMBENT_OK);
    tell(told, toldLamp);
    view = viewOf(told);
    const Sheet sheet(40, -0.9f);
    const uint32_t mesh = scene.addMesh({.positions = sheet.positions, .triangles = sheet.triangles});
    for (int i = 0; i < 3; ++i) scene.addInstance(mesh, turned(i));
    light.intensity = vec3(1);
    light.outerConeCos = std::cos(kPi / 4);
    lamp = scene.addLight(light);
  }
  ~Both() { lambent_destroy(device); }

  void tell(lambent_scene& to, lambent_light& lampMade) const {
    const Sheet sheet(40, -0.9f);
    EXPECT_EQ(lambent_scene_create(device, &to), LAMBENT_OK);
    lambent_mesh_desc desc;
    LAMBENT_DEFAULTS(LAMBENT_MESH_DESC, &desc);
    desc.vertex_count = uint32_t(sheet.positions.size());
    desc.triangle_count = uint32_t(sheet.triangles.size());
    desc.positions = &sheet.positions[0].x;
    desc.indices = &sheet.triangles[0].x;
    lambent_mesh mesh = 0;
    EXPECT_EQ(lambent_mesh_create(device, to, &desc, &mesh), LAMBENT_OK);
    for (int i = 0; i < 3; ++i) {
      const mat4 place = turned(i);
      lambent_instance instance = 0;
      EXPECT_EQ(lambent_instance_create(device, to, mesh, &place[0].x, &instance), LAMBENT_OK);
    }
    lambent_light_desc lit;
    LAMBENT_DEFAULTS(LAMBENT_LIGHT_DESC, &lit);
    EXPECT_EQ(lambent_light_create(device, to, &lit, &lampMade), LAMBENT_OK);
  }
  lambent_view viewOf(lambent_scene of) const {
    lambent_view_desc desc;
    LAMBENT_DEFAULTS(LAMBENT_VIEW_DESC, &desc);
    desc.width = kWidth;
    desc.height = kHeight;
    lambent_view made = 0;
    EXPECT_EQ(lambent_view_create(device, of, &desc, &made), LAMBENT_OK);
    return made;
  }
  uint64_t bytes(bool gpu) const {
    size_t count = 0;
    lambent_memory(device, nullptr, &count);
    std::vector<lambent_memory_row> rows(count);
    lambent_memory(device, rows.data(), &count);
    uint64_t sum = 0;
    for (const lambent_memory_row& row : rows)
      if (bool(row.gpu) == gpu) sum += row.bytes;
    return sum;
  }
  static vec3 lampAt(int i) {
    return {0.5f * std::cos(0.1f * float(i)), 0.3f, 0.2f + 0.3f * std::sin(0.1f * float(i))};
  }

  double byFrame(int i) {
    light.position = lampAt(i);
    scene.setLight(lamp, light);
    CameraView camera;
    camera.worldFromView[3] = vec4(0.7f, 0.6f, 1.8f, 1);
    camera.width = kWidth;
    camera.height = kHeight;
    const auto begin = std::chrono::steady_clock::now();
    frame.run(scene.view(changes, camera, 0));
    glFinish();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  }
  double byLibrary(int i, lambent_view of, lambent_output& out) const {
    lambent_light_desc desc;
    LAMBENT_DEFAULTS(LAMBENT_LIGHT_DESC, &desc);
    const vec3 at = lampAt(i);
    std::copy(&at.x, &at.x + 3, desc.position);
    EXPECT_EQ(lambent_light_set(device, told, toldLamp, &desc), LAMBENT_OK);
    lambent_frame f;
    LAMBENT_DEFAULTS(LAMBENT_FRAME, &f);
    f.world_from_view[12] = 0.7f, f.world_from_view[13] = 0.6f, f.world_from_view[14] = 1.8f;
    LAMBENT_DEFAULTS(LAMBENT_OUTPUT, &out);
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_EQ(lambent_render(device, of, &f, &out), LAMBENT_OK) << lambent_message(device);
    glFinish();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  }
};

std::vector<vec4> texelsOf(uint32_t texture) {
  std::vector<vec4> texels(size_t(kWidth * kHeight));
  glGetTextureImage(texture, 0, GL_RGBA, GL_FLOAT, GLsizei(texels.size() * sizeof(vec4)), texels.data());
  return texels;
}

} // namespace

TEST(LibraryBesideTheFrame, GivesTheSameLightInTheSameTime) {
  const auto context = eglHost();
  if (!context) GTEST_SKIP() << "EGL offers no OpenGL 4.5 here";
  context->makeCurrent();
  {
    Both both;
    std::vector<double> ratios;
    lambent_output out;
    for (int i = 0; i < 16; ++i) { // who begins takes turns, as the second finds warm caches
      double frame = 0, library = 0;
      if (i % 2 == 0) frame = both.byFrame(i);
      library = both.byLibrary(i, both.view, out);
      if (i % 2 != 0) frame = both.byFrame(i);
      if (i >= 4) ratios.push_back(library / frame);
      ASSERT_EQ(texelsOf(out.indirect), texelsOf(both.frame.indirectIrradiance())) << i;
      ASSERT_EQ(texelsOf(out.direct), texelsOf(both.frame.directIrradiance())) << i;
    }
    std::ranges::sort(ratios);
    const double median = 0.5 * (ratios[ratios.size() / 2 - 1] + ratios[ratios.size() / 2]);
    std::printf("a frame through the library takes %.3f of the frame itself (median of %zu pairs)\n", median,
                ratios.size());
    EXPECT_LT(ratios[ratios.size() / 4], 1.3) << "lower quartile: other work beside the tests slows some pairs";

    const uint64_t cpu = both.bytes(false), gpu = both.bytes(true);
    const lambent_view second = both.viewOf(both.told);
    both.byLibrary(24, second, out);
    const uint64_t cpu2 = both.bytes(false), gpu2 = both.bytes(true);
    lambent_scene other = 0;
    lambent_light lamp = 0;
    both.tell(other, lamp);
    both.byLibrary(25, both.viewOf(other), out);
    std::printf(
        "MiB for rays and scenes, on the GPU: a view %.1f, %.1f; a second %.1f, %.1f more; a second scene with one "
        "%.1f, %.1f more\n",
        double(cpu) / (1 << 20), double(gpu) / (1 << 20), double(cpu2 - cpu) / (1 << 20),
        double(gpu2 - gpu) / (1 << 20), double(both.bytes(false) - cpu2) / (1 << 20),
        double(both.bytes(true) - gpu2) / (1 << 20));
    EXPECT_LT(gpu2 - gpu, gpu + (gpu >> 4)) << "a second view holds no more than the first";
  }
  context->release();
}

} // namespace lambent::test::library_test

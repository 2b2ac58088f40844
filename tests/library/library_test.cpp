// The library as a host sees it: lambent.h, the shared library, and a context of the host's.
#include "room.h"
#include "tests/host/contexts.h"

#include <algorithm>
#include <cstring>
#include <random>
#include <string>
#include <thread>

namespace lambent::test {

/// A texture of floats; `channels` a texel.
GLuint textureOf(GLenum format, int width, int height, int channels, const std::vector<float>& texels) {
  GLuint texture = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &texture);
  glTextureStorage2D(texture, 1, format, width, height);
  const GLenum layout = channels == 1 ? GL_RED : channels == 2 ? GL_RG : GL_RGB;
  glTextureSubImage2D(texture, 0, 0, 0, width, height, layout, GL_FLOAT, texels.data());
  return texture;
}

class Library : public testing::Test {
 protected:
  void SetUp() override {
    context = eglHost();
    if (!context) GTEST_SKIP() << "EGL offers no OpenGL 4.5 here";
    context->makeCurrent();
  }
  void TearDown() override { EXPECT_TRUE(!context || glGetError() == GL_NO_ERROR); }
  std::unique_ptr<HostContext> context;
};

TEST_F(Library, HasTheVersionOfItsHeader) {
  EXPECT_EQ(lambent_version(), uint32_t(LAMBENT_VERSION));
  EXPECT_STREQ(lambent_version_text(), "0.1.0");
}

TEST_F(Library, LightsARoom) {
  Room room;
  const lambent_view view = room.view();
  lambent_output out = room.render(view);
  EXPECT_GT(Room::mean(Room::read(out.indirect, GL_RGB)), 0.01);
  EXPECT_GT(Room::mean(Room::read(out.direct, GL_RGB)), 0.1);
  EXPECT_FALSE(out.converged);
  for (int i = 0; i < 200 && !out.converged; ++i) out = room.render(view);
  EXPECT_TRUE(out.converged);
  const std::vector<float> before = Room::read(out.indirect, GL_RGB);
  room.place(0.3f);
  out = room.render(view);
  EXPECT_FALSE(out.converged) << "the block moved";
  EXPECT_NE(before, Room::read(out.indirect, GL_RGB));
}

TEST_F(Library, GivesTheSameLightToTheBitInTwoDevicesAndWithOneThread) {
  lambent_device_desc one;
  LAMBENT_DEFAULTS(LAMBENT_DEVICE_DESC, &one);
  one.threads = 1;
  std::vector<float> light[2];
  for (int i = 0; i < 2; ++i) {
    Room room(i == 0 ? nullptr : &one);
    const lambent_view view = room.view();
    for (int frame = 0; frame < 4; ++frame) {
      room.place(0.05f * float(frame));
      const lambent_output out = room.render(view);
      light[i] = Room::read(out.indirect, GL_RGB);
    }
  }
  EXPECT_EQ(light[0], light[1]);
}

TEST_F(Library, TwoDevicesRunInTwoThreads) {
  std::vector<float> light[2];
  const auto work = [](std::vector<float>& to) {
    const auto own = eglHost();
    own->makeCurrent();
    {
      Room room;
      const lambent_view view = room.view();
      for (int frame = 0; frame < 4; ++frame) {
        room.place(0.05f * float(frame));
        to = Room::read(room.render(view).indirect, GL_RGB);
      }
    }
    own->release();
  };
  std::thread other(work, std::ref(light[1]));
  work(light[0]);
  other.join();
  context->makeCurrent();
  EXPECT_EQ(light[0], light[1]);
}

// What a host may get wrong ---------------------------------------------------------------------------

TEST_F(Library, WrongCallsAreStatusesThatChangeNothing) {
  EXPECT_EQ(lambent_create(nullptr, nullptr), LAMBENT_INVALID_ARGUMENT);
  lambent_scene scene = 0;
  EXPECT_EQ(lambent_scene_create(nullptr, &scene), LAMBENT_INVALID_HANDLE);
  EXPECT_EQ(lambent_scene_create(reinterpret_cast<lambent_device*>(8), &scene), LAMBENT_INVALID_HANDLE);
  lambent_destroy(nullptr);
  lambent_destroy(reinterpret_cast<lambent_device*>(8));
  Room room;
  const lambent_view view = room.view();
  const std::vector<float> before = Room::read(room.render(view).indirect, GL_RGB);
  EXPECT_EQ(lambent_render(room.device, 17, nullptr, nullptr), LAMBENT_INVALID_HANDLE);
  EXPECT_EQ(lambent_render(room.device, view, nullptr, nullptr), LAMBENT_INVALID_ARGUMENT);
  EXPECT_NE(std::string(lambent_message(room.device)).find("frame is NULL"), std::string::npos);
  EXPECT_EQ(lambent_render(room.device, room.scene, nullptr, nullptr), LAMBENT_INVALID_HANDLE) << "a scene is no view";
  lambent_frame f = Room::frame();
  f.size = 1000;
  EXPECT_EQ(lambent_render(room.device, view, &f, nullptr), LAMBENT_INVALID_ARGUMENT);
  f = Room::frame();
  f.depth = 4711;
  f.normal = 4712;
  EXPECT_EQ(lambent_render(room.device, view, &f, nullptr), LAMBENT_INVALID_ARGUMENT) << "no such textures";
  f = Room::frame();
  f.indirect_out = 4711;
  EXPECT_EQ(lambent_render(room.device, view, &f, nullptr), LAMBENT_INVALID_ARGUMENT);
  f = Room::frame();
  f.world_from_view[0] = 2;
  EXPECT_EQ(lambent_render(room.device, view, &f, nullptr), LAMBENT_INVALID_ARGUMENT) << "scaled";
  f = Room::frame();
  f.fov_y = std::nanf("");
  EXPECT_EQ(lambent_render(room.device, view, &f, nullptr), LAMBENT_INVALID_ARGUMENT);
  lambent_mesh mesh = 0;
  EXPECT_EQ(lambent_mesh_destroy(room.device, room.scene, room.walls), LAMBENT_INVALID_ARGUMENT) << "it is shown";
  EXPECT_EQ(lambent_mesh_destroy(room.device, room.scene, mesh), LAMBENT_INVALID_HANDLE);
  EXPECT_EQ(lambent_view_set(room.device, view, "smc.vpls", "many"), LAMBENT_INVALID_ARGUMENT);
  EXPECT_EQ(lambent_view_set(room.device, view, "smc.vpl", "3"), LAMBENT_INVALID_ARGUMENT);
  EXPECT_NE(std::string(lambent_message(room.device)).find("smc.vpls"), std::string::npos) << "the nearest name";
  char text[4];
  EXPECT_EQ(lambent_view_get(room.device, view, "gather.mode", text, sizeof text), LAMBENT_INVALID_ARGUMENT);
  EXPECT_EQ(lambent_view_get(room.device, view, "smc.vpls", text, sizeof text), LAMBENT_OK);
  EXPECT_STREQ(text, "64");
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR)) << "a wrong call leaves no OpenGL error";
  // A second scene's things are not of the first.
  ASSERT_EQ(lambent_scene_create(room.device, &scene), LAMBENT_OK);
  lambent_instance instance = 0;
  EXPECT_EQ(lambent_instance_create(room.device, scene, room.walls, kIdentity, &instance), LAMBENT_INVALID_HANDLE);
  f = Room::frame();
  f.indirect_out = f.direct_out = textureOf(GL_RGBA16F, 32, 24, 3, std::vector<float>(32 * 24 * 3));
  EXPECT_EQ(lambent_render(room.device, view, &f, nullptr), LAMBENT_INVALID_ARGUMENT) << "one texture for two";
  f.indirect_out = room.render(view).direct;
  f.direct_out = 0;
  EXPECT_EQ(lambent_render(room.device, view, &f, nullptr), LAMBENT_INVALID_ARGUMENT) << "the library's own";
  GLuint odd[5]; // none of which can be a G-buffer
  glCreateTextures(GL_TEXTURE_2D_MULTISAMPLE, 1, &odd[0]);
  glTextureStorage2DMultisample(odd[0], 4, GL_RGBA16F, 32, 24, GL_TRUE);
  glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &odd[1]);
  glTextureStorage3D(odd[1], 1, GL_RGBA16F, 32, 24, 1);
  glCreateTextures(GL_TEXTURE_2D, 1, &odd[2]);
  glTextureStorage2D(odd[2], 1, GL_RGBA16UI, 32, 24);
  glCreateTextures(GL_TEXTURE_BUFFER, 1, &odd[3]);
  GLuint buffer = 0;
  glCreateBuffers(1, &buffer);
  glNamedBufferStorage(buffer, 32 * 24 * 4, nullptr, 0);
  glTextureBuffer(odd[3], GL_R32F, buffer);
  glCreateTextures(GL_TEXTURE_2D, 1, &odd[4]);
  glTextureStorage2D(odd[4], 3, GL_RGBA16F, 32, 24);
  glTextureParameteri(odd[4], GL_TEXTURE_BASE_LEVEL, 1);
  for (const GLuint texture : odd) {
    f = Room::frame();
    f.depth = f.normal = texture;
    EXPECT_EQ(lambent_render(room.device, view, &f, nullptr), LAMBENT_INVALID_ARGUMENT) << texture;
    EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR)) << texture;
  }
  f = Room::frame();
  std::fill(f.world_from_view, f.world_from_view + 16, 0.0f);
  for (int i = 0; i < 4; ++i) f.world_from_view[5 * i] = 1;
  f.world_from_view[11] = 0.9f; // a translation in the last row
  EXPECT_EQ(lambent_render(room.device, view, &f, nullptr), LAMBENT_INVALID_ARGUMENT) << "row by row";
  context->release();
  const auto sharing = context->sharing();
  sharing->makeCurrent();
  EXPECT_EQ(lambent_render(room.device, view, &(f = Room::frame()), nullptr), LAMBENT_NO_CONTEXT) << "shares objects";
  sharing->release();
  EXPECT_EQ(lambent_render(room.device, view, &f, nullptr), LAMBENT_NO_CONTEXT);
  const auto other = eglHost();
  other->makeCurrent();
  EXPECT_EQ(lambent_render(room.device, view, &f, nullptr), LAMBENT_NO_CONTEXT) << "another context's";
  other->release();
  context->makeCurrent();
  EXPECT_NE(before, std::vector<float>());
  room.render(view);
}

TEST_F(Library, AFaultInsideIsAStatusAndTheDeviceIsDead) {
  for (const char* where : {"call", "worker"}) {
    Room room;
    const lambent_view view = room.view();
    room.render(view);
    setenv("LAMBENT_FAULT", where, 1);
    const lambent_frame f = Room::frame();
    EXPECT_EQ(lambent_render(room.device, view, &f, nullptr), LAMBENT_DEAD) << where;
    unsetenv("LAMBENT_FAULT");
    EXPECT_NE(std::string(lambent_message(room.device)).find("CHECK"), std::string::npos);
    EXPECT_EQ(lambent_render(room.device, view, &f, nullptr), LAMBENT_DEAD) << "from then on";
    lambent_scene scene = 0;
    EXPECT_EQ(lambent_scene_create(room.device, &scene), LAMBENT_DEAD);
  }
  Room next; // others live
  next.render(next.view());
}

TEST_F(Library, CallsFromCallbacksAreBusy) {
  struct Host {
    lambent_device* device = nullptr;
    lambent_status status = LAMBENT_OK;
  } host;
  lambent_device_desc desc;
  LAMBENT_DEFAULTS(LAMBENT_DEVICE_DESC, &desc);
  desc.user = &host;
  desc.log = [](void* user, lambent_level, const char*) {
    Host& h = *static_cast<Host*>(user);
    lambent_scene scene = 0;
    h.status = lambent_scene_create(h.device, &scene);
    lambent_destroy(h.device);
  };
  Room room(&desc);
  host.device = room.device;
  EXPECT_EQ(lambent_view_destroy(room.device, 3), LAMBENT_INVALID_HANDLE); // is logged
  EXPECT_EQ(host.status, LAMBENT_BUSY);
  EXPECT_NE(std::string(lambent_message(nullptr)).find("busy"), std::string::npos);
  room.render(room.view());
}

TEST_F(Library, ASkyTellsItsSunAndItsRadiance) {
  lambent_sky_desc sky;
  LAMBENT_DEFAULTS(LAMBENT_SKY_DESC, &sky);
  float sun[3], radius = 0, radiance[6];
  EXPECT_EQ(lambent_sky_sun(&sky, sun, &radius), LAMBENT_INVALID_ARGUMENT) << "a constant one has none";
  sky.type = LAMBENT_CLEAR_SKY;
  ASSERT_EQ(lambent_sky_sun(&sky, sun, &radius), LAMBENT_OK);
  EXPECT_NEAR(sun[1], 2.6, 0.6);
  EXPECT_NEAR(radius, 0.0046, 0.0002);
  const float directions[6] = {0, 1, 0, 5, 1, 0};
  ASSERT_EQ(lambent_sky_radiance(&sky, directions, 2, radiance), LAMBENT_OK);
  EXPECT_GT(radiance[2], radiance[0]) << "blue";
}

TEST_F(Library, ADestroyedDeviceIsNone) {
  lambent_device* device = nullptr;
  ASSERT_EQ(lambent_create(nullptr, &device), LAMBENT_OK);
  lambent_destroy(device);
  lambent_scene scene = 0;
  EXPECT_EQ(lambent_scene_create(device, &scene), LAMBENT_INVALID_HANDLE);
  lambent_destroy(device);
}

TEST_F(Library, DescriptorsOfOtherSizesAreRefused) {
  unsigned char bytes[400];
  EXPECT_EQ(lambent_defaults(LAMBENT_LIGHT_DESC, bytes, sizeof(lambent_light_desc) - 1), LAMBENT_INVALID_ARGUMENT);
  Room room;
  lambent_light_desc light;
  LAMBENT_DEFAULTS(LAMBENT_LIGHT_DESC, &light);
  lambent_light made = 0;
  for (const size_t size : {size_t(0), sizeof light - 4, sizeof light + 8}) {
    light.size = size;
    EXPECT_EQ(lambent_light_create(room.device, room.scene, &light, &made), LAMBENT_INVALID_ARGUMENT);
    EXPECT_NE(std::string(lambent_message(room.device)).find("size field"), std::string::npos);
  }
}

TEST_F(Library, MemoryIsToldAndMayBeRefused) {
  struct Host {
    int64_t held = 0, most = INT64_MAX;
  } host;
  lambent_device_desc desc;
  LAMBENT_DEFAULTS(LAMBENT_DEVICE_DESC, &desc);
  desc.user = &host;
  desc.memory = [](void* user, int64_t bytes) -> int {
    Host& h = *static_cast<Host*>(user);
    if (bytes > 0 && h.held + bytes > h.most) return 0;
    h.held += bytes;
    return 1;
  };
  {
    Room room(&desc);
    const lambent_view view = room.view();
    room.render(view);
    EXPECT_GT(host.held, 1000);
    size_t count = 0;
    room.ok(lambent_memory(room.device, nullptr, &count));
    std::vector<lambent_memory_row> rows(count);
    room.ok(lambent_memory(room.device, rows.data(), &count));
    uint64_t rays = 0, gpu = 0;
    for (const lambent_memory_row& row : rows) {
      if (std::string(row.owner) == "rays") rays = row.bytes;
      if (row.gpu) gpu += row.bytes;
    }
    EXPECT_EQ(int64_t(rays), host.held);
    EXPECT_GT(gpu, 100000u);
    host.most = host.held; // nothing more from here on
    const lambent_view second = room.view();
    const lambent_frame f = Room::frame();
    EXPECT_EQ(lambent_render(room.device, second, &f, nullptr), LAMBENT_OUT_OF_MEMORY);
    host.most = INT64_MAX;
    room.render(second);
    room.render(view);
  }
  EXPECT_EQ(host.held, 0) << "all is given back";
}

/// Whichever request is refused, the next frame is whole, deformed instances too.
TEST_F(Library, WhatWasRefusedOnceIsThereInTheNextFrame) {
  struct Host {
    int left = -1; // requests up to the one that is refused; below 0: none is
    int asked = 0;
  } host;
  lambent_device_desc desc;
  LAMBENT_DEFAULTS(LAMBENT_DEVICE_DESC, &desc);
  desc.user = &host;
  desc.memory = [](void* user, int64_t bytes) -> int {
    Host& h = *static_cast<Host*>(user);
    return bytes <= 0 || (++h.asked, h.left < 0 || h.left-- != 0);
  };
  const float points[6] = {-0.4f, -0.999f, 0, 0.4f, -0.999f, 0.2f},
              up[6] = {0, 1, 0, 0, 1, 0}; // below the block; beside
  const auto lightAfter = [&](int refused, bool deformsLater, lambent_status& status) {
    Room room(&desc);
    const lambent_view view = room.view(8, 6);
    const lambent_frame f = Room::frame();
    if (deformsLater) room.render(view, f);
    std::vector<float> positions; // the block's vertices, made larger: as Room::box gives them
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side)
        for (int corner = 0; corner < 4; ++corner) {
          float p[3];
          p[axis] = side ? 0.32f : -0.32f;
          p[(axis + 1) % 3] = corner == 1 || corner == 2 ? 0.32f : -0.32f;
          p[(axis + 2) % 3] = corner >= 2 ? 0.32f : -0.32f;
          positions.insert(positions.end(), p, p + 3);
        }
    room.ok(lambent_instance_deform(room.device, room.scene, room.block, positions.data(), nullptr, 24));
    host.asked = 0;
    host.left = refused;
    status = lambent_render(room.device, view, &f, nullptr);
    host.left = -1;
    room.render(view, f);
    std::vector<float> direct(6);
    room.ok(lambent_irradiance(room.device, view, points, up, 2, nullptr, direct.data()));
    return direct;
  };
  for (const bool deformsLater : {false, true}) {
    lambent_status status = LAMBENT_OK;
    const std::vector<float> expected = lightAfter(-1, deformsLater, status);
    const int requests = host.asked;
    EXPECT_EQ(status, LAMBENT_OK);
    EXPECT_GT(requests, 3);
    EXPECT_LT(expected[0], 0.5f * expected[3]) << "the block's shadow";
    for (int k = 0; k < requests; ++k) {
      const std::vector<float> found = lightAfter(k, deformsLater, status);
      EXPECT_EQ(status, LAMBENT_OUT_OF_MEMORY) << k;
      EXPECT_EQ(found, expected) << k << (deformsLater ? ", deformed later" : "");
    }
  }
}

TEST_F(Library, DriverCheckPassesAndTells) {
  struct Told {
    int lines = 0, bad = 0;
    std::string text;
  } told;
  EXPECT_EQ(lambent_check(
                [](void* user, int ok, const char* line) {
                  Told& t = *static_cast<Told*>(user);
                  ++t.lines;
                  t.bad += !ok;
                  t.text += std::string(ok ? "ok   " : "BAD  ") + line + "\n";
                },
                &told),
            LAMBENT_OK)
      << told.text;
  EXPECT_GT(told.lines, 15);
  EXPECT_EQ(told.bad, 0);
}

// G-buffers of other conventions ----------------------------------------------------------------------

struct Convention {
  lambent_depth depth;
  bool minusOne, infinite;
  lambent_normals normals;
  lambent_space space;
  bool top, rectangle;
};

TEST_F(Library, EveryConventionOfAGBufferGivesTheSameLight) {
  constexpr int w = Room::kWidth, h = Room::kHeight, x0 = 5, y0 = 3;
  Room room;
  constexpr int kFrames = 3;
  const auto drawn = [&](const lambent_frame& f) {
    const lambent_view view = room.view();
    lambent_output out;
    for (int i = 0; i < kFrames; ++i) out = room.render(view, f);
    std::pair<std::vector<float>, std::vector<float>> light{Room::read(out.indirect, GL_RGB),
                                                            Room::read(out.direct, GL_RGB)};
    room.ok(lambent_view_destroy(room.device, view));
    return light;
  };
  const lambent_frame own = Room::frame();
  const auto expected = drawn(own);
  std::vector<float> distances, normals;
  {
    const lambent_view view = room.view();
    const lambent_output out = room.render(view);
    std::vector<float> depth(size_t(w * h));
    glGetTextureImage(out.depth, 0, GL_DEPTH_COMPONENT, GL_FLOAT, GLsizei(depth.size() * 4), depth.data());
    for (const float d : depth) distances.push_back(own.near_plane / d);
    normals = Room::read(out.normal, GL_RGB);
    room.ok(lambent_view_destroy(room.device, view));
  }
  const float n = own.near_plane, far = 40;
  int tried = 0;
  for (int i = 0; i < 384; ++i) {
    const Convention c{lambent_depth(i % 3),      i / 3 % 2 == 1,  i / 6 % 2 == 1,  lambent_normals(i / 12 % 4),
                       lambent_space(i / 48 % 2), i / 96 % 2 == 1, i / 192 % 2 == 1};
    if (c.depth == LAMBENT_DEPTH_LINEAR && (c.minusOne || c.infinite)) continue; // has neither range nor planes
    if (i % 5 != 0 && i >= 48) continue; // all of depth and normals, a fifth of what else goes with them
    ++tried;
    SCOPED_TRACE(i);
    const int columns = w + (c.rectangle ? 9 : 0), rows = h + (c.rectangle ? 7 : 0), x1 = c.rectangle ? x0 : 0,
              y1 = c.rectangle ? y0 : 0;
    const bool octahedral = c.normals >= LAMBENT_NORMALS_OCTAHEDRAL,
               unorm = c.normals == LAMBENT_NORMALS_UNORM || c.normals == LAMBENT_NORMALS_OCTAHEDRAL_UNORM;
    const int channels = octahedral ? 2 : 3;
    std::vector<float> depth(size_t(columns * rows), 0.5f), normal(size_t(channels * columns * rows), 0.3f);
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const size_t from = size_t(y * w + x), to = size_t((y1 + (c.top ? h - 1 - y : y)) * columns + x1 + x);
        const float z = distances[from], inverse = c.infinite ? 0 : n / far;
        const float forward = (1 - n / z) / (1 - inverse);
        float d = c.depth == LAMBENT_DEPTH_LINEAR    ? z
                  : c.depth == LAMBENT_DEPTH_FORWARD ? forward
                                                     : (n / z - inverse) / (1 - inverse);
        if (c.minusOne) d = 2 * d - 1;
        depth[to] = d;
        // The camera does not turn, so view space differs by nothing; what space does is tested by a turned one below.
        float v[3] = {normals[3 * from], normals[3 * from + 1], normals[3 * from + 2]};
        if (octahedral) {
          const float sum = std::abs(v[0]) + std::abs(v[1]) + std::abs(v[2]), px = v[0] / sum, py = v[1] / sum;
          const auto sign = [](float s) { return s >= 0 ? 1.0f : -1.0f; };
          v[0] = v[2] < 0 ? sign(px) * (1 - std::abs(py)) : px;
          v[1] = v[2] < 0 ? sign(py) * (1 - std::abs(px)) : py;
        }
        for (int k = 0; k < channels; ++k)
          normal[size_t(channels) * to + size_t(k)] = unorm ? 0.5f * v[k] + 0.5f : v[k];
      }
    lambent_frame f = own;
    const GLenum normalFormat = octahedral ? (unorm ? GL_RG16 : GL_RG16_SNORM) : (unorm ? GL_RGB16 : GL_RGB16F);
    f.depth = textureOf(GL_R32F, columns, rows, 1, depth);
    f.normal = textureOf(normalFormat, columns, rows, channels, normal);
    f.indirect_out = textureOf(GL_RGBA16F, columns, rows, 3, std::vector<float>(size_t(3 * columns * rows), 7));
    f.far_plane = c.infinite || c.depth == LAMBENT_DEPTH_LINEAR ? INFINITY : far;
    f.depth_type = c.depth;
    f.depth_minus_one = c.minusOne;
    f.normal_type = c.normals;
    f.normal_space = c.space;
    f.origin_top = c.top;
    f.x = x1;
    f.y = y1;
    const lambent_view view = room.view();
    lambent_output out;
    for (int k = 0; k < kFrames; ++k) out = room.render(view, f);
    EXPECT_EQ(out.indirect, f.indirect_out);
    const std::vector<float> indirect = Room::read(out.indirect, GL_RGB, columns, rows),
                             direct = Room::read(out.direct, GL_RGB);
    double off = 0, offDirect = 0;
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x)
        for (int k = 0; k < 3; ++k) {
          const size_t at = size_t(3 * (y * w + x) + k), row = size_t(c.top ? h - 1 - y : y);
          off += double(std::abs(indirect[3 * ((size_t(y1) + row) * size_t(columns) + size_t(x1 + x)) + size_t(k)] -
                                 expected.first[at]));
          offDirect += double(std::abs(direct[3 * (row * w + size_t(x)) + size_t(k)] - expected.second[at]));
        }
    EXPECT_LT(off / (3 * w * h), 1e-3 * Room::mean(expected.first));
    EXPECT_LT(offDirect / (3 * w * h), 1e-3 * Room::mean(expected.second));
    if (c.rectangle) {
      EXPECT_EQ(indirect[0], 7) << "outside of the rectangle nothing is written";
    }
    room.ok(lambent_view_destroy(room.device, view));
    for (const GLuint texture : {f.depth, f.normal, f.indirect_out}) glDeleteTextures(1, &texture);
  }
  EXPECT_GT(tried, 60);
}

/// OGRE's context is of the compatibility profile, and its textures are made by glTexImage2D and want mipmaps.
TEST_F(Library, TexturesOfOldHostsAreReadToo) {
  context->release();
  const auto old = compatibilityHost();
  if (!old) GTEST_SKIP() << "EGL offers no compatibility profile here";
  old->makeCurrent();
  {
    constexpr int w = Room::kWidth, h = Room::kHeight;
    Room room;
    lambent_output out = room.render(room.view());
    const std::vector<float> expected = Room::read(out.direct, GL_RGB), normals = Room::read(out.normal, GL_RGB);
    std::vector<float> depth(size_t(w * h));
    glGetTextureImage(out.depth, 0, GL_DEPTH_COMPONENT, GL_FLOAT, GLsizei(depth.size() * 4), depth.data());
    GLuint textures[3];
    glGenTextures(3, textures);
    const auto fill = [&](GLuint texture, GLenum format, GLenum layout, const float* texels) {
      glBindTexture(GL_TEXTURE_2D, texture);
      glTexImage2D(GL_TEXTURE_2D, 0, GLint(format), w, h, 0, layout, GL_FLOAT, texels);
    };
    fill(textures[0], GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, depth.data());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    fill(textures[1], GL_RGB16F, GL_RGB, normals.data());
    fill(textures[2], GL_RGBA16F, GL_RGB, nullptr);
    lambent_frame f = Room::frame();
    f.depth = textures[0];
    f.normal = textures[1];
    f.depth_type = LAMBENT_DEPTH_REVERSED;
    f.direct_out = textures[2];
    glEnable(GL_ALPHA_TEST); // that none of ours passes
    glAlphaFunc(GL_GREATER, 2);
    glEnable(GL_POLYGON_STIPPLE);
    const GLubyte none[128] = {};
    glPolygonStipple(none);
    glClampColor(GL_CLAMP_FRAGMENT_COLOR, GL_TRUE);
    glPixelTransferf(GL_RED_SCALE, 2);
    out = room.render(room.view(), f);
    GLfloat scale = 0;
    glGetFloatv(GL_RED_SCALE, &scale);
    EXPECT_TRUE(glIsEnabled(GL_ALPHA_TEST) && glIsEnabled(GL_POLYGON_STIPPLE) && scale == 2) << "left as found";
    glPixelTransferf(GL_RED_SCALE, 1);
    const std::vector<float> found = Room::read(textures[2], GL_RGB);
    double off = 0;
    for (size_t i = 0; i < found.size(); ++i) off += double(std::abs(found[i] - expected[i])) / double(found.size());
    EXPECT_LT(off, 1e-3 * Room::mean(expected));
    EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
    GLuint cube = 0;
    glGenTextures(1, &cube);
    glBindTexture(GL_TEXTURE_3D, cube);
    glTexImage3D(GL_TEXTURE_3D, 0, GL_R32F, w, h, 4, 0, GL_RED, GL_FLOAT, nullptr);
    f.depth = cube;
    EXPECT_EQ(lambent_render(room.device, room.view(), &f, nullptr), LAMBENT_INVALID_ARGUMENT);
  }
  old->release();
  context->makeCurrent();
}

/// Normals of view space, under a camera that is turned.
TEST_F(Library, NormalsOfViewSpaceAreTurnedWithTheCamera) {
  constexpr int w = Room::kWidth, h = Room::kHeight;
  Room room;
  lambent_frame f = Room::frame();
  const float c = std::cos(0.7f), s = std::sin(0.7f);
  const float turned[3][3] = {{c, 0, -s}, {0, 1, 0}, {s, 0, c}}; // columns
  for (int i = 0; i < 3; ++i) std::copy(turned[i], turned[i] + 3, f.world_from_view + 4 * i);
  lambent_view view = room.view();
  lambent_output out = room.render(view, f);
  const std::vector<float> expected = Room::read(out.direct, GL_RGB), world = Room::read(out.normal, GL_RGB);
  std::vector<float> depth(size_t(w * h)), seen(world.size());
  glGetTextureImage(out.depth, 0, GL_DEPTH_COMPONENT, GL_FLOAT, GLsizei(depth.size() * 4), depth.data());
  for (size_t i = 0; i < world.size(); i += 3)
    for (int k = 0; k < 3; ++k)
      seen[i + size_t(k)] = turned[k][0] * world[i] + turned[k][1] * world[i + 1] + turned[k][2] * world[i + 2];
  f.depth = textureOf(GL_R32F, w, h, 1, depth);
  f.normal = textureOf(GL_RGB16F, w, h, 3, seen);
  f.depth_type = LAMBENT_DEPTH_REVERSED;
  f.normal_space = LAMBENT_VIEW;
  view = room.view();
  out = room.render(view, f);
  const std::vector<float> found = Room::read(out.direct, GL_RGB);
  double off = 0;
  for (size_t i = 0; i < found.size(); ++i) off += double(std::abs(found[i] - expected[i])) / double(found.size());
  EXPECT_LT(off, 1e-3 * Room::mean(expected));
  f.normal_space = LAMBENT_WORLD;
  out = room.render(view, f);
  EXPECT_GT(std::abs(Room::mean(Room::read(out.direct, GL_RGB)) / Room::mean(expected) - 1), 0.01) << "it matters";
}

/// Soft light begins at the host's surfaces too, though rays know those of the scene.
TEST_F(Library, SoftLightFallsOnTheHostsSurfaces) {
  constexpr int w = Room::kWidth, h = Room::kHeight;
  Room room;
  lambent_material_desc glow;
  LAMBENT_DEFAULTS(LAMBENT_MATERIAL_DESC, &glow);
  for (float& c : glow.emission) c = 20;
  lambent_material material = 0;
  room.ok(lambent_material_create(room.device, room.scene, &glow, &material));
  lambent_instance instance = 0;
  float place[16];
  std::copy(kIdentity, kIdentity + 16, place);
  place[12] = 0.5f, place[13] = 0.5f, place[14] = -0.3f;
  room.ok(lambent_instance_create(room.device, room.scene, room.box(0.1f, false, material), place, &instance));
  room.ok(lambent_light_destroy(room.device, room.scene, room.lamp));
  lambent_output out = room.render(room.view());
  std::vector<float> normals = Room::read(out.normal, GL_RGB), depth(size_t(w * h));
  glGetTextureImage(out.depth, 0, GL_DEPTH_COMPONENT, GL_FLOAT, GLsizei(depth.size() * 4), depth.data());
  lambent_frame f = Room::frame();
  f.depth_type = LAMBENT_DEPTH_REVERSED;
  f.depth = textureOf(GL_R32F, w, h, 1, depth);
  const auto directBy = [&](const std::vector<float>& seen) {
    f.normal = textureOf(GL_RGB16F, w, h, 3, seen);
    const lambent_view view = room.view();
    for (int i = 0; i < 8; ++i) out = room.render(view, f);
    return Room::mean(Room::read(out.direct, GL_RGB));
  };
  const double lit = directBy(normals);
  for (size_t i = 0; i < normals.size(); i += 3) { // all towards the viewer, as of a normal map gone wild
    normals[i] = normals[i + 1] = 0;
    normals[i + 2] = 1;
  }
  const double other = directBy(normals);
  EXPECT_GT(lit, 0.01);
  EXPECT_GT(std::abs(other / lit - 1), 0.1) << lit << " and " << other;
}

/// A wrong convention is a dark or odd image, and no error: the log hears of it.
TEST_F(Library, SurfacesThatAreNotTheScenesAreWarnedOf) {
  std::string heard;
  lambent_device_desc desc;
  LAMBENT_DEFAULTS(LAMBENT_DEVICE_DESC, &desc);
  desc.user = &heard;
  desc.log = [](void* user, lambent_level, const char* line) { *static_cast<std::string*>(user) += line; };
  constexpr int w = Room::kWidth, h = Room::kHeight;
  Room room(&desc);
  lambent_frame f = Room::frame();
  const float c = std::cos(1.4f), s = std::sin(1.4f);
  const float turned[3][3] = {{c, 0, -s}, {0, 1, 0}, {s, 0, c}};
  for (int i = 0; i < 3; ++i) std::copy(turned[i], turned[i] + 3, f.world_from_view + 4 * i);
  const lambent_output out = room.render(room.view(), f);
  const std::vector<float> normals = Room::read(out.normal, GL_RGB);
  std::vector<float> depth(size_t(w * h));
  glGetTextureImage(out.depth, 0, GL_DEPTH_COMPONENT, GL_FLOAT, GLsizei(depth.size() * 4), depth.data());
  f.depth = textureOf(GL_R32F, w, h, 1, depth);
  f.normal = textureOf(GL_RGB16F, w, h, 3, normals);
  f.depth_type = LAMBENT_DEPTH_REVERSED;
  const auto warningOf = [&](const lambent_frame& frame) {
    heard.clear();
    const lambent_view view = room.view();
    room.render(view, frame);
    const std::string first = heard;
    heard.clear();
    room.render(view, frame);
    EXPECT_EQ(heard, "") << "once is enough";
    return first;
  };
  EXPECT_EQ(warningOf(f), "");
  lambent_frame wrong = f;
  wrong.depth_type = LAMBENT_DEPTH_FORWARD;
  EXPECT_NE(warningOf(wrong).find("depth_type"), std::string::npos);
  wrong = f;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) wrong.world_from_view[4 * i + k] = f.world_from_view[4 * k + i];
  EXPECT_NE(warningOf(wrong).find("world_from_view"), std::string::npos) << "row by row";
  wrong = f;
  wrong.normal_space = LAMBENT_VIEW;
  EXPECT_NE(warningOf(wrong).find("normal_space"), std::string::npos);
}

// Light at points -------------------------------------------------------------------------------------

TEST_F(Library, LightAtPointsIsThatOfTheImage) {
  Room room;
  const lambent_view view = room.view();
  room.ok(lambent_view_set(room.device, view, "gather.mode", "full"));
  room.ok(lambent_view_set(room.device, view, "shadow.resolution", "128"));
  lambent_output out;
  for (int i = 0; i < 40; ++i) out = room.render(view);
  const lambent_frame f = Room::frame();
  std::vector<float> depth(size_t(Room::kWidth * Room::kHeight));
  glGetTextureImage(out.depth, 0, GL_DEPTH_COMPONENT, GL_FLOAT, GLsizei(depth.size() * 4), depth.data());
  const std::vector<float> normals = Room::read(out.normal, GL_RGB);
  std::vector<float> points;
  for (int y = 0; y < Room::kHeight; ++y)
    for (int x = 0; x < Room::kWidth; ++x) {
      const float z = f.near_plane / depth[size_t(y * Room::kWidth + x)], half = std::tan(f.fov_y / 2);
      points.push_back((2 * (float(x) + 0.5f) / Room::kWidth - 1) * half * Room::kWidth / Room::kHeight * z);
      points.push_back((2 * (float(y) + 0.5f) / Room::kHeight - 1) * half * z + f.world_from_view[13]);
      points.push_back(f.world_from_view[14] - z);
    }
  std::vector<float> indirect(points.size()), direct(points.size());
  room.ok(lambent_irradiance(room.device, view, points.data(), normals.data(), points.size() / 3, indirect.data(),
                             direct.data()));
  EXPECT_NEAR(Room::mean(indirect) / Room::mean(Room::read(out.indirect, GL_RGB)), 1, 0.03);
  EXPECT_NEAR(Room::mean(direct) / Room::mean(Room::read(out.direct, GL_RGB)), 1, 0.03);
  uint32_t names[2] = {};
  room.ok(lambent_irradiance_texture(room.device, view, points.data(), normals.data(), points.size() / 3, 32, &names[0],
                                     &names[1]));
  EXPECT_EQ(Room::read(names[0], GL_RGB), indirect);
  EXPECT_EQ(Room::read(names[1], GL_RGB), direct);
  const lambent_mesh mesh = room.box(0.1f, false, 0);
  EXPECT_EQ(lambent_irradiance(room.device, view, points.data(), normals.data(), 1, indirect.data(), nullptr),
            LAMBENT_INVALID_ARGUMENT)
      << "meshes changed since the last frame";
  EXPECT_NE(mesh, 0u);
}

} // namespace lambent::test

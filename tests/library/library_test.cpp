// The library as a host sees it: lambent.h, the shared library, and a context of the host's.
#include "gi/lambent.hpp"
#include "room.h"

#include <algorithm>
#include <string>
#include <thread>

namespace lambent::test {

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
  std::vector<float> alone[2], light[2];
  const auto work = [](std::vector<float>& to, float step) {
    const auto own = eglHost();
    own->makeCurrent();
    {
      Room room;
      const lambent_view view = room.view();
      for (int frame = 0; frame < 4; ++frame) {
        room.place(step * float(frame));
        to = Room::read(room.render(view).indirect, GL_RGB);
      }
    }
    own->release();
  };
  for (int i = 0; i < 2; ++i) work(alone[i], i ? -0.05f : 0.05f);
  std::thread other(work, std::ref(light[1]), -0.05f);
  work(light[0], 0.05f);
  other.join();
  context->makeCurrent();
  for (int i = 0; i < 2; ++i) EXPECT_EQ(light[i], alone[i]) << i;
  EXPECT_NE(light[0], light[1]);
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
    EXPECT_EQ(lambent_render(room.device, view, &f, nullptr), LAMBENT_DEVICE_LOST) << where;
    unsetenv("LAMBENT_FAULT");
    EXPECT_NE(std::string(lambent_message(room.device)).find("CHECK"), std::string::npos);
    EXPECT_EQ(lambent_render(room.device, view, &f, nullptr), LAMBENT_DEVICE_LOST) << "from then on";
    lambent_scene scene = 0;
    EXPECT_EQ(lambent_scene_create(room.device, &scene), LAMBENT_DEVICE_LOST);
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
  sky.type = LAMBENT_SKY_CLEAR;
  ASSERT_EQ(lambent_sky_sun(&sky, sun, &radius), LAMBENT_OK);
  EXPECT_NEAR(sun[1], 2.6, 0.6);
  EXPECT_NEAR(radius, 0.0046, 0.0002);
  const float directions[6] = {0, 1, 0, 5, 1, 0};
  ASSERT_EQ(lambent_sky_radiance(&sky, directions, 2, radiance), LAMBENT_OK);
  EXPECT_GT(radiance[2], radiance[0]) << "blue";
}

TEST_F(Library, ASkyMayBeAPicture) {
  lambent_sky_desc sky;
  LAMBENT_DEFAULTS(LAMBENT_SKY_DESC, &sky);
  sky.type = LAMBENT_SKY_PICTURE;
  std::vector<float> texels(size_t(64 * 32 * 3), 0.5f);
  for (int y = 0; y < 32; ++y) texels[size_t(3 * (64 * y + 48))] = 8; // red at +Z, a quarter right of the middle
  const float directions[6] = {0, 0, 1, 1, 0, 0};
  float radiance[6], sun[3], radius;
  EXPECT_EQ(lambent_sky_radiance(&sky, directions, 2, radiance), LAMBENT_INVALID_ARGUMENT) << "no texels";
  sky.texels = texels.data();
  sky.width = 64;
  sky.height = 32;
  ASSERT_EQ(lambent_sky_radiance(&sky, directions, 2, radiance), LAMBENT_OK) << lambent_message(nullptr);
  EXPECT_GT(radiance[0], 3);
  EXPECT_NEAR(radiance[3], 0.5, 1e-3);
  EXPECT_EQ(lambent_sky_sun(&sky, sun, &radius), LAMBENT_INVALID_ARGUMENT);
  sky.scale = 2;
  sky.turn = 1.5707964f; // counter-clockwise from above: from +Z to +X
  ASSERT_EQ(lambent_sky_radiance(&sky, directions, 2, radiance), LAMBENT_OK);
  EXPECT_NEAR(radiance[0], 1, 1e-3);
  EXPECT_GT(radiance[3], 6);
  for (const float wrong : {-1.0f, 70000.0f, std::nanf("")}) {
    texels[100] = wrong;
    EXPECT_EQ(lambent_sky_radiance(&sky, directions, 2, radiance), LAMBENT_INVALID_ARGUMENT) << wrong;
  }
  texels[100] = 0;
  for (const int wide : {0, -64, 4097}) {
    sky.width = wide;
    EXPECT_EQ(lambent_sky_radiance(&sky, directions, 2, radiance), LAMBENT_INVALID_ARGUMENT) << wide;
  }
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
    uint64_t rays = 0, lights = 0, gpu = 0;
    for (const lambent_memory_row& row : rows) {
      if (std::string(row.owner) == "rays") rays = row.bytes;
      if (std::string(row.owner) == "virtual lights") lights = row.bytes;
      if (row.gpu) gpu += row.bytes;
    }
    EXPECT_EQ(int64_t(rays), host.held);
    EXPECT_GT(gpu, 100000u);
    EXPECT_GT(lights, 10000u);
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

/// Whatever the technique, the default preset leaves a view that renders.
TEST_F(Library, PresetsGoWithEveryTechnique) {
  Room room;
  const lambent_view view = room.view(8, 6);
  for (const char* technique : {"rsm", "isr", "multires-gather", "lpv", "smc"}) {
    room.ok(lambent_view_set(room.device, view, "technique", technique));
    for (const char* preset : {"low", "default"}) {
      room.ok(lambent_view_preset(room.device, view, preset));
      room.ok(lambent_view_set(room.device, view, "smc.vpls", "64"));
      room.ok(lambent_view_set(room.device, view, "smc.warmup", "2"));
      room.render(view);
    }
  }
  EXPECT_EQ(lambent_view_preset(room.device, view, "best"), LAMBENT_INVALID_ARGUMENT);
}

TEST_F(Library, IsTheSameInCpp) {
  using namespace lambent_cpp;
  Device device;
  const lambent_scene scene = device.scene();
  auto material = defaults<lambent_material_desc>();
  const lambent_material white = device.material(scene, material);
  const float positions[9] = {-1, 0, -1, 1, 0, -1, 0, 0, 1};
  const uint32_t indices[3] = {0, 2, 1};
  auto mesh = defaults<lambent_mesh_desc>();
  mesh.vertex_count = 3, mesh.triangle_count = 1, mesh.positions = positions, mesh.indices = indices;
  mesh.material = white;
  const lambent_mesh triangle = device.mesh(scene, mesh);
  const lambent_instance instance = device.instance(scene, triangle, kIdentity);
  auto lamp = defaults<lambent_light_desc>();
  lamp.position[1] = 1;
  const lambent_light light = device.light(scene, lamp);
  auto sky = defaults<lambent_sky_desc>();
  device.setSky(scene, sky);
  auto size = defaults<lambent_view_desc>();
  size.width = 8, size.height = 6;
  const lambent_view view = device.view(scene, size);
  device.preset(view, "low");
  device.set(view, "smc.vpls", "64");
  EXPECT_EQ(device.setting(view, "smc.vpls"), "64");
  auto frame = defaults<lambent_frame>();
  frame.world_from_view[13] = 0.5f, frame.world_from_view[14] = 1.5f;
  EXPECT_NE(device.render(view, frame).direct, 0u);
  const float point[3] = {0, 0.01f, 0}, up[3] = {0, 1, 0};
  float direct[3];
  device.irradiance(view, point, up, 1, nullptr, direct);
  EXPECT_NEAR(direct[0], 1 / (0.99 * 0.99), 0.01);
  uint32_t texture = 0;
  device.irradianceTexture(view, point, up, 1, 1, nullptr, &texture);
  EXPECT_NE(texture, 0u);
  device.resize(view, 10, 6);
  device.move(scene, instance, kIdentity);
  device.deform(scene, instance, positions, nullptr, 3);
  device.setLight(scene, light, lamp);
  device.setMaterial(scene, white, material);
  EXPECT_GT(device.memory().size(), 2u);
  EXPECT_THROW(device.reloadShaders(), Error);
  EXPECT_THROW(device.destroyMesh(scene, triangle), Error);
  const uint8_t texel[4] = {};
  auto image = defaults<lambent_texture_desc>();
  image.width = image.height = 1, image.rgba = texel;
  device.destroyTexture(scene, device.texture(scene, image));
  device.destroyInstance(scene, instance);
  device.destroyMesh(scene, triangle);
  device.destroyMaterial(scene, white);
  device.destroyLight(scene, light);
  device.destroyView(view);
  device.destroyScene(scene);
  Device moved = std::move(device);
  EXPECT_EQ(device.get(), nullptr);
  try {
    moved.destroyView(view);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.status, LAMBENT_INVALID_HANDLE);
    EXPECT_NE(std::string(e.what()).find("no such view"), std::string::npos);
  }
}

} // namespace lambent::test

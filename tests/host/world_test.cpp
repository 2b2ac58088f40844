// Worlds told to the library: the light is that of the frame itself; what changes is told, what is wrong is a status.
#include "contexts.h"
#include "engine/scene/scene.h"
#include "gi/frame/gi_frame.h"
#include "gi/lambent_world.h"
#include "tests/support/test.h"

#include <epoxy/gl.h>

#include <cstring>
#include <fstream>

namespace lambent::test {

namespace {

constexpr int kWidth = 48, kHeight = 32;

double meanOf(uint32_t texture) {
  std::vector<vec4> texels(size_t(kWidth * kHeight));
  glGetTextureImage(texture, 0, GL_RGBA, GL_FLOAT, GLsizei(texels.size() * sizeof(vec4)), texels.data());
  double sum = 0;
  for (const vec4& t : texels) sum += double(luminance(vec3(t))) / double(texels.size());
  return sum;
}

/// A world of a file, a device with a scene that it is told to, and a view of that.
struct Told {
  lambent_world* world = nullptr;
  lambent_device* device = nullptr;
  lambent_scene scene = 0;
  lambent_view view = 0;
  lambent_frame frame;

  explicit Told(const char* file) {
    EXPECT_EQ(lambent_world_load(file, nullptr, &world), LAMBENT_OK) << lambent_world_message(nullptr);
    EXPECT_EQ(lambent_create(nullptr, &device), LAMBENT_OK);
    EXPECT_EQ(lambent_scene_create(device, &scene), LAMBENT_OK);
    lambent_view_desc d;
    LAMBENT_DEFAULTS(LAMBENT_VIEW_DESC, &d);
    d.width = kWidth;
    d.height = kHeight;
    EXPECT_EQ(lambent_view_create(device, scene, &d, &view), LAMBENT_OK);
    for (const auto& [setting, value] : {std::pair("smc.vpls", "128"), {"smc.points", "128"}, {"smc.warmup", "4"}})
      EXPECT_EQ(lambent_view_set(device, view, setting, value), LAMBENT_OK);
    LAMBENT_DEFAULTS(LAMBENT_FRAME, &frame);
    EXPECT_EQ(lambent_world_camera(world, 0, &frame), LAMBENT_OK);
  }
  ~Told() {
    lambent_destroy(device);
    lambent_world_destroy(world);
  }
  Told(const Told&) = delete;

  lambent_output draw() const {
    EXPECT_EQ(lambent_world_tell(world, device, scene), LAMBENT_OK) << lambent_world_message(world);
    lambent_output out;
    LAMBENT_DEFAULTS(LAMBENT_OUTPUT, &out);
    EXPECT_EQ(lambent_render(device, view, &frame, &out), LAMBENT_OK) << lambent_message(device);
    return out;
  }
  lambent_entity find(const char* name) const {
    lambent_entity e = LAMBENT_NO_ENTITY;
    EXPECT_EQ(lambent_world_find(world, name, &e), LAMBENT_OK) << lambent_world_message(world);
    return e;
  }
};

class Worlds : public testing::Test {
 protected:
  void SetUp() override {
    context = eglHost();
    if (!context) GTEST_SKIP() << "EGL offers no OpenGL 4.5 here";
    context->makeCurrent();
  }
  void TearDown() override {
    if (!context) return;
    EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
    context->release();
  }
  std::unique_ptr<HostContext> context;
};

} // namespace

/// Textures, masks, animation and a sun: as the frame has them from the scene itself.
TEST_F(Worlds, AFileHasTheLightThatTheFrameGivesIt) {
  for (const char* file : {"content/hall/hall.gltf", "content/cornell-spot/cornell-spot.gltf"}) {
    SCOPED_TRACE(file);
    Told told(file);
    Settings settings;
    settings.smc.vpls = settings.smc.points = 128;
    settings.smc.warmup = 4;
    settings.direct.surfaces = SoftSurfaces::Image;
    GiFrame gi(settings);
    Scene scene = loadScene(file);
    SceneExtractor extractor;
    const CameraView seen = [&] {
      const std::vector<NamedCamera> cameras = sceneCameras(scene);
      CameraView c = cameras.empty() ? defaultView(scene) : cameras.front().view;
      c.width = kWidth;
      c.height = kHeight;
      return c;
    }();
    for (int i = 0; i < 4; ++i) {
      animate(scene, 0.1 * i);
      gi.run(extractor.extract(scene, seen, 0));
      ASSERT_EQ(lambent_world_pose(told.world, 0.1 * i), LAMBENT_OK);
      const lambent_output out = told.draw();
      EXPECT_NEAR(meanOf(out.direct) / meanOf(gi.directIrradiance()), 1, 1e-3) << i;
      EXPECT_NEAR(meanOf(out.indirect) / meanOf(gi.indirectIrradiance()), 1, 0.01) << i;
    }
    EXPECT_EQ(lambent_world_warning(told.world, 0), nullptr) << lambent_world_warning(told.world, 0);
  }
}

TEST_F(Worlds, WhatChangesIsTold) {
  Told told("content/cornell/cornell.gltf");
  double sky[3];
  EXPECT_EQ(lambent_world_origin(told.world, sky), LAMBENT_OK);
  const double before = meanOf(told.draw().direct);
  // A lamp of the host's, on an entity that moves.
  lambent_entity lamp = LAMBENT_NO_ENTITY;
  float place[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 1};
  ASSERT_EQ(lambent_world_create(told.world, "lamp", LAMBENT_NO_ENTITY, place, &lamp), LAMBENT_OK);
  lambent_light_desc light;
  LAMBENT_DEFAULTS(LAMBENT_LIGHT_DESC, &light);
  ASSERT_EQ(lambent_world_light(told.world, lamp, &light), LAMBENT_OK);
  const double lit = meanOf(told.draw().direct);
  EXPECT_GT(lit, 1.02 * before);
  place[13] = 0.4f;
  ASSERT_EQ(lambent_world_place(told.world, lamp, place), LAMBENT_OK);
  const double moved = meanOf(told.draw().direct);
  EXPECT_GT(std::abs(moved / lit - 1), 0.01);
  lambent_light_desc read;
  LAMBENT_DEFAULTS(LAMBENT_LIGHT_DESC, &read);
  ASSERT_EQ(lambent_world_light_of(told.world, lamp, &read), LAMBENT_OK);
  EXPECT_EQ(read.position[1], 0.4f);
  EXPECT_EQ(read.intensity[0], 1);
  // A child that shows a mesh of the file goes with its parent.
  size_t count = 0;
  ASSERT_EQ(lambent_world_entities(told.world, nullptr, &count), LAMBENT_OK);
  std::vector<lambent_entity> all(count);
  ASSERT_EQ(lambent_world_entities(told.world, all.data(), &count), LAMBENT_OK);
  uint32_t mesh = 0;
  const auto shows = [&](lambent_entity e) { return lambent_world_mesh_of(told.world, e, &mesh) == LAMBENT_OK; };
  ASSERT_TRUE(std::ranges::any_of(all, shows));
  lambent_entity child = LAMBENT_NO_ENTITY;
  const float small[16] = {0.2f, 0, 0, 0, 0, 0.2f, 0, 0, 0, 0, 0.2f, 0, 0, 0, 0, 1};
  ASSERT_EQ(lambent_world_create(told.world, "child", lamp, small, &child), LAMBENT_OK);
  ASSERT_EQ(lambent_world_show(told.world, child, mesh), LAMBENT_OK);
  told.draw();
  const lambent_instance shown = lambent_world_instance(told.world, child, told.device, told.scene);
  EXPECT_NE(shown, 0u);
  ASSERT_EQ(lambent_world_show(told.world, child, mesh == 0 ? 1 : 0), LAMBENT_OK) << lambent_world_message(told.world);
  told.draw();
  EXPECT_NE(lambent_world_instance(told.world, child, told.device, told.scene), shown) << "another mesh";
  float world[16];
  ASSERT_EQ(lambent_world_placement(told.world, child, nullptr, world), LAMBENT_OK);
  EXPECT_EQ(world[13], 0.4f);
  lambent_mesh_desc arrays;
  ASSERT_EQ(lambent_world_mesh(told.world, mesh, &arrays), LAMBENT_OK);
  EXPECT_TRUE(arrays.vertex_count > 0 && arrays.positions && arrays.normals && arrays.indices);
  ASSERT_EQ(lambent_world_remove(told.world, lamp), LAMBENT_OK);
  EXPECT_EQ(lambent_world_name(told.world, child), nullptr) << "descendants go too";
  EXPECT_NEAR(meanOf(told.draw().direct) / before, 1, 0.005);
  EXPECT_EQ(lambent_world_instance(told.world, child, told.device, told.scene), 0u);
  // A constant sky lights what is open.
  lambent_sky_desc above;
  LAMBENT_DEFAULTS(LAMBENT_SKY_DESC, &above);
  for (float& c : above.radiance) c = 5;
  ASSERT_EQ(lambent_world_sky(told.world, &above), LAMBENT_OK);
  EXPECT_GT(meanOf(told.draw().direct), 1.1 * before);
}

/// A second scene of the same world, and a device that took the place of one that ended.
TEST_F(Worlds, AnyNumberOfScenesIsTold) {
  Told told("content/cornell/cornell.gltf");
  const double direct = meanOf(told.draw().direct);
  lambent_scene other = 0;
  ASSERT_EQ(lambent_scene_create(told.device, &other), LAMBENT_OK);
  EXPECT_EQ(lambent_world_tell(told.world, told.device, other), LAMBENT_OK);
  ASSERT_EQ(lambent_scene_destroy(told.device, other), LAMBENT_OK);
  EXPECT_EQ(lambent_world_tell(told.world, told.device, other), LAMBENT_INVALID_HANDLE);
  EXPECT_NE(std::string(lambent_world_message(told.world)), "");
  EXPECT_NEAR(meanOf(told.draw().direct) / direct, 1, 1e-3);
}

TEST_F(Worlds, WrongCallsAreStatuses) {
  lambent_world* world = nullptr;
  EXPECT_EQ(lambent_world_load("no-such.gltf", nullptr, &world), LAMBENT_INVALID_ARGUMENT);
  EXPECT_EQ(world, nullptr);
  EXPECT_NE(std::string(lambent_world_message(nullptr)).find("no-such.gltf"), std::string::npos);
  EXPECT_EQ(lambent_world_load("content/cornell/cornell.gltf", "none", &world), LAMBENT_INVALID_ARGUMENT);
  EXPECT_EQ(lambent_world_load(nullptr, nullptr, nullptr), LAMBENT_INVALID_ARGUMENT);
  ASSERT_EQ(lambent_world_load(nullptr, nullptr, &world), LAMBENT_OK);
  lambent_frame frame;
  LAMBENT_DEFAULTS(LAMBENT_FRAME, &frame);
  EXPECT_EQ(lambent_world_camera(world, 0, &frame), LAMBENT_OK) << "of nothing";
  EXPECT_EQ(lambent_world_camera(world, 1, &frame), LAMBENT_INVALID_ARGUMENT);
  EXPECT_EQ(lambent_world_place(world, 7, frame.world_from_view), LAMBENT_INVALID_HANDLE);
  EXPECT_EQ(lambent_world_place(world, LAMBENT_NO_ENTITY, frame.world_from_view), LAMBENT_INVALID_HANDLE);
  lambent_entity e = LAMBENT_NO_ENTITY;
  ASSERT_EQ(lambent_world_create(world, nullptr, LAMBENT_NO_ENTITY, nullptr, &e), LAMBENT_OK);
  EXPECT_EQ(lambent_world_show(world, e, 0), LAMBENT_INVALID_ARGUMENT);
  EXPECT_EQ(lambent_world_place(world, e, nullptr), LAMBENT_INVALID_ARGUMENT);
  frame.world_from_view[3] = 1;
  EXPECT_EQ(lambent_world_place(world, e, frame.world_from_view), LAMBENT_INVALID_ARGUMENT);
  lambent_light_desc light{};
  EXPECT_EQ(lambent_world_light(world, e, &light), LAMBENT_INVALID_ARGUMENT);
  EXPECT_EQ(lambent_world_light_of(world, e, &light), LAMBENT_INVALID_ARGUMENT);
  EXPECT_EQ(lambent_world_pose(world, NAN), LAMBENT_INVALID_ARGUMENT);
  EXPECT_EQ(lambent_world_tell(world, nullptr, 0), LAMBENT_INVALID_HANDLE);
  EXPECT_EQ(lambent_world_remove(world, e), LAMBENT_OK);
  EXPECT_EQ(lambent_world_remove(world, e), LAMBENT_INVALID_HANDLE);
  lambent_world_destroy(world);
  lambent_world_destroy(world);
  EXPECT_EQ(lambent_world_pose(world, 0), LAMBENT_INVALID_HANDLE);
  EXPECT_EQ(lambent_world_name(world, e), nullptr);
}

} // namespace lambent::test

// Worlds told to the library: the light is that of the frame itself; what changes is told, what is wrong is a status.
#include "engine/scene/scene.h"
#include "gi/frame/gi_frame.h"
#include "gi/lambent_world.h"
#include "in_host.h"
#include "tests/support/files.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cstdlib>

namespace lambent::test::world_test {

namespace {

constexpr int kWidth = 48, kHeight = 32;

double meanOf(uint32_t texture) {
  std::vector<vec4> texels(size_t(kWidth * kHeight));
  glGetTextureImage(texture, 0, GL_RGBA, GL_FLOAT, GLsizei(texels.size() * sizeof(vec4)), texels.data());
  double sum = 0;
  for (const vec4& t : texels) sum += double(luminance(vec3(t))) / double(texels.size());
  return sum;
}

/// A triangle under a lamp, seen from above, that a morph target carries away: by 30 m at 1 s.
const char* const kMorphed = R"({"asset":{"version":"2.0"},"extensionsUsed":["KHR_lights_punctual"],
"buffers":[{"byteLength":88,"uri":"data:application/octet-stream;base64,AACAvwAAAAAAAIA/AACAPwAAAAAAAIA/AAAAAAAAAAAAAIC/)"
                             R"(AADwQQAAAAAAAAAAAADwQQAAAAAAAAAAAADwQQAAAAAAAAAAAAAAAAAAgD8AAAAAAACAPw=="}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":36},
{"buffer":0,"byteOffset":72,"byteLength":8},{"buffer":0,"byteOffset":80,"byteLength":8}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[-1,0,-1],"max":[1,0,1]},
{"bufferView":1,"componentType":5126,"count":3,"type":"VEC3","min":[30,0,0],"max":[30,0,0]},
{"bufferView":2,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[1]},
{"bufferView":3,"componentType":5126,"count":2,"type":"SCALAR"}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"targets":[{"POSITION":1}]}],"weights":[0]}],
"cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":0.1}}],
"extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","intensity":2000}]}},
"nodes":[{"name":"sheet","mesh":0},
{"name":"lamp","translation":[0,1,0],"extensions":{"KHR_lights_punctual":{"light":0}}},
{"name":"eye","camera":0,"translation":[0,3,0],"rotation":[-0.70710678,0,0,0.70710678]}],
"scenes":[{"nodes":[0,1,2]}],"scene":0,
"animations":[{"samplers":[{"input":2,"output":3}],"channels":[{"sampler":0,"target":{"node":0,"path":"weights"}}]}]})";

/// A world of a file, a device with a scene that it is told to, and a view of that.
struct Told {
  lambent_world* world = nullptr;
  lambent_device* device = nullptr;
  lambent_scene scene = 0;
  lambent_view view = 0;
  lambent_frame frame;

  explicit Told(const char* file) {
    EXPECT_EQ(lambent_world_load(file, nullptr, &world), LAMBENT_OK) << lambent_world_message(nullptr);
    LAMBENT_DEFAULTS(LAMBENT_FRAME, &frame);
    EXPECT_EQ(lambent_world_camera(world, 0, &frame), LAMBENT_OK);
    open();
  }
  void open() {
    EXPECT_EQ(lambent_create(nullptr, &device), LAMBENT_OK);
    EXPECT_EQ(lambent_scene_create(device, &scene), LAMBENT_OK);
    lambent_view_desc d;
    LAMBENT_DEFAULTS(LAMBENT_VIEW_DESC, &d);
    d.width = kWidth;
    d.height = kHeight;
    EXPECT_EQ(lambent_view_create(device, scene, &d, &view), LAMBENT_OK);
    for (const auto& [setting, value] : {std::pair("smc.vpls", "128"), {"smc.points", "128"}, {"smc.warmup", "4"}})
      EXPECT_EQ(lambent_view_set(device, view, setting, value), LAMBENT_OK);
  }
  ~Told() {
    lambent_destroy(device);
    lambent_world_destroy(world);
  }
  Told(const Told&) = delete;

  lambent_output draw() const {
    EXPECT_EQ(lambent_world_sync(world, device, scene), LAMBENT_OK) << lambent_world_message(world);
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

class Worlds : public InHost {};

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
    double first = 0, last = 0;
    for (int i = 0; i < 4; ++i) {
      animate(scene, 2.0 * i);
      gi.run(extractor.extract(scene, seen, 0));
      ASSERT_EQ(lambent_world_animate(told.world, 2.0 * i), LAMBENT_OK);
      const lambent_output out = told.draw();
      (i == 0 ? first : last) = meanOf(out.direct);
      EXPECT_NEAR(meanOf(out.direct) / meanOf(gi.directIrradiance()), 1, 1e-3) << i;
      EXPECT_NEAR(meanOf(out.indirect) / meanOf(gi.indirectIrradiance()), 1, 0.01) << i;
    }
    EXPECT_EQ(lambent_world_warning(told.world, 0), nullptr) << lambent_world_warning(told.world, 0);
    if (!scene.animations.empty()) {
      EXPECT_GT(std::abs(last / first - 1), 2e-3) << "what moves shows";
    }
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
  ASSERT_EQ(lambent_world_set_light(told.world, lamp, &light), LAMBENT_OK);
  const double lit = meanOf(told.draw().direct);
  EXPECT_GT(lit, 1.02 * before);
  place[13] = 0.4f;
  ASSERT_EQ(lambent_world_set_transform(told.world, lamp, place), LAMBENT_OK);
  const double moved = meanOf(told.draw().direct);
  EXPECT_GT(std::abs(moved / lit - 1), 0.01);
  lambent_light_desc read;
  LAMBENT_DEFAULTS(LAMBENT_LIGHT_DESC, &read);
  ASSERT_EQ(lambent_world_get_light(told.world, lamp, &read), LAMBENT_OK);
  EXPECT_EQ(read.position[1], 0.4f);
  EXPECT_EQ(read.intensity[0], 1);
  // A child that shows a mesh of the file goes with its parent.
  size_t count = 0;
  ASSERT_EQ(lambent_world_entities(told.world, nullptr, &count), LAMBENT_OK);
  std::vector<lambent_entity> all(count);
  ASSERT_EQ(lambent_world_entities(told.world, all.data(), &count), LAMBENT_OK);
  uint32_t mesh = 0;
  const auto shows = [&](lambent_entity e) { return lambent_world_get_mesh(told.world, e, &mesh) == LAMBENT_OK; };
  ASSERT_TRUE(std::ranges::any_of(all, shows));
  lambent_entity child = LAMBENT_NO_ENTITY;
  const float small[16] = {0.2f, 0, 0, 0, 0, 0.2f, 0, 0, 0, 0, 0.2f, 0, 0, 0, 0, 1};
  ASSERT_EQ(lambent_world_create(told.world, "child", lamp, small, &child), LAMBENT_OK);
  ASSERT_EQ(lambent_world_set_mesh(told.world, child, mesh), LAMBENT_OK);
  told.draw();
  const lambent_instance shown = lambent_world_instance(told.world, child, told.device, told.scene);
  EXPECT_NE(shown, 0u);
  ASSERT_EQ(lambent_world_set_mesh(told.world, child, mesh == 0 ? 1 : 0), LAMBENT_OK)
      << lambent_world_message(told.world);
  told.draw();
  EXPECT_NE(lambent_world_instance(told.world, child, told.device, told.scene), shown) << "another mesh";
  float world[16];
  ASSERT_EQ(lambent_world_get_transform(told.world, child, nullptr, world), LAMBENT_OK);
  EXPECT_EQ(world[13], 0.4f);
  lambent_mesh_desc arrays;
  ASSERT_EQ(lambent_world_mesh_data(told.world, mesh, &arrays), LAMBENT_OK);
  EXPECT_TRUE(arrays.vertex_count > 0 && arrays.positions && arrays.normals && arrays.indices);
  ASSERT_EQ(lambent_world_remove(told.world, lamp), LAMBENT_OK);
  EXPECT_EQ(lambent_world_name(told.world, child), nullptr) << "descendants go too";
  EXPECT_NEAR(meanOf(told.draw().direct) / before, 1, 0.005);
  EXPECT_EQ(lambent_world_instance(told.world, child, told.device, told.scene), 0u);
  // A constant sky lights what is open.
  lambent_sky_desc above;
  LAMBENT_DEFAULTS(LAMBENT_SKY_DESC, &above);
  for (float& c : above.radiance) c = 5;
  ASSERT_EQ(lambent_world_set_sky(told.world, &above), LAMBENT_OK);
  EXPECT_GT(meanOf(told.draw().direct), 1.1 * before);
}

TEST_F(Worlds, AnyNumberOfScenesIsTold) {
  Told told("content/cornell/cornell.gltf");
  const double direct = meanOf(told.draw().direct);
  lambent_scene other = 0;
  ASSERT_EQ(lambent_scene_create(told.device, &other), LAMBENT_OK);
  EXPECT_EQ(lambent_world_sync(told.world, told.device, other), LAMBENT_OK);
  ASSERT_EQ(lambent_scene_destroy(told.device, other), LAMBENT_OK);
  EXPECT_EQ(lambent_world_sync(told.world, told.device, other), LAMBENT_INVALID_HANDLE);
  EXPECT_NE(std::string(lambent_world_message(told.world)), "");
  EXPECT_NEAR(meanOf(told.draw().direct) / direct, 1, 1e-3);
}

/// Devices that took the place of one that ended, some with instances of the host's own; and one that is lost.
TEST_F(Worlds, ANewDeviceIsToldAll) {
  Told told("content/cornell/cornell.gltf");
  const double direct = meanOf(told.draw().direct);
  for (int i = 0; i < 4; ++i) {
    if (i == 2) {
      setenv("LAMBENT_FAULT", "call", 1);
      EXPECT_EQ(lambent_render(told.device, told.view, &told.frame, nullptr), LAMBENT_DEVICE_LOST);
      unsetenv("LAMBENT_FAULT");
      EXPECT_EQ(lambent_world_sync(told.world, told.device, told.scene), LAMBENT_DEVICE_LOST);
      EXPECT_EQ(lambent_world_animate(told.world, 0), LAMBENT_OK) << "the world lives on";
    }
    lambent_destroy(told.device);
    told.open();
    if (i == 1) { // a far triangle, under the first numbers
      const float corners[9] = {50, 0, 0, 51, 0, 0, 50, 1, 0};
      const uint32_t indices[3] = {0, 1, 2};
      lambent_mesh_desc d;
      LAMBENT_DEFAULTS(LAMBENT_MESH_DESC, &d);
      d.vertex_count = 3, d.triangle_count = 1, d.positions = corners, d.indices = indices;
      lambent_mesh mesh = 0;
      lambent_instance instance = 0;
      const float place[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
      ASSERT_EQ(lambent_mesh_create(told.device, told.scene, &d, &mesh), LAMBENT_OK);
      ASSERT_EQ(lambent_instance_create(told.device, told.scene, mesh, place, &instance), LAMBENT_OK);
    }
    EXPECT_NEAR(meanOf(told.draw().direct) / direct, 1, 0.02) << i;
  }
}

/// What the host destroys of a world is not made twice.
TEST_F(Worlds, AnInstanceThatTheHostDestroyedComesAgainAlone) {
  Told told("content/cornell/cornell.gltf");
  told.draw();
  const auto bytes = [&] {
    size_t count = 64;
    lambent_memory_row rows[64];
    EXPECT_EQ(lambent_memory(told.device, rows, &count), LAMBENT_OK);
    for (size_t i = 0; i < count; ++i)
      if (std::string(rows[i].owner) == "scenes") return rows[i].bytes;
    return uint64_t(0);
  };
  const uint64_t before = bytes();
  size_t count = 0;
  lambent_world_entities(told.world, nullptr, &count);
  std::vector<lambent_entity> all(count);
  lambent_world_entities(told.world, all.data(), &count);
  const auto instanceOf = [&](lambent_entity e) {
    return lambent_world_instance(told.world, e, told.device, told.scene);
  };
  const auto shown = std::ranges::find_if(all, [&](lambent_entity e) { return instanceOf(e) != 0; });
  ASSERT_NE(shown, all.end());
  const lambent_instance first = instanceOf(*shown);
  ASSERT_EQ(lambent_instance_destroy(told.device, told.scene, first), LAMBENT_OK);
  float place[16];
  ASSERT_EQ(lambent_world_get_transform(told.world, *shown, place, nullptr), LAMBENT_OK);
  place[13] += 0.01f;
  ASSERT_EQ(lambent_world_set_transform(told.world, *shown, place), LAMBENT_OK);
  told.draw();
  EXPECT_NE(instanceOf(*shown), first);
  EXPECT_EQ(bytes(), before);
}

TEST_F(Worlds, AnInstanceThatTheHostDestroyedComesAgainInItsPose) {
  const TemporaryFolder folder;
  writeBytes(folder / "morphed.gltf", kMorphed);
  Told told((folder / "morphed.gltf").c_str());
  const lambent_entity sheet = told.find("sheet");
  const double undeformed = meanOf(told.draw().direct);
  EXPECT_GT(undeformed, 0);
  ASSERT_EQ(lambent_world_animate(told.world, 0.95), LAMBENT_OK);
  EXPECT_EQ(meanOf(told.draw().direct), 0) << "out of sight";
  for (const bool posed : {true, false}) { // the instance is missed where it is posed, and where it is moved
    SCOPED_TRACE(posed);
    const lambent_instance had = lambent_world_instance(told.world, sheet, told.device, told.scene);
    ASSERT_EQ(lambent_instance_destroy(told.device, told.scene, had), LAMBENT_OK);
    float place[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0.01f, 0, 1};
    ASSERT_EQ(posed ? lambent_world_animate(told.world, 0.9) : lambent_world_set_transform(told.world, sheet, place),
              LAMBENT_OK);
    EXPECT_EQ(meanOf(told.draw().direct), 0) << "still";
    const lambent_instance has = lambent_world_instance(told.world, sheet, told.device, told.scene);
    EXPECT_TRUE(has != 0 && has != had);
  }
  ASSERT_EQ(lambent_world_animate(told.world, 0), LAMBENT_OK);
  EXPECT_NEAR(meanOf(told.draw().direct) / undeformed, 1, 0.05);
}

TEST_F(Worlds, ACameraBeyondAllPlacesIsRefused) {
  const TemporaryFolder folder;
  std::string far = kMorphed;
  far.replace(far.find("[0,3,0]"), 7, "[0,3e12,0]");
  writeBytes(folder / "far.gltf", far);
  lambent_world* world = nullptr;
  ASSERT_EQ(lambent_world_load((folder / "far.gltf").c_str(), nullptr, &world), LAMBENT_OK);
  lambent_frame frame;
  LAMBENT_DEFAULTS(LAMBENT_FRAME, &frame);
  EXPECT_EQ(lambent_world_camera(world, 0, &frame), LAMBENT_INVALID_ARGUMENT);
  lambent_world_destroy(world);
}

TEST_F(Worlds, LargeFilesAreAllowedOnRequest) {
  lambent_world* world = nullptr;
  const TemporaryFolder folder; // twelve million points in 1 kB: a gigabyte
  std::string many =
      R"({"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "accessors": [)";
  many += R"({"componentType": 5126, "type": "VEC3", "count": 12582912}], "meshes": [{"primitives": [)";
  for (int i = 0; i < 4; ++i) many += std::string(i ? "," : "") + R"({"attributes": {"POSITION": 0}})";
  writeBytes(folder / "many.gltf", many + "]}]}");
  EXPECT_EQ(lambent_world_load((folder / "many.gltf").c_str(), nullptr, &world), LAMBENT_INVALID_ARGUMENT);
  EXPECT_NE(std::string(lambent_world_message(nullptr)).find("may ask for"), std::string::npos);
  lambent_world_allow_large(1);
  EXPECT_EQ(lambent_world_load((folder / "many.gltf").c_str(), nullptr, &world), LAMBENT_OK);
  lambent_world_destroy(world);
  lambent_world_allow_large(0);
}

/// Backs of what is not double-sided are not shown, unless the host shows them.
TEST_F(Worlds, TheBacksOfAFileAreHiddenUnlessTheHostShowsThem) {
  const TemporaryFolder folder;
  std::string turned = kMorphed;
  const std::string sheet = R"({"name":"sheet","mesh":0)";
  turned.replace(turned.find(sheet), sheet.size(), sheet + R"(,"rotation":[1,0,0,0])");
  writeBytes(folder / "turned.gltf", turned);
  const std::string file = (folder / "turned.gltf").string();
  EXPECT_EQ(meanOf(Told(file.c_str()).draw().direct), 0);
  lambent_world_two_sided(1);
  EXPECT_GT(meanOf(Told(file.c_str()).draw().direct), 0);
  lambent_world_two_sided(0);
  EXPECT_EQ(meanOf(Told(file.c_str()).draw().direct), 0);
}

/// A picture of the sky is the world's own: told to the library after the host's copy and the file have gone.
TEST_F(Worlds, SkiesFromExtrasAndFromTheHost) {
  const TemporaryFolder folder;
  writeBytes(folder / "sky.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n" + std::string("\x80\x80\x80\x81"));
  std::string lit = kMorphed;
  lit.replace(lit.find("2000"), 4, "0");
  lit.replace(lit.find("\"nodes\":[0,"), 0, R"("extras":{"lambent_sky":{"image":"sky.hdr"}},)");
  writeBytes(folder / "lit.gltf", lit);
  Told told((folder / "lit.gltf").c_str());
  const double byFile = meanOf(told.draw().direct);
  EXPECT_GT(byFile, 0);
  {
    const std::vector<float> texels(6, 3.0f);
    lambent_sky_desc sky;
    LAMBENT_DEFAULTS(LAMBENT_SKY_DESC, &sky);
    sky.type = LAMBENT_SKY_PICTURE;
    sky.texels = texels.data();
    sky.width = 2;
    sky.height = 1;
    ASSERT_EQ(lambent_world_set_sky(told.world, &sky), LAMBENT_OK);
  }
  EXPECT_NEAR(meanOf(told.draw().direct), 3 * byFile, 0.1 * byFile);
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
  EXPECT_EQ(lambent_world_set_transform(world, 7, frame.world_from_view), LAMBENT_INVALID_HANDLE);
  EXPECT_EQ(lambent_world_set_transform(world, LAMBENT_NO_ENTITY, frame.world_from_view), LAMBENT_INVALID_HANDLE);
  lambent_entity e = LAMBENT_NO_ENTITY;
  ASSERT_EQ(lambent_world_create(world, nullptr, LAMBENT_NO_ENTITY, nullptr, &e), LAMBENT_OK);
  EXPECT_EQ(lambent_world_set_mesh(world, e, 0), LAMBENT_INVALID_ARGUMENT);
  EXPECT_EQ(lambent_world_set_transform(world, e, nullptr), LAMBENT_INVALID_ARGUMENT);
  frame.world_from_view[3] = 1;
  EXPECT_EQ(lambent_world_set_transform(world, e, frame.world_from_view), LAMBENT_INVALID_ARGUMENT);
  lambent_light_desc light{};
  EXPECT_EQ(lambent_world_set_light(world, e, &light), LAMBENT_INVALID_ARGUMENT);
  EXPECT_EQ(lambent_world_get_light(world, e, &light), LAMBENT_INVALID_ARGUMENT);
  EXPECT_EQ(lambent_world_animate(world, NAN), LAMBENT_INVALID_ARGUMENT);
  EXPECT_EQ(lambent_world_sync(world, nullptr, 0), LAMBENT_INVALID_HANDLE);
  EXPECT_EQ(lambent_world_remove(world, e), LAMBENT_OK);
  EXPECT_EQ(lambent_world_remove(world, e), LAMBENT_INVALID_HANDLE);
  lambent_world_destroy(world);
  lambent_world_destroy(world);
  EXPECT_EQ(lambent_world_animate(world, 0), LAMBENT_INVALID_HANDLE);
  EXPECT_EQ(lambent_world_name(world, e), nullptr);
}

} // namespace lambent::test::world_test

// What a host tells of its scene while frames run, and what it reads of the light: textures, shaders, points.
#include "gi/lambent.hpp"
#include "room.h"

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace lambent::test {

TEST_F(Library, TexturesAndMaterialsChangeAndEnd) {
  Room room;
  const uint8_t texels[8] = {255, 0, 0, 255, 0, 255, 0, 0}; // red; green, and cut out
  lambent_texture_desc t;
  LAMBENT_DEFAULTS(LAMBENT_TEXTURE_DESC, &t);
  t.width = 2;
  t.height = 1;
  t.rgba = texels;
  t.nearest = 1;
  lambent_texture texture = 0;
  room.ok(lambent_texture_create(room.device, room.scene, &t, &texture));
  lambent_material_desc m;
  LAMBENT_DEFAULTS(LAMBENT_MATERIAL_DESC, &m);
  for (float& c : m.base_color) c = 1;
  m.base_texture = texture;
  m.base_uv[0] = 0; // all of the first texel
  m.base_uv[2] = 0.25f;
  lambent_material material = 0;
  room.ok(lambent_material_create(room.device, room.scene, &m, &material));
  EXPECT_EQ(lambent_texture_destroy(room.device, room.scene, texture), LAMBENT_INVALID_ARGUMENT) << "it is used";
  const lambent_mesh mesh = room.box(0.4f, false, material);
  EXPECT_EQ(lambent_material_destroy(room.device, room.scene, material), LAMBENT_INVALID_ARGUMENT) << "a mesh has it";
  lambent_instance instance = 0;
  float place[16];
  std::copy(kIdentity, kIdentity + 16, place);
  place[14] = -0.5f;
  room.ok(lambent_instance_create(room.device, room.scene, mesh, place, &instance));
  const lambent_view view = room.view();
  const auto seen = [&](int channel) {
    const std::vector<float> albedo = Room::read(room.render(view).albedo, GL_RGB);
    return albedo[3 * size_t((Room::kHeight / 2) * Room::kWidth + Room::kWidth / 2) + size_t(channel)];
  };
  EXPECT_NEAR(seen(0), 1, 0.01);
  EXPECT_NEAR(seen(1), 0, 0.01);
  m.base_uv[2] = 0.75f;
  room.ok(lambent_material_set(room.device, room.scene, material, &m));
  EXPECT_NEAR(seen(0), 0, 0.01);
  EXPECT_NEAR(seen(1), 1, 0.01);
  m.alpha_mode = LAMBENT_ALPHA_MASK;
  room.ok(lambent_material_set(room.device, room.scene, material, &m));
  EXPECT_NEAR(seen(0), 0.8, 0.01) << "the wall behind";
  m.base_uv_set = 2;
  EXPECT_EQ(lambent_material_set(room.device, room.scene, material, &m), LAMBENT_INVALID_ARGUMENT);
  m.base_uv_set = 1; // which the mesh lacks: coordinates are 0
  m.base_uv[2] = 0.25f;
  room.ok(lambent_material_set(room.device, room.scene, material, &m));
  EXPECT_NEAR(seen(0), 1, 0.01);
  m.base_texture = 0;
  room.ok(lambent_material_set(room.device, room.scene, material, &m));
  room.ok(lambent_texture_destroy(room.device, room.scene, texture));
  EXPECT_EQ(lambent_texture_destroy(room.device, room.scene, texture), LAMBENT_INVALID_HANDLE);
  room.render(view);
  room.ok(lambent_instance_destroy(room.device, room.scene, instance));
  room.ok(lambent_mesh_destroy(room.device, room.scene, mesh));
  room.ok(lambent_material_destroy(room.device, room.scene, material));
  EXPECT_EQ(lambent_material_set(room.device, room.scene, material, &m), LAMBENT_INVALID_HANDLE);
  m.base_texture = texture;
  EXPECT_EQ(lambent_material_create(room.device, room.scene, &m, &material), LAMBENT_INVALID_HANDLE);
  EXPECT_NEAR(seen(0), 0.8, 0.01);
}

TEST_F(Library, HiddenBacksAreNotSeen) {
  Room room;
  lambent_material_desc m;
  LAMBENT_DEFAULTS(LAMBENT_MATERIAL_DESC, &m);
  for (float& c : m.base_color) c = 1;
  lambent_material material = 0;
  room.ok(lambent_material_create(room.device, room.scene, &m, &material));
  lambent_instance instance = 0;
  float place[16];
  std::copy(kIdentity, kIdentity + 16, place);
  place[14] = -0.8f; // its fronts are inside, and the far one is behind the wall
  room.ok(lambent_instance_create(room.device, room.scene, room.box(0.4f, true, material), place, &instance));
  const lambent_view view = room.view();
  const auto seen = [&] {
    const std::vector<float> albedo = Room::read(room.render(view).albedo, GL_RGB);
    return albedo[3 * size_t((Room::kHeight / 2) * Room::kWidth + Room::kWidth / 2)];
  };
  EXPECT_NEAR(seen(), 1, 0.01) << "a back";
  m.back_hidden = 1;
  room.ok(lambent_material_set(room.device, room.scene, material, &m));
  EXPECT_NEAR(seen(), 0.8, 0.01) << "the wall behind";
}

/// Its G-buffer, which blended surfaces are not in, is that of the room without them.
TEST_F(Library, BlendedLetsItsShareOfLightPass) {
  std::string heard;
  lambent_device_desc desc;
  LAMBENT_DEFAULTS(LAMBENT_DEVICE_DESC, &desc);
  desc.user = &heard;
  desc.log = [](void* user, lambent_level, const char* line) { *static_cast<std::string*>(user) += line; };
  Room room(&desc);
  const lambent_view view = room.view();
  lambent_frame f = Room::frame();
  {
    const lambent_output own = room.render(view);
    std::vector<float> depth = Room::read(own.depth, GL_DEPTH_COMPONENT);
    for (float& d : depth) d = f.near_plane / d;
    f.depth = textureOf(GL_R32F, Room::kWidth, Room::kHeight, 1, depth);
    f.depth_type = LAMBENT_DEPTH_LINEAR;
    f.normal = textureOf(GL_RGB16F, Room::kWidth, Room::kHeight, 3, Room::read(own.normal, GL_RGB));
  }
  const std::vector<float> normals = Room::read(f.normal, GL_RGB);
  struct Light {
    double floor = 0, all = 0, indirect = 0; // direct light of the floor and of everything, indirect light
    float asked[3] = {};                     // direct light at a point of the floor
  };
  const auto light = [&](lambent_material pane, std::vector<float> corners) {
    lambent_instance instance = 0;
    if (pane) {
      const uint32_t indices[] = {0, 1, 2, 0, 2, 3};
      lambent_mesh_desc mesh;
      LAMBENT_DEFAULTS(LAMBENT_MESH_DESC, &mesh);
      mesh.vertex_count = 4;
      mesh.triangle_count = 2;
      mesh.positions = corners.data();
      mesh.indices = indices;
      mesh.material = pane;
      lambent_mesh made = 0;
      room.ok(lambent_mesh_create(room.device, room.scene, &mesh, &made));
      room.ok(lambent_instance_create(room.device, room.scene, made, kIdentity, &instance));
    }
    const lambent_view fresh = room.view(); // which compares the surfaces again
    lambent_output out;
    for (int i = 0; i < 4; ++i) out = room.render(fresh, f);
    const std::vector<float> direct = Room::read(out.direct, GL_RGB);
    Light sum{0, Room::mean(direct), Room::mean(Room::read(out.indirect, GL_RGB))};
    const float point[] = {0.3f, -0.99f, 0.5f}, up[] = {0, 1, 0};
    room.ok(lambent_irradiance(room.device, fresh, point, up, 1, nullptr, sum.asked));
    for (size_t i = 0; i < direct.size(); ++i)
      if (normals[i / 3 * 3 + 1] > 0.9f) sum.floor += double(direct[i]);
    if (pane) room.ok(lambent_instance_destroy(room.device, room.scene, instance));
    room.ok(lambent_view_destroy(room.device, fresh));
    return sum;
  };
  const Light open = light(0, {});
  lambent_material_desc m;
  LAMBENT_DEFAULTS(LAMBENT_MATERIAL_DESC, &m);
  for (float& c : m.base_color) c = 0;
  m.alpha_mode = LAMBENT_ALPHA_BLEND;
  m.alpha = 0.75f;
  lambent_material pane = 0;
  room.ok(lambent_material_create(room.device, room.scene, &m, &pane));
  const Light below = light(pane, {-1, 0.3f, -1, 1, 0.3f, -1, 1, 0.3f, 1, -1, 0.3f, 1});
  EXPECT_NEAR(below.floor / open.floor, 0.25, 0.01) << "below the lamp";
  EXPECT_NEAR(below.asked[0] / open.asked[0], 0.25, 0.01) << "at a point";
  m.alpha = 0.98f;
  room.ok(lambent_material_set(room.device, room.scene, pane, &m));
  const Light before = light(pane, {-1, -1, 0.8f, 1, -1, 0.8f, 1, 1, 0.8f, -1, 1, 0.8f});
  EXPECT_NEAR(before.all / open.all, 1, 0.01) << "the camera looks through it";
  const Light behind = light(pane, {-1, -1, 0.95f, 1, -1, 0.95f, 1, 1, 0.95f, -1, 1, 0.95f});
  EXPECT_NEAR(before.indirect / behind.indirect, 1, 0.1) << "before the camera or behind it";
  EXPECT_EQ(heard, "");
  m.alpha_mode = 3;
  EXPECT_EQ(lambent_material_set(room.device, room.scene, pane, &m), LAMBENT_INVALID_ARGUMENT);
}

TEST_F(Library, ShadersAreReadAgainWhileAHostRuns) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / ("lambent-reload-" + std::to_string(getpid()));
  fs::copy("shaders", folder, fs::copy_options::recursive);
  const std::string name = folder;
  std::string heard;
  lambent_device_desc desc;
  LAMBENT_DEFAULTS(LAMBENT_DEVICE_DESC, &desc);
  desc.shader_folder = name.c_str();
  desc.user = &heard;
  desc.log = [](void* user, lambent_level, const char* line) { *static_cast<std::string*>(user) += line; };
  {
    Room room(&desc);
    const lambent_view view = room.view();
    const double before = Room::mean(Room::read(room.render(view).direct, GL_RGB));
    const auto write = [&](const std::string& text) {
      std::ofstream(folder / "direct.frag") << text;
      fs::last_write_time(folder / "direct.frag", fs::file_time_type::clock::now() + std::chrono::seconds(2));
    };
    std::stringstream shader;
    shader << std::ifstream(folder / "direct.frag").rdbuf();
    room.ok(lambent_reload_shaders(room.device));
    EXPECT_EQ(heard, "") << "nothing changed";
    write("#version 450\nno shader\n");
    EXPECT_EQ(lambent_reload_shaders(room.device), LAMBENT_FAILED);
    EXPECT_NE(std::string(lambent_message(room.device)).find("direct.frag"), std::string::npos);
    EXPECT_NEAR(Room::mean(Room::read(room.render(view).direct, GL_RGB)) / before, 1, 1e-6) << "the last good one";
    std::string dark = shader.str();
    dark.insert(dark.find_last_of('}'), "outIrradiance = vec4(0);\n");
    write(dark);
    heard.clear();
    room.ok(lambent_reload_shaders(room.device));
    EXPECT_NE(heard.find("reloaded direct.frag"), std::string::npos) << heard;
    EXPECT_EQ(Room::mean(Room::read(room.render(view).direct, GL_RGB)), 0);
  }
  fs::remove_all(folder);
  Room room;
  EXPECT_EQ(lambent_reload_shaders(room.device), LAMBENT_INVALID_ARGUMENT) << "built in";
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
  EXPECT_GT(told.lines, 26);
  EXPECT_EQ(told.bad, 0);
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
  /// Root of the mean square of what differs, over the mean.
  const auto apart = [](const std::vector<float>& points, const std::vector<float>& image) {
    double square = 0;
    for (size_t i = 0; i < points.size(); ++i) square += double((points[i] - image[i]) * (points[i] - image[i]));
    return std::sqrt(square / double(points.size())) / Room::mean(image);
  };
  const std::vector<float> indirectSeen = Room::read(out.indirect, GL_RGB), directSeen = Room::read(out.direct, GL_RGB);
  EXPECT_NEAR(Room::mean(indirect) / Room::mean(indirectSeen), 1, 0.03);
  EXPECT_NEAR(Room::mean(direct) / Room::mean(directSeen), 1, 0.03);
  std::printf("points and image: %.3f of the mean apart, direct light %.3f\n", apart(indirect, indirectSeen),
              apart(direct, directSeen));
  EXPECT_LT(apart(indirect, indirectSeen), 0.07);
  EXPECT_LT(apart(direct, directSeen), 0.01);
  uint32_t names[2] = {};
  room.ok(lambent_irradiance_texture(room.device, view, points.data(), normals.data(), points.size() / 3, 32, &names[0],
                                     &names[1]));
  EXPECT_EQ(Room::read(names[0], GL_RGB), indirect);
  EXPECT_EQ(Room::read(names[1], GL_RGB), direct);
  const lambent_mesh mesh = room.box(0.1f, false, 0);
  room.ok(lambent_irradiance(room.device, view, points.data(), normals.data(), 1, indirect.data(), nullptr));
  room.ok(lambent_mesh_destroy(room.device, room.scene, mesh));
  EXPECT_EQ(lambent_irradiance(room.device, view, points.data(), normals.data(), 1, indirect.data(), nullptr),
            LAMBENT_INVALID_ARGUMENT)
      << "a mesh has gone since the last frame";
}

} // namespace lambent::test

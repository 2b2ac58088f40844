// G-buffers of every convention give the same light, and wrong ones are told.
#include "room.h"
#include "tests/support/effort.h"

#include <algorithm>
#include <string>

namespace lambent::test {

struct Convention {
  lambent_depth depth;
  bool minusOne, infinite;
  lambent_normals normals;
  lambent_space space;
  bool top, rectangle;
};

/// Of 0.2 m, at the upper right of what is seen.
void addGlowingBox(const Room& room, float emission) {
  lambent_material_desc glow;
  LAMBENT_DEFAULTS(LAMBENT_MATERIAL_DESC, &glow);
  for (float& c : glow.emission) c = emission;
  lambent_material material = 0;
  room.ok(lambent_material_create(room.device, room.scene, &glow, &material));
  lambent_instance instance = 0;
  float place[16];
  std::copy(kIdentity, kIdentity + 16, place);
  place[12] = 0.5f, place[13] = 0.5f, place[14] = -0.3f;
  room.ok(lambent_instance_create(room.device, room.scene, room.box(0.1f, false, material), place, &instance));
}

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
  const bool all = isLong();
  int tried = 0;
  for (int i = 0; i < 384; ++i) {
    const Convention c{lambent_depth(i % 3),      i / 3 % 2 == 1,  i / 6 % 2 == 1,  lambent_normals(i / 12 % 4),
                       lambent_space(i / 48 % 2), i / 96 % 2 == 1, i / 192 % 2 == 1};
    if (c.depth == LAMBENT_DEPTH_LINEAR && (c.minusOne || c.infinite)) continue; // has neither range nor planes
    if (!all && i % 5 != 0 && i >= 48) continue; // all of depth and normals, a fifth of what else goes with them
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
  EXPECT_EQ(tried, all ? 288 : 86);
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
  f.normal_space = LAMBENT_SPACE_VIEW;
  view = room.view();
  out = room.render(view, f);
  const std::vector<float> found = Room::read(out.direct, GL_RGB);
  double off = 0;
  for (size_t i = 0; i < found.size(); ++i) off += double(std::abs(found[i] - expected[i])) / double(found.size());
  EXPECT_LT(off, 1e-3 * Room::mean(expected));
  f.normal_space = LAMBENT_SPACE_WORLD;
  out = room.render(view, f);
  EXPECT_GT(std::abs(Room::mean(Room::read(out.direct, GL_RGB)) / Room::mean(expected) - 1), 0.01) << "it matters";
}

/// Parallel rays, with what glows told as a texture: every depth is that of the library's own surfaces.
TEST_F(Library, ParallelRaysAndEmissionGiveTheSameLight) {
  constexpr int w = Room::kWidth, h = Room::kHeight;
  Room room;
  addGlowingBox(room, 3);
  lambent_frame f = Room::frame();
  f.ortho_half_height = 0.7f;
  const lambent_output own = room.render(room.view(), f);
  const std::vector<float> direct = Room::read(own.direct, GL_RGB), indirect = Room::read(own.indirect, GL_RGB);
  f.normal = textureOf(GL_RGB16F, w, h, 3, Room::read(own.normal, GL_RGB));
  f.emission = textureOf(GL_RGB16F, w, h, 3, Room::read(own.emission, GL_RGB));
  EXPECT_GT(Room::mean(Room::read(own.emission, GL_RGB)), 0.01) << "it is seen";
  // Distances by closed form: the back wall at z = -1, the block's front at 0.3, the glowing one's at -0.2.
  const float camera = f.world_from_view[14];
  const std::vector<float> normals = Room::read(own.normal, GL_RGB), emission = Room::read(own.emission, GL_RGB);
  std::vector<float> distances;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const float up = f.world_from_view[13] + f.ortho_half_height * (2 * (float(y) + 0.5f) / h - 1),
                  right = f.ortho_half_height * w / h * (2 * (float(x) + 0.5f) / w - 1);
      const bool glows = emission[3 * size_t(y * w + x)] > 0;
      const bool block = std::abs(right + 0.4f) < 0.3f && std::abs(up + 0.7f) < 0.3f;
      EXPECT_EQ(glows, std::abs(right - 0.5f) < 0.1f && std::abs(up - 0.5f) < 0.1f) << x << ' ' << y;
      EXPECT_GT(normals[3 * size_t(y * w + x) + 2], 0.99f) << "all seen faces look at the camera";
      distances.push_back(camera - (glows ? -0.2f : block ? 0.3f : -1));
    }
  for (const lambent_depth type : {LAMBENT_DEPTH_FORWARD, LAMBENT_DEPTH_REVERSED, LAMBENT_DEPTH_LINEAR})
    for (const bool minusOne : {false, true}) {
      if (minusOne && type == LAMBENT_DEPTH_LINEAR) continue;
      SCOPED_TRACE(int(type) * 2 + minusOne);
      f.far_plane = 12;
      std::vector<float> depth;
      for (const float d : distances) {
        const float forward = (d - f.near_plane) / (f.far_plane - f.near_plane);
        const float stored = type == LAMBENT_DEPTH_LINEAR ? d : type == LAMBENT_DEPTH_FORWARD ? forward : 1 - forward;
        depth.push_back(minusOne ? 2 * stored - 1 : stored);
      }
      f.depth = textureOf(GL_R32F, w, h, 1, depth);
      f.depth_type = type;
      f.depth_minus_one = minusOne;
      const lambent_view view = room.view();
      const lambent_output out = room.render(view, f);
      for (const auto& [texture, expected] : {std::pair(out.direct, &direct), {out.indirect, &indirect}}) {
        const std::vector<float> found = Room::read(texture, GL_RGB);
        double off = 0;
        for (size_t i = 0; i < found.size(); ++i)
          off += double(std::abs(found[i] - (*expected)[i])) / double(found.size());
        EXPECT_LT(off, 2e-3 * Room::mean(*expected));
      }
      room.ok(lambent_view_destroy(room.device, view));
      glDeleteTextures(1, &f.depth);
    }
}

/// Soft light begins at the host's surfaces too, though rays know those of the scene.
TEST_F(Library, SoftLightFallsOnTheHostsSurfaces) {
  constexpr int w = Room::kWidth, h = Room::kHeight;
  Room room;
  addGlowingBox(room, 20);
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
  wrong.normal_space = LAMBENT_SPACE_VIEW;
  EXPECT_NE(warningOf(wrong).find("normal_space"), std::string::npos);
}

} // namespace lambent::test

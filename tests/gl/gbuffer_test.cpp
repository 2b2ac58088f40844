// The G-buffer against rays: what a pixel holds is what the ray through its centre meets.
#include "gl_fixture.h"
#include "shader_copy.h"

namespace lambent::test::gbuffer_test {

class GBufferTest : public GatherTest {
 protected:
  void expectAgreesWithRays(const Room& room) {
    const GBuffer frame = surfaces(room.scene);
    const Image depth = surfaceBuffer(Buffer::Depth, frame), normal = surfaceBuffer(Buffer::Normal, frame);
    const vec3 forward = -vec3(room.scene.camera.worldFromView[2]);
    int differing = 0;
    for (const auto [x, y] : Pixels(depth)) {
      // A GPU may round corners of triangles to 1/256 of a pixel, and interpolate between what it rounded.
      float nearest = kInfinity, farthest = -kInfinity;
      bool faces = false;
      for (const vec2 corner : {vec2(-1, -1), vec2(1, -1), vec2(-1, 1), vec2(1, 1)}) {
        const vec2 at = (vec2(x, y) + 0.5f + corner / 256.0f) / vec2(depth.width, depth.height);
        const CameraRay ray = cameraRay(room.scene.camera, at.x, at.y);
        const SurfaceHit hit = room.rays.seen(Ray{ray.origin, ray.direction});
        const float distance = glm::dot(hit.position - room.scene.camera.position(), forward);
        nearest = std::min(nearest, distance), farthest = std::max(farthest, distance);
        faces |= glm::length(normal.at(x, y) - hit.normal) <= 1e-3f;
      }
      const float is = depth.at(x, y).x;
      differing += !(is >= nearest - 1e-5f && is <= farthest + 1e-5f && faces);
    }
    EXPECT_LE(differing, 3) << "only pixels whose centre lies on an edge may differ";
  }

  /// A square of `size` metres whose mask repeats four times, seen from some distances: as large a share of it is drawn
  /// as rays meet.
  void expectCoverage(const std::vector<u8vec4>& texels, float size, const vec2& middle,
                      std::span<const float> distances, double tolerance, const std::string& what) {
    HandScene scene;
    const uint32_t masked = scene.material(vec3(1));
    Material& m = scene.assets.materials[masked];
    m.baseColorTexture = scene.texture(128, texels);
    m.baseColorTexture.nearest = false;
    m.baseColorTexture.uvTransform = mat3(4, 0, 0, 0, 4, 0, 0, 0, 1);
    m.alphaMode = AlphaMode::Mask;
    scene.quad({-0.5f * size, -0.5f * size, 0}, {size, 0, 0}, {0, size, 0}, masked);
    Rng rng(1, Stream::Test, 1);
    double wanted = 0; // what rays meet
    constexpr int kRays = 20000;
    for (int i = 0; i < kRays; ++i)
      wanted += (sampleAlpha(scene.assets, m.baseColorTexture, rng.next2()) >= 0.5f) / double(kRays);
    for (const float distance : distances) {
      scene.camera = cameraAt(vec3(middle, distance), vec3(0), 1.0f);
      const Image depth = surfaceBuffer(Buffer::Depth, surfaces(scene));
      int passed = 0;
      for (const vec3& d : depth.pixels) passed += d.x > 0;
      EXPECT_NEAR(double(passed) / double(depth.pixels.size()), wanted, tolerance) << what << ' ' << distance;
    }
  }
};

TEST_F(GBufferTest, PerspectiveAgreesWithRays) { expectAgreesWithRays(Room()); }

TEST_F(GBufferTest, OrthographicAgreesWithRays) {
  Room room;
  room.scene.camera = cameraAt(vec3(0.1f, 0.1f, 0.85f), vec3(0, -0.1f, -1), 1);
  room.scene.camera.orthoHalfHeight = 0.6f; // all rays start inside the room
  expectAgreesWithRays(room);
}

/// A room seen from outside through its walls' hidden backs, with a block and its mirror image in it: as by rays.
TEST_F(GBufferTest, HiddenBacksAreNotThere) {
  for (const bool hidden : {true, false}) {
    HandScene scene;
    const uint32_t wall = scene.material(vec3(0.7f)), red = scene.material(vec3(0.7f, 0.1f, 0.1f));
    scene.assets.materials[wall].backHidden = scene.assets.materials[red].backHidden = hidden;
    scene.box(vec3(-1), vec3(1), wall, true);
    const uint32_t mesh = scene.instances[scene.add(block(vec3(0.3f), red))].mesh;
    scene.place(uint32_t(scene.instances.size() - 1), glm::translate(mat4(1), vec3(-0.5f, 0, 0)));
    scene.instance(mesh, glm::translate(mat4(1), vec3(0.5f, 0, 0)) * glm::scale(mat4(1), vec3(-1, 1, 1)));
    scene.camera = cameraAt(vec3(0.2f, 0.3f, 4), vec3(0), 0.7f);
    const TracedScene traced(scene);
    const Image depth = surfaceBuffer(Buffer::Depth, surfaces(scene));
    const vec3 forward = -vec3(scene.camera.worldFromView[2]);
    int differing = 0, seen = 0;
    for (const auto [x, y] : Pixels(depth)) {
      const SurfaceHit hit = surfacesAt(traced.rays, scene.camera, std::array{(vec2(x, y) + 0.5f) / vec2(64, 48)})[0];
      const float distance = hit.valid() ? glm::dot(hit.position - scene.camera.position(), forward) : 0;
      differing += !(std::abs(depth.at(x, y).x - distance) <= 1e-2f * distance);
      seen += hit.valid();
    }
    EXPECT_LE(differing, 20) << "edges of blocks";
    EXPECT_GT(seen, 1000);
    EXPECT_EQ(depth.at(32, 24).x > 3.5f, hidden) << "the wall before the camera is 3 m off";
  }
}

TEST_F(GBufferTest, LeftAndUpAreWhereTheyShouldBe) {
  const Room room;
  const GBuffer frame = surfaces(room.scene);
  const Image albedo = surfaceBuffer(Buffer::Albedo, frame), normal = surfaceBuffer(Buffer::Normal, frame);
  EXPECT_GT(albedo.at(0, 24).x, albedo.at(0, 24).y) << "the red wall is on the left";
  EXPECT_GT(albedo.at(63, 24).y, albedo.at(63, 24).x);
  EXPECT_NEAR(normal.at(32, 0).y, -1, 1e-3f) << "the ceiling is at the top";
  EXPECT_NEAR(normal.at(32, 47).y, 1, 1e-3f);
}

/// The product of what positions differ by between pixels is nothing in single precision; a direction is still needed.
TEST_F(GBufferTest, PixelsOfALengthWithoutSquareHaveNormals) {
  HandScene scene;
  scene.quad({-4e-11f, -4e-11f, -2e-11f}, {8e-11f, 0, 0}, {0, 8e-11f, 0}, scene.material(vec3(0.5f)));
  scene.assets.meshes[0].normals.assign(4, vec3(1, 0, 0)); // no help
  scene.camera = cameraAt(vec3(0), {0, 0, -1}, 1);
  scene.camera.near = 1e-13f;
  const GBuffer frame = surfaces(scene);
  const Image normal = surfaceBuffer(Buffer::Normal, frame);
  for (const vec3& n : normal.pixels) ASSERT_NEAR(glm::length(n), 1, 1e-3f);
  EXPECT_GT(surfaceBuffer(Buffer::Depth, frame).at(32, 24).x, 0);
}

/// Texels of a draw whose value, too small for a normal number, was not flushed to 0. Each takes long enough for all
/// threads of a driver on the CPU to have a share.
class DenormalProbe {
 public:
  DenormalProbe() { folder_.write("denormals.frag", kProgram); }
  size_t kept() const {
    target_.bind();
    gl::PipelineState{.width = kSide, .height = kSide}.apply();
    const gl::Program& program = programs_.get({.fragment = "denormals.frag"});
    program.use();
    program.set("root", 1e-20f);
    gl::drawFullscreen();
    return size_t(std::ranges::count_if(readTexture(texels_), [](const vec4& v) { return v.x != 0; }));
  }

 private:
  static constexpr int kSide = 512;
  static constexpr const char* kProgram = R"(#version 450
uniform float root;
layout(location = 0) out float outSquare;
void main() {
  uint h = uint(gl_FragCoord.x);
  for (int i = 0; i < 1000; ++i) h = (h ^ h >> 15) * 1664525u + 1013904223u;
  outSquare = h == 0u ? 0.0 : root * root;
}
)";
  ShaderCopy folder_;
  mutable gl::ProgramCache programs_{folder_.path};
  gl::Texture texels_{"denormals", {.format = GL_R32F, .width = kSide, .height = kSide}};
  gl::Framebuffer target_{"denormals", {&texels_}};
};

/// Threads of llvmpipe that take denormals in two ways draw other bytes whenever they share the tiles otherwise.
TEST_F(GBufferTest, LeavesThreadsOfTheDriverTheirWayWithDenormals) {
  HandScene scene; // the second wall is hidden by the first
  scene.quad({-4, -4, -2}, {8, 0, 0}, {0, 8, 0}, scene.material(vec3(0.5f)));
  scene.quad({-8, -8, -3}, {16, 0, 0}, {0, 16, 0}, scene.material(vec3(0.4f)));
  scene.camera = cameraAt(vec3(0), {0, 0, -1}, 1);
  scene.size(512, 384);
  const DenormalProbe probe;
  const size_t before = probe.kept();
  for (const bool glossy : {false, true}) {
    surfaces(scene, glossy);
    EXPECT_EQ(probe.kept(), before);
  }
}

/// Behind a surface its shading normal is turned, not given up for that of the triangle.
TEST_F(GBufferTest, BackSidesTurnTheShadingNormal) {
  HandScene scene;
  scene.quad({-4, -4, -2}, {0, 8, 0}, {8, 0, 0}, scene.material(vec3(0.5f), vec3(0), true)); // its front looks away
  const vec3 tilted = glm::normalize(vec3(0.3f, 0, -1));
  scene.assets.meshes[0].normals.assign(4, tilted);
  scene.camera = cameraAt(vec3(0), {0, 0, -1}, 0.5f);
  const Image normal = surfaceBuffer(Buffer::Normal, surfaces(scene));
  for (const vec3& n : normal.pixels) ASSERT_LT(glm::length(n + tilted), 1e-3f);
}

TEST_F(GBufferTest, EmissionLeavesTheFrontAlsoOfMirroredInstances) {
  HandScene scene;
  const uint32_t single = scene.material(vec3(0.5f), vec3(2)), twofold = scene.material(vec3(0.5f), vec3(3), true);
  // Four quads side by side, seen from +z: front, back, mirrored front, double-sided back.
  scene.quad(vec3(-4, -1, 0), vec3(2, 0, 0), vec3(0, 2, 0), single);
  scene.quad(vec3(-2, -1, 0), vec3(0, 2, 0), vec3(2, 0, 0), single);
  scene.quad(vec3(0, -1, 0), vec3(2, 0, 0), vec3(0, 2, 0), single);
  scene.quad(vec3(2, -1, 0), vec3(0, 2, 0), vec3(2, 0, 0), twofold);
  mat4 mirror(1);
  mirror[0][0] = -1;
  mirror[3][0] = 2; // x → 2 - x keeps the quad in its place
  scene.instances[2].worldFromObject = mirror;
  scene.camera = cameraAt(vec3(0, 0, 4), vec3(0), 1.6f);
  const GBuffer frame = surfaces(scene);
  const Image emission = surfaceBuffer(Buffer::Emission, frame), normal = surfaceBuffer(Buffer::Normal, frame);
  // The picture is 64 pixels for 2·4·tan(0.8)·4/3 ≈ 10.98 m.
  const auto pixelAt = [](float x) { return int(32 + x * 64 / 10.98f); };
  EXPECT_EQ(emission.at(pixelAt(-3), 24).x, 2);
  EXPECT_EQ(emission.at(pixelAt(-1), 24).x, 0);
  EXPECT_EQ(emission.at(pixelAt(1), 24).x, 2);
  EXPECT_EQ(emission.at(pixelAt(3), 24).x, 3);
  for (float x : {-3.0f, -1.0f, 1.0f, 3.0f}) EXPECT_NEAR(normal.at(pixelAt(x), 24).z, 1, 1e-3f) << x;
  EXPECT_EQ(surfaceBuffer(Buffer::Depth, frame).at(0, 0).x, 0) << "background";
}

/// A chequer of texels, eight to a pixel: black and white texels by themselves, some of each, or the grey of all.
TEST_F(GBufferTest, EverySamplerModeMinifiesAsItSays) {
  HandScene scene;
  std::vector<u8vec4> texels;
  Rng rng(1, Stream::Test, 0);
  for (int i = 0; i < 64 * 64; ++i) texels.emplace_back(u8vec4(vec4(vec3(rng.below(2) * 255.0f), 255)));
  const uint32_t chequer = scene.material(vec3(1));
  Material& m = scene.assets.materials[chequer];
  m.baseColorTexture = scene.texture(64, texels, false);
  m.baseColorTexture.uvTransform = mat3(16, 0, 0, 0, 16, 0, 0, 0, 1);
  scene.quad({-9, -9, 0}, {18, 0, 0}, {0, 18, 0}, chequer);
  scene.camera = cameraAt(vec3(0, 0, 12), vec3(0), 1.0f);
  for (const bool nearest : {false, true})
    for (int mode = 0; mode <= int(Minify::LinearMipmapLinear); ++mode) {
      m.baseColorTexture.nearest = nearest;
      m.baseColorTexture.minify = Minify(mode);
      ++scene.assets.revision;
      const Image albedo = surfaceBuffer(Buffer::Albedo, surfaces(scene));
      double sum = 0, squares = 0;
      for (const vec3& c : albedo.pixels) sum += double(c.x), squares += double(c.x) * double(c.x);
      const double n = double(albedo.pixels.size()), mean = sum / n, variance = squares / n - mean * mean;
      EXPECT_NEAR(mean, 0.5, 0.05) << nearest << ' ' << mode;
      const bool one = Minify(mode) == Minify::Nearest || (Minify(mode) == Minify::Auto && nearest);
      if (one)
        EXPECT_NEAR(variance, 0.25, 0.01) << nearest << ' ' << mode;
      else if (Minify(mode) == Minify::Linear)
        EXPECT_NEAR(variance, 0.11, 0.03) << nearest << ' ' << mode;
      else
        EXPECT_LT(variance, 0.02) << nearest << ' ' << mode;
    }
}

/// A mask that cuts nothing out cuts nothing out far away either, whatever its cutoff.
TEST_F(GBufferTest, MasksOfWhatIsOpaqueStayOpaqueFarAway) {
  for (const float cutoff : {0.33f, 0.51f, 0.75f, 1.0f}) {
    HandScene scene;
    const uint32_t solid = scene.material(vec3(1));
    Material& m = scene.assets.materials[solid];
    m.baseColorTexture = scene.texture(64, std::vector<u8vec4>(64 * 64, u8vec4(255)));
    m.baseColorTexture.nearest = false;
    m.baseColorTexture.uvTransform = mat3(8, 0, 0, 0, 8, 0, 0, 0, 1);
    m.alphaMode = AlphaMode::Mask;
    m.alphaCutoff = cutoff;
    scene.quad({-9, -9, 0}, {18, 0, 0}, {0, 18, 0}, solid);
    scene.camera = cameraAt(vec3(0, 0, 9), vec3(0), 1.0f);
    const Image depth = surfaceBuffer(Buffer::Depth, surfaces(scene));
    for (const vec3& d : depth.pixels) ASSERT_GT(d.x, 0) << cutoff;
  }
}

/// Leaves that are smaller than pixels still cover their share of them.
TEST_F(GBufferTest, MasksKeepTheirCoverageFarAway) {
  for (const float covered : {0.15f, 0.3f, 0.8f}) {
    std::vector<u8vec4> texels;
    Rng rng(1, Stream::Test, 0);
    for (int i = 0; i < 128 * 128; ++i) texels.emplace_back(255, 255, 255, rng.next() < covered ? 255 : 0);
    expectCoverage(texels, 18, vec2(0), std::array{2.0f, 6.0f, 12.0f}, 0.05, // 1.3, 4 and 8 texels to a pixel
                   std::to_string(covered));
  }
}

/// So do bars and holes of one kind, which all average to the same alpha at once. (Between two levels of a texture
/// their contrast is less, so that the larger share grows.)
TEST_F(GBufferTest, MasksOfRegularPatternsKeepTheirCoverageFarAway) {
  for (const auto& [open, of] : {std::pair(1, 4), {2, 4}, {3, 4}, {1, 2}, {6, 16}}) {
    std::vector<u8vec4> texels;
    for (int i = 0; i < 128 * 128; ++i) texels.emplace_back(255, 255, 255, i % 128 % of < open ? 0 : 255);
    expectCoverage(texels, 180, vec2(0.3f, 0.2f), std::array{6.0f, 12.0f, 25.0f, 50.0f, 90.0f}, 0.12,
                   std::to_string(open) + " of " + std::to_string(of));
  }
}

/// Nor does the colour of what is not there: texels between leaves are black as a rule.
TEST_F(GBufferTest, ColoursOfWhatIsCutOutDoNotShowFarAway) {
  std::vector<u8vec4> texels;
  Rng rng(1, Stream::Test, 0);
  for (int i = 0; i < 128 * 128; ++i)
    texels.push_back(rng.next() < 0.3f ? u8vec4(250, 120, 60, 255) : u8vec4(0, 0, 0, 0));
  for (const AlphaMode mode : {AlphaMode::Mask, AlphaMode::Blend})
    for (const bool srgb : {true, false}) {
      HandScene scene;
      const uint32_t leaves = scene.material(vec3(1));
      Material& m = scene.assets.materials[leaves];
      m.baseColorTexture = scene.texture(128, texels, srgb);
      m.baseColorTexture.nearest = false;
      m.baseColorTexture.uvTransform = mat3(4, 0, 0, 0, 4, 0, 0, 0, 1);
      m.alphaMode = mode;
      scene.quad({-9, -9, 0}, {18, 0, 0}, {0, 18, 0}, leaves);
      scene.camera = cameraAt({0, 0, 12}, vec3(0), 1.0f);
      const GBuffer frame = surfaces(scene);
      const Image depth = surfaceBuffer(Buffer::Depth, frame), albedo = surfaceBuffer(Buffer::Albedo, frame);
      const vec3 expected = vec3(decodeTexel({250, 120, 60, 255}, srgb));
      int seen = 0;
      for (size_t i = 0; i < depth.pixels.size(); ++i) {
        if (depth.pixels[i].x == 0) continue;
        ++seen;
        EXPECT_LT(glm::length(albedo.pixels[i] - expected), 0.06f) << int(mode) << srgb << ' ' << i;
      }
      EXPECT_GT(seen, 100);
    }
}

TEST_F(GBufferTest, TexturesMasksAndVertexColours) {
  HandScene scene;
  const TextureRef picture = scene.texture(2, {{188, 0, 0, 255}, {0, 188, 0, 0}}); // red and opaque; green, transparent
  const uint32_t textured = scene.material(vec3(0.5f)), masked = scene.material(vec3(1)),
                 plain = scene.material(vec3(1));
  for (uint32_t m : {textured, masked}) scene.assets.materials[m].baseColorTexture = picture;
  scene.assets.materials[masked].alphaMode = AlphaMode::Mask;
  // uv' = 1 - u: the masked quad shows the picture mirrored.
  scene.assets.materials[masked].baseColorTexture.uvTransform = mat3(-1, 0, 0, 0, 1, 0, 1, 0, 1);
  scene.quad(vec3(-2, -1, 0), vec3(2, 0, 0), vec3(0, 2, 0), textured);
  scene.quad(vec3(0, -1, 0), vec3(2, 0, 0), vec3(0, 2, 0), masked);
  scene.quad(vec3(-2, -3, 0), vec3(4, 0, 0), vec3(0, 2, 0), plain);
  scene.assets.meshes[2].colors.assign(4, vec4(0.25f, 0.5f, 0.75f, 1));
  scene.camera = cameraAt(vec3(0, 0, 5), vec3(0), 1.0f);
  const GBuffer frame = surfaces(scene);
  const Image albedo = surfaceBuffer(Buffer::Albedo, frame), depth = surfaceBuffer(Buffer::Depth, frame);
  const float pixelsPerMetre = 24 / (5 * std::tan(0.5f));
  const auto at = [&](const Image& i, float x, float y) {
    return i.at(int(32 + x * pixelsPerMetre), int(24 - y * pixelsPerMetre));
  };
  EXPECT_NEAR(at(albedo, -1.5f, 0).x, 0.5f * linearFromSrgb(188 / 255.0f), 0x1p-9f);
  EXPECT_NEAR(at(albedo, -0.5f, 0).y, 0.5f * linearFromSrgb(188 / 255.0f), 0x1p-9f);
  EXPECT_EQ(at(depth, 0.5f, 0).x, 0) << "masked away";
  EXPECT_NEAR(at(albedo, 1.5f, 0).x, linearFromSrgb(188 / 255.0f), 0x1p-9f);
  EXPECT_LT(glm::length(at(albedo, 0, -2) - vec3(0.25f, 0.5f, 0.75f)), 2e-3f);
}

} // namespace lambent::test::gbuffer_test

// Gather, filter and composite against closed forms and constants.
#include "gl_fixture.h"

#include <random>

namespace lambent::test::indirect_test {

using IndirectTest = GatherTest;

VirtualLight lamp(const vec3& position, const vec3& normal, float radiance, float area) {
  return lightAt(position, normal, vec3(radiance), area);
}

TEST_F(IndirectTest, OneVplOnAPlane) {
  const Floor floor;
  const GBuffer gbuffer = surfaces(floor.scene);
  const vec3 position(0.3f, 1, -0.2f), normal = glm::normalize(vec3(0.3f, -1, 0));
  for (const float disk : {4.0f, 1.0f, 0.0f})
    for (const float clamp : {0.0f, 0.3f}) {
      Settings settings = with(GatherMode::Full);
      settings.gather.disk = disk;
      settings.gather.clamp = clamp;
      const std::vector lights{lamp(position, normal, 4, 0.2f)};
      const SurfaceLighting raw = gathered(gbuffer, lights, settings);
      const Image image = read(Buffer::Unfiltered, gbuffer, raw);
      for (const auto [x, y] : Pixels(image)) {
        const vec3 d = position - floor.at(x, y);
        const float r2 = glm::dot(d, d), r = std::sqrt(r2);
        float g = std::max(0.0f, glm::dot(normal, -d) / r) * d.y / r / (r2 + disk * 0.2f / kPi);
        if (clamp > 0) g = std::min(g, clamp);
        ASSERT_NEAR(image.at(x, y).x, 4 * 0.2f * g, 1e-3f * 0.8f * g + 1e-5f) << x << ' ' << y;
      }
    }
}

/// Eye, pixel and light are on one axis, so that the light is on the shaded point to the last bit.
TEST_F(IndirectTest, AVplOnTheShadedPointIsNoDivisionByZero) {
  HandScene scene;
  scene.quad({-4, -4, -2}, {8, 0, 0}, {0, 8, 0}, scene.material(vec3(0.5f)));
  scene.camera = cameraAt(vec3(0), {0, 0, -1}, 1, 17, 17);
  const GBuffer gbuffer = surfaces(scene);
  Settings settings = with(GatherMode::Full);
  settings.gather.disk = 0;
  for (const float side : {1.0f, -1.0f}) {
    const std::vector lights{lamp({0, 0, -2}, {0, 0, side}, 4, 0.2f)};
    const Image image = read(Buffer::Unfiltered, gbuffer, gathered(gbuffer, lights, settings));
    EXPECT_EQ(image.at(8, 8), vec3(0)) << side;
  }
}

/// 40 VPLs that make every class of 16 different, over several sizes that 4 does not divide.
TEST_F(IndirectTest, EachSubsetReadsItsOwnLights) {
  Floor floor;
  floor.scene.size(37, 27);
  const GBuffer gbuffer = surfaces(floor.scene);
  std::vector<VirtualLight> vpls;
  for (int i = 0; i < 40; ++i)
    vpls.push_back(lamp(vec3(0.1f * float(i) - 2, 1 + 0.05f * float(i), 0.3f), vec3(0, -1, 0), 1 + float(i), 0.1f));
  const Image image = read(Buffer::Unfiltered, gbuffer, gathered(gbuffer, vpls, Settings{}));
  for (const auto [x, y] : Pixels(image)) {
    const int fromBottom = image.height - 1 - y;
    const size_t c = size_t(x % 4 + 4 * (fromBottom % 4));
    float wanted = 0;
    for (size_t i = c; i < vpls.size(); i += 16) {
      const vec3 d = vpls[i].position - floor.at(x, y);
      const float r2 = glm::dot(d, d);
      wanted += 16 * vpls[i].radiance.x * 0.1f * d.y * d.y / r2 / (r2 + GatherSettings{}.disk * 0.1f / kPi);
    }
    ASSERT_NEAR(image.at(x, y).x, wanted, 2e-3f * wanted) << x << ' ' << y;
  }
}

TEST_F(IndirectTest, InterleavedMeansTheSameAsFull) {
  const Floor floor;
  const GBuffer gbuffer = surfaces(floor.scene);
  // The same light in all of 2100 slots (two chunks): every subset of 16 sees as much as all of them together.
  const size_t count = 4096;
  const std::vector<VirtualLight> lights(count, lamp(vec3(0, 2, 0), vec3(0, -1, 0), 1, 0.01f));
  const Image full = read(Buffer::Unfiltered, gbuffer, gathered(gbuffer, lights, with(GatherMode::Full)));
  const Image interleaved = read(Buffer::Unfiltered, gbuffer, gathered(gbuffer, lights, Settings{}));
  for (size_t i = 0; i < full.pixels.size(); ++i)
    ASSERT_NEAR(interleaved.pixels[i].x, full.pixels[i].x, 1e-4f * full.pixels[i].x);
}

TEST_F(IndirectTest, EmptyBlackAndBrokenLightsBringNothing) {
  const Floor floor;
  const GBuffer gbuffer = surfaces(floor.scene);
  std::vector<VirtualLight> lights(5, lamp(vec3(0, 2, 0), vec3(0, -1, 0), 1, 0.1f));
  lights[0].alive = false;
  lights[1].area = 0;
  lights[2].radiance = vec3(std::nanf(""));
  lights[3].normal = vec3(std::nanf(""));
  lights[4].area = kInfinity;
  const Image image = read(Buffer::Unfiltered, gbuffer, gathered(gbuffer, lights, with(GatherMode::Full)));
  for (const vec3& e : image.pixels) ASSERT_EQ(e.x, 0);
}

TEST_F(IndirectTest, OnlyChangedLightsAreUploaded) {
  constexpr uint32_t kFirst = 7, kSecond = kLightsPerChunk + 7; // of either chunk
  std::vector<VirtualLight> lights(kLightsPerChunk + 100, lamp(vec3(0, 2, 0), vec3(0, -1, 0), 1, 0.1f));
  const PackedLights packed = lightBuffer.run(lights);
  EXPECT_EQ(lightBuffer.uploaded(), lights.size());
  lightBuffer.run(lights);
  EXPECT_EQ(lightBuffer.uploaded(), 0u);
  const auto held = [&](uint32_t slot) {
    VplLight light;
    packed.buffer->read(lightOrder(slot) * sizeof light, std::span(&light, 1));
    return light;
  };
  const auto same = [](const VplLight& a, const VplLight& b) { return std::memcmp(&a, &b, sizeof a) == 0; };
  glClearNamedBufferData(packed.buffer->name(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
  lights[kFirst] = lamp(vec3(0, 3, 0), vec3(0, -1, 0), 1, 0.1f);
  lightBuffer.run(lights);
  EXPECT_EQ(lightBuffer.uploaded(), 1u);
  EXPECT_TRUE(same(held(kFirst), pack(lights[kFirst])));
  EXPECT_TRUE(same(held(kSecond), VplLight{})) << "a chunk without changes was sent";
  lights[kSecond].alive = false;
  lights.resize(kLightsPerChunk + 50);
  lightBuffer.run(lights);
  EXPECT_EQ(lightBuffer.uploaded(), 51u) << "slots that are gone are emptied";
  EXPECT_TRUE(same(held(kLightsPerChunk + 20), pack(lights[0]))) << "the chunk with changes is whole";
  EXPECT_TRUE(same(held(kLightsPerChunk + 60), VplLight{}));
}

TEST_F(IndirectTest, FilterKeepsConstants) {
  Room room;
  room.scene.size(61, 43); // tiles with a ragged edge
  const GBuffer gbuffer = surfaces(room.scene);
  const gl::Texture constant = textureOf(Image(64, 44, vec3(0.3f, 1.7f, 4000)));
  const SurfaceLighting raw{&constant, nullptr, true};
  for (const bool on : {true, false}) {
    const Image image = read(Buffer::Irradiance, gbuffer, raw, filterPass.run({gbuffer, raw, {.on = on}}));
    for (const vec3& e : image.pixels) {
      ASSERT_NEAR(e.x, 0.3f, 1e-6f);
      ASSERT_NEAR(e.z, 4000, 4e-3f);
    }
  }
}

TEST_F(IndirectTest, FilterMixesAllSubsetsEqually) {
  const Floor floor;
  const GBuffer gbuffer = surfaces(floor.scene);
  // Each subset holds another constant; their mean must appear wherever the kernel lies inside the picture.
  std::vector<vec4> texels(64 * 48);
  for (const auto [x, y] : Pixels(64, 48))
    texels[size_t(y) * 64 + x] = vec4(vec3(float(1 << (x / 16 + 4 * (y / 12)))), 1);
  const gl::Texture tiles = textureOf(64, 48, texels);
  const SurfaceLighting raw{&tiles, nullptr, true};
  const Image image = read(Buffer::Irradiance, gbuffer, raw, filterPass.run({gbuffer, raw, {}}));
  for (const auto [x, y] : Pixels({3, 3}, {61, 45}))
    ASSERT_NEAR(image.at(x, y).x, 65535 / 16.0f, 0.05f) << x << ' ' << y;
}

TEST_F(IndirectTest, FilterStopsAtEdges) {
  const Room room;
  const GBuffer gbuffer = surfaces(room.scene);
  // Light only where the normal points up (the floor and the block's top), in place of a gather.
  const Image normal = surfaceBuffer(Buffer::Normal, gbuffer);
  std::vector<vec4> texels(64 * 48);
  for (const auto [x, y] : Pixels(64, 48))
    texels[size_t(y % 4 * 12 + y / 4) * 64 + x % 4 * 16 + x / 4] = vec4(normal.at(x, 47 - y).y > 0.5f ? 1.0f : 0.0f);
  const gl::Texture tiles = textureOf(64, 48, texels);
  const SurfaceLighting raw{&tiles, nullptr, true};
  const Image image = read(Buffer::Irradiance, gbuffer, raw, filterPass.run({gbuffer, raw, {}}));
  for (const auto [x, y] : Pixels(64, 48))
    ASSERT_NEAR(image.at(x, y).x, normal.at(x, y).y > 0.5f ? 1 : 0, 1e-3f) << x << ' ' << y;
}

TEST_F(IndirectTest, FilterStopsAtSteps) { // between planes that face the same way
  HandScene scene;
  const uint32_t white = scene.material(vec3(0.7f));
  scene.quad(vec3(-4, -4, -3), vec3(8, 0, 0), vec3(0, 8, 0), white);
  scene.quad(vec3(-0.5f, -0.5f, -2), vec3(1, 0, 0), vec3(0, 1, 0), white);
  scene.camera = cameraAt(vec3(0), vec3(0, 0, -1), 1.0f);
  const GBuffer gbuffer = surfaces(scene);
  const Image depth = surfaceBuffer(Buffer::Depth, gbuffer);
  std::vector<vec4> texels(64 * 48);
  for (const auto [x, y] : Pixels(64, 48))
    texels[size_t(y) * 64 + x] = vec4(depth.at(x, 47 - y).x < 2.5f ? 1.0f : 0.0f);
  const gl::Texture light = textureOf(64, 48, texels);
  const SurfaceLighting raw{&light, nullptr, false, true};
  const Image image = read(Buffer::Irradiance, gbuffer, raw, filterPass.run({gbuffer, raw, {}}));
  int nearer = 0;
  for (const auto [x, y] : Pixels(64, 48)) {
    const bool lit = depth.at(x, y).x < 2.5f;
    nearer += lit;
    ASSERT_NEAR(image.at(x, y).x, lit ? 1 : 0, 1e-3f) << x << ' ' << y;
  }
  EXPECT_GT(nearer, 100);
}

TEST_F(IndirectTest, CompositeAddsUp) {
  HandScene scene;
  scene.quad(vec3(-1, -10, 0), vec3(2, 0, 0), vec3(0, 20, 0), scene.material(vec3(0.5f, 0.25f, 1), vec3(0, 2, 0)));
  scene.camera = cameraAt(vec3(0, 0, 3), vec3(0), 1.2f);
  const GBuffer gbuffer = surfaces(scene);
  Image rows(64, 48);
  for (const auto [x, y] : Pixels(rows)) rows.at(x, y) = vec3(float(y + 1));
  const gl::Texture irradiance = textureOf(rows);
  CompositePass composite(passes);
  const SurfaceLighting indirect{&irradiance}, direct{&irradiance};
  FrameResults results;
  results.surfaces = gbuffer;
  results.direct = direct;
  results.indirect = indirect;
  results.sky = vec3(0.1f, 0.2f, 0.3f);
  results.radiance = &composite.run({gbuffer, direct, indirect, results.sky});
  const Image beauty = readBuffer(Buffer::Beauty, results),
              parts[2] = {readBuffer(Buffer::Direct, results), readBuffer(Buffer::Indirect, results)};
  EXPECT_LT(glm::length(beauty.at(0, 10) - vec3(0.1f, 0.2f, 0.3f)), 1e-6f);
  for (int y : {0, 20, 47}) {
    const float e = float(y + 1);
    EXPECT_NEAR(beauty.at(32, y).x, 0.5f / kPi * 2 * e, 1e-3f * e);
    EXPECT_NEAR(beauty.at(32, y).y, 2 + 0.25f / kPi * 2 * e, 1e-3f * e);
    EXPECT_NEAR(parts[1].at(32, y).z, e / kPi, 1e-3f * e);
  }
  for (size_t i = 0; i < beauty.pixels.size(); ++i)
    ASSERT_LT(glm::length(beauty.pixels[i] - parts[0].pixels[i] - parts[1].pixels[i]), 1e-3f);
}

} // namespace lambent::test::indirect_test

// Area lights: their pieces' unshadowed light against closed forms and sums, and the points that rays are sent to.
#include "engine/core/rng.h"
#include "gi/lighting/area_lights.h"
#include "gi/lighting/area_pieces.h"
#include "tests/support/area_pieces.h"
#include "tests/support/hand_scene.h"

namespace lambent::test::area_lights_test {

/// ∫ cosx cosy / r² over a parallelogram, by its midpoints.
double summed(const AreaPiece& piece, const vec3& position, const vec3& normal, int steps) {
  const glm::dvec3 corner(piece.corners[0]), e1 = glm::dvec3(piece.corners[1]) - corner,
                                             e2 = glm::dvec3(piece.corners[3]) - corner;
  double sum = 0;
  for (int i = 0; i < steps; ++i)
    for (int j = 0; j < steps; ++j) {
      const glm::dvec3 way = corner + e1 * ((i + 0.5) / steps) + e2 * ((j + 0.5) / steps) - glm::dvec3(position);
      const double r2 = glm::dot(way, way), x = glm::dot(glm::dvec3(normal), way),
                   y = -glm::dot(glm::dvec3(piece.normalArea), way);
      if (x > 0 && (y > 0 || piece.radianceSides.w > 0)) sum += x * std::abs(y) / (r2 * r2);
    }
  return sum * double(piece.normalArea.w) / (double(steps) * steps);
}

TEST(AreaPiece, ARectangleAboveAPlane) {
  // Over one corner of a parallel rectangle a × b at height 1 (Siegel and Howell, configuration C-11).
  const float a = 0.7f, b = 1.9f;
  const AreaPiece piece = quadPiece({0, 1, 0}, {a, 0, 0}, {0, 0, b});
  ASSERT_LT(piece.normalArea.y, 0);
  const double ra = std::sqrt(1 + double(a) * a), rb = std::sqrt(1 + double(b) * b);
  const double expected = 0.5 * (a / ra * std::atan(b / ra) + b / rb * std::atan(a / rb));
  EXPECT_NEAR(double(areaFormFactor(piece, vec3(0), vec3(0, 1, 0))), expected, 1e-6);
  EXPECT_EQ(areaFormFactor(piece, vec3(0, 2, 0), vec3(0, -1, 0)), 0) << "its back";
  EXPECT_EQ(areaFormFactor(piece, vec3(0), vec3(0, -1, 0)), 0) << "below the horizon";
}

TEST(AreaPiece, FillsTheSkyWithPi) {
  const AreaPiece piece = quadPiece({-1e4f, 1, -1e4f}, {2e4f, 0, 0}, {0, 0, 2e4f});
  EXPECT_NEAR(areaFormFactor(piece, vec3(0), vec3(0, 1, 0)), kPi, 1e-3f);
  EXPECT_NEAR(areaFormFactor(piece, vec3(0), vec3(1, 0, 0)), 0.5f * kPi, 1e-3f) << "half of it";
}

TEST(AreaPiece, IsTheIntegralWherever) {
  int clipped = 0, far = 0;
  for (uint32_t i = 0; i < 300; ++i) {
    Rng rng(4, Stream::Test, i);
    const auto around = [&] { return 2.0f * rng.next3() - 1.0f; };
    const AreaPiece piece = quadPiece(around() + vec3(0, 1.5f, 0), around(), around(), i % 2 == 0);
    const vec3 normal = glm::normalize(around()), position = (i % 5 == 0 ? 40.0f : 1.0f) * around();
    const double expected = summed(piece, position, normal, 300), got = areaFormFactor(piece, position, normal);
    const double nearest = std::sqrt(double(piece.normalArea.w)) / 300;
    ASSERT_NEAR(got, expected, i % 5 == 0 ? 4e-3 * expected + 1e-9 : 4e-3 * expected + 2e-3 * nearest + 1e-6) << i;
    clipped += expected > 0 && summed(piece, position, -normal, 50) > 0;
    far += expected > 0 && i % 5 == 0;
  }
  EXPECT_GT(clipped, 30);
  EXPECT_GT(far, 10);
}

TEST(AreaPiece, IsANumberOnItsEdgesAndCorners) {
  const AreaPiece piece = quadPiece({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, true);
  for (const vec3& at : {vec3(0), vec3(0.5f, 0, 0), vec3(1, 0, 1), vec3(0.3f, 0, 0.3f), vec3(2, 0, 0), vec3(-1, 0, 0)})
    for (const vec3& n : {vec3(0, 1, 0), vec3(1, 0, 0), vec3(0, -1, 0), glm::normalize(vec3(1))}) {
      const float f = areaFormFactor(piece, at, n);
      EXPECT_TRUE(f >= 0 && f <= 3.2f) << f;
      const float above = areaFormFactor(piece, at + vec3(0, 1e-7f, 0), n);
      EXPECT_TRUE(above >= 0 && above <= 3.142f) << above;
    }
  // Of tilted ones, rounding puts corners and edges before the plane or behind it.
  for (uint32_t i = 0; i < 1000; ++i) {
    Rng rng(5, Stream::Test, i);
    const auto around = [&] { return 2.0f * rng.next3() - 1.0f; };
    const vec3 corner = around(), u = around(), v = around();
    const AreaPiece tilted = quadPiece(corner, u, v, true);
    const vec3 plane(tilted.normalArea), normal = glm::normalize(around());
    for (const vec3& at : {corner, corner + u, corner + u + v, corner + v, corner + 0.5f * u, corner + u + 0.5f * v,
                           corner + 0.5f * u + v, corner + 0.5f * v})
      for (const vec3& n : {plane, -plane, normal}) {
        const float f = areaFormFactor(tilted, at, n);
        ASSERT_TRUE(f >= 0 && f <= 3.142f) << i << ": " << f;
      }
  }
}

AreaLights lightsOf(const HandScene& scene) { return areaLights(collectLights(scene.view())); }

TEST(AreaLights, ABoxHasSixPiecesAndAllItsArea) {
  HandScene scene;
  scene.box(vec3(-1, -2, -3), vec3(1, 2, 3), scene.material(vec3(0), vec3(2)), false);
  const AreaLights lights = lightsOf(scene);
  ASSERT_EQ(lights.lights.size(), 6u) << "an emitter per quad";
  float area = 0;
  for (const AreaPiece& p : lights.pieces) {
    EXPECT_EQ(p.corners[0].w, 4);
    area += p.normalArea.w;
  }
  EXPECT_FLOAT_EQ(area, 2 * (2 * 4 + 4 * 6 + 2 * 6));
  EXPECT_EQ(lights.samples.size(), 6u * AreaLights::kSamples);
  // From outside, the side that faces is all that lights.
  vec3 sum(0);
  for (const AreaLight& l : lights.lights) sum += unshadowed(lights, l, vec3(0, 5, 0), vec3(0, -1, 0));
  EXPECT_NEAR(sum.x, 2 * summed(quadPiece({-1, 2, -3}, {0, 0, 6}, {2, 0, 0}), vec3(0, 5, 0), vec3(0, -1, 0), 300),
              1e-3f);
}

TEST(AreaLights, NeighboursInTheOrderLieSideBySide) {
  HandScene scene;
  scene.quad({-1, 3, -1}, {2, 0, 0}, {0, 0, 2}, scene.material(vec3(0), vec3(2)));
  const AreaLights lights = lightsOf(scene);
  const size_t count = lights.samples.size();
  float along = 0;
  for (size_t i = 1; i < count; ++i) along += glm::distance(lights.samples[i - 1].position, lights.samples[i].position);
  EXPECT_LT(along / float(count - 1), 0.25f) << "at random: 1.04";
  for (size_t quarter = 0; quarter < 4; ++quarter) { // each quarter of the order fills a quarter of the light
    const std::span of = std::span(lights.samples).subspan(quarter * (count / 4), count / 4);
    vec3 middle(0);
    float spread = 0;
    for (const AreaSample& s : of) middle += s.position / float(of.size());
    for (const AreaSample& s : of) spread += glm::distance(s.position, middle) / float(of.size());
    EXPECT_LT(spread, 0.5f) << "of a square metre 0.38, of all four 0.77";
  }
}

/// A square of n × n squares in one mesh, `apart` by so much, facing down at height 2.
std::vector<EmitterTriangle> squares(int n, float apart) {
  std::vector<EmitterTriangle> out;
  const float side = 2.0f / float(n);
  for (int i = 0; i < n * n; ++i) {
    const vec3 at = vec3(float(i % n), 0, float(i / n)) * (side + apart) + vec3(-1, 2, -1), x(side, 0, 0),
               z(0, 0, side);
    out.push_back(makeEmitterTriangle(at, at + x, at + x + z, vec3(3)));
    out.push_back(makeEmitterTriangle(at, at + x + z, at + z, vec3(3)));
  }
  return out;
}

/// Of every strip along a side of a lamp, rays to it know as much as they are many.
TEST(AreaLights, RaysKnowEdgesAlongASideToTheirNumber) {
  LightSet set;
  addEmitter(set, 0, 0, squares(3, 0), false); // one of 2 × 2 m
  const AreaLights lights = areaLights(set);
  const uint32_t count = lights.lights.at(0).samples;
  for (const AreaSample& s : std::span(lights.samples).first(count)) // none at a corner, where a wall may begin
    EXPECT_LT(std::max(std::abs(s.position.x), std::abs(s.position.z)), 1 - 1 / float(count));
  for (const uint32_t rays : {4u, 16u, 64u, 128u}) {
    uint32_t quadrants[4] = {};
    for (uint32_t k = 0; k < rays; ++k) {
      const vec3& p = lights.samples[(2 * k + 1) * count / (2 * rays)].position;
      ++quadrants[(p.x > 0) + 2 * (p.z > 0)];
    }
    for (const uint32_t in : quadrants) EXPECT_EQ(in, rays / 4);
    for (const int axis : {0, 2})
      for (int i = 0; i <= 100; ++i) {
        const float edge = -1 + 0.02f * float(i);
        float open = 0;
        for (uint32_t k = 0; k < rays; ++k)
          open += float(lights.samples[(2 * k + 1) * count / (2 * rays)].position[axis] < edge) / float(rays);
        EXPECT_NEAR(open, 0.5f * (edge + 1), 0.501f / float(rays)) << rays << " rays, axis " << axis;
      }
  }
}

TEST(AreaLights, TexturedOnesKeepTheirTexture) {
  HandScene scene;
  const uint32_t material = scene.material(vec3(0), vec3(4));
  scene.assets.materials[material].emissiveTexture = scene.texture(2, {{0, 0, 0, 255}, {255, 255, 255, 255}}, false);
  scene.quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, material); // u along x, faces down
  const AreaLights lights = lightsOf(scene);
  ASSERT_EQ(lights.lights.size(), 1u);
  ASSERT_EQ(lights.pieces.size(), 1u) << "the bright half";
  EXPECT_NEAR(lights.pieces[0].normalArea.w, 2, 1e-6);
  for (const AreaSample& s : lights.samples) {
    EXPECT_GE(s.position.x, 0);
    EXPECT_NEAR(s.radiance.x, 2, 0.01f) << "each stands for half as much surface as without the texture";
  }
  const float bright = summed(quadPiece({0, 1, -1}, {1, 0, 0}, {0, 0, 2}), vec3(0), vec3(0, 1, 0), 200);
  EXPECT_NEAR(unshadowed(lights, lights.lights[0], vec3(0), vec3(0, 1, 0)).x, 4 * bright, 0.01f * 4 * bright);
}

TEST(AreaLights, AreWhatTheyAreHoweverTheyAreCut) {
  for (const int n : {1, 2, 7, 24}) {
    LightSet set;
    addEmitter(set, 0, 0, squares(n, 0), false);
    const AreaLights lights = areaLights(set);
    ASSERT_EQ(lights.lights.size(), 1u);
    ASSERT_EQ(lights.pieces.size(), 1u) << n << "² squares are one";
    EXPECT_NEAR(lights.pieces[0].normalArea.w, 4, 1e-4);
    const float one = summed(quadPiece({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}), vec3(0.9f, 1.9f, 0), vec3(1, 0, 0), 400);
    EXPECT_NEAR(unshadowed(lights, lights.lights[0], vec3(0.9f, 1.9f, 0), vec3(1, 0, 0)).x, 3 * one, 0.01f * one);
  }
}

/// However thin a strip of light is: corners that lie closer than lengths are told apart must not be taken for one.
TEST(AreaLights, ThinStripsKeepTheirLight) {
  for (const float width : {1e-2f, 1e-3f, 1e-4f, 3e-5f, 1e-5f, 1e-6f}) {
    const vec3 corner(-1, 1, 0), along(2, 0, 0), across(0, 0, width);
    const std::vector<EmitterTriangle> triangles{
        makeEmitterTriangle(corner, corner + along, corner + along + across, vec3(1)),
        makeEmitterTriangle(corner, corner + along + across, corner + across, vec3(1))};
    std::vector<uint32_t> of;
    float light = 0, area = 0;
    for (const AreaPiece& piece : mergedPieces(triangles, true, of)) {
      light += areaFormFactor(piece, vec3(0.3f, 0, 0), {0, 1, 0});
      area += piece.normalArea.w;
    }
    const float wanted = areaFormFactor(quadPiece(corner, along, across, true), vec3(0.3f, 0, 0), {0, 1, 0});
    EXPECT_NEAR(area / (2 * width), 1, 1e-3f) << width;
    EXPECT_NEAR(light / wanted, 1, 1e-2f) << width;
  }
}

TEST(AreaLights, LampsOfOneMeshThatDoNotTouchAreLightsOfTheirOwn) {
  LightSet set;
  addEmitter(set, 0, 0, squares(6, 0.1f), false);
  const AreaLights lights = areaLights(set);
  EXPECT_EQ(lights.lights.size(), 36u);
  EXPECT_EQ(lights.pieces.size(), 36u);
}

/// Of 64 × 64 texels 4 shine: 4 of 4096, on 4 m².
TEST(AreaLights, ASmallBrightSpotIsFoundAndStaysSmall) {
  HandScene scene;
  std::vector<u8vec4> texels(64 * 64, {0, 0, 0, 255});
  for (const int texel : {40 * 64 + 20, 40 * 64 + 21, 41 * 64 + 20, 41 * 64 + 21}) texels[size_t(texel)] = u8vec4(255);
  const uint32_t material = scene.material(vec3(0), vec3(1000));
  scene.assets.materials[material].emissiveTexture = scene.texture(64, texels, false);
  scene.quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, material);
  const AreaLights lights = lightsOf(scene);
  ASSERT_EQ(lights.lights.size(), 1u);
  float power = 0, area = 0;
  for (const AreaPiece& p : lights.pieces) power += p.radianceSides.x * p.normalArea.w, area += p.normalArea.w;
  EXPECT_NEAR(power, 1000 * 4 * 4.0f / 4096, 0.15f * 1000 * 4 * 4.0f / 4096);
  EXPECT_LT(area, 0.02f) << "the spot is 0.004 m²";
  for (const AreaSample& s : lights.samples) EXPECT_LT(glm::distance(s.position, lights.samples[0].position), 0.1f);
}

TEST(AreaLights, DisksShineToTheirFrontOrToBothSides) {
  AreaPiece disk{};
  disk.corners[0] = vec4(0, 1, 0, 0);
  disk.normalArea = vec4(0, -1, 0, 0.01f);
  disk.radianceSides = vec4(1, 1, 1, 0);
  const float front = areaFormFactor(disk, vec3(0), vec3(0, 1, 0));
  EXPECT_NEAR(front, 0.01f / (1 + 0.01f / kPi), 1e-6f);
  disk.normalArea.y = 1;
  EXPECT_EQ(areaFormFactor(disk, vec3(0), vec3(0, 1, 0)), 0);
  disk.radianceSides.w = 1;
  EXPECT_EQ(areaFormFactor(disk, vec3(0), vec3(0, 1, 0)), front);
}

} // namespace lambent::test::area_lights_test

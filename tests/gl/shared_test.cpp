// Mappings that C++ and GLSL share give the same numbers on both sides.
#include "gl_fixture.h"
#include "shader_copy.h"
#include "shaders/shared/octahedral.h"
#include "shaders/shared/shadow_lookup.h"

namespace lambent::test::shared_test {

using SharedTest = GlTest;

/// What a receiver is held to is never nearer than what the map met, and hardly farther.
TEST(ParaboloidValue, SixteenBitsHoldNearDistancesFinely) {
  for (int i = 1; i < 100000; ++i) {
    const float share = std::pow(float(i) / 100000, 4.0f); // most of them near
    const float value = std::round(paraboloidValue(share) * 65535) / 65535, held = paraboloidShare(value);
    EXPECT_GE(held, share + 0.9e-5f) << "room for the map's origin off its surface";
    EXPECT_LE(held, share + 1.1e-5f + 5e-5f * std::sqrt(share));
    EXPECT_NEAR(leastParaboloidValue(held), value, 2e-6f);
  }
}

TEST_F(SharedTest, GlslAgreesWithCpp) {
  constexpr int kSide = 33; // odd: the axes themselves are among the directions
  const ShaderCopy folder;
  folder.write("probe.frag", R"(#version 450
#include "shared/paraboloid.h"
#include "shared/octahedral.h"
layout(location = 0) out vec4 outTangent;
layout(location = 1) out vec4 outBitangent;
layout(location = 2) out vec4 outMapping;
layout(location = 3) out vec4 outDecoded;
void main() {
  vec2 p = (gl_FragCoord.xy - 0.5) / 16.0 - 1.0;
  vec3 n = unitFromOctahedral(p);
  uint bits = packSnorm2x16(octahedralFromUnit(n));
  vec3 decoded = unitFromOctahedral(unpackSnorm2x16(bits));
  vec3 tangent, bitangent;
  basisAround(decoded, tangent, bitangent);
  outTangent = vec4(tangent, uintBitsToFloat(bits));
  outBitangent = vec4(bitangent, 0.0);
  vec3 d = vec3(n.xy, abs(n.z));
  outMapping = vec4(paraboloidFromDirection(d), directionFromParaboloid(p * 0.5 + 0.5).xy);
  outDecoded = vec4(decoded, directionFromParaboloid(p * 0.5 + 0.5).z);
}
)");
  gl::ProgramCache cache(folder.path);
  std::vector<gl::Texture> targets;
  for (int i = 0; i < 4; ++i)
    targets.emplace_back("probe", gl::TextureDesc{.format = GL_RGBA32F, .width = kSide, .height = kSide});
  const gl::Framebuffer framebuffer("probe", {&targets[0], &targets[1], &targets[2], &targets[3]});
  framebuffer.bind();
  gl::PipelineState{.width = kSide, .height = kSide}.apply();
  cache.get({.fragment = "probe.frag"}).use();
  gl::drawFullscreen();
  std::vector<std::vector<vec4>> got;
  for (const gl::Texture& t : targets) got.push_back(readTexture(t));

  for (const auto [x, y] : Pixels(kSide, kSide)) {
    const int i = y * kSide + x;
    const vec2 p = vec2(x, y) / 16.0f - 1.0f;
    const vec3 n = unitFromOctahedral(p);
    const vec3 decoded = unitFromOctahedral(glm::unpackSnorm2x16(glm::packSnorm2x16(octahedralFromUnit(n))));
    vec3 tangent, bitangent;
    basisAround(decoded, tangent, bitangent);
    const vec2 map = paraboloidFromDirection(vec3(n.x, n.y, std::abs(n.z)));
    const vec3 d = directionFromParaboloid(p * 0.5f + 0.5f);
    // A coordinate halfway between two of 16 bits is a driver's to round, and the basis switches on the sign of z.
    if (std::abs(decoded.z) > 1e-4f || glm::abs(p) != vec2(0.5f)) {
      EXPECT_LT(glm::length(vec3(got[0][i]) - tangent), 2e-4f) << x << ' ' << y;
      EXPECT_LT(glm::length(vec3(got[1][i]) - bitangent), 2e-4f) << x << ' ' << y;
    }
    EXPECT_LT(glm::length(vec3(got[3][i]) - decoded), 2e-4f) << x << ' ' << y;
    EXPECT_LT(glm::length(vec2(got[2][i].x, got[2][i].y) - map), 1e-5f) << x << ' ' << y;
    EXPECT_LT(glm::length(vec3(got[2][i].z, got[2][i].w, got[3][i].w) - d), 1e-5f) << x << ' ' << y;
    EXPECT_LT(glm::length(decoded - n), 1e-4f) << x << ' ' << y; // 16 bits are enough
  }
}

TEST(SharedMappings, ParaboloidInverts) {
  for (const auto [x, y] : Pixels(16, 16)) {
    const vec2 uv = (vec2(x, y) + 0.5f) / 16.0f;
    const vec3 d = directionFromParaboloid(uv);
    EXPECT_NEAR(glm::length(d), 1, 1e-5f);
    if (d.z > -0.5f) {
      EXPECT_LT(glm::length(paraboloidFromDirection(d) - uv), 1e-5f);
    }
  }
}

} // namespace lambent::test::shared_test

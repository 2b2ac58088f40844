// Glossy receivers in the reference: closed forms, other integrals, and virtual lights as another way to the same
// number.
#include "engine/trace/embree_query.h"
#include "gi/lighting/receivers.h"
#include "gi/reference/state_file.h"
#include "gi/vpl/smc.h"
#include "tests/support/effort.h"
#include "tests/support/hand_scene.h"
#include "tests/support/spread_lights.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lambent {
namespace {

struct Finish {
  float roughness, metalness;
};
constexpr Finish kFinishes[] = {{0.3f, 1}, {0.5f, 0}, {0.6f, 0.5f}};

/// A plate of 20 m × 20 m at z = 0, seen askew so closely that all pixels show about one point of it.
struct Plate {
  test::HandScene scene;
  vec3 albedo{0.8f, 0.6f, 0.3f};

  explicit Plate(const Finish& roughnessMetalness) {
    const uint32_t m = scene.material(albedo);
    scene.assets.materials[m].roughness = roughnessMetalness.roughness;
    scene.assets.materials[m].metalness = roughnessMetalness.metalness;
    scene.quad({-10, -10, 0}, {20, 0, 0}, {0, 20, 0}, m);
    const vec3 back = glm::normalize(vec3(0.9f, 0, 1));
    scene.camera.worldFromView = mat4(mat3(vec3(0, 1, 0), glm::cross(back, vec3(0, 1, 0)), back));
    scene.camera.worldFromView[3] = vec4(2.0f * back, 1);
    scene.camera.near = 1e-3f;
    scene.camera.fovY = 1e-4f;
    scene.camera.width = scene.camera.height = 32;
  }
  Receiver receiver() const {
    return makeReceiver({0, 0, 1}, glm::normalize(vec3(0.9f, 0, 1)), albedo, scene.assets.materials[0].roughness,
                        scene.assets.materials[0].metalness);
  }
  /// Every pixel's reflected direct radiance, in green: independent estimates of one number.
  test::Mean direct(uint32_t samples) const {
    const SceneView view = scene.view();
    EmbreeQuery rays(scene.assets);
    rays.update(view);
    const LightSet lights = collectLights(view);
    const ReferenceInputs in{rays, lights, view.camera, 0, 0, 1, &view};
    ReferenceSums sums(32, 32);
    RayCounts counts;
    addSamples(sums, in, samples, counts);
    std::vector<double> values;
    for (const vec3& p : readReference(sums, in, ReferenceBuffer::Direct).mean.pixels) values.push_back(double(p.y));
    return test::meanOf(values);
  }
};

TEST(GlossyReference, PlateUnderAPointLight) {
  for (const Finish& roughnessMetalness : kFinishes) {
    Plate plate(roughnessMetalness);
    LightView lamp;
    lamp.position = {-0.8f, 0.2f, 1.1f};
    lamp.intensity = vec3(3);
    plate.scene.lights.push_back(lamp);
    const float r2 = glm::dot(lamp.position, lamp.position);
    const vec3 towards = lamp.position / std::sqrt(r2);
    const Receiver receiver = plate.receiver();
    const float wanted = 3 / r2 * towards.z * (receiver.diffuse.y / kPi + glossyReflectance(receiver, towards, 0).y);
    const test::Mean m = plate.direct(1); // one light is always the one chosen
    EXPECT_NEAR(m.mean, wanted, 1e-3 * wanted) << roughnessMetalness.roughness;
    EXPECT_GT(m.mean, 1.2 * 3 / r2 * towards.z * receiver.diffuse.y / kPi) << "the lobe matters";
  }
}

TEST(GlossyReference, PlateUnderTheSkyAndALamp) {
  // Two triangles of a lamp, met by connections and by rays, before a sky that only rays meet; against a fine sum over
  // all directions.
  const vec3 corner(-2, -0.6f, 1), e1(1.2f, 0, 0.4f), e2(0, 1.2f, 0);
  const vec3 lampNormal = glm::normalize(glm::cross(e2, e1));
  for (const Finish& roughnessMetalness : kFinishes) {
    Plate plate(roughnessMetalness);
    plate.scene.sky = vec3(0.5f);
    plate.scene.quad(corner, e2, e1, plate.scene.material(vec3(0), vec3(4)));
    ASSERT_LT(glm::dot(lampNormal, corner), 0) << "faces the plate";
    const Receiver receiver = plate.receiver();
    double wanted = 0;
    constexpr int kSteps = 1500;
    for (int i = 0; i < kSteps; ++i)
      for (int j = 0; j < kSteps; ++j) {
        const float cosine2 = (float(i) + 0.5f) / kSteps, phi = 2 * kPi * (float(j) + 0.5f) / kSteps;
        const float sine = std::sqrt(1 - cosine2);
        const vec3 d(sine * std::cos(phi), sine * std::sin(phi), std::sqrt(cosine2));
        const vec3 at = d * (glm::dot(corner, lampNormal) / glm::dot(d, lampNormal)) - corner;
        const float u = glm::dot(at, e1) / glm::dot(e1, e1), v = glm::dot(at, e2) / glm::dot(e2, e2);
        const bool lamp = glm::dot(d, lampNormal) < 0 && u > 0 && u < 1 && v > 0 && v < 1;
        wanted += double(reflectanceOf(receiver, d).y) * (lamp ? 4 : 0.5) * double(kPi) / kSteps / kSteps;
      }
    const test::Mean m = plate.direct(400);
    EXPECT_LT(std::abs(m.mean - wanted), test::kDeviateLimit * m.error + 1e-3 * wanted) << m.mean << " for " << wanted;
    EXPECT_LT(m.error, 3e-3 * wanted) << "too noisy to tell";
  }
}

/// A closed room, its walls Lambert, its floor glossy where the camera looks.
struct GlossyRoom {
  test::HandScene scene;
  vec3 size{2, 1, 3}, albedo{0.6f, 0.5f, 0.4f};

  explicit GlossyRoom(const Finish& roughnessMetalness) {
    const uint32_t m = scene.material(albedo);
    scene.assets.materials[m].roughness = roughnessMetalness.roughness;
    scene.assets.materials[m].metalness = roughnessMetalness.metalness;
    scene.box({0, 0, 0}, size, m, true);
    LightView lamp;
    lamp.position = {1.6f, 0.4f, 2.5f};
    scene.lights.push_back(lamp);
    scene.camera.worldFromView[0] = vec4(-1, 0, 0, 0); // looks along +Z
    scene.camera.worldFromView[2] = vec4(0, 0, -1, 0);
    scene.camera.worldFromView[3] = vec4(1, 0.5f, 0.1f, 1);
    scene.camera.width = 24;
    scene.camera.height = 16;
  }
};

TEST(GlossyReference, AgreesWithEvenlySpreadVirtualLights) {
  constexpr int kPerSet = 2000, kSets = test::kSanitized ? 1 : 24;
  constexpr float kClamp = 3; // 1/m²
  for (const Finish& roughnessMetalness : kFinishes) {
    const GlossyRoom room(roughnessMetalness);
    const SceneView view = room.scene.view();
    EmbreeQuery rays(room.scene.assets);
    rays.update(view);
    const LightSet lights = collectLights(view);
    GatherSettings gather;
    gather.disk = gather.spread = 0;
    gather.clamp = kClamp;
    RayCounts counts;
    std::vector<vec2> centres;
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 24; ++x) centres.push_back((vec2(x, y) + 0.5f) / vec2(24, 16));
    const std::vector<SurfaceHit> seen = surfacesAt(rays, view.camera, centres);
    std::vector<double> means;
    for (uint32_t set = 0; set < kSets; ++set) {
      std::vector<Vpl> vpls = test::spreadOverBox(room.size, room.albedo, kPerSet, set);
      std::vector<Vpl*> all;
      for (Vpl& v : vpls) all.push_back(&v);
      estimateRadiance(all, rays, lights, 16, 2, 1, counts);
      VplSet whole;
      whole.slots = std::move(vpls);
      GlossyGather glossy{view, {}};
      const std::vector<vec3> irradiance = gatherByRays(rays, view.camera, lightsOf(whole), gather, counts, &glossy);
      double sum = 0;
      for (size_t i = 0; i < seen.size(); ++i) {
        const Receiver receiver = receiverOf(view, seen[i]);
        sum += double(receiver.diffuse.y / kPi * irradiance[i].y + glossyTint(receiver).y * glossy.radiance[i].y);
      }
      means.push_back(sum / double(seen.size()));
    }
    const ReferenceInputs in{rays, lights, view.camera, 2, kClamp, 1, &view};
    ReferenceSums sums(24, 16);
    addSamples(sums, in, test::kSanitized ? 2 : 1500, counts);
    const ReferencePicture picture = readReference(sums, in, ReferenceBuffer::Indirect);
    double truth = 0;
    for (const vec3& p : picture.mean.pixels) truth += double(p.y) / (24 * 16);
    if (test::kSanitized) continue; // too few to tell
    const test::Mean m = test::meanOf(means);
    EXPECT_LT(std::abs(m.mean - truth), test::kDeviateLimit * std::hypot(m.error, truth * picture.relativeErrorOfMean))
        << m.mean << " against " << truth << ", roughness " << roughnessMetalness.roughness;
    EXPECT_LT(m.error, 0.015 * truth) << "too noisy to tell";
  }
}

TEST(GlossyReference, LambertMaterialsAreUntouchedAndKeysTellFinishes) {
  GlossyRoom room({1, 0});
  const SceneView view = room.scene.view();
  EmbreeQuery rays(room.scene.assets);
  rays.update(view);
  const LightSet lights = collectLights(view);
  const ReferenceInputs lambert{rays, lights, view.camera, 1, 0, 1}, glossy{rays, lights, view.camera, 1, 0, 1, &view};
  const uint64_t lambertKey = referenceKey(view, lambert), glossyKey = referenceKey(view, glossy);
  EXPECT_NE(lambertKey, glossyKey);
  ReferenceSums a(24, 16), b(24, 16);
  RayCounts counts;
  addSamples(a, lambert, 256, counts);
  addSamples(b, glossy, 256, counts);
  const ReferencePicture p = readReference(a, lambert, ReferenceBuffer::Beauty),
                         q = readReference(b, glossy, ReferenceBuffer::Beauty);
  double deviate = 0;
  for (size_t i = 0; i < p.mean.pixels.size(); ++i) {
    const double error = std::hypot(double(p.error.pixels[i].y), double(q.error.pixels[i].y));
    deviate += (double(p.mean.pixels[i].y) - double(q.mean.pixels[i].y)) / error;
  }
  EXPECT_LT(std::abs(deviate) / std::sqrt(24.0 * 16), test::kDeviateLimit); // another sampler, the same number
  room.scene.assets.materials[0].roughness = 0.5f;
  EXPECT_EQ(referenceKey(view, lambert), lambertKey);
  EXPECT_NE(referenceKey(view, glossy), glossyKey);
}

} // namespace
} // namespace lambent

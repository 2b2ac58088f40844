// Glossy receivers in the reference: closed forms, other integrals, and virtual lights as another way to the same
// number.
#include "gi/lighting/receivers.h"
#include "gi/near/mirror_rays.h"
#include "gi/reference/state_file.h"
#include "gi/vpl/smc.h"
#include "tests/support/reference.h"
#include "tests/support/spread_lights.h"

namespace lambent::test::glossy_test {

struct Finish {
  float roughness, metalness;
};
constexpr Finish kFinishes[] = {{0.3f, 1}, {0.5f, 0}, {0.6f, 0.5f}};

/// A plate of 20 m × 20 m at z = 0, seen askew so closely that all pixels show about one point of it.
struct Plate {
  HandScene scene;
  vec3 albedo{0.8f, 0.6f, 0.3f};

  explicit Plate(const Finish& finish) {
    scene.quad({-10, -10, 0}, {20, 0, 0}, {0, 20, 0}, scene.glossyMaterial(albedo, finish.roughness, finish.metalness));
    scene.camera = probeAt(2.0f * glm::normalize(vec3(0.9f, 0, 1)), vec3(0));
  }
  Receiver receiver() const {
    return makeReceiver({0, 0, 1}, glm::normalize(vec3(0.9f, 0, 1)), albedo,
                        plainFinish(scene.assets.materials[0].roughness, scene.assets.materials[0].metalness));
  }
  /// Every pixel's reflected direct radiance, in green: independent estimates of one number.
  Mean direct(uint32_t samples) const {
    const TracedScene s(scene);
    const ReferenceInputs in{s.rays, s.lights, scene.camera, 0, 0, 1, &s.view};
    return meanOf(trace(in, samples, ReferenceBuffer::Direct).mean, {0, 1, 0});
  }
};

TEST(GlossyReference, PlateUnderAPointLight) {
  for (const Finish& finish : kFinishes) {
    Plate plate(finish);
    const LightView lamp = plate.scene.lamp({-0.8f, 0.2f, 1.1f}, vec3(3));
    const float r2 = glm::dot(lamp.position, lamp.position);
    const vec3 towards = lamp.position / std::sqrt(r2);
    const Receiver receiver = plate.receiver();
    const float wanted = 3 / r2 * towards.z * (receiver.diffuse.y / kPi + glossyReflectance(receiver, towards, 0).y);
    const Mean m = plate.direct(1); // one light is always the one chosen
    EXPECT_NEAR(m.mean, wanted, 1e-3 * wanted) << finish.roughness;
    EXPECT_GT(m.mean, 1.2 * 3 / r2 * towards.z * receiver.diffuse.y / kPi) << "the lobe matters";
  }
}

/// Of its points rays of the lobe bring a share and connections the rest: against a fine sum over the disk, which knows
/// of neither. The sharp ones are the cases that connections alone hardly find.
TEST(GlossyReference, PlateUnderASunWithADisk) {
  SKIP_STATISTICS_WHEN_SANITIZED();
  for (const float radius : {1e-5f, 0.05f, 0.3f})
    for (const Finish& finish : {Finish{0.1f, 1}, Finish{0.1f, 0}, Finish{0.4f, 1}, Finish{0.6f, 0.5f}}) {
      Plate plate(finish);
      LightView sun{.type = LightType::Directional,
                    .direction = glm::normalize(vec3(0.85f, 0.05f, -1)), // just beside the mirrored direction
                    .intensity = vec3(3),
                    .angularRadius = radius};
      plate.scene.lights.push_back(sun);
      const Receiver receiver = plate.receiver();
      double wanted = 0;
      const int steps = 400;
      for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
          const vec3 towards = -pointOfDisk(sun, (vec2(i, j) + 0.5f) / float(steps)).direction;
          wanted += double(3 * towards.z * reflectanceOf(receiver, towards).y);
        }
      wanted /= steps * steps;
      const Mean m = plate.direct(256);
      EXPECT_NEAR(m.mean, wanted, 4 * m.error + 2e-3 * wanted)
          << finish.roughness << ' ' << finish.metalness << ' ' << radius;
      EXPECT_LT(m.error, 0.02 * wanted) << "found by rays of the lobe";
    }
}

TEST(GlossyReference, PlateUnderTheSkyAndALamp) {
  // Two triangles of a lamp, met by connections and by rays, before a sky that only rays meet; against a fine sum over
  // all directions.
  const vec3 corner(-2, -0.6f, 1), e1(1.2f, 0, 0.4f), e2(0, 1.2f, 0);
  const vec3 lampNormal = glm::normalize(glm::cross(e2, e1));
  for (const Finish& finish : kFinishes) {
    Plate plate(finish);
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
    EXPECT_TRUE(agrees(plate.direct(400), wanted, 3e-3 * wanted, 1e-3 * wanted));
  }
}

/// A metal plate mirrors a wall that a lamp lights, twice reflected light too: rays of the lobe against path tracing.
/// Between the roughnesses where rays begin and end to take over they bring their share.
TEST(GlossyReference, MirrorsShowWhatPathTracingShows) {
  for (const float roughness : {0.0f, 0.15f, 0.28f, 0.4f}) {
    Plate plate({roughness, 1});
    plate.scene.quad({-2, -10, 0}, {0, 20, 0}, {0, 0, 6}, plate.scene.material({0.7f, 0.4f, 0.2f}));
    plate.scene.lamp({1, 1, 2}, vec3(5));
    const TracedScene s(plate.scene);
    for (const int bounces : {1, 2}) {
      const ReferenceInputs in{s.rays, s.lights, plate.scene.camera, bounces, 0, 1, &s.view};
      const Mean wanted = meanOf(trace(in, 256, ReferenceBuffer::Indirect).mean, {0, 1, 0});
      RayCounts counts;
      const MirrorInputs mirrors{.view = s.view, .rays = s.rays, .lights = s.lights, .samples = 64, .bounces = bounces};
      const Receiver receiver = plate.receiver();
      std::vector<double> found;
      for (const vec3& light : traceMirrors(mirrors, counts)) found.push_back(double(light.y * glossyTint(receiver).y));
      const Mean m = meanOf(found);
      const double share = double(mirrorShare(receiver));
      EXPECT_NEAR(m.mean, share * wanted.mean, 4 * (m.error + wanted.error) + 2e-3 * wanted.mean)
          << roughness << ' ' << bounces;
      EXPECT_GT(wanted.mean, 20 * wanted.error) << roughness << ' ' << bounces;
      EXPECT_EQ(share, roughness < 0.25f ? 1 : roughness > 0.35f ? 0 : share);
      if (share == 0) {
        EXPECT_EQ(counts.occlusion, 0u) << "rough surfaces cast none";
      }
    }
  }
}

/// The share of rays is that of the image, which virtual lights leave out, whatever the surface is where a ray meets
/// it.
TEST(GlossyReference, MirrorsGoByTheFinishOfTheImage) {
  Plate plate({0.6f, 1});
  plate.scene.quad({-2, -10, 0}, {0, 20, 0}, {0, 0, 6}, plate.scene.material({0.7f, 0.4f, 0.2f}));
  plate.scene.lamp({1, 1, 2}, vec3(5));
  const TracedScene s(plate.scene);
  const size_t pixels = size_t(plate.scene.camera.width) * size_t(plate.scene.camera.height);
  const auto light = [&](std::vector<vec4> finish) {
    RayCounts counts;
    double sum = 0;
    for (const vec3& v :
         traceMirrors({.view = s.view, .rays = s.rays, .lights = s.lights, .samples = 16, .finish = finish}, counts))
      sum += double(v.y);
    return sum;
  };
  EXPECT_EQ(light({}), 0) << "too rough";
  EXPECT_GT(light(std::vector<vec4>(pixels, plainFinish(0.1f, 1))), 0);
  std::vector<vec4> lower(pixels, plainFinish(0.6f, 1)); // rows from the bottom
  std::fill_n(lower.begin(), pixels / 4, plainFinish(0.1f, 1));
  RayCounts counts;
  const std::vector<vec3> some =
      traceMirrors({.view = s.view, .rays = s.rays, .lights = s.lights, .samples = 16, .finish = lower}, counts);
  for (size_t i = 0; i < pixels; ++i) EXPECT_EQ(some[i] == vec3(0), i < 3 * pixels / 4) << i;
}

/// Pixels that cannot show a mirror are not asked; those that can get the same light.
TEST(GlossyReference, MirrorsAreLookedForWhereTheyMayBe) {
  HandScene scene;
  scene.quad({-5, -5, 8}, {0, 10, 0}, {10, 0, 0}, scene.material(vec3(0.6f))); // behind the camera
  const uint32_t chrome = scene.glossyMaterial(vec3(0.9f), 0, 1);
  scene.lamp({1, 1, 3}, vec3(5));
  scene.camera = cameraAt({0, 0, 4}, {0, 0, 0}, 0.8f, 48, 32);
  const auto lightOf = [&](const TracedScene& s, const PixelBox& pixels, RayCounts& counts) {
    return traceMirrors({.view = s.view, .rays = s.rays, .lights = s.lights, .pixels = pixels, .samples = 4}, counts);
  };
  EXPECT_TRUE(mirrorsOf(scene.view()).empty());
  scene.box({0.3f, -0.6f, -0.5f}, {0.9f, -0.1f, 0.2f}, chrome, false);
  const TracedScene s(scene);
  const PixelBox box = mirrorsOf(s.view);
  EXPECT_GT(box.lo.x, 20);
  EXPECT_GT(box.lo.y, 14) << "rows count from the top";
  EXPECT_LT((box.hi.x - box.lo.x) * (box.hi.y - box.lo.y), 48 * 32 / 4);
  RayCounts whole, part;
  const std::vector<vec3> all = lightOf(s, {}, whole), some = lightOf(s, box, part);
  EXPECT_EQ(all, some);
  EXPECT_GT(maxComponent(*std::ranges::max_element(all, {}, [](const vec3& v) { return maxComponent(v); })), 0);
  EXPECT_LT(part.closest, whole.closest / 2);
  scene.box({-1, -1, 3.5f}, {1, -0.5f, 5}, chrome, false); // around the camera
  const PixelBox around = mirrorsOf(scene.view());
  EXPECT_EQ(around.lo, glm::ivec2(0));
  EXPECT_EQ(around.hi, glm::ivec2(48, 32));
}

TEST(GlossyReference, AgreesWithEvenlySpreadVirtualLights) {
  constexpr int kPerSet = 2000, kSets = kSanitized ? 1 : 24;
  constexpr float kClamp = 3; // 1/m²
  for (const Finish& finish : kFinishes) {
    const ReferenceBox room(finish.roughness, finish.metalness);
    const TracedScene s(room.scene);
    const SceneView& view = s.view;
    const GatherSettings gather{.disk = 0, .clamp = kClamp, .spread = 0, .mirrors = 0};
    RayCounts counts;
    std::vector<vec2> centres;
    for (const auto [x, y] : Pixels(24, 16)) centres.push_back((vec2(x, y) + 0.5f) / vec2(24, 16));
    const std::vector<SurfaceHit> seen = surfacesAt(s.rays, view.camera, centres);
    std::vector<double> means;
    for (uint32_t set = 0; set < kSets; ++set) {
      std::vector<Vpl> vpls = spreadOverBox(room.size, room.albedo, kPerSet, set);
      relight(vpls, s.rays, s.lights, 16, 2);
      VplSet whole;
      whole.slots = std::move(vpls);
      GlossyGather glossy{view, {}};
      const std::vector<vec3> irradiance = gatherByRays(s.rays, view.camera, lightsOf(whole), gather, counts, &glossy);
      double sum = 0;
      for (size_t i = 0; i < seen.size(); ++i) {
        const Receiver receiver = receiverOf(view, seen[i]);
        sum += double(receiver.diffuse.y / kPi * irradiance[i].y + glossyTint(receiver).y * glossy.radiance[i].y);
      }
      means.push_back(sum / double(seen.size()));
    }
    const ReferenceImage picture =
        trace({s.rays, s.lights, view.camera, 2, kClamp, 1, &view}, kSanitized ? 2 : 1500, ReferenceBuffer::Indirect);
    if (kSanitized) continue; // too few to tell
    const double truth = meanOf(picture.mean, {0, 1, 0}).mean;
    EXPECT_TRUE(agrees(meanOf(means), Mean{truth, truth * picture.relativeErrorOfMean}, 0.015 * truth))
        << "roughness " << finish.roughness;
  }
}

TEST(GlossyReference, LambertMaterialsAreUntouchedAndKeysTellFinishes) {
  ReferenceBox room;
  const TracedScene s(room.scene);
  const SceneView& view = s.view;
  const ReferenceInputs lambert{s.rays, s.lights, view.camera, 1, 0, 1},
      glossy{s.rays, s.lights, view.camera, 1, 0, 1, &view};
  const uint64_t lambertKey = referenceKey(view, lambert), glossyKey = referenceKey(view, glossy);
  EXPECT_NE(lambertKey, glossyKey);
  const ReferenceImage p = trace(lambert, 256, ReferenceBuffer::Beauty),
                       q = trace(glossy, 256, ReferenceBuffer::Beauty);
  double deviate = 0;
  for (size_t i = 0; i < p.mean.pixels.size(); ++i) {
    const double error = std::hypot(double(p.error.pixels[i].y), double(q.error.pixels[i].y));
    deviate += (double(p.mean.pixels[i].y) - double(q.mean.pixels[i].y)) / error;
  }
  EXPECT_LT(std::abs(deviate) / std::sqrt(24.0 * 16), kDeviateLimit); // another sampler, the same number
  room.scene.assets.materials[0].roughness = 0.5f;
  EXPECT_EQ(referenceKey(view, lambert), lambertKey);
  EXPECT_NE(referenceKey(view, glossy), glossyKey);
}

/// A plate whose map tilts it everywhere, under a lamp and by a sky: E = I·cosθ/r², and the sky's share of a tilted
/// plane's directions that the plate itself does not hide.
TEST(NormalMapReference, TiltedPlate) {
  HandScene scene;
  const uint32_t material = scene.material(vec3(1));
  scene.normalMap(material, {0.6f, 0, 0.8f});
  scene.quad({-10, -10, 0}, {20, 0, 0}, {0, 20, 0}, material);
  scene.camera = probeAt(vec3(0, 0, 2), vec3(0));
  const vec3 local = vec3(scene.assets.images[0].texels[0]) / 127.5f - 1.0f;
  const vec3 normal = glm::normalize(vec3(local.x, -local.y, local.z)); // e2 is v, downwards in the texture
  const auto direct = [&](const SceneView* maps, const TracedScene& s, uint32_t samples) {
    const ReferenceInputs in{
        .rays = s.rays, .lights = s.lights, .camera = scene.camera, .bounces = 0, .normalMaps = maps};
    return meanOf(trace(in, samples, ReferenceBuffer::Direct).mean, {0, 1, 0});
  };
  {
    const LightView lamp = scene.lamp({0.9f, 0.3f, 0.8f}, vec3(3));
    const TracedScene s(scene);
    const float r2 = glm::dot(lamp.position, lamp.position), r3 = r2 * std::sqrt(r2);
    EXPECT_NEAR(direct(&s.view, s, 1).mean, 3 / kPi * glm::dot(normal, lamp.position) / r3, 2e-3);
    EXPECT_NEAR(direct(nullptr, s, 1).mean, 3 / kPi * lamp.position.z / r3, 2e-3);
  }
  scene.lights.clear();
  scene.sky = vec3(1);
  const TracedScene s(scene);
  const Mean m = direct(&s.view, s, 64);
  EXPECT_NEAR(m.mean, 0.5 * (1 + double(normal.z)), 4 * m.error + 1e-3);
}

} // namespace lambent::test::glossy_test

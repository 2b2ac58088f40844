// Glossy receivers: the shared BRDF against textbook formulas integrated another way, energy, and its sampler.
#include "engine/core/rng.h"
#include "gi/lighting/receivers.h"
#include "tests/support/hand_scene.h"

namespace lambent::test::receivers_test {

const vec3 kUp(0, 0, 1);

vec3 atCosine(float cosine, float phi = 0) {
  const float sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine));
  return {sine * std::cos(phi), sine * std::sin(phi), cosine};
}

Receiver seenAt(float cosViewer, float roughness, float metalness, const vec3& albedo = vec3(1)) {
  return makeReceiver(kUp, atCosine(cosViewer), albedo, plainFinish(roughness, metalness));
}

/// ∫ f cosθ dω over the hemisphere of lights, by midpoints in (cos²θ, φ).
double reflectedShare(const std::function<double(const vec3&)>& reflectance, int steps = 800) {
  double sum = 0;
  for (int i = 0; i < steps; ++i)
    for (int j = 0; j < steps; ++j)
      sum += reflectance(
          atCosine(std::sqrt((float(i) + 0.5f) / float(steps)), 2 * kPi * (float(j) + 0.5f) / float(steps)));
  return sum * double(kPi) / (double(steps) * steps);
}

/// The same integral of the lobe alone from the papers' own forms (D by tanθ, Smith's Λ), over half vectors in place of
/// lights: cosines of light and half vector cancel as in Walter et al. 2007, eq. 41.
double lobeShareByHalfVectors(double cosViewer, double roughness, const Receiver& r, int steps = 800) {
  const double alpha = roughness * roughness, sineViewer = std::sqrt(1 - cosViewer * cosViewer);
  const auto lambda = [&](double cosine) {
    const double tan2 = 1 / (cosine * cosine) - 1;
    return 0.5 * (std::sqrt(1 + alpha * alpha * tan2) - 1);
  };
  double sum = 0;
  for (int i = 0; i < steps; ++i) { // even in what the density gathers: sharp lobes keep their tails
    const double u = (i + 0.5) / steps, t = alpha * std::sqrt(u / (1 - u)), ch = 1 / std::sqrt(1 + t * t), sh = t * ch;
    for (int j = 0; j < steps; ++j) {
      const double phi = 2 * M_PI * (j + 0.5) / steps;
      const double vh = sh * std::cos(phi) * sineViewer + ch * cosViewer, cosLight = 2 * vh * ch - cosViewer;
      if (vh <= 0 || cosLight <= 0) continue;
      const double fresnel = double(r.specular.y) + double(r.grazing.y) * std::pow(1 - vh, 5);
      const double masking = 1 / (1 + lambda(cosViewer) + lambda(cosLight));
      // f cosLight dω = D G F / (4 cosViewer) · 4 vh dω_half, and D cosθ dω_half is one part of steps²
      sum += masking * fresnel / cosViewer * vh / ch;
    }
  }
  return sum / steps / steps;
}

TEST(Receivers, LobeIntegratesToTheSameInAnotherFormulation) {
  for (const float roughness : {0.3f, 0.6f, 1.0f})
    for (const float cosViewer : {0.1f, 0.4f, 0.8f, 1.0f})
      for (const bool metal : {true, false}) {
        if (!metal && roughness == 1) continue; // Lambert: below
        const Receiver r = seenAt(cosViewer, roughness, metal ? 1.0f : 0.0f);
        const double share = reflectedShare([&](const vec3& l) { return double(glossyReflectance(r, l, 0).y); });
        const double wanted = lobeShareByHalfVectors(cosViewer, roughness, r);
        EXPECT_NEAR(share, wanted, 2e-3 * wanted) << roughness << ' ' << cosViewer << ' ' << metal;
        EXPECT_LT(share, 1.002);
      }
}

TEST(Receivers, ReflectNoMoreThanTheyGet) {
  const vec4 finishes[] = {plainFinish(0, 0),   plainFinish(0, 0.3f),   plainFinish(0, 0.7f), plainFinish(0, 1),
                           vec4(0, 0.5f, 0, 0), vec4(0, 0, 0.2f, 0.5f), vec4(0, 0, 0.5f, 1),  vec4(0, 0.5f, 1, 1)};
  double largest = 0;
  for (float roughness = kLeastRoughness; roughness < 1.01f; roughness += 0.05f)
    for (const float cosViewer :
         {1e-4f, 1e-3f, 3e-3f, 0.01f, 0.03f, 0.06f, 0.1f, 0.15f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f, 0.7f, 0.8f, 1.0f}) {
      // Lobes are sums of two parts.
      Receiver part;
      part.specular = vec3(1), part.grazing = vec3(0);
      const double white = lobeShareByHalfVectors(double(cosViewer), double(roughness), part, 200);
      part.specular = vec3(0), part.grazing = vec3(1);
      const double schlick = lobeShareByHalfVectors(double(cosViewer), double(roughness), part, 200);
      for (const vec4& f : finishes) {
        const Receiver r = makeReceiver(kUp, atCosine(cosViewer), vec3(1), vec4(roughness, f.y, f.z, f.w));
        const double share = double(r.diffuse.y) + double(r.specular.y) * white + double(r.grazing.y) * schlick;
        EXPECT_LT(share, 1.0005) << roughness << ' ' << cosViewer << ' ' << f.y << ' ' << f.z; // the sum's own error
        // What the bound takes away from a white dielectric for nothing stays small. Nor is a white metal dark: what
        // meets several facets is made up for.
        const double least = f.z > 0 ? 0.7 : cosViewer < 0.1f ? 0.81 : f.y == 0 ? 0.95 : 0.9;
        EXPECT_GT(share, least) << roughness << ' ' << cosViewer << ' ' << f.y << ' ' << f.z;
        largest = std::max(largest, share);
      }
    }
  EXPECT_GT(largest, 0.99);
}

TEST(Receivers, TheLobeIsReciprocalButForTheViewersFactor) {
  Rng rng(1, Stream::Test, 0);
  for (int i = 0; i < 1000; ++i) {
    const vec3 a = atCosine(0.01f + 0.99f * rng.next(), 6 * rng.next()), b = atCosine(0.01f + 0.99f * rng.next(), 0);
    const vec3 albedo = rng.next3();
    const float roughness = rng.next(), metalness = float(rng.below(2)); // of each the factor is one
    const Receiver fromA = makeReceiver(kUp, a, albedo, plainFinish(roughness, metalness)),
                   fromB = makeReceiver(kUp, b, albedo, plainFinish(roughness, metalness));
    if (fromA.specular == vec3(0)) continue;
    const vec3 there = glossyReflectance(fromA, b, 0) / fromA.specular,
               back = glossyReflectance(fromB, a, 0) / fromB.specular;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(there[c], back[c], 1e-4f * there[c]);
  }
}

TEST(Receivers, RoughDielectricsAreLambertAndSharpOnesAreBounded) {
  const vec3 albedo(0.2f, 0.5f, 0.9f);
  const Receiver rough = seenAt(0.6f, 1, 0, albedo);
  EXPECT_EQ(rough.diffuse, albedo);
  EXPECT_EQ(glossyReflectance(rough, atCosine(0.6f, kPi), 0), vec3(0));
  EXPECT_EQ(seenAt(0.6f, 0.5f, 1, albedo).diffuse, vec3(0));
  EXPECT_LT(glm::length(seenAt(0.6f, 0.1f, 1, albedo).specular - albedo), 0.02f);
  const vec3 mirror = atCosine(0.6f, kPi);
  EXPECT_EQ(glossyReflectance(seenAt(0.6f, 0, 1), mirror, 0),
            glossyReflectance(seenAt(0.6f, kLeastRoughness, 1), mirror, 0));
  EXPECT_FLOAT_EQ(glossyReflectance(forVirtualLights(seenAt(0.6f, 0.1f, 1), 0), mirror, 0).x /
                      seenAt(0.6f, 0.1f, 1).specular.x,
                  glossyReflectance(seenAt(0.6f, kLeastVplRoughness, 1), mirror, 0).x /
                      seenAt(0.6f, kLeastVplRoughness, 1).specular.x);
  EXPECT_GT(glossyReflectance(seenAt(0.6f, 0.3f, 1), mirror, 0).x,
            4 * glossyReflectance(seenAt(0.6f, 0.6f, 1), mirror, 0).x);
  // Nowhere infinite or NaN: light from under the surface, along it, opposite to a viewer who is also in it.
  for (const float cosViewer : {0.0f, -1e-3f, 1.0f})
    for (const vec3& light : {-atCosine(cosViewer), atCosine(0, kPi), vec3(0, 0, -1), vec3(0, 0, 1)})
      for (const float roughness : {0.0f, 0.3f})
        EXPECT_TRUE(isFinite(glossyReflectance(seenAt(cosViewer, roughness, 0.5f), light, 0)));
}

TEST(Receivers, SpreadIsThatOfARougherSurface) {
  const vec3 light = atCosine(0.7f, 2.8f);
  const Receiver smooth = seenAt(0.6f, 0.4f, 1), rough = seenAt(0.6f, 0.5f, 1);
  const vec3 wanted = glossyReflectance(rough, light, 0);
  const vec3 spread = glossyReflectance(smooth, light, rough.alpha2 - smooth.alpha2);
  EXPECT_LT(glm::length(spread / smooth.specular - wanted / rough.specular), 1e-5f * wanted.x);
  EXPECT_TRUE(isFinite(glossyReflectance(smooth, light, kInfinity)));
  // A disk seen by a receiver: its radius over the distance, squared, shrinks with the cosine.
  EXPECT_NEAR(lobeSpread(1, kPi * 0.01f, 0.5f, 4), 0.01 / 4 * 0.5, 1e-7);
  EXPECT_EQ(lobeSpread(1, 1, -0.5f, 4), 0);
}

/// Too sharp for a sum over all directions: what their own samples find of a lobe.
TEST(Receivers, SharpLobesAreFoundByTheirSamples) {
  SKIP_STATISTICS_WHEN_SANITIZED();
  for (const float roughness : {kLeastRoughness, 0.1f, 0.2f})
    for (const float cosViewer : {0.1f, 0.4f, 1.0f})
      for (const float metalness : {0.0f, 1.0f}) {
        const Receiver r = seenAt(cosViewer, roughness, metalness);
        double found = 0, byLobe = 0, most = 0;
        const int count = 100000;
        for (int i = 0; i < count; ++i) {
          Rng rng(1, Stream::Test, uint32_t(i));
          const float choice = rng.next();
          const vec2 u = rng.next2();
          const vec3 d = sampleReflection(r, choice, u), visible = sampleLobe(r, u);
          if (d.z > 0) found += double(glossyReflectance(r, d, 0).y * d.z / pdfReflection(r, d));
          if (!(visible.z > 0)) continue;
          const double weight = double(glossyReflectance(r, visible, 0).y * visible.z / pdfLobe(r, visible));
          byLobe += weight;
          most = std::max(most, weight);
        }
        const double wanted = lobeShareByHalfVectors(double(cosViewer), double(roughness), r);
        EXPECT_NEAR(found / count, wanted, 0.015 * wanted) << roughness << ' ' << cosViewer << ' ' << metalness;
        EXPECT_NEAR(byLobe / count, wanted, 0.005 * wanted) << roughness << ' ' << cosViewer << ' ' << metalness;
        EXPECT_LT(most, 1.01 * double(r.specular.y + r.grazing.y)) << "no sample weighs more than its Fresnel term";
      }
}

/// Counts directions of a sampler in rings of equal height and sectors, against the sum of its density.
template <class Sample, class Density> double deviateFrom(const Sample& sample, const Density& density, Rng rng) {
  constexpr int kRings = 24, kSectors = 24, kFine = 24, kSamples = 200000;
  std::vector<double> counts(kRings * kSectors + 1, 0), expected(kRings * kSectors + 1, 0); // last: all below
  for (int i = 0; i < kSamples; ++i) {
    const vec3 d = sample(rng);
    EXPECT_NEAR(glm::length(d), 1, 1e-5f);
    const int ring = std::min(int(d.z * kRings), kRings - 1);
    const int sector = std::clamp(int((std::atan2(d.y, d.x) / kPi + 1) / 2 * kSectors), 0, kSectors - 1);
    counts[d.z < 0 ? kRings * kSectors : ring * kSectors + sector] += 1;
  }
  double above = 0;
  for (int i = 0; i < kRings * kFine; ++i)
    for (int j = 0; j < kSectors * kFine; ++j) {
      const float z = (float(i) + 0.5f) / (kRings * kFine);
      const float phi = kPi * (2 * (float(j) + 0.5f) / (kSectors * kFine) - 1);
      const double share = double(density(atCosine(z, phi))) * 2 * double(kPi) / (kRings * kFine) / (kSectors * kFine);
      expected[i / kFine * kSectors + j / kFine] += share * kSamples;
      above += share;
    }
  expected.back() = (1 - above) * kSamples;
  return chiSquareDeviate(counts, expected);
}

TEST(Receivers, SamplesFollowTheirDensity) {
  for (const float roughness : {0.3f, 0.7f})
    for (const float cosViewer : {0.15f, 0.9f}) {
      const Receiver r = seenAt(cosViewer, roughness, 0.5f);
      const Rng rng(2, Stream::Test, uint32_t(1000 * roughness + 10 * cosViewer));
      const auto both = [&](Rng& numbers) {
        const float choice = numbers.next();
        return sampleReflection(r, choice, numbers.next2());
      };
      EXPECT_LT(deviateFrom(
                    both, [&](const vec3& d) { return pdfReflection(r, d); }, rng),
                kDeviateLimit)
          << roughness << ' ' << cosViewer;
      const auto lobe = [&](Rng& numbers) { return sampleLobe(r, numbers.next2()); };
      EXPECT_LT(deviateFrom(
                    lobe, [&](const vec3& d) { return pdfLobe(r, d); }, rng),
                kDeviateLimit)
          << roughness << ' ' << cosViewer;
    }
}

TEST(Receivers, FinishComesFromFactorsAndTexture) {
  HandScene scene;
  const uint32_t m = scene.material(vec3(0.4f, 0.6f, 0.8f));
  Material& material = scene.assets.materials[m];
  EXPECT_FALSE(material.glossy());
  material.roughness = 0.8f;
  material.metalness = 0.5f;
  material.roughnessMetalnessTexture = // left: rough dielectric, right: half as rough, metal
      scene.texture(2, {{255, 255, 0, 255}, {0, 128, 255, 255}}, false);
  EXPECT_TRUE(material.glossy());
  scene.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, m);
  scene.camera.worldFromView[3] = vec4(0, 0, 2, 1);
  const SceneView view = scene.view();
  SurfaceHit hit;
  hit.t = 2;
  hit.normal = hit.geometricNormal = kUp;
  hit.albedo = material.baseColor;
  hit.instance = hit.primitive = hit.triangle = 0; // corners (-1,-1), (1,-1), (1,1)
  hit.barycentric = {0.2f, 0.0f};                  // u = 0.2
  hit.position = {-0.6f, -1, 0};
  Receiver r = receiverOf(view, hit),
           wanted = makeReceiver(kUp, glm::normalize(vec3(0.6f, 1, 2)), hit.albedo, plainFinish(0.8f, 0));
  EXPECT_NEAR(r.alpha2, wanted.alpha2, 1e-6f);
  EXPECT_LT(glm::length(r.diffuse - wanted.diffuse), 1e-6f);
  EXPECT_LT(glm::length(r.towardsViewer - wanted.towardsViewer), 1e-6f);
  hit.barycentric = {0.8f, 0.0f};
  SceneView parallel = view;
  parallel.camera.orthoHalfHeight = 1;
  EXPECT_LT(glm::length(receiverOf(parallel, hit).towardsViewer - vec3(0, 0, 1)), 1e-6f) << "the same everywhere";
  r = receiverOf(view, hit);
  wanted = makeReceiver(kUp, wanted.towardsViewer, hit.albedo, plainFinish(0.8f * 128 / 255, 0.5f));
  EXPECT_NEAR(r.alpha2, wanted.alpha2, 1e-6f);
  EXPECT_LT(glm::length(r.specular - wanted.specular), 1e-6f);
}

} // namespace lambent::test::receivers_test

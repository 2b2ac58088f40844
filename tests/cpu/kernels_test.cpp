// Numeric kernels over random and extreme arguments, against long double or closed forms. The bounds are those that
// their headers state.
#include "gi/vpl/smc.h"
#include "shaders/shared/ggx.h"
#include "shaders/shared/octahedral.h"
#include "shaders/shared/paraboloid.h"
#include "shaders/shared/solid_angle.h"
#include "shaders/shared/tone_map.h"

#include "tests/support/test.h"

#include <cfloat>
#include <glm/gtc/packing.hpp>

namespace lambent::test::kernels_test {

using Real = long double;

/// Numbers for the i-th try.
Rng tried(uint32_t i) { return Rng(11, Stream::Test, i); }

/// From `least` to `most`, any power of ten as likely as another.
float anySize(Rng& rng, float least, float most) {
  return std::exp(std::log(least) + rng.next() * (std::log(most) - std::log(least)));
}

/// Mostly any direction; else near an axis or a plane of the axes, or on it, where formulas switch.
vec3 anyUnit(Rng& rng) {
  vec3 v = sampleSphere(rng.next2());
  const float beside = anySize(rng, 1e-9f, 1e-2f);
  switch (rng.below(4)) {
  case 0:
    v[int(rng.below(3))] *= beside;
    break;
  case 1:
    v *= rng.below(8) ? beside : 0.0f;
    v[int(rng.below(3))] = rng.below(2) ? 1.0f : -1.0f;
    break;
  default:
    break;
  }
  return glm::normalize(v);
}

Real length(const vec3& a, const vec3& b) {
  Real sum = 0;
  for (int i = 0; i < 3; ++i) sum += (Real(a[i]) - b[i]) * (Real(a[i]) - b[i]);
  return std::sqrt(sum);
}

TEST(Kernels, SolidAngleOfARectangle) {
  const auto exact = [](vec2 lo, vec2 hi) { // by Gauss with 3 × 3 points in each of 16 × 16 parts
    const Real n = 16;
    Real sum = 0;
    const Real points[3] = {0.5L - std::sqrt(0.15L), 0.5L, 0.5L + std::sqrt(0.15L)},
               weights[3] = {5 / 18.0L, 8 / 18.0L, 5 / 18.0L};
    const Real w = (Real(hi.x) - lo.x) / n, h = (Real(hi.y) - lo.y) / n;
    for (int i = 0; i < int(n); ++i)
      for (int j = 0; j < int(n); ++j)
        for (int k = 0; k < 9; ++k) {
          const Real x = lo.x + w * (i + points[k % 3]), y = lo.y + h * (j + points[k / 3]);
          sum += weights[k % 3] * weights[k / 3] / std::pow(1 + x * x + y * y, 1.5L);
        }
    return sum * w * h;
  };
  Real worst = 0;
  for (uint32_t i = 0; i < 300; ++i) {
    Rng rng = tried(i);
    const vec2 lo = (rng.next2() * 2.0f - 1.0f) * anySize(rng, 1e-3f, 20);
    const vec2 size = anySize(rng, 1e-4f, 2) * vec2(1, 0.5f + rng.next());
    const vec2 hi = lo + size;
    const Real whole = exact(lo, hi);
    worst = std::max(worst, std::abs(rectSolidAngle(lo, hi) - whole) / whole);
  }
  EXPECT_LE(worst, 1e-4L);
}

TEST(Kernels, OctahedralMap) {
  Real worst = 0, packed = 0;
  for (uint32_t i = 0; i < 200000; ++i) {
    Rng rng = tried(i);
    const vec3 n = anyUnit(rng);
    const vec2 p = octahedralFromUnit(n);
    ASSERT_LE(std::max(std::abs(p.x), std::abs(p.y)), 1);
    worst = std::max(worst, length(unitFromOctahedral(p), n));
    packed = std::max(packed, length(unitFromOctahedral(glm::unpackSnorm2x16(glm::packSnorm2x16(p))), n));
  }
  EXPECT_LE(worst, 2e-5L);
  EXPECT_LE(packed, 7e-5L);
}

TEST(Kernels, ParaboloidMapAndItsBasis) {
  Real there = 0, back = 0, basis = 0;
  for (uint32_t i = 0; i < 200000; ++i) {
    Rng rng = tried(i);
    vec3 d = anyUnit(rng);
    vec3 t, b;
    basisAround(d, t, b);
    ASSERT_TRUE(isFinite(t) && isFinite(b)) << i;
    for (const auto& [x, y, product] : {std::tuple(t, t, 1), {b, b, 1}, {d, t, 0}, {d, b, 0}, {t, b, 0}})
      basis = std::max(basis, std::abs(Real(x.x) * y.x + Real(x.y) * y.y + Real(x.z) * y.z - product));
    basis = std::max(basis, length(glm::cross(d, t), b));
    d.z = std::abs(d.z);
    const vec2 uv = paraboloidFromDirection(d);
    ASSERT_TRUE(isFinite(vec3(uv, 0)) && isFinite(directionFromParaboloid(uv))) << i;
    for (int c = 0; c < 2; ++c) there = std::max(there, std::abs(uv[c] - (0.5L + 0.5L * d[c] / (1 + Real(d.z)))));
    back = std::max(back, length(directionFromParaboloid(uv), d));
  }
  EXPECT_LE(there, 1e-7L);
  EXPECT_LE(back, 4e-7L);
  EXPECT_LE(basis, 4e-7L);
}

TEST(Kernels, GgxLobe) {
  const auto density = [](Real alpha2, Real c) {
    const Real t = c * c * (alpha2 - 1) + 1;
    return alpha2 / (std::acos(-1.0L) * t * t);
  };
  Real worst = 0, lobe = 0;
  for (uint32_t i = 0; i < 100000; ++i) {
    Rng rng = tried(i);
    const float roughness = rng.below(8) ? rng.next() : rng.below(2) ? 0.0f : 1.0f, metal = rng.next();
    const Receiver r = makeReceiver({0, 0, 1}, sampleCosineHemisphere({0, 0, 1}, rng.next2()), rng.next3(),
                                    plainFinish(roughness, metal));
    const float c = rng.below(4) ? rng.next() : 1 - anySize(rng, 1e-7f, 1e-2f);
    worst = std::max(worst, std::abs(ggxDensity(r.alpha2, float(1 - Real(c) * c), c * c) / density(r.alpha2, c) - 1));
    vec3 l = sampleSphere(rng.next2());
    if (rng.below(4) == 0) l.z = anySize(rng, 1e-8f, 1e-2f), l = glm::normalize(l);
    if (rng.below(8) == 0)
      l = glm::normalize(vec3(-r.towardsViewer.x, -r.towardsViewer.y, r.towardsViewer.z)); // mirrored
    const float spread = rng.below(2) ? 0 : anySize(rng, 1e-6f, 10);
    const vec3 got = glossyReflectance(r, l, spread);
    ASSERT_TRUE(isFinite(got) && glm::all(glm::greaterThanEqual(got, vec3(0))));
    if (l.z <= 0) continue;
    const Real a2 = std::min(Real(r.alpha2) + spread, 1.0L), v = r.cosViewer, n = l.z;
    const Real dot = Real(l.x) * r.towardsViewer.x + Real(l.y) * r.towardsViewer.y + Real(l.z) * r.towardsViewer.z;
    const Real hx = Real(l.x) + r.towardsViewer.x, hy = Real(l.y) + r.towardsViewer.y, h2 = 2 + 2 * dot;
    const Real across = (hx * hx + hy * hy) / h2, along = std::min((n + v) * (n + v) / h2, 1.0L);
    const Real t = across + a2 * along;
    const Real masking = 0.5L / (n * std::sqrt(v * v * (1 - a2) + a2) + v * std::sqrt(n * n * (1 - a2) + a2));
    for (int channel = 0; channel < 3; ++channel) {
      const Real fresnel = r.specular[channel] + r.grazing[channel] * std::pow(1 - std::sqrt(0.5L + 0.5L * dot), 5);
      const Real wanted = fresnel * a2 / (std::acos(-1.0L) * t * t) * masking;
      if (wanted > 1e-6L) lobe = std::max(lobe, std::abs(got[channel] / wanted - 1));
    }
  }
  EXPECT_LE(worst, 3e-5L);
  EXPECT_LE(lobe, 1e-3L);
  for (const float roughness : {kLeastRoughness, 0.3f, 0.5f, 0.8f, 1.0f}) { // ∫ D cosθ over the hemisphere
    const float alpha2 = std::pow(roughness, 4.0f);
    Real sum = 0;
    const int steps = 20000;
    for (int i = 0; i < steps; ++i) { // by sin² = s², denser about the normal
      const Real s = (i + 0.5L) / steps, sine2 = s * s * s * s;
      sum += ggxDensity(alpha2, float(sine2), float(1 - sine2)) * 4 * s * s * s * std::acos(-1.0L) / steps;
    }
    EXPECT_NEAR(double(sum), 1, 2e-5) << roughness;
  }
}

TEST(Kernels, ToneMappers) {
  for (int mapper = 0; mapper < 3; ++mapper) {
    float before = -1;
    for (float grey = 0; grey < FLT_MAX / 2; grey = grey < 1e-30f ? 1e-30f : grey * 1.01f) {
      const vec3 shown = toneMapped(vec3(grey), mapper);
      ASSERT_TRUE(isFinite(shown)) << mapper << ' ' << grey;
      ASSERT_GE(shown.x, before - 1e-6f) << mapper << ' ' << grey;
      before = shown.x;
    }
    EXPECT_NEAR(before, mapper == 2 ? 2.51f / 2.43f : 1, 1e-3f) << mapper;
    for (uint32_t i = 0; i < 100000; ++i) {
      Rng rng = tried(i);
      const vec3 c(anySize(rng, 1e-30f, 1e38f), anySize(rng, 1e-30f, 1e38f),
                   rng.below(4) ? 0 : anySize(rng, 1e-30f, 1e38f));
      const vec3 shown = toneMapped(c, mapper);
      ASSERT_TRUE(isFinite(shown) && shown.x >= -1e-6f && shown.y >= -1e-6f && shown.z >= -1e-6f)
          << mapper << ' ' << c.x << ' ' << c.y << ' ' << c.z;
    }
  }
}

TEST(Kernels, GeometryTerm) {
  Real worst = 0;
  for (uint32_t i = 0; i < 100000; ++i) {
    Rng rng = tried(i);
    GatherSettings settings;
    settings.disk = rng.below(2) ? 1 : 4 * rng.next();
    settings.clamp = rng.below(2) ? 0 : anySize(rng, 1e-6f, 1e6f);
    const float x = 2 * rng.next() - 1, y = rng.below(8) ? 2 * rng.next() - 1 : 0;
    const float r2 = anySize(rng, 1e-20f, 1e20f), area = rng.below(8) ? anySize(rng, 1e-20f, 1e20f) : 0;
    const float g = geometryTerm(x, y, r2, area, settings);
    Real wanted =
        std::max(Real(x), 0.0L) * std::max(Real(y), 0.0L) / (r2 + Real(area) * settings.disk / std::acos(-1.0L));
    if (settings.clamp > 0) wanted = std::min(wanted, Real(settings.clamp));
    ASSERT_TRUE(std::isfinite(g));
    if (wanted == 0) {
      ASSERT_EQ(g, 0);
    } else
      worst = std::max(worst, std::abs(g / wanted - 1));
  }
  EXPECT_LE(worst, 3e-7L);
}

TEST(Kernels, AreasOfNeighboursGrowWithTheSceneAndTurnWithIt) {
  std::vector<DensityPoint> points;
  for (uint32_t i = 0; i < 500; ++i) {
    Rng rng = tried(i);
    const vec3 p = sampleSphere(rng.next2());
    points.push_back({p * (1 + 0.1f * rng.next()), p});
  }
  const std::vector<float> areas = representedAreas(points, points, true, 3, DensityEstimator::KnnSide, kInfinity);
  float worst = 0;
  for (uint32_t i = 0; i < 8; ++i) {
    Rng rng = tried(i);
    const float size = anySize(rng, 1e-12f, 1e12f);
    vec3 x = anyUnit(rng), y, z;
    basisAround(x, y, z);
    const mat3 turn(x, y, z);
    std::vector<DensityPoint> others;
    for (const DensityPoint& p : points) others.push_back({size * (turn * p.position), turn * p.normal});
    const std::vector<float> got = representedAreas(others, others, true, 3, DensityEstimator::KnnSide, kInfinity);
    for (size_t k = 0; k < areas.size(); ++k) worst = std::max(worst, std::abs(got[k] / (size * size) / areas[k] - 1));
  }
  EXPECT_LE(worst, 1e-5f);
}

} // namespace lambent::test::kernels_test

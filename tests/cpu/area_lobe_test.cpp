// Lobes of area lights by linearly transformed cosines against numerical integrals of the lobe itself.
#include "engine/core/rng.h"
#include "gi/lighting/area_lobe.h"
#include "gi/lighting/receivers.h"
#include "tests/support/area_pieces.h"

namespace lambent::test::area_lobe_test {

const float kRoughnesses[] = {0.3f, 0.37f, 0.5f, 0.62f, 0.8f, 1.0f};

/// On the plane z = 0, seen from +x; `f0` 1 for a white metal, else a dielectric. Strength 1.
Receiver seenFrom(float cosViewer, float roughness, float f0) {
  Receiver r = makeReceiver(vec3(0, 0, 1), vec3(std::sqrt(1 - cosViewer * cosViewer), 0, cosViewer), vec3(1),
                            plainFinish(roughness, 1));
  r.specular = vec3(f0);
  r.grazing = vec3(1 - f0);
  return r;
}

/// ∫ lobe · cosx · cosy / r² over a parallelogram, by its midpoints.
double integrated(const AreaPiece& piece, const Receiver& r, int steps) {
  const vec3 corner(piece.corners[0]), e1 = vec3(piece.corners[1]) - corner, e2 = vec3(piece.corners[3]) - corner;
  double sum = 0;
  for (int i = 0; i < steps; ++i)
    for (int j = 0; j < steps; ++j) {
      const vec3 way = corner + e1 * ((float(i) + 0.5f) / float(steps)) + e2 * ((float(j) + 0.5f) / float(steps));
      const float r2 = glm::dot(way, way), up = -glm::dot(vec3(piece.normalArea), way);
      if (way.z <= 0 || (up <= 0 && piece.radianceSides.w == 0)) continue;
      sum += double(glossyReflectance(r, way / std::sqrt(r2), 0).x * way.z * std::abs(up) / (r2 * r2));
    }
  return sum * double(piece.normalArea.w) / (double(steps) * steps);
}

/// Share of uniform light from above that is reflected: rings of even height in the square of the sine.
double albedo(const Receiver& r, int steps = 1500) {
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const float u = (float(i) + 0.5f) / float(steps), sine = std::sqrt(u), cosine = std::sqrt(1 - u);
    for (int j = 0; j < steps; ++j) {
      const float azimuth = kPi * (float(j) + 0.5f) / float(steps);
      sum += double(glossyReflectance(r, vec3(sine * std::cos(azimuth), sine * std::sin(azimuth), cosine), 0).x);
    }
  }
  return sum * double(kPi) / (double(steps) * steps);
}

/// Around the mirror images of views, at grazing angles, through the horizon, and where tails reach.
std::vector<AreaPiece> rectangles() {
  return {quadPiece({-3, -2, 1.5f}, {0, 4, 0}, {4, 0, 0}, true),                   // large, above
          quadPiece({-1.2f, -0.3f, 1}, {0, 0.5f, 0}, {0.6f, 0, 0}, true),          // small, above
          quadPiece({-2, -1, 0.1f}, {0, 2, 0}, {0, 0, 2}, true),                   // a wall opposite the viewer
          quadPiece({-2, -1, -1}, {0, 2, 0}, {0, 0, 2}, true),                     // half of it below the horizon
          quadPiece({-1, 0.4f, 0.2f}, {-0.6f, 0.8f, 0.2f}, {0.3f, 0.3f, 1}, true), // aslant, at the side
          quadPiece({1.5f, -1, 0.2f}, {0, 2, 0}, {0, 0, 1.5f}, true)};             // behind the viewer
}

/// RMS and largest error over the share of uniform light that the lobe reflects.
struct LobeError {
  double sum = 0, most = 0;
  int count = 0;
  void add(double got, double wanted, double whole) {
    const double error = std::abs(got - wanted) / whole;
    sum += error * error;
    most = std::max(most, error);
    ++count;
  }
  double rms() const { return std::sqrt(sum / count); }
};

/// What stood here before: sixteen disks spread over the piece, each with its direction's reflectance.
double bySixteenDisks(const AreaPiece& piece, const Receiver& r) {
  const vec3 corner(piece.corners[0]), e1 = vec3(piece.corners[1]) - corner, e2 = vec3(piece.corners[3]) - corner;
  double sum = 0;
  for (int i = 0; i < 16; ++i) {
    AreaPiece disk = piece;
    disk.corners[0] = vec4(corner + e1 * ((float(i % 4) + 0.5f) / 4) + e2 * ((float(i / 4) + 0.5f) / 4), 0);
    disk.normalArea.w /= 16;
    const vec3 way(disk.corners[0]);
    const float r2 = glm::dot(way, way), facing = std::abs(glm::dot(vec3(disk.normalArea), way)) / std::sqrt(r2);
    sum += double(areaFormFactor(disk, vec3(0), r.normal) *
                  glossyReflectance(r, way / std::sqrt(r2), lobeSpread(0.5f, disk.normalArea.w, facing, r2)).x);
  }
  return sum;
}

struct Survey {
  LobeError all, steep, disks; // steep: cosine of the viewer's angle from 0.25
};

Survey surveyed(const std::vector<AreaLobe>& table) {
  Survey survey;
  for (const float f0 : {1.0f, 0.04f})
    for (const float cosViewer : {1.0f, 0.8f, 0.6f, 0.4f, 0.25f, 0.12f, 0.05f})
      for (const float roughness : kRoughnesses) {
        const Receiver r = seenFrom(cosViewer, roughness, f0);
        const double whole = albedo(r, 120);
        for (const AreaPiece& piece : rectangles()) {
          const double wanted = integrated(piece, r, 150), got = double(lobeRadiance(table, piece, vec3(0), r).x);
          survey.all.add(got, wanted, whole);
          if (cosViewer >= 0.25f) survey.steep.add(got, wanted, whole);
          survey.disks.add(bySixteenDisks(piece, r), wanted, whole);
        }
      }
  return survey;
}

constexpr double kRms = 0.018, kSteepRms = 0.011;

TEST(AreaLobe, IsTheIntegralOfTheLobeOverRectangles) {
  const Survey survey = surveyed(lobeTable()); // 0.0167 and 0.108, steep 0.0098 and 0.038; disks 0.158 and 0.97
  EXPECT_LT(survey.all.rms(), kRms);
  EXPECT_LT(survey.all.most, 0.12);
  EXPECT_LT(survey.steep.rms(), kSteepRms);
  EXPECT_LT(survey.steep.most, 0.045);
  EXPECT_GT(survey.disks.rms(), 4 * survey.all.rms());
}

TEST(AreaLobe, OtherMapsAreFurtherOff) {
  SKIP_STATISTICS_WHEN_SANITIZED();
  std::vector<AreaLobe> broader = lobeTable(), unturned = broader, shifted = broader;
  for (AreaLobe& lobe : broader) lobe.white.w *= 1.15f, lobe.schlick.w *= 1.15f;
  for (AreaLobe& lobe : unturned) lobe.white.z = lobe.schlick.z = 0;
  std::rotate(shifted.begin(), shifted.begin() + kLobeRoughnesses, shifted.end());
  EXPECT_GT(surveyed(broader).steep.rms(), kSteepRms);
  EXPECT_GT(surveyed(unturned).steep.rms(), kSteepRms);
  EXPECT_GT(surveyed(shifted).steep.rms(), kSteepRms);
}

TEST(AreaLobe, ReflectsOfUniformLightWhatTheLobeDoes) {
  const AreaPiece sky = quadPiece({-1e4f, -1e4f, 1}, {0, 2e4f, 0}, {2e4f, 0, 0}, true);
  for (const float f0 : {1.0f, 0.5f, 0.04f})
    for (const float cosViewer : {1.0f, 0.9f, 0.8f, 0.6f, 0.4f, 0.25f, 0.12f, 0.05f})
      for (const float roughness : kRoughnesses) {
        const Receiver r = seenFrom(cosViewer, roughness, f0);
        const double wanted = albedo(r, 400);
        EXPECT_NEAR(lobeRadiance(lobeTable(), sky, vec3(0), r).x, wanted, (cosViewer < 0.25f ? 0.03 : 0.01) * wanted)
            << "F0 " << f0 << ", cosine " << cosViewer << ", roughness " << roughness;
      }
}

/// Sharp lobes, by rays that are drawn from them: around the mirror image's edges, and beside it.
TEST(AreaLobe, SharpLobesSeeWhatTheMirroredDirectionMeets) {
  SKIP_STATISTICS_WHEN_SANITIZED();
  LobeError error;
  for (const float roughness : {kLeastRoughness, 0.08f, 0.13f, 0.22f})
    for (const float cosViewer : {1.0f, 0.8f, 0.4f, 0.2f}) {
      const Receiver r = seenFrom(cosViewer, roughness, 1);
      const vec3 mirrored(-r.towardsViewer.x, 0, r.towardsViewer.z), side(0, 1, 0), up = glm::cross(side, mirrored);
      const float wide = 4 * roughness * roughness;
      for (const vec2& shift : {vec2(0, 0), vec2(0.5f, 0), vec2(0, 0.5f), vec2(0.5f, 0.5f), vec2(0, 2)}) {
        const vec3 corner = 2.0f * (mirrored + wide * ((shift.x - 0.5f) * side + (shift.y - 0.5f) * up));
        const AreaPiece piece = quadPiece(corner, 2 * wide * side, 2 * wide * up, true);
        double seen = 0, whole = 0;
        const int count = 40000;
        for (int i = 0; i < count; ++i) {
          Rng rng(1, Stream::Test, uint32_t(i));
          const vec3 d = sampleReflection(r, rng.next(), rng.next2());
          const float pdf = pdfReflection(r, d);
          if (d.z <= 0 || !(pdf > 0)) continue;
          const double value = double(glossyReflectance(r, d, 0).x * d.z / pdf);
          whole += value;
          const vec3 at = d * (2 / glm::dot(d, mirrored)) - corner;
          const vec2 place = vec2(glm::dot(at, side), glm::dot(at, up)) / (2 * wide);
          if (glm::dot(d, mirrored) > 0 && glm::min(place.x, place.y) >= 0 && glm::max(place.x, place.y) <= 1)
            seen += value;
        }
        error.add(double(lobeRadiance(lobeTable(), piece, vec3(0), r).x), seen / count, whole / count);
      }
    }
  std::printf("sharp lobes: RMS %.4f, largest %.4f of what the lobe reflects\n", error.rms(), error.most);
  EXPECT_LT(error.rms(), 0.012);
  EXPECT_LT(error.most, 0.035);
}

TEST(AreaLobe, OtherStartsFindTheSameMaps) {
  for (const int column : {4, 10, kLobeRoughnesses - 1})
    for (const int row : {0, 7, 15}) {
      const float least = std::sqrt(kLeastRoughness);
      const float root = least + (1 - least) * float(column) / float(kLobeRoughnesses - 1), roughness = root * root;
      const float angle = float(row) / float(kLobeAngles - 1);
      const AreaLobe entry = forViewer(lobeTable()[size_t(row) * kLobeRoughnesses + size_t(column)], 1 - angle * angle);
      const FittedLobe again =
          fitLobe(roughness * roughness, 1 - angle * angle, 1, entry.white * vec4(0.9f, 1.1f, 1.1f, 1.2f));
      EXPECT_LT(glm::length(again.map - entry.white), 0.03f) << column << ' ' << row;
      EXPECT_FLOAT_EQ(again.share, entry.share.x);
    }
  for (const AreaLobe& lobe : lobeTable())
    for (const vec4& m : {lobe.white, lobe.schlick}) EXPECT_GT(m.x * m.w - m.y * m.z, 0);
}

TEST(AreaLobe, PiecesFarAndNearAgree) {
  // Its parts count as points, or the whole does; a strip is long though its area is small.
  const Receiver r = seenFrom(0.5f, 0.35f, 1);
  for (const vec3& side : {vec3(0, 0.12f, 0), vec3(0, 1.2f, 0)}) {
    const vec3 corner(-1.5f, -0.3f, 0.8f), other(0.012f / side.y, 0, 0.012f / side.y);
    const double whole = double(lobeRadiance(lobeTable(), quadPiece(corner, side, other, true), vec3(0), r).x);
    double parts = 0;
    for (int i = 0; i < 1024; ++i)
      parts += double(lobeRadiance(lobeTable(),
                                   quadPiece(corner + side * (float(i % 32) / 32) + other * (float(i / 32) / 32),
                                             side / 32.0f, other / 32.0f, true),
                                   vec3(0), r)
                          .x);
    EXPECT_NEAR(whole, parts, 0.01 * parts) << side.y;
  }
}

TEST(AreaLobe, OnlyFrontsShineUnlessBothSidesDo) {
  const Receiver r = seenFrom(0.7f, 0.5f, 1);
  const vec3 corner(-1, -1, 1), e1(0, 2, 0), e2(2, 0, 0); // faces down
  EXPECT_GT(lobeRadiance(lobeTable(), quadPiece(corner, e1, e2), vec3(0), r).x, 0.1f);
  EXPECT_EQ(lobeRadiance(lobeTable(), quadPiece(corner, e2, e1), vec3(0), r).x, 0);
  EXPECT_FLOAT_EQ(lobeRadiance(lobeTable(), quadPiece(corner, e2, e1, true), vec3(0), r).x,
                  lobeRadiance(lobeTable(), quadPiece(corner, e1, e2), vec3(0), r).x);
  for (AreaPiece piece : rectangles()) {
    const float both = lobeRadiance(lobeTable(), piece, vec3(0), r).x;
    const bool inFront = glm::dot(vec3(piece.normalArea), vec3(piece.corners[0])) < 0;
    piece.radianceSides.w = 0;
    EXPECT_EQ(lobeRadiance(lobeTable(), piece, vec3(0), r).x, inFront ? both : 0);
  }
}

} // namespace lambent::test::area_lobe_test

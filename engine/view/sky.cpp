// Preetham, Shirley, Smits 1999: coefficients are their tables 2 (Perez) and 1 (zenith), fitted for turbidities from 2
// to 6 or so. Ours: the elevation stays at the horizon once the sun is below, with less and less light.
#include "engine/view/sky.h"

#include "engine/core/sampling.h"
#include "shaders/shared/octahedral.h"
#include "shaders/shared/sky.h"

#include <array>
#include <cmath>
#include <optional>

namespace lambent {

namespace {

constexpr int kRows = 32, kColumns = 32;     // of the tables: rows of equal height from +Y down, columns around +Y
constexpr float kPerKilocandela = kPi / 100; // see Sky
constexpr float kGroundAlbedo = 0.2f;

float degrees(float radians) { return radians * (180 / kPi); }
float elevationOf(const vec3& towardsSun) { return std::asin(glm::clamp(towardsSun.y, -1.0f, 1.0f)); }
float limited(float turbidity) { return glm::clamp(turbidity, 2.0f, 10.0f); }

/// Direction at row and column of a table, in fractions of the whole.
vec3 tableDirection(float row, float column) {
  const float y = 1 - 2 * row, r = std::sqrt(glm::max(0.0f, 1 - y * y)), phi = 2 * kPi * column;
  return {r * std::cos(phi), y, r * std::sin(phi)};
}
int cellOf(float place, int count) { return glm::clamp(int(place * float(count)), 0, count - 1); }

/// Chooses a cell by its weight, and a direction uniformly within it.
class Table {
 public:
  using Weights = std::array<std::array<float, kColumns>, kRows>;

  explicit Table(const Weights& weights) {
    std::array<float, kRows> sums{};
    for (int row = 0; row < kRows; ++row) {
      columns_[row] = Distribution(weights[row]);
      sums[row] = float(columns_[row].total());
    }
    rows_ = Distribution(sums);
  }
  double total() const { return rows_.total(); }
  vec3 sample(vec2 u) const {
    const auto [row, withinRow] = rows_.choose(u.x);
    const auto [column, withinColumn] = columns_[row].choose(u.y);
    return tableDirection((float(row) + withinRow) / kRows, (float(column) + withinColumn) / kColumns);
  }
  float pdf(const vec3& direction) const {
    const float turn = std::atan2(direction.z, direction.x) / (2 * kPi);
    const int row = cellOf(0.5f - 0.5f * direction.y, kRows), column = cellOf(turn < 0 ? turn + 1 : turn, kColumns);
    return rows_.probability(row) * columns_[row].probability(column) / kCell;
  }

  static constexpr float kCell = 4 * kPi / (kRows * kColumns); // steradians

 private:
  Distribution rows_;
  std::array<Distribution, kRows> columns_;
};

/// Along each side of an octahedral map of normals with +Y at its centre: floors get a table of their own.
constexpr int kNormals = 9;
int normalCell(const vec3& normal) {
  const vec2 place = octahedralFromUnit({normal.x, normal.z, normal.y}) * 0.5f + 0.5f;
  return cellOf(place.y, kNormals) * kNormals + cellOf(place.x, kNormals);
}

DaylightModel makeModel(const vec3& towardsSun, float turbidity) {
  const float t = turbidity, elevation = elevationOf(towardsSun);
  DaylightModel m;
  const vec2 across(towardsSun.x, towardsSun.z);
  const float length = glm::length(across);
  m.towardsSun = towardsSun.y >= 0 ? towardsSun
                 : length > 0      ? vec3(towardsSun.x, 0, towardsSun.z) / length
                                   : vec3(0, 0, 1);
  m.a = {-0.0193f * t - 0.2592f, -0.0167f * t - 0.2608f, 0.1787f * t - 1.4630f};
  m.b = {-0.0665f * t + 0.0008f, -0.0950f * t + 0.0092f, -0.3554f * t + 0.4275f};
  m.c = {-0.0004f * t + 0.2125f, -0.0079f * t + 0.2102f, -0.0227f * t + 5.3251f};
  m.d = {-0.0641f * t - 0.8989f, -0.0441f * t - 1.6537f, 0.1206f * t - 2.5771f};
  m.e = {-0.0033f * t + 0.0452f, -0.0109f * t + 0.0529f, -0.0670f * t + 0.3703f};

  const float s = std::acos(glm::clamp(m.towardsSun.y, 0.0f, 1.0f)); // from the zenith
  const vec4 powers(s * s * s, s * s, s, 1);
  const vec3 turbidities(t * t, t, 1);
  const auto chromaticity = [&](const vec4& square, const vec4& linear, const vec4& constant) {
    return glm::dot(turbidities, vec3(glm::dot(square, powers), glm::dot(linear, powers), glm::dot(constant, powers)));
  };
  const float x = chromaticity({0.00166f, -0.00375f, 0.00209f, 0}, {-0.02903f, 0.06377f, -0.03202f, 0.00394f},
                               {0.11693f, -0.21196f, 0.06052f, 0.25886f});
  const float y = chromaticity({0.00275f, -0.00610f, 0.00317f, 0}, {-0.04214f, 0.08970f, -0.04153f, 0.00516f},
                               {0.15346f, -0.26756f, 0.06670f, 0.26688f});
  const float chi = (4.0f / 9 - t / 120) * (kPi - 2 * s);
  const float kilocandelas = (4.0453f * t - 4.9710f) * std::tan(chi) - 0.2155f * t + 2.4192f;
  const float dusk = elevation < 0 ? std::pow(10.0f, glm::max(degrees(elevation), -18.0f) / 3) : 1.0f;
  m.zenith = vec3(x, y, kilocandelas * kPerKilocandela * dusk) / perez(m, 1, m.towardsSun.y);
  m.ground = vec3(0);
  return m;
}

} // namespace

struct Sky::Daylight {
  vec3 towardsSun;
  float turbidity;
  DaylightModel model;
  vec3 irradiance{0};
  std::optional<Table> all;
  std::vector<Table> facing; // by the cell of the normal

  Daylight(const vec3& direction, float t) : towardsSun(direction), turbidity(t), model(makeModel(direction, t)) {
    constexpr int kTurns = 3; // places of a cell: 3×3
    Table::Weights luminances{};
    glm::dvec3 sum(0);
    for (int row = 0; row < kRows / 2; ++row)
      for (int column = 0; column < kColumns; ++column)
        for (int i = 0; i < kTurns * kTurns; ++i) {
          const vec2 within = (vec2(i / kTurns, i % kTurns) + 0.5f) / float(kTurns);
          const vec3 d = tableDirection((float(row) + within.x) / kRows, (float(column) + within.y) / kColumns);
          const vec3 part = daylightRadiance(model, d) * (Table::kCell / (kTurns * kTurns));
          sum += glm::dvec3(part * d.y);
          luminances[row][column] += luminance(part);
        }
    irradiance = vec3(sum);
    const vec3 sun = daylightSun(towardsSun, turbidity) * glm::max(towardsSun.y, 0.0f);
    model.ground = (irradiance + sun) * (kGroundAlbedo / kPi);
    for (int row = kRows / 2; row < kRows; ++row) luminances[row].fill(luminance(model.ground) * Table::kCell);
    all.emplace(luminances);

    for (int i = 0; i < kNormals * kNormals; ++i) {
      const vec3 n = unitFromOctahedral((vec2(i % kNormals, i / kNormals) + 0.5f) * (2.0f / kNormals) - 1.0f);
      const vec3 normal(n.x, n.z, n.y);
      Table::Weights weights = luminances;
      for (int row = 0; row < kRows; ++row)
        for (int column = 0; column < kColumns; ++column) {
          const vec3 d = tableDirection((float(row) + 0.5f) / kRows, (float(column) + 0.5f) / kColumns);
          weights[row][column] *= glm::max(0.0f, glm::dot(d, normal));
        }
      facing.emplace_back(weights);
    }
  }
};

Sky Sky::daylight(const vec3& towardsSun, float turbidity) {
  Sky sky;
  sky.daylight_ = std::make_shared<const Daylight>(towardsSun, limited(turbidity));
  return sky;
}

vec3 Sky::radiance(const vec3& direction) const {
  return daylight_ ? daylightRadiance(daylight_->model, direction) : constantRadiance_;
}

float Sky::meanLuminance() const {
  return daylight_ ? float(daylight_->all->total()) / (4 * kPi) : luminance(constantRadiance_);
}

vec3 Sky::irradiance() const { return daylight_ ? daylight_->irradiance : kPi * constantRadiance_; }

SkySample Sky::sample(vec2 u) const {
  const vec3 d = daylight_ ? daylight_->all->sample(u) : sampleSphere(u);
  return {d, radiance(d), pdf(d)};
}

float Sky::pdf(const vec3& direction) const { return daylight_ ? daylight_->all->pdf(direction) : 1 / (4 * kPi); }

SkySample Sky::sampleFacing(const vec3& normal, vec2 u) const {
  const vec3 d = daylight_ ? daylight_->facing[normalCell(normal)].sample(u) : sampleCosineHemisphere(normal, u);
  return {d, radiance(d), pdfFacing(normal, d)};
}

float Sky::pdfFacing(const vec3& normal, const vec3& direction) const {
  return daylight_ ? daylight_->facing[normalCell(normal)].pdf(direction)
                   : pdfCosineHemisphere(glm::dot(normal, direction));
}

const DaylightModel* Sky::model() const { return daylight_ ? &daylight_->model : nullptr; }

std::vector<float> Sky::numbers() const {
  if (!daylight_) return {constantRadiance_.x, constantRadiance_.y, constantRadiance_.z};
  const vec3& d = daylight_->towardsSun;
  return {d.x, d.y, d.z, daylight_->turbidity};
}

vec3 daylightSun(const vec3& towardsSun, float turbidity) {
  const float elevation = elevationOf(towardsSun), t = limited(turbidity);
  if (elevation < 0) return vec3(0);
  constexpr float kAboveTheAir = 128 * kPerKilocandela; // of 128 klx
  const vec3 micrometres(0.61f, 0.55f, 0.465f);         // about where Rec.709's primaries are
  // Relative mass of the air along the ray (Kasten), as the paper has it; it bends around the horizon.
  const float mass = 1 / (std::sin(elevation) + 0.15f * std::pow(3.885f + degrees(elevation), -1.253f));
  const float haze = 0.04608f * t - 0.04586f; // Ångström's coefficient
  vec3 light;
  for (int c = 0; c < 3; ++c)
    light[c] =
        kAboveTheAir *
        std::exp(-mass * (0.008735f * std::pow(micrometres[c], -4.08f) + haze * std::pow(micrometres[c], -1.3f)));
  return light;
}

} // namespace lambent

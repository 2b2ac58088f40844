// Preetham, Shirley, Smits 1999: coefficients are their tables 2 (Perez) and 1 (zenith), fitted for turbidities from 2
// to 6 or so. Ours: the elevation stays at the horizon once the sun is below, with less and less light.
#include "engine/view/sky.h"

#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/core/parallel.h"
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
/// Row and column of a direction, as tableDirection takes them; the column in [0, 1).
vec2 tablePlace(const vec3& direction) {
  const float turn = std::atan2(direction.z, direction.x) / (2 * kPi);
  return {glm::clamp(0.5f - 0.5f * direction.y, 0.0f, 1.0f), turn < 0 ? glm::min(turn + 1, 0x1.fffffep-1f) : turn};
}
int cellOf(float place, int count) { return glm::clamp(int(place * float(count)), 0, count - 1); }

/// What is even within each of the cells, finer: luminances of kParts × kParts parts of equal solid angle.
constexpr int kParts = 16;
class Parts {
 public:
  explicit Parts(std::span<const float> luminances) : parts_(luminances) {}
  /// Where in the cell; both in [0, 1).
  vec2 sample(vec2 within) const {
    const auto [part, rest] = parts_.choose(within.x);
    return (vec2(part / kParts, part % kParts) + vec2(rest, within.y)) / float(kParts);
  }
  /// Density over that of an even cell.
  float density(vec2 within) const {
    return parts_.probability(uint32_t(cellOf(within.x, kParts) * kParts + cellOf(within.y, kParts))) * kParts * kParts;
  }

 private:
  Distribution parts_;
};
using PartsOfCells = std::vector<Parts>; // row by row; empty: cells are even

/// Chooses a cell by its weight, and a direction within it.
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
  bool empty() const { return rows_.empty(); }
  double total() const { return rows_.total(); }
  vec3 sample(vec2 u, const PartsOfCells& parts) const {
    const auto [row, withinRow] = rows_.choose(u.x);
    const auto [column, withinColumn] = columns_[row].choose(u.y);
    vec2 within(withinRow, withinColumn);
    if (!parts.empty()) within = parts[row * kColumns + column].sample(within);
    return tableDirection((float(row) + within.x) / kRows, (float(column) + within.y) / kColumns);
  }
  float pdf(const vec3& direction, const PartsOfCells& parts) const {
    const vec2 place = tablePlace(direction) * vec2(kRows, kColumns);
    const int row = glm::min(int(place.x), kRows - 1), column = glm::min(int(place.y), kColumns - 1);
    const float even = rows_.probability(row) * columns_[row].probability(column) / kCell;
    return parts.empty() || !(even > 0)
               ? even
               : even * parts[size_t(row * kColumns + column)].density(place - vec2(row, column));
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

/// Luminance times solid angle of the cells, and the same facing each of the normals.
struct Sky::Varying {
  vec3 irradiance{0}, below{0};
  std::optional<Table> all;
  std::vector<Table> facing; // by the cell of the normal
  PartsOfCells parts;
  struct Daylight {
    vec3 towardsSun;
    float turbidity;
    DaylightModel model;
  };
  std::optional<Daylight> daylight;
  Picture picture;
  std::vector<float> numbers;

  void choose(const Table::Weights& luminances) {
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
  turbidity = limited(turbidity);
  auto made = std::make_shared<Varying>();
  DaylightModel& model =
      made->daylight.emplace(Varying::Daylight{towardsSun, turbidity, makeModel(towardsSun, turbidity)}).model;
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
  made->irradiance = vec3(sum);
  const vec3 sun = daylightSun(towardsSun, turbidity) * glm::max(towardsSun.y, 0.0f);
  model.ground = (made->irradiance + sun) * (kGroundAlbedo / kPi);
  made->below = kPi * model.ground;
  for (int row = kRows / 2; row < kRows; ++row) luminances[row].fill(luminance(model.ground) * Table::kCell);
  made->choose(luminances);
  made->numbers = {towardsSun.x, towardsSun.y, towardsSun.z, turbidity};
  Sky sky;
  sky.varying_ = std::move(made);
  return sky;
}

Sky Sky::image(std::shared_ptr<const SkyImage> image, float scale, float turn) {
  CHECK(image && image->width > 0 && image->height > 0);
  CHECK_EQ(image->texels.size(), size_t(image->width) * size_t(image->height));
  auto made = std::make_shared<Varying>();
  made->picture = {std::move(image), scale, turn};
  const SkyImage& pixels = *made->picture.image;
  Hash digest(1);
  digest.values(pixels.texels);
  made->numbers = {float(pixels.width), float(pixels.height), scale, turn};
  for (int i = 0; i < 4; ++i) made->numbers.push_back(float(digest.result() >> (16 * i) & 0xffff));
  Sky sky;
  sky.varying_ = made;

  // Twice as many places along each side of a part as the picture has texels there, up to 8: as many as it has where it
  // is 4096 wide.
  const int turns = glm::clamp(2 * ((pixels.width + kColumns * kParts - 1) / (kColumns * kParts)), 2, 8);
  Table::Weights luminances{};
  std::array<glm::dvec3, kRows> sums{}; // a row is above the horizon or below it
  std::vector<std::vector<float>> parts(size_t(kRows) * kColumns, std::vector<float>(size_t(kParts) * kParts));
  parallelFor(kRows, 1, [&](size_t first, size_t last) {
    for (size_t row = first; row < last; ++row)
      for (size_t column = 0; column < kColumns; ++column) {
        std::vector<float>& here = parts[row * kColumns + column];
        for (int i = 0; i < kParts * kParts; ++i)
          for (int j = 0; j < turns * turns; ++j) {
            const vec2 within =
                (vec2(i / kParts, i % kParts) + (vec2(j / turns, j % turns) + 0.5f) / float(turns)) / float(kParts);
            const vec3 d = tableDirection((float(row) + within.x) / kRows, (float(column) + within.y) / kColumns);
            const vec3 part = sky.radiance(d) * (Table::kCell / float(kParts * kParts * turns * turns));
            sums[row] += glm::dvec3(part * glm::abs(d.y));
            here[size_t(i)] += luminance(part);
          }
        for (const float part : here) luminances[row][column] += part;
        // A part that seemed dark is drawn now and then, for light between the places.
        const float little = luminances[row][column] > 0 ? 0.02f * luminances[row][column] / (kParts * kParts) : 1;
        for (float& part : here) part += little;
      }
  });
  glm::dvec3 above(0), below(0);
  for (int row = 0; row < kRows; ++row) (row < kRows / 2 ? above : below) += sums[size_t(row)];
  for (const std::vector<float>& cell : parts) made->parts.emplace_back(cell);
  if (!(Table(luminances).total() > 0)) return {};
  made->irradiance = vec3(above);
  made->below = vec3(below);
  made->choose(luminances);
  return sky;
}

namespace {

vec3 radianceOf(const Sky::Picture& picture, const vec3& direction) {
  const SkyImage& image = *picture.image;
  const vec2 place = skyImagePlace(direction, picture.turn) * vec2(image.width, image.height) - 0.5f;
  const vec2 low = glm::floor(place), part = place - low;
  const auto at = [&](int x, int y) -> const vec3& {
    x = (x % image.width + image.width) % image.width;
    return image.texels[size_t(glm::clamp(y, 0, image.height - 1)) * size_t(image.width) + size_t(x)];
  };
  const int x = int(low.x), y = int(low.y);
  return picture.scale *
         glm::mix(glm::mix(at(x, y), at(x + 1, y), part.x), glm::mix(at(x, y + 1), at(x + 1, y + 1), part.x), part.y);
}

} // namespace

vec3 Sky::radiance(const vec3& direction) const {
  if (!varying_) return constantRadiance_;
  return varying_->daylight ? daylightRadiance(varying_->daylight->model, direction)
                            : radianceOf(varying_->picture, direction);
}

float Sky::meanLuminance() const {
  return varying_ ? float(varying_->all->total()) / (4 * kPi) : luminance(constantRadiance_);
}

vec3 Sky::irradiance() const { return varying_ ? varying_->irradiance : kPi * constantRadiance_; }
vec3 Sky::irradianceBelow() const { return varying_ ? varying_->below : kPi * constantRadiance_; }

SkySample Sky::sample(vec2 u) const {
  const vec3 d = varying_ ? varying_->all->sample(u, varying_->parts) : sampleSphere(u);
  return {d, radiance(d), pdf(d)};
}

float Sky::pdf(const vec3& direction) const {
  return varying_ ? varying_->all->pdf(direction, varying_->parts) : 1 / (4 * kPi);
}

SkySample Sky::sampleFacing(const vec3& normal, vec2 u) const {
  if (!varying_) {
    const vec3 d = sampleCosineHemisphere(normal, u);
    return {d, radiance(d), pdfFacing(normal, d)};
  }
  const Table& table = varying_->facing[size_t(normalCell(normal))];
  if (table.empty()) return {}; // all is dark on that side
  const vec3 d = table.sample(u, varying_->parts);
  return {d, radiance(d), pdfFacing(normal, d)};
}

float Sky::pdfFacing(const vec3& normal, const vec3& direction) const {
  return varying_ ? varying_->facing[size_t(normalCell(normal))].pdf(direction, varying_->parts)
                  : pdfCosineHemisphere(glm::dot(normal, direction));
}

const DaylightModel* Sky::model() const {
  return varying_ && varying_->daylight ? &varying_->daylight->model : nullptr;
}

const Sky::Picture& Sky::picture() const {
  static const Picture none;
  return varying_ ? varying_->picture : none;
}

std::vector<float> Sky::numbers() const {
  if (!varying_) return {constantRadiance_.x, constantRadiance_.y, constantRadiance_.z};
  return varying_->numbers;
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

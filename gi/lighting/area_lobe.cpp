// Heitz, Dupuy, Hill and Neubelt 2016, "Real-time polygonal-light shading with linearly transformed cosines",
// section 3. Unlike there, the middle of the matrix is 1, so that its entries stay bounded and smooth up to grazing
// views, and what the map leaves below the surface is made up for above it.
#include "gi/lighting/area_lobe.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lambent {

namespace {

constexpr int kUnknowns = 5;           // the map's four and a factor
constexpr int kHalves = 18, kLow = 12; // directions per axis
constexpr float kLeastCos = 0.01f;     // of viewers
using Unknowns = std::array<double, kUnknowns>;

/// A direction of the quadrature with y ≥ 0 in the receiver's frame; the other half is its mirror image.
struct Direction {
  glm::dvec3 towardsLight;
  double weight;         // sr
  double lobe;           // times cosine
  double importance = 0; // of a squared error
};

/// All above the surface: some spread as reflections by the lobe's own normals, some over all the sky and denser
/// towards the horizon, weighted by the sum of both densities (Veach's balance heuristic).
std::vector<Direction> directionsFor(float alpha, float cosViewer, float f0) {
  const Receiver viewed = {.normal = vec3(0, 0, 1),
                           .towardsViewer = vec3(std::sqrt(1 - cosViewer * cosViewer), 0, cosViewer),
                           .specular = vec3(f0),
                           .grazing = vec3(1 - f0),
                           .diffuse = vec3(0),
                           .cosViewer = cosViewer,
                           .alpha2 = alpha * alpha};
  const glm::dvec3 viewer(viewed.towardsViewer);
  const double alpha2 = double(viewed.alpha2);
  std::vector<Direction> directions;
  const auto add = [&](const glm::dvec3& light) {
    if (light.z <= 0) return;
    const glm::dvec3 half = glm::normalize(light + viewer);
    const double cos2 = half.z * half.z, sin2 = half.x * half.x + half.y * half.y;
    const double s2 = alpha2 * cos2 / (sin2 + alpha2 * cos2);
    const double reflected = double(ggxDensity(viewed.alpha2, float(sin2), float(cos2))) * half.z /
                             (4 * glm::dot(viewer, half) * 2 * std::sqrt(s2));
    const double low = 1 / (4 * double(kPi) * std::sqrt(light.z));
    const double density = kHalves * kHalves * reflected + kLow * kLow * low;
    directions.push_back({light, 1 / density, double(glossyReflectance(viewed, vec3(light), 0).x) * light.z});
  };
  for (int i = 0; i < kHalves; ++i)
    for (int j = 0; j < kHalves; ++j) {
      // 1 − s² of the normals stand steeper: with s even, their tails are not cut off.
      const double s = (i + 0.5) / kHalves, azimuth = double(kPi) * (j + 0.5) / kHalves;
      const double tangent = double(alpha) * std::sqrt(1 - s * s) / s;
      const double cosine = 1 / std::sqrt(1 + tangent * tangent), sine = tangent * cosine;
      const glm::dvec3 half(sine * std::cos(azimuth), sine * std::sin(azimuth), cosine);
      if (glm::dot(viewer, half) > 0) add(2 * glm::dot(viewer, half) * half - viewer);
    }
  for (int i = 0; i < kLow; ++i)
    for (int j = 0; j < kLow; ++j) {
      const double u = (i + 0.5) / kLow, cosine = u * u, sine = std::sqrt(1 - cosine * cosine);
      const double azimuth = double(kPi) * (j + 0.5) / kLow;
      add({sine * std::cos(azimuth), sine * std::sin(azimuth), cosine});
    }
  return directions;
}

/// The mapped cosine, 1/sr; `gradient`, if any, by the unknowns.
double mappedCosine(const Unknowns& p, const glm::dvec3& d, Unknowns* gradient) {
  const double vx = p[0] * d.x + p[1] * d.z, vz = p[2] * d.x + p[3] * d.z;
  if (gradient) gradient->fill(0);
  if (vz <= 0) return 0;
  const double determinant = p[0] * p[3] - p[1] * p[2], length2 = vx * vx + d.y * d.y + vz * vz;
  const double unit = p[4] / (double(kPi) * length2 * length2), value = unit * determinant * vz;
  if (gradient) {
    const double q = 4 * value / length2, up = unit * vz, det = unit * determinant;
    *gradient = {up * p[3] - q * vx * d.x, -up * p[2] - q * vx * d.z, -up * p[1] + (det - q * vz) * d.x,
                 up * p[0] + (det - q * vz) * d.z, value / p[4]};
  }
  return value;
}

/// Sum of squared errors above, and of what lies below at the mirror images of the directions.
struct Errors {
  double sum = 0;
  std::array<Unknowns, kUnknowns> curvature{};
  Unknowns slope{};
};

Errors errorsOf(const Unknowns& p, const std::vector<Direction>& directions, bool derive) {
  Errors errors;
  Unknowns gradient;
  for (const Direction& d : directions)
    for (const double side : {1.0, -1.0}) {
      const glm::dvec3 direction(d.towardsLight.x, d.towardsLight.y, side * d.towardsLight.z);
      const double error = (side > 0 ? d.lobe : 0) - mappedCosine(p, direction, derive ? &gradient : nullptr);
      errors.sum += d.importance * error * error;
      if (!derive) continue;
      for (int i = 0; i < kUnknowns; ++i) {
        errors.slope[size_t(i)] += d.importance * gradient[size_t(i)] * error;
        for (int j = 0; j < kUnknowns; ++j)
          errors.curvature[size_t(i)][size_t(j)] += d.importance * gradient[size_t(i)] * gradient[size_t(j)];
      }
    }
  return errors;
}

/// Solves (curvature + damping · its diagonal) step = slope; symmetric and positive, so no pivots.
Unknowns stepOf(Errors e, double damping) {
  for (size_t i = 0; i < kUnknowns; ++i) e.curvature[i][i] = e.curvature[i][i] * (1 + damping) + 1e-12;
  for (size_t i = 0; i < kUnknowns; ++i)
    for (size_t row = 0; row < kUnknowns; ++row) {
      if (row == i) continue;
      const double factor = e.curvature[row][i] / e.curvature[i][i];
      for (size_t k = i; k < kUnknowns; ++k) e.curvature[row][k] -= factor * e.curvature[i][k];
      e.slope[row] -= factor * e.slope[i];
    }
  for (size_t i = 0; i < kUnknowns; ++i) e.slope[i] /= e.curvature[i][i];
  return e.slope;
}

} // namespace

FittedLobe fitLobe(float alpha, float cosViewer, float f0, const vec4& start) {
  std::vector<Direction> directions = directionsFor(alpha, cosViewer, f0);
  double all = 0, peak = 0;
  for (const Direction& d : directions) {
    all += d.weight * d.lobe;
    peak = std::max(peak, d.lobe);
  }
  // Squared errors alone leave the far sides of a sharp lobe to chance, relative ones give up the peak of a broad lobe.
  const double relative = 1.2 - 0.3 * std::clamp((double(alpha) - 0.1) / 0.2, 0.0, 1.0);
  for (Direction& d : directions) d.importance = d.weight / std::pow(d.lobe + 1e-3 * peak, relative);
  Unknowns p{double(start.x), double(start.y), double(start.z), double(start.w), all};
  Errors errors = errorsOf(p, directions, true);
  double damping = 1e-3;
  for (int tries = 0; tries < 60; ++tries) {
    const Unknowns step = stepOf(errors, damping);
    Unknowns next;
    for (size_t i = 0; i < kUnknowns; ++i) next[i] = p[i] + step[i];
    const bool valid = next[0] * next[3] > next[1] * next[2] && next[4] > 0;
    const double sum = valid ? errorsOf(next, directions, false).sum : errors.sum;
    if (sum >= errors.sum) {
      damping *= 8;
      if (damping > 1e6) break;
      continue;
    }
    const bool settled = sum > (1 - 1e-3) * errors.sum;
    p = next;
    damping *= 0.1;
    if (settled) break;
    errors = errorsOf(p, directions, true);
  }
  return {vec4(p[0], p[1], p[2], p[3]), float(all), errors.sum};
}

namespace {

/// The map that a very sharp lobe tends to: the mirrored direction becomes the axis, towards and from the viewer
/// normals turn directions twice as far, and across that less by the viewer's cosine.
vec4 sharpMap(float alpha, float cosViewer) {
  const float sine = std::sqrt(1 - cosViewer * cosViewer);
  return cosViewer * vec4(cosViewer, sine, -2 * alpha * sine, 2 * alpha * cosViewer);
}

/// From the neighbour's map, or where that does not reach, from a sharp lobe's.
FittedLobe fitted(float alpha, float cosViewer, float f0, const vec4& neighbour) {
  const FittedLobe one = fitLobe(alpha, cosViewer, f0, neighbour),
                   other = fitLobe(alpha, cosViewer, f0, sharpMap(alpha, cosViewer));
  return other.error < one.error ? other : one;
}

} // namespace

const std::vector<AreaLobe>& lobeTable() {
  static const std::vector<AreaLobe> table = [] {
    std::vector<AreaLobe> made(size_t(kLobeRoughnesses) * kLobeAngles);
    for (int column = 0; column < kLobeRoughnesses; ++column) {
      const float least = std::sqrt(kLeastRoughness);
      const float root = least + (1 - least) * float(column) / float(kLobeRoughnesses - 1),
                  alpha = root * root * root * root;
      // From the view along the normal outwards, each from the last.
      FittedLobe white{.map = vec4(1, 0, 0, std::min(2 * alpha, 1.0f))}, schlick = white;
      for (int row = 0; row < kLobeAngles; ++row) {
        const float angle = float(row) / float(kLobeAngles - 1), cosine = std::max(1 - angle * angle, kLeastCos);
        white = fitted(alpha, cosine, 1, white.map);
        schlick = fitted(alpha, cosine, 0, schlick.map);
        made[size_t(row) * kLobeRoughnesses + size_t(column)] = {
            turnedMap(white.map, cosine, 1), turnedMap(schlick.map, cosine, 1), vec4(white.share, schlick.share, 0, 0)};
      }
    }
    return made;
  }();
  return table;
}

AreaLobe lobeAt(const std::vector<AreaLobe>& table, const vec2& place) {
  const vec2 size(kLobeRoughnesses, kLobeAngles), at = glm::clamp(place * size - 0.5f, vec2(0), size - 1.0f);
  const glm::ivec2 lo = glm::min(glm::ivec2(at), glm::ivec2(size) - 2);
  const vec2 part = at - vec2(lo);
  AreaLobe sum{vec4(0), vec4(0), vec4(0)};
  for (int dy = 0; dy < 2; ++dy)
    for (int dx = 0; dx < 2; ++dx) {
      const AreaLobe& entry = table[size_t(lo.y + dy) * kLobeRoughnesses + size_t(lo.x + dx)];
      const float weight = (dx ? part.x : 1 - part.x) * (dy ? part.y : 1 - part.y);
      sum.white += weight * entry.white;
      sum.schlick += weight * entry.schlick;
      sum.share += weight * entry.share;
    }
  return sum;
}

vec3 lobeRadiance(const std::vector<AreaLobe>& table, const AreaPiece& piece, const vec3& position,
                  const Receiver& receiver) {
  const AreaLobe lobe = forViewer(lobeAt(table, lobePlace(receiver.alpha2, receiver.cosViewer)), receiver.cosViewer);
  vec3 x, y;
  lobeFrame(receiver, x, y);
  return vec3(piece.radianceSides) * lobeReflection(piece, position, receiver, lobe, x, y);
}

} // namespace lambent

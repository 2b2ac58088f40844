#include "gi/lighting/photons.h"

#include "engine/core/error.h"
#include "engine/core/rng.h"
#include "shaders/shared/paraboloid.h"
#include "shaders/shared/vpl_light.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

/// Integral over the cosine of a spot's falloff ((c − outer)/width)², clamped to [0, 1]: a ramp, then a plateau.
struct SpotProfile {
  float outer, rampEnd, ramp, plateau; // the last two are the integrals

  explicit SpotProfile(const LightView& light) {
    const float width = glm::max(0.001f, light.innerConeCos - light.outerConeCos); // as glTF's formula bounds it
    outer = light.outerConeCos;
    rampEnd = glm::min(1.0f, outer + width);
    ramp = (rampEnd - outer) * (rampEnd - outer) * (rampEnd - outer) / (3 * width * width);
    plateau = 1 - rampEnd;
  }
  float integral() const { return ramp + plateau; }
  /// Cosine with density falloff/integral.
  float sample(float u) const {
    const float at = u * integral();
    if (at < ramp) return outer + (rampEnd - outer) * std::cbrt(at / ramp);
    return glm::min(1.0f, rampEnd + (at - ramp));
  }
};

vec3 aroundAxis(const vec3& axis, float cosine, float u) {
  vec3 t, b;
  basisAround(axis, t, b);
  const float sine = std::sqrt(glm::max(0.0f, 1 - cosine * cosine)), phi = 2 * kPi * u;
  return glm::normalize(t * (sine * std::cos(phi)) + b * (sine * std::sin(phi)) + axis * cosine);
}

} // namespace

PhotonNumbers photonNumbers(uint32_t index, uint32_t seed) {
  // Steps of the recurrence: golden ratio for the light, √3 and √7 for the position, Roberts' R2 for the direction. For
  // runs of 43, 128 and 512 points each of these pairs has an L2 discrepancy of at most 0.41, 0.31 and 0.25 of random
  // points'; Roberts' own sequence in five dimensions has 0.43 where it matters most, in direction, at 43.
  constexpr double kGolden = 0.6180339887498949, kRoot3 = 0.7320508075688772, kRoot7 = 0.6457513110645906;
  constexpr double kR2a = 0.7548776662466927, kR2b = 0.5698402909980532;
  Rng rng(seed, Stream::Photons, 0);
  const auto at = [&](double step) { // in double, so that large indices keep their fraction
    const double x = double(rng.next()) + double(index) * step;
    return glm::min(float(x - std::floor(x)), kBelowOne);
  };
  return {at(kGolden), {at(kRoot3), at(kRoot7)}, {at(kR2a), at(kR2b)}}; // braces: evaluated in this order
}

uint32_t sequenceIndex(uint32_t i, uint32_t count) {
  const uint32_t run = (count + kLightClasses - 1) / kLightClasses;
  return i % kLightClasses * run + i / kLightClasses;
}

PhotonSource::PhotonSource(const LightSet& lights, const Aabb& boundsWorld, float rayEpsilon)
    : lights_(lights), bounds_(boundsWorld), rayEpsilon_(rayEpsilon) {
  if (bounds_.empty()) return;
  std::vector<float> powers; // as luminances, W
  for (const LightView& l : lights.punctual) {
    const float strength = luminance(l.intensity);
    switch (l.type) {
    case LightType::Point:
      powers.push_back(4 * kPi * strength);
      break;
    case LightType::Spot:
      powers.push_back(2 * kPi * SpotProfile(l).integral() * strength);
      break;
    case LightType::Directional: {
      const float radius = diskRadius(l.direction);
      powers.push_back(kPi * radius * radius * strength);
      break;
    }
    }
  }
  for (const Emitter& e : lights.emitters) powers.push_back((e.doubleSided ? 2 : 1) * kPi * e.power);
  const float radius = 0.5f * bounds_.diameter();
  powers.push_back(4 * kPi * kPi * radius * radius * lights.sky.meanLuminance());
  for (float power : powers) power_ += power;
  choice_ = Distribution(powers);
}

Photon PhotonSource::emit(const PhotonNumbers& u) const {
  const auto [light, within] = choice_.choose(u.light); // within the share: chooses the triangle of a surface
  const float probability = choice_.probability(light);
  Photon photon;
  if (light < lights_.punctual.size()) {
    photon = emitPunctual(lights_.punctual[light], u);
  } else if (light < lights_.lightCount()) {
    const Emitter& emitter = lights_.emitters[light - lights_.punctual.size()];
    photon = emitSurface(emitter, within, u);
  } else {
    photon = emitSky(u);
  }
  photon.flux /= probability;
  return photon;
}

Photon PhotonSource::emitPunctual(const LightView& light, const PhotonNumbers& u) const {
  if (light.type == LightType::Directional) {
    const float radius = diskRadius(light.direction);
    Photon p = fromDisk(light.direction, radius, u.position);
    p.flux = light.intensity * (kPi * radius * radius);
    return p;
  }
  Photon p;
  p.range = light.range;
  p.ray.origin = light.position;
  if (light.type == LightType::Spot) {
    const SpotProfile profile(light);
    p.ray.direction = aroundAxis(light.direction, profile.sample(u.direction.x), u.direction.y);
    p.flux = light.intensity * (2 * kPi * profile.integral());
  } else {
    p.ray.direction = sampleSphere(u.direction);
    p.flux = light.intensity * (4 * kPi);
  }
  return p;
}

Photon PhotonSource::emitSurface(const Emitter& emitter, float uTriangle, const PhotonNumbers& u) const {
  const EmitterPoint e = sampleEmitter(lights_, emitter, {uTriangle, u.position.x, u.position.y});
  Photon p;
  if (!(e.pdfArea > 0)) return p;
  vec3 normal = e.normal;
  vec2 direction = u.direction;
  if (emitter.doubleSided) { // one half of the first number is for each side
    if (direction.x >= 0.5f) normal = -normal;
    direction.x = glm::fract(2 * direction.x);
  }
  p.ray = {offsetPoint(e.position, normal, rayEpsilon_), sampleCosineHemisphere(normal, direction)};
  p.flux = e.radiance * ((emitter.doubleSided ? 2 : 1) * kPi / e.pdfArea);
  return p;
}

Photon PhotonSource::emitSky(const PhotonNumbers& u) const {
  const float radius = 0.5f * bounds_.diameter();
  const SkySample s = lights_.sky.sample(u.direction);
  const bool constant = lights_.sky.constant(); // then any direction is as good as its opposite
  Photon p = fromDisk(constant ? s.direction : -s.direction, radius, u.position);
  p.flux = s.radiance * (constant ? 4 * kPi * kPi * radius * radius : kPi * radius * radius / s.pdf);
  return p;
}

/// From outside through a disk around the scene's centre.
Photon PhotonSource::fromDisk(const vec3& direction, float radius, vec2 u) const {
  vec3 t, b;
  basisAround(direction, t, b);
  const float r = radius * std::sqrt(u.x), phi = 2 * kPi * u.y;
  Photon p;
  p.ray.origin = bounds_.centre() + t * (r * std::cos(phi)) + b * (r * std::sin(phi)) - direction * bounds_.diameter();
  p.ray.direction = direction;
  return p;
}

/// Radius that the bounds' corners have around their centre, seen along a direction.
float PhotonSource::diskRadius(const vec3& direction) const {
  float radius2 = 0;
  const vec3 half = 0.5f * bounds_.size();
  for (int i = 0; i < 4; ++i) { // opposite corners are alike
    const vec3 corner = half * vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, 1);
    const float along = glm::dot(corner, direction);
    radius2 = glm::max(radius2, glm::dot(corner, corner) - along * along);
  }
  return std::sqrt(radius2);
}

vec3 arrivingFlux(const Photon& photon, const SurfaceHit& hit) {
  constexpr float kLargestRatio = 4;
  const vec3 towards = -photon.ray.direction;
  const float shading = glm::dot(towards, hit.normal), geometric = glm::dot(towards, hit.geometricNormal);
  if (shading <= 0 || geometric <= 0) return vec3(0);
  float share = glm::min(shading / geometric, kLargestRatio);
  if (photon.range < kInfinity) {
    const float q = hit.t / photon.range;
    share *= glm::clamp(1 - q * q * q * q, 0.0f, 1.0f);
  }
  return photon.flux * share;
}

} // namespace lambent

#include "gi/lighting/light_paths.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

/// Share of a sample drawn with density `own` when `other` could have drawn it too; none of one that could not have
/// been drawn. Ratio first: squares overflow.
float powerHeuristic(float own, float other) {
  if (!(own > 0)) return 0;
  const float ratio = other / own;
  return 1 / (1 + ratio * ratio);
}

LightConnection connectToPunctual(const LightView& light, float probability, const PathVertex& vertex,
                                  const vec3& weight, vec2 u, float rayEpsilon) {
  const PunctualSample p = punctualIrradiance(pointOfDisk(light, u), vertex.position, vertex.normal);
  if (luminance(p.irradiance) <= 0 || glm::dot(p.towards, vertex.geometricNormal) <= 0) return {};
  const vec3 origin = offsetPoint(vertex.position, vertex.geometricNormal, rayEpsilon);
  vec3 brought = weight * p.irradiance / (kPi * probability);
  if (vertex.receiver && hasDisk(light)) // its rays bring the rest
    brought *= powerHeuristic(probability * pdfOfDisk(light, p.towards), pdfOfRay(vertex, p.towards));
  return {p.distance < kInfinity ? segment(origin, light.position) : Ray{origin, p.towards}, brought};
}

LightConnection connectToEmitter(const LightSet& lights, const Emitter& emitter, float probability,
                                 const PathVertex& vertex, const vec3& weight, const vec3& u, float rayEpsilon) {
  const EmitterPoint e = sampleEmitter(lights, emitter, u);
  const vec3 d = e.position - vertex.position;
  const float r2 = glm::dot(d, d);
  if (!(r2 > 0)) return {};
  const vec3 towards = d / std::sqrt(r2);
  const float cosReceiver = glm::dot(towards, vertex.normal);
  float cosEmitter = -glm::dot(towards, e.normal);
  if (emitter.doubleSided) cosEmitter = std::abs(cosEmitter);
  if (cosReceiver <= 0 || cosEmitter <= 0 || glm::dot(towards, vertex.geometricNormal) <= 0) return {};
  const float pdfLight = probability * e.pdfArea * r2 / cosEmitter; // per steradian
  const float mis = powerHeuristic(pdfLight, pdfOfRay(vertex, towards));
  const vec3 emitterSide = -glm::dot(towards, e.normal) > 0 ? e.normal : -e.normal;
  return {segment(offsetPoint(vertex.position, vertex.geometricNormal, rayEpsilon),
                  offsetPoint(e.position, emitterSide, rayEpsilon)),
          weight * e.radiance * (cosReceiver * mis / (kPi * pdfLight))};
}

} // namespace

float pdfOfRay(const PathVertex& vertex, const vec3& direction) {
  return vertex.receiver ? pdfReflection(*vertex.receiver, direction)
                         : pdfCosineHemisphere(glm::dot(direction, vertex.normal));
}

LightConnection connectToLight(const LightSet& lights, const PathVertex& vertex, const vec3& weight, float uLight,
                               const vec3& uPoint, float rayEpsilon) {
  const auto [light, probability] = LightChoice(lights, vertex.position, vertex.normal).sample(uLight);
  if (light == kNone) return {};
  if (light < lights.punctual.size())
    return connectToPunctual(lights.punctual[light], probability, vertex, weight, {uPoint.y, uPoint.z}, rayEpsilon);
  return connectToEmitter(lights, lights.emitters[light - lights.punctual.size()], probability, vertex, weight, uPoint,
                          rayEpsilon);
}

LightConnection connectToSky(const LightSet& lights, const PathVertex& vertex, const vec3& weight, vec2 u,
                             float rayEpsilon) {
  const SkySample s = lights.sky.sampleFacing(vertex.normal, u);
  const float cosine = glm::dot(s.direction, vertex.normal);
  // Rounded into the next cell of the table, a direction may have no density there.
  if (cosine <= 0 || glm::dot(s.direction, vertex.geometricNormal) <= 0 || !(s.pdf > 0)) return {};
  const float mis = powerHeuristic(s.pdf, pdfOfRay(vertex, s.direction));
  return {{offsetPoint(vertex.position, vertex.geometricNormal, rayEpsilon), s.direction},
          weight * s.radiance * (cosine * mis / (kPi * s.pdf))};
}

vec3 skyByRay(const LightSet& lights, const PathVertex& vertex, const vec3& direction) {
  vec3 radiance = lights.sky.radiance(direction);
  if (!lights.sky.constant())
    radiance *= powerHeuristic(pdfOfRay(vertex, direction), lights.sky.pdfFacing(vertex.normal, direction));
  if (!vertex.receiver) return radiance;
  for (uint32_t i = 0; i < lights.punctual.size(); ++i) {
    if (!hasDisk(lights.punctual[i]) || !isInDisk(lights.punctual[i], direction)) continue;
    const float pdf = pdfOfDisk(lights.punctual[i], direction);
    const float chosen = LightChoice(lights, vertex.position, vertex.normal).probability(i);
    radiance += lights.punctual[i].intensity * (pdf * powerHeuristic(pdfOfRay(vertex, direction), chosen * pdf));
  }
  return radiance;
}

float emitterShare(const LightSet& lights, const PathVertex& vertex, const vec3& direction, const SurfaceHit& hit) {
  const uint32_t e = lights.emitterOf(hit);
  if (e == kNone) return 1;
  const LightChoice choice(lights, vertex.position, vertex.normal);
  const float cosEmitter = std::abs(glm::dot(direction, hit.geometricNormal));
  const float pdfLight = choice.probability(uint32_t(lights.punctual.size()) + e) *
                         pdfEmitterArea(lights, lights.emitters[e], hit.triangle) * hit.t * hit.t /
                         std::max(cosEmitter, 1e-6f);
  return powerHeuristic(pdfOfRay(vertex, direction), pdfLight);
}

} // namespace lambent

// Paper 1, 3.2.3: the radiance that a VPL reflects, by path tracing with next-event estimation. Numbers are seeded by
// the VPL's own id, so a VPL that stays gives the same estimate until the light or the geometry that it sees changes.
//
// At each path vertex: one light chosen in proportion to what it could bring, one shadow ray, one cosine-distributed
// ray. The cosine ray meets the sky directly (that is the sky's whole estimator) and emitters by multiple importance
// sampling (power heuristic, Veach 1997) with the shadow rays, so a VPL close to a lamp stays finite in variance. Noise
// of 16 paths under a 1.5 m × 0.8 m quad at 1 m and 0.2 m: 16 % and 17 %; with the balance heuristic 13 % and 24 %. The
// paths of one VPL share stratified numbers at the first vertex: 4×4 strata for directions, an additive recurrence for
// lights.
#include "engine/core/parallel.h"
#include "engine/core/rng.h"
#include "gi/vpl/smc.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

/// One path's present vertex. `weight` turns irradiance/π at this vertex into radiance leaving the VPL.
struct PathState {
  vec3 position, normal, geometricNormal;
  vec3 weight;
  bool alive = true;
  Rng rng{0, Stream::LightPaths, 0};
};

struct Pending {
  uint32_t path;
  vec3 value; // radiance added to the VPL if the segment is clear
};

/// Share of a sample drawn with density `own` when `other` could have drawn it too. Ratio first: squares overflow.
float powerHeuristic(float own, float other) {
  const float ratio = other / own;
  return 1 / (1 + ratio * ratio);
}

class VplEstimator {
 public:
  VplEstimator(const RayQuery& rays, const LightSet& lights, int paths, int bounces, uint32_t seed)
      : rays_(rays), lights_(lights), paths_(paths), bounces_(bounces), seed_(seed), states_(paths) {}

  vec3 estimate(const Vpl& vpl, RayCounts& counts) {
    sum_ = vec3(0);
    const uint32_t id = uint32_t(mix64(vpl.id));
    Rng first(seed_, Stream::LightPaths, id);
    const vec3 shift(first.next(), first.next(), first.next());
    const float lightShift = first.next();
    for (int i = 0; i < paths_; ++i)
      states_[i] = {vpl.position, vpl.normal, vpl.geometricNormal,
                    vpl.albedo,   true,       Rng(seed_, Stream::LightPaths, id, uint32_t(i) + 1)};
    for (int depth = 0; depth < bounces_; ++depth) {
      connectToLights(depth, shift, lightShift, counts);
      const bool last = depth + 1 == bounces_;
      // The last vertex needs its cosine ray only to meet sky and emitters.
      if (last && lights_.emitters.empty() && luminance(lights_.sky) <= 0) break;
      extend(depth, last, counts);
    }
    return sum_ / float(paths_);
  }

 private:
  void connectToLights(int depth, const vec3& shift, float lightShift, RayCounts& counts) {
    if (lights_.lightCount() == 0) return;
    segments_.clear();
    pending_.clear();
    for (int i = 0; i < paths_; ++i) {
      PathState& s = states_[i];
      if (!s.alive) continue;
      // Drawn whether used or not: the sequence does not depend on what the lights do.
      float uLight = s.rng.next();
      vec3 u(s.rng.next(), s.rng.next(), s.rng.next());
      if (depth == 0) {
        uLight = std::min((float(i) + lightShift) / float(paths_), 0x1.fffffep-1f);
        u = additiveRecurrence3(uint32_t(i), shift);
      }
      const LightChoice choice(lights_, s.position, s.normal, weights_);
      if (choice.empty()) continue;
      const uint32_t light = choice.sample(uLight);
      const float probability = choice.probability(light);
      const vec3 origin = offsetPoint(s.position, s.geometricNormal);
      if (light < lights_.punctual.size()) {
        const PunctualSample p = punctualIrradiance(lights_.punctual[light], s.position, s.normal);
        if (luminance(p.irradiance) <= 0 || glm::dot(p.towards, s.geometricNormal) <= 0) continue;
        segments_.push_back(p.distance < kInfinity ? segment(origin, lights_.punctual[light].position)
                                                   : Ray{origin, p.towards});
        pending_.push_back({uint32_t(i), s.weight * p.irradiance / (kPi * probability)});
        continue;
      }
      const Emitter& emitter = lights_.emitters[light - lights_.punctual.size()];
      const EmitterPoint e = sampleEmitter(lights_, emitter, u);
      const vec3 d = e.position - s.position;
      const float r2 = glm::dot(d, d);
      if (!(r2 > 0)) continue;
      const vec3 towards = d / std::sqrt(r2);
      const float cosReceiver = glm::dot(towards, s.normal);
      float cosEmitter = -glm::dot(towards, e.normal);
      if (emitter.doubleSided) cosEmitter = std::abs(cosEmitter);
      if (cosReceiver <= 0 || cosEmitter <= 0 || glm::dot(towards, s.geometricNormal) <= 0) continue;
      const float pdfLight = probability * e.pdfArea * r2 / cosEmitter; // per steradian
      const float mis = powerHeuristic(pdfLight, pdfCosineHemisphere(cosReceiver));
      const vec3 emitterSide = -glm::dot(towards, e.normal) > 0 ? e.normal : -e.normal;
      segments_.push_back(segment(origin, offsetPoint(e.position, emitterSide)));
      pending_.push_back({uint32_t(i), s.weight * e.radiance * (cosReceiver * mis / (kPi * pdfLight))});
    }
    blocked_.resize(segments_.size());
    rays_.occluded(segments_, blocked_);
    counts.occlusion += segments_.size();
    for (size_t j = 0; j < pending_.size(); ++j)
      if (!blocked_[j]) sum_ += pending_[j].value;
  }

  void extend(int depth, bool last, RayCounts& counts) {
    segments_.clear();
    owners_.clear();
    const int side = int(std::sqrt(float(paths_)));
    for (int i = 0; i < paths_; ++i) {
      PathState& s = states_[i];
      if (!s.alive) continue;
      vec2 u = s.rng.next2();
      if (depth == 0 && i < side * side) u = (vec2(i % side, i / side) + u) / float(side);
      const vec3 direction = sampleCosineHemisphere(s.normal, u);
      if (glm::dot(direction, s.geometricNormal) <= 0) { // under the real surface of a smooth-shaded one
        s.alive = false;
        continue;
      }
      segments_.push_back({offsetPoint(s.position, s.geometricNormal), direction});
      owners_.push_back(uint32_t(i));
    }
    hits_.resize(segments_.size());
    rays_.closest(segments_, hits_);
    counts.closest += segments_.size();
    for (size_t j = 0; j < owners_.size(); ++j) {
      PathState& s = states_[owners_[j]];
      const SurfaceHit& h = hits_[j];
      if (!h.valid()) {
        sum_ += s.weight * lights_.sky;
        s.alive = false;
        continue;
      }
      if (luminance(h.emission) > 0) addEmission(s, segments_[j].direction, h);
      s.weight *= h.albedo;
      s.alive = !last && maxComponent(s.weight) > 0;
      s.position = h.position;
      s.normal = h.normal;
      s.geometricNormal = h.geometricNormal;
    }
  }

  /// A cosine ray met an emitter: the share that next-event estimation does not cover.
  void addEmission(const PathState& s, const vec3& direction, const SurfaceHit& h) {
    float mis = 1;
    const uint32_t e = lights_.emitterOf(h);
    if (e != kNone) {
      const LightChoice choice(lights_, s.position, s.normal, weights_);
      const float cosEmitter = std::abs(glm::dot(direction, h.geometricNormal));
      const float pdfCosine = pdfCosineHemisphere(glm::dot(direction, s.normal));
      const float pdfLight = choice.probability(uint32_t(lights_.punctual.size()) + e) *
                             pdfEmitterArea(lights_, lights_.emitters[e], h.triangle) * h.t * h.t /
                             std::max(cosEmitter, 1e-6f);
      mis = powerHeuristic(pdfCosine, pdfLight);
    }
    sum_ += s.weight * h.emission * mis;
  }

  const RayQuery& rays_;
  const LightSet& lights_;
  const int paths_, bounces_;
  const uint32_t seed_;
  vec3 sum_{0};
  std::vector<PathState> states_;
  std::vector<Ray> segments_;
  std::vector<Pending> pending_;
  std::vector<uint32_t> owners_;
  std::vector<uint8_t> blocked_;
  std::vector<SurfaceHit> hits_;
  std::vector<float> weights_;
};

} // namespace

void estimateRadiance(std::span<Vpl* const> vpls, const RayQuery& rays, const LightSet& lights, int paths, int bounces,
                      uint32_t seed, RayCounts& counts) {
  constexpr size_t kGrain = 16;
  std::vector<RayCounts> perBlock((vpls.size() + kGrain - 1) / kGrain);
  const bool dark = lights.empty() || bounces < 1;
  parallelFor(vpls.size(), kGrain, [&](size_t begin, size_t end) {
    VplEstimator estimator(rays, lights, paths, bounces, seed);
    for (size_t i = begin; i < end; ++i) {
      const bool black = maxComponent(vpls[i]->albedo) <= 0;
      vpls[i]->radiance = dark || black ? vec3(0) : estimator.estimate(*vpls[i], perBlock[begin / kGrain]);
    }
  });
  for (const RayCounts& c : perBlock) counts += c;
}

} // namespace lambent

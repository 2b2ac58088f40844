#include "gi/vpl/sources.h"

#include "engine/core/error.h"
#include "gi/lighting/photons.h"

#include <algorithm>
#include <cmath>

namespace lambent {

VplChanges placeVpls(VplSource source, VplSet& set, const VplUpdate& in, VplUpdateLog& log,
                     const std::function<void(int, int)>& progress) {
  if (set.source != source) {
    const uint64_t nextId = set.nextId; // ids stay unique
    set = {};
    set.source = source;
    set.nextId = nextId;
  }
  // Every bounce brings a place the lights' power at most.
  const Aabb& bounds = in.view.boundsWorld;
  const float power = bounds.empty() ? kInfinity : PhotonSource(in.lights, bounds, 0).power();
  set.mostFlux = power * float(std::max(1, in.settings.bounces));
  switch (source) {
  case VplSource::Ir:
    return placeByPhotons(set, in, log);
  case VplSource::Mir:
    return placeByImagePower(set, in, log);
  case VplSource::Tcas:
    return placeByShadowMapChains(set, in, log);
  case VplSource::Poisson:
    return placeOverSurfaces(set, in, log);
  case VplSource::Smc:
    break;
  case VplSource::Rsm:
  case VplSource::Isr:
  case VplSource::Hisr:
  case VplSource::None:
    CHECK(!"not sampled: gi/contract/light_source.h");
  }
  return updateVpls(set, in, log, progress);
}

CandidatesAsked candidatesAsked(const SmcSettings& smc, const VplSettings& vpl) {
  if (vpl.source == VplSource::Mir) return {vpl.mirCandidates, "vpl.mirCandidates"};
  if (vpl.source == VplSource::Smc) return {smc.candidateRays, "smc.candidateRays"};
  return {1, "smc.vpls"};
}

PlacedVpl::PlacedVpl(const SurfaceHit& hit, const vec3& flux)
    : position(hit.position), normal(hit.normal), geometricNormal(hit.geometricNormal), albedo(hit.albedo),
      power(flux * hit.albedo / kPi), instance(hit.instance) {}

namespace {

/// Areas by nearest neighbours, within a factor of the median: an isolated VPL must not be blurred over half the scene,
/// and coincident ones must keep a finite radiance.
std::vector<float> boundedAreas(std::span<const DensityPoint> points, const VplUpdate& in) {
  constexpr float kLargest = 16, kSmallest = 1e-3f; // of the median; 16 as smc's limit to the mean share
  Aabb box;
  box.add(in.view.camera.position());
  for (const DensityPoint& p : points) box.add(p.position);
  const float widest = std::max(1e-20f, box.diameter() * box.diameter());
  std::vector<float> areas =
      representedAreas(points, points, true, neighboursForRendering(in.settings), in.settings.density, widest);
  if (areas.empty()) return areas;
  std::vector<float> sorted = areas;
  std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
  const float median = std::max(sorted[sorted.size() / 2], 1e-9f * widest);
  for (float& a : areas) a = glm::clamp(a, kSmallest * median, kLargest * median);
  return areas;
}

} // namespace

VplChanges adoptVpls(VplSet& set, std::span<const PlacedVpl> placed, const VplUpdate& in, VplUpdateLog& log) {
  CpuScope scope(log.stages, key(StageId::Density));
  std::vector<DensityPoint> points;
  for (const PlacedVpl& p : placed)
    if (p.alive()) points.push_back({p.position, p.normal});
  const std::vector<float> areas = boundedAreas(points, in);

  VplChanges changes;
  set.slots.resize(placed.size());
  size_t next = 0;
  for (uint32_t i = 0; i < placed.size(); ++i) {
    const PlacedVpl& p = placed[i];
    Vpl& v = set.slots[i];
    if (!p.alive()) {
      v = {};
      continue;
    }
    CHECK(isFinite(p.power));
    const bool stayed = v.alive && v.position == p.position && v.normal == p.normal;
    if (!stayed) {
      v = {};
      v.id = set.nextId++;
      v.bornFrame = set.frame;
      changes.movedSlots.push_back(i);
    }
    v.position = p.position;
    v.normal = p.normal;
    v.geometricNormal = p.geometricNormal;
    v.albedo = p.albedo;
    v.instance = in.view.instances[p.instance].id;
    v.mailbox = offsetPoint(p.position, p.geometricNormal, in.rays.rayEpsilon());
    v.alive = v.valid = true;
    v.area = v.candidateArea = areas[next++];
    v.radiance = v.samplerRadiance = p.power / v.area;
    ++changes.alive;
  }
  changes.placedSlots = changes.movedSlots;
  log.relit = log.relitForChange = changes.alive;
  changes.kept = changes.alive - uint32_t(changes.movedSlots.size());
  return changes;
}

std::vector<uint32_t> systematicMultiplicities(std::span<const float> weights, uint32_t count, float u) {
  std::vector<uint32_t> out(weights.size(), 0);
  double total = 0;
  for (float w : weights) total += w;
  if (!(total > 0)) return out;
  double sum = 0;
  uint32_t drawn = 0;
  size_t last = 0; // of positive weight
  for (size_t i = 0; i < weights.size(); ++i) {
    if (!(weights[i] > 0)) continue;
    last = i;
    sum += weights[i];
    for (; drawn < count && (double(drawn) + u) * total < sum * count; ++drawn) ++out[i];
  }
  out[last] += count - drawn; // rounding left a remainder
  return out;
}

} // namespace lambent

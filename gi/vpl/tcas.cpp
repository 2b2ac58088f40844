// Temporally coherent adaptive sampling: T. Barák, J. Bittner, V. Havran, "Temporally Coherent Adaptive Sampling for
// Imperfect Shadow Maps", EGSR 2013; `tcas` of paper 1, 5.1: Metropolis–Hastings over reflective shadow maps, quasi-
// random numbers, 16 iterations per frame, one bounce, nothing between VPL and camera looked at. What we do:
// - A texel of a reflective shadow map is a photon's first hit: the numbers that choose light, place and direction are
//   the coordinates, in which texels are uniform in flux. No map is drawn, each looked-at texel is a ray.
// - Target: the luminance that the texel's light would bring, unblocked, to a fixed set of points seen by the camera,
//   plus a small share of its flux, so that light of any place can be chosen (those points are only some).
// - Each slot's chain has its own numbers, the same in every frame, and proposes texels independently of where it
//   stands. The set is thus a function of view, lights and geometry alone: while these stand still nothing moves, and
//   while they move a slot changes only where a comparison of two targets tips. Coherence is one of the maps, not of
//   the world (paper 1, 2): VPLs drift with a moving light.
// - First texels follow a low-discrepancy sequence over the slots, proposals are random: one sequence for both would
//   put all proposals of a step at the same offset from the present texels, which is no symmetric choice (measured:
//   1.2 % too much light in the Cornell box, and more noise).
// - Chains that start anywhere would need many steps to forget it. They start as Veach does (1997, 11.3.1): the first
//   texels of all slots are resampled in proportion to target, after which every VPL has the same weight after any
//   number of steps: the mean target b over N times its own. Slots keep their own first texel where it was drawn.
#include "engine/core/parallel.h"
#include "engine/core/rng.h"
#include "gi/lighting/photons.h"
#include "gi/vpl/sources.h"

namespace lambent {

namespace {

constexpr int kCameraPoints = 128;
constexpr float kFluxShare = 0.05f; // of the target, on average

/// Texels of all slots and steps, [step · slots + slot].
std::vector<PlacedVpl> readShadowMaps(const PhotonSource& source, const VplUpdate& in, RayCounts& counts) {
  const uint32_t slots = uint32_t(in.settings.vpls);
  const size_t count = size_t(slots) * size_t(in.vpl.tcasIterations + 1);
  std::vector<PlacedVpl> texels(count);
  parallelFor(count, 256, [&](size_t begin, size_t end) {
    std::vector<Photon> photons;
    std::vector<Ray> rays;
    for (size_t i = begin; i < end; ++i) {
      const uint32_t step = uint32_t(i / slots), slot = uint32_t(i % slots);
      Rng rng(in.seed, Stream::Photons, slot, step);
      photons.push_back(
          source.emit(step == 0 ? photonNumbers(sequenceIndex(slot, slots), in.seed)
                                : PhotonNumbers{rng.next(), {rng.next(), rng.next()}, {rng.next(), rng.next()}}));
      rays.push_back(photons.back().ray);
    }
    std::vector<SurfaceHit> hits(rays.size());
    in.rays.closest(rays, hits);
    for (size_t i = begin; i < end; ++i) {
      const SurfaceHit& h = hits[i - begin];
      if (h.valid() && isFinite(h.position) && isFinite(h.normal))
        texels[i] = PlacedVpl(h, arrivingFlux(photons[i - begin], h));
    }
  });
  counts.closest += count;
  return texels;
}

/// Mean geometry term between a texel and the camera's points, 1/m². Each point stands for its share of what the camera
/// sees, so distances are widened by the spacing of points.
std::vector<float> meanGeometryTerms(std::span<const PlacedVpl> texels, std::span<const VisiblePoint> points) {
  std::vector<float> terms(texels.size(), 1); // a camera that sees nothing weighs all alike
  if (points.empty()) return terms;
  Aabb box;
  for (const VisiblePoint& p : points) box.add(p.position);
  GatherSettings widened;
  widened.disk = kPi; // r² + spacing²
  const float spacing2 = std::max(1e-20f, box.diameter() * box.diameter() / float(points.size()));
  parallelFor(texels.size(), 256, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      terms[i] = 0;
      if (!texels[i].alive()) continue;
      for (const VisiblePoint& x : points) {
        const vec3 d = texels[i].position - x.position;
        const float r2 = glm::dot(d, d), inverse = 1 / std::sqrt(std::max(r2, 1e-20f));
        terms[i] += geometryTerm(glm::dot(d, x.normal) * inverse, -glm::dot(d, texels[i].normal) * inverse, r2,
                                 spacing2, widened);
      }
      terms[i] /= float(points.size());
    }
  });
  return terms;
}

std::vector<float> targets(std::span<const PlacedVpl> texels, std::span<const VisiblePoint> points) {
  std::vector<float> out = meanGeometryTerms(texels, points);
  double flux = 0, brought = 0;
  for (size_t i = 0; i < texels.size(); ++i) {
    const double power = luminance(texels[i].power);
    flux += power;
    brought += power * out[i];
  }
  const float everywhere = brought > 0 ? kFluxShare * float(brought / flux) : 1;
  for (size_t i = 0; i < texels.size(); ++i) out[i] = luminance(texels[i].power) * (out[i] + everywhere);
  return out;
}

/// Index of the texel that each slot starts from.
std::vector<uint32_t> startingTexels(std::span<const float> firstTargets) {
  const uint32_t slots = uint32_t(firstTargets.size());
  const std::vector<uint32_t> times = systematicMultiplicities(firstTargets, slots, 0.5f);
  std::vector<uint32_t> start(slots), spare;
  for (uint32_t i = 0; i < slots; ++i) {
    start[i] = i;
    for (uint32_t copy = 1; copy < times[i]; ++copy) spare.push_back(i);
  }
  size_t next = 0;
  for (uint32_t i = 0; i < slots && next < spare.size(); ++i)
    if (times[i] == 0) start[i] = spare[next++];
  return start;
}

} // namespace

VplChanges placeByShadowMapChains(VplSet& set, const VplUpdate& in, VplUpdateLog& log) {
  ++set.frame;
  const uint32_t slots = uint32_t(in.settings.vpls), steps = uint32_t(in.vpl.tcasIterations);
  std::vector<PlacedVpl> placed(slots);
  const PhotonSource source(in.lights, in.view.boundsWorld, in.rays.rayEpsilon());
  if (in.settings.bounces > 0 && !source.empty()) {
    CpuScope scope(log.stages, key(StageId::Chains));
    const std::vector<PlacedVpl> texels = readShadowMaps(source, in, log.candidates);
    const std::vector<VisiblePoint> points =
        findVisiblePoints(in.rays, in.view.camera, kCameraPoints, in.seed, 0, log.points); // the same in every frame
    const std::vector<float> target = targets(texels, points);
    double mean = 0;
    for (float t : target) mean += double(t) / double(target.size());
    const std::vector<uint32_t> start = startingTexels(std::span(target).first(slots));
    for (uint32_t slot = 0; slot < slots; ++slot) {
      size_t at = start[slot];
      Rng rng(in.seed, Stream::Acceptance, slot);
      for (uint32_t step = 1; step <= steps; ++step) {
        const size_t proposed = size_t(step) * slots + slot;
        if (rng.next() * target[at] < target[proposed]) at = proposed;
      }
      if (!(target[at] > 0)) continue;
      placed[slot] = texels[at];
      placed[slot].power *= float(mean / (double(slots) * double(target[at])));
    }
  }
  VplChanges changes = adoptVpls(set, placed, in, log);
  changes.candidates = slots * steps;
  return changes;
}

} // namespace lambent

// Instant radiosity: A. Keller, "Instant Radiosity", SIGGRAPH 1997; `ir` of paper 1, 5.1. What we do:
// - N slots are shared evenly by bounces 1..B. Photon j leaves its VPL of bounce b in the j-th slot of b's share, so
//   slots never change hands, and a slot whose photon left the scene stays empty.
// - A photon is always carried on, its flux times albedo: with slots set aside for every bounce, Russian roulette would
//   only empty some of them and give the rest their light. (Keller lets ρN photons carry on, which saves slots.)
// - What leaves the lights follows a low-discrepancy sequence, further directions are random; both by photon number.
#include "engine/core/parallel.h"
#include "engine/core/rng.h"
#include "engine/core/sampling.h"
#include "gi/lighting/photons.h"
#include "gi/vpl/sources.h"

#include <algorithm>

namespace lambent {

VplChanges placeByPhotons(VplSet& set, const VplUpdate& in, VplUpdateLog& log) {
  ++set.frame;
  const uint32_t slots = uint32_t(in.settings.vpls), bounces = uint32_t(in.settings.bounces);
  std::vector<PlacedVpl> placed(slots);
  set.direct = slots / std::max(bounces, 1u) + (slots % std::max(bounces, 1u) > 0 ? 1 : 0);
  const PhotonSource source(in.lights, in.view.boundsWorld, in.rays.rayEpsilon());
  if (bounces > 0 && !source.empty()) {
    CpuScope scope(log.stages, key(StageId::Photons));
    // Photons that bounce b has slots for. Earlier bounces get the odd slots: they carry more light.
    const auto share = [&](uint32_t b) { return slots / bounces + (b < slots % bounces ? 1 : 0); };
    constexpr size_t kGrain = 64;
    const size_t photons = share(0);
    parallelCount(photons, kGrain, log.candidates, [&](size_t begin, size_t end, RayCounts& count) {
      std::vector<Photon> flying;
      std::vector<uint32_t> number; // j of each
      for (size_t j = begin; j < end; ++j) {
        flying.push_back(source.emit(photonNumbers(sequenceIndex(uint32_t(j), uint32_t(photons)), in.seed)));
        number.push_back(uint32_t(j));
      }
      std::vector<Ray> rays;
      std::vector<SurfaceHit> hits;
      uint32_t firstSlot = 0;
      for (uint32_t b = 0; b < bounces && !flying.empty(); ++b) {
        rays.clear();
        for (const Photon& p : flying) rays.push_back(p.ray);
        hits.resize(rays.size());
        in.rays.closest(rays, hits);
        count.closest += rays.size();
        size_t left = 0;
        for (size_t i = 0; i < hits.size(); ++i) {
          const SurfaceHit& h = hits[i];
          if (!h.valid() || !isFinite(h.position) || !isFinite(h.normal) || number[i] >= share(b)) continue;
          const vec3 flux = arrivingFlux(flying[i], h);
          placed[firstSlot + number[i]] = PlacedVpl(h, flux / float(share(b)));
          // Around the geometric normal: the flux that leaves in a direction goes with the cosine to the real surface.
          Rng rng(in.seed, Stream::Photons, number[i], b + 1);
          Photon next;
          next.ray = {offsetPoint(h.position, h.geometricNormal, in.rays.rayEpsilon()),
                      sampleCosineHemisphere(h.geometricNormal, rng.next2())};
          next.flux = flux * h.albedo;
          if (maxComponent(next.flux) <= 0) continue;
          flying[left] = next;
          number[left++] = number[i];
        }
        flying.resize(left);
        number.resize(left);
        firstSlot += share(b);
      }
    });
  }
  return adoptVpls(set, placed, in, log);
}

} // namespace lambent

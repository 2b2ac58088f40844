// Metropolis instant radiosity: B. Segovia, J.-C. Iehl, B. Péroche, "Metropolis Instant Radiosity", Eurographics 2007;
// `mir` of paper 1, 5.1, which resamples paths of a path tracer, 256:1, independently for each frame, instead of
// mutating them. What we do:
// - A candidate is a point x that the camera sees (uniform over the image), a cosine-distributed ray to y, and one
//   light path that estimates the radiance of y. Its weight is the luminance it brings to the image with x taken as
//   white: the albedo at x would only shift VPLs between pixels whose irradiance is shown, filtered and compared alike.
// - N of the candidates are drawn in proportion to weight by systematic resampling. One drawn several times stands in
//   several neighbouring slots, which interleaved sampling shows to different pixels.
// - Each VPL brings the same power to the image. Segovia finds its intensity from q(y), the mean over the image of
//   what a unit VPL at y brings, which takes shadow rays to many points and has no finite variance near corners. But
//   q(y) is the density of candidates, and there are many of those: 1/(M q) = π r_k²/k among all M hits is a mean-free
//   estimate where the density is even over r_k (3 cm for 524 k candidates in a room), and no chosen weight enters it.
#include "engine/core/rng.h"
#include "gi/vpl/sources.h"

#include <algorithm>

namespace lambent {

namespace {

/// One radiance estimate per hit, by one light path of its own.
std::vector<vec3> estimateHits(std::span<const CandidateHit> hits, const VplUpdate& in, uint32_t frame,
                               RayCounts& counts) {
  constexpr size_t kChunk = 1 << 16; // bounds the memory that VPLs in the making take
  std::vector<vec3> radiance(hits.size());
  std::vector<Vpl> vpls;
  std::vector<Vpl*> pointers;
  for (size_t first = 0; first < hits.size(); first += kChunk) {
    const size_t count = std::min(kChunk, hits.size() - first);
    vpls.assign(count, {});
    pointers.clear();
    for (size_t i = 0; i < count; ++i) {
      const CandidateHit& h = hits[first + i];
      vpls[i].position = h.position;
      vpls[i].normal = h.normal;
      vpls[i].geometricNormal = h.geometricNormal;
      vpls[i].albedo = h.albedo;
      vpls[i].id = uint64_t(frame) << 32 | (first + i); // new numbers in each frame
      pointers.push_back(&vpls[i]);
    }
    estimateRadiance(pointers, in.rays, in.lights, 1, in.settings.bounces, in.seed, counts);
    for (size_t i = 0; i < count; ++i) radiance[first + i] = vpls[i].radiance;
  }
  return radiance;
}

/// 1/(M q) at hit i of M, m²: the share of surface per hit, by the k nearest of the others.
std::vector<float> areasPerHit(std::span<const CandidateHit> hits, std::span<const uint32_t> chosen) {
  constexpr int kNeighbours = 16; // one such area is known to 25 %
  std::vector<DensityPoint> all, queries;
  all.reserve(hits.size());
  for (const CandidateHit& h : hits) all.push_back({h.position, h.normal, h.share});
  for (uint32_t i : chosen) queries.push_back(all[i]);
  // Each query is itself among them: the nearest of k + 1.
  std::vector<float> areas =
      representedAreas(queries, all, false, kNeighbours + 1, DensityEstimator::KnnSide, kInfinity);
  for (float& a : areas) a *= float(kNeighbours + 1) / float(kNeighbours);
  return areas;
}

} // namespace

VplChanges placeByImagePower(VplSet& set, const VplUpdate& in, VplUpdateLog& log) {
  ++set.frame;
  const uint32_t slots = uint32_t(in.settings.vpls);
  const int count = int(slots) * in.vpl.mirCandidates;
  std::vector<CandidateHit> hits;
  {
    CpuScope scope(log.stages, key(StageId::Candidates));
    const std::vector<VisiblePoint> points =
        findVisiblePoints(in.rays, in.view.camera, count, in.seed, set.frame, log.points);
    if (points.empty()) { // the camera faces the sky
      set.slots.resize(slots);
      VplChanges none;
      for (const Vpl& v : set.slots) none.alive += v.alive;
      none.kept = none.alive;
      return none;
    }
    hits = traceCandidates(in.rays, points, count, in.seed, set.frame, log.candidates);
  }
  std::vector<vec3> radiance;
  {
    CpuScope scope(log.stages, key(StageId::Radiosity));
    radiance = estimateHits(hits, in, set.frame, log.radiosity);
  }
  std::vector<PlacedVpl> placed(slots);
  {
    CpuScope scope(log.stages, key(StageId::Resample));
    std::vector<float> weights;
    double total = 0;
    for (const vec3& r : radiance) total += weights.emplace_back(luminance(r));
    Rng rng(in.seed, Stream::Resample, 0, set.frame);
    const std::vector<uint32_t> times = systematicMultiplicities(weights, slots, rng.next());
    std::vector<uint32_t> chosen;
    for (uint32_t i = 0; i < times.size(); ++i)
      if (times[i] > 0) chosen.push_back(i);
    const std::vector<float> areas = areasPerHit(hits, chosen);
    uint32_t slot = 0;
    for (size_t c = 0; c < chosen.size(); ++c) {
      const CandidateHit& h = hits[chosen[c]];
      PlacedVpl p;
      p.position = h.position;
      p.normal = h.normal;
      p.geometricNormal = h.geometricNormal;
      p.albedo = h.albedo;
      p.instance = h.instance;
      // radiance · area over the mean number of times that this candidate is drawn
      p.power = radiance[chosen[c]] * (areas[c] * float(total / (double(slots) * weights[chosen[c]])));
      for (uint32_t copy = 0; copy < times[chosen[c]]; ++copy) placed[slot++] = p;
    }
  }
  VplChanges changes = adoptVpls(set, placed, in, log);
  changes.candidates = uint32_t(hits.size());
  return changes;
}

} // namespace lambent

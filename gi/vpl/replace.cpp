// Paper 1, 3.2.5 and algorithm 1 lines 9–17: find undersampled regions and move a bounded number of VPLs there.
// Intensities of VPLs and candidates are both taken with k = 1. Other than in the paper, each winner lowers the area of
// the candidates around it before the next is picked.
#include "gi/vpl/smc.h"

#include <algorithm>

namespace lambent {

namespace {
float samplingIntensity(const Vpl& v) { return luminance(v.samplerRadiance) * v.candidateArea; }
} // namespace

VplChanges replaceVpls(VplSet& set, std::vector<Vpl>& candidates, int maxMoves, DensityEstimator estimator) {
  VplChanges changes;
  changes.candidates = uint32_t(candidates.size());

  std::vector<float> present;
  std::vector<uint32_t> empty, invalid, valid;
  for (uint32_t i = 0; i < set.slots.size(); ++i) {
    const Vpl& v = set.slots[i];
    if (!v.alive) {
      empty.push_back(i);
      continue;
    }
    present.push_back(samplingIntensity(v));
    (v.valid ? valid : invalid).push_back(i);
  }
  changes.invalid = uint32_t(invalid.size());
  if (!present.empty()) {
    const size_t rank = std::min(present.size() - 1, size_t(0.95 * double(present.size())));
    std::nth_element(present.begin(), present.begin() + rank, present.end());
    for (const Vpl& c : candidates) changes.strong += samplingIntensity(c) > present[rank];
  }

  const auto weakestFirst = [&](std::vector<uint32_t>& slots) {
    std::stable_sort(slots.begin(), slots.end(), [&](uint32_t a, uint32_t b) {
      return samplingIntensity(set.slots[a]) < samplingIntensity(set.slots[b]);
    });
  };
  weakestFirst(invalid);
  weakestFirst(valid);
  const size_t least = std::min<size_t>(maxMoves, changes.strong); // M_min, eq. 9
  std::vector<uint32_t> targets = invalid;
  for (size_t i = 0; i < valid.size() && targets.size() < least; ++i) targets.push_back(valid[i]);
  targets.resize(std::min<size_t>(targets.size(), maxMoves));
  // Empty slots bring no light, so filling them moves nothing that anyone sees: they come first and are not counted.
  targets.insert(targets.begin(), empty.begin(), empty.end());

  for (uint32_t slot : targets) {
    auto best = candidates.end();
    for (auto c = candidates.begin(); c != candidates.end(); ++c)
      if (!c->alive && samplingIntensity(*c) > 0 &&
          (best == candidates.end() || samplingIntensity(*c) > samplingIntensity(*best)))
        best = c;
    if (best == candidates.end()) break; // no light to be had: everyone stays
    best->alive = true;                  // taken
    Vpl& v = set.slots[slot] = *best;
    v.bornFrame = set.frame;
    v.valid = true;
    changes.movedSlots.push_back(slot);
    for (Vpl& c : candidates) {
      if (c.alive || (estimator != DensityEstimator::Knn && !sameSide(c.normal, v.normal))) continue;
      const vec3 d = c.position - v.position;
      c.candidateArea = std::min(c.candidateArea, kPi * glm::dot(d, d));
    }
  }
  std::sort(changes.movedSlots.begin(), changes.movedSlots.end());
  for (const Vpl& v : set.slots) changes.alive += v.alive;
  changes.kept = changes.alive - uint32_t(changes.movedSlots.size());
  return changes;
}

} // namespace lambent

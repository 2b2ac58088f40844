#include "gi/vpl/asked_memory.h"

#include "engine/core/error.h"
#include "engine/core/memory.h"
#include "gi/vpl/kept_paths.h"
#include "gi/vpl/sources.h"

#include <algorithm>

namespace lambent {

namespace {

/// Of paths that are kept: all of the lights', half as many of the sampler's for each light, and as many in its pool.
double bytesOfPaths(const SmcSettings& smc) {
  const double paths = (smc.cache ? 2.0 * smc.vpls : 1.0) * smc.paths; // else those of one light at a time
  return paths * std::max(smc.bounces, 1) * sizeof(KeptVertex);
}

double bytesOfCandidates(const SmcSettings& smc, const VplSettings& vpl) {
  constexpr double kSearched = 200; // while neighbours are looked for: points, tree, weights, areas
  const double rays = double(smc.vpls) * candidatesAsked(smc, vpl).perSlot;
  return rays * (sizeof(CandidateHit) + kSearched);
}

} // namespace

double bytesOfVpls(const SmcSettings& smc, const VplSettings& vpl) {
  return bytesOfPaths(smc) + bytesOfCandidates(smc, vpl);
}

void refuseBeyondMemory(const SmcSettings& smc, const VplSettings& vpl, size_t free) {
  const double paths = bytesOfPaths(smc), candidates = bytesOfCandidates(smc, vpl);
  if (paths + candidates <= double(free)) return;
  const std::string names = paths > candidates ? "smc.vpls, smc.paths and smc.bounces"
                                               : std::string("smc.vpls and ") + candidatesAsked(smc, vpl).setting;
  const std::string cure =
      paths > candidates && smc.cache ? "lower one of them, or smc.cache=off" : "lower one of them";
  throw InputError("settings", names + " ask for " + moreThanIsLeft(paths + candidates, cure));
}

uint64_t bytesHeld(const VplSet& set) {
  uint64_t sum = (set.slots.size() + set.pool.size()) * sizeof(Vpl) + set.cells.size() * sizeof(VplCell);
  for (const VplCell& cell : set.cells) sum += cell.points.size() * sizeof(cell.points[0]);
  for (const std::vector<KeptPaths>* all : {&set.samplerPaths, &set.lightPaths, &set.poolPaths})
    for (const KeptPaths& k : *all)
      sum += sizeof(KeptPaths) + k.vertices.size() * sizeof(KeptVertex) + k.lengths.size() +
             k.emitters.size() * sizeof(KeptPaths::EmitterHit);
  return sum;
}

} // namespace lambent

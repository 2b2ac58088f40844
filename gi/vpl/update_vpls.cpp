// Paper 1, algorithm 1: the stages in order. Two things differ. VPLs are re-lit before they are compared with
// candidates: the paper compares fresh candidates with last frame's values, so a switched light would misjudge both for
// a frame. And the sampler judges by an estimate of its own, so that its choices do not bias the light (see
// estimateRadiance).
#include "gi/vpl/smc.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace lambent {

namespace {

/// VPLs ride on the object that carries them.
void carryAlong(VplSet& set, const SceneView& view, std::vector<uint32_t>& moved) {
  std::unordered_map<uint32_t, const InstanceView*> byId;
  for (const InstanceView& i : view.instances) byId.emplace(i.id, &i);
  for (uint32_t i = 0; i < set.slots.size(); ++i) {
    Vpl& v = set.slots[i];
    if (!v.alive) continue;
    const auto carrier = byId.find(v.instance);
    if (carrier == byId.end()) {
      v.alive = false; // the object is gone, and its light with it
      continue;
    }
    const InstanceView& instance = *carrier->second;
    if (!instance.moved) continue;
    const mat4 nowFromBefore = instance.worldFromObject * glm::inverse(instance.worldFromObjectBefore);
    const mat3 normalNow = glm::transpose(glm::inverse(mat3(nowFromBefore)));
    v.position = vec3(nowFromBefore * vec4(v.position, 1));
    v.normal = glm::normalize(normalNow * v.normal);
    v.geometricNormal = glm::normalize(normalNow * v.geometricNormal);
    if (!isFinite(v.position) || !isFinite(v.normal) || !isFinite(v.geometricNormal))
      v.alive = false; // scaled to nothing
    moved.push_back(i);
  }
}

std::vector<DensityPoint> densityPoints(std::span<const Vpl> vpls, std::vector<uint32_t>& index) {
  std::vector<DensityPoint> points;
  index.clear();
  for (uint32_t i = 0; i < vpls.size(); ++i)
    if (vpls[i].alive) {
      points.push_back({vpls[i].position, vpls[i].normal});
      index.push_back(i);
    }
  return points;
}

/// No VPL stands for more than this, m²: 16 times the mean share. An isolated VPL's disk would else reach far beyond
/// the surface it is on (the paper's clothes line).
float areaLimit(const VplSet& set) { return 16 * set.visibleArea / float(std::max<size_t>(16, set.slots.size())); }

/// Half the paths rank well enough, so two estimates cost what paper 1's one for VPLs and one for candidates did.
int samplerPaths(const SmcSettings& settings) { return std::max(1, settings.paths / 2); }

/// The sampler's densities, k = 1.
void estimateSamplerDensities(VplSet& set, const SmcSettings& settings) {
  std::vector<uint32_t> index;
  const std::vector<DensityPoint> points = densityPoints(set.slots, index);
  const std::vector<float> areas = representedAreas(points, points, true, 1, settings.density, areaLimit(set));
  for (size_t i = 0; i < index.size(); ++i) set.slots[index[i]].candidateArea = areas[i];
}

/// What rendering uses: areas of all VPLs, radiance of `moved` slots and of those whose cell changed, or of all.
void estimateLight(VplSet& set, const VplUpdate& in, std::span<const uint32_t> moved, bool relight, VplUpdateLog& log) {
  const SmcSettings& settings = in.settings;
  const bool cells = settings.density == DensityEstimator::Cells;
  std::vector<uint32_t> changed(moved.begin(), moved.end());
  {
    CpuScope scope(log.stages, "density");
    if (cells) {
      changed = updateCells(set, in.rays, in.view, moved, std::sqrt(areaLimit(set) / kPi), in.seed, log.cells);
    } else {
      set.cells.clear();
      std::vector<uint32_t> index;
      const std::vector<DensityPoint> points = densityPoints(set.slots, index);
      const std::vector<float> areas =
          representedAreas(points, points, true, neighboursForRendering(settings), settings.density, areaLimit(set));
      for (size_t i = 0; i < index.size(); ++i) set.slots[index[i]].area = areas[i];
    }
  }
  CpuScope scope(log.stages, "radiosity");
  if (relight) {
    changed.clear();
    for (uint32_t i = 0; i < set.slots.size(); ++i) changed.push_back(i);
  }
  std::vector<Vpl*> lit;
  std::vector<const VplCell*> cellsOfLit;
  for (uint32_t slot : changed) {
    if (!set.slots[slot].alive) continue;
    lit.push_back(&set.slots[slot]);
    if (cells) cellsOfLit.push_back(&set.cells[slot]);
  }
  log.relit += uint32_t(lit.size());
  estimateRadiance(lit, in.rays, in.lights, settings.paths, settings.bounces, in.seed, log.radiosity,
                   RadianceUse::Rendering, cellsOfLit);
}

struct Iteration {
  int moves;
  bool relight, geometryMoved;
  bool mayBurst; // the camera changed: a cut is possible
};

VplChanges iterate(VplSet& set, const VplUpdate& in, const Iteration& now, VplUpdateLog& log) {
  const SmcSettings& settings = in.settings;
  ++set.frame;
  std::vector<VisiblePoint> points;
  {
    CpuScope scope(log.stages, "points");
    points = findVisiblePoints(in.rays, in.view.camera, settings.points, in.seed, set.frame, log.points);
  }
  if (points.empty()) { // the camera faces the sky: nothing can be verified, nothing is lost
    VplChanges none;
    for (const Vpl& v : set.slots) none.alive += v.alive;
    none.kept = none.alive;
    return none;
  }
  {
    CpuScope scope(log.stages, "validate");
    verifyIndirectVisibility(set, in.rays, in.view.camera, now.geometryMoved, points, settings.validationRays, in.seed,
                             log.validation);
  }
  std::vector<CandidateHit> hits;
  {
    CpuScope scope(log.stages, "candidates");
    hits = traceCandidates(in.rays, points, settings.candidateRays * settings.vpls, in.seed, set.frame, log.candidates);
  }
  Resampled resampled;
  {
    CpuScope scope(log.stages, "resample");
    resampled = resampleUniformInArea(hits, settings.vpls, in.seed, set.frame);
    // A slow average: the limit on areas must not flicker.
    const float area = float(resampled.area);
    set.visibleArea = set.visibleArea > 0 ? glm::mix(set.visibleArea, area, 1.0f / 16) : area;
  }
  std::vector<Vpl> candidates;
  {
    CpuScope scope(log.stages, "radiosity");
    std::vector<Vpl*> lit;
    if (now.relight)
      for (Vpl& v : set.slots)
        if (v.alive) lit.push_back(&v);
    for (uint32_t pick : resampled.picks) {
      const CandidateHit& h = hits[pick];
      Vpl v;
      v.position = h.position;
      v.normal = h.normal;
      v.geometricNormal = h.geometricNormal;
      v.albedo = h.albedo;
      v.mailbox = h.from;
      v.instance = in.view.instances[h.instance].id;
      v.id = set.nextId++;
      candidates.push_back(v);
    }
    for (Vpl& v : candidates) lit.push_back(&v);
    estimateRadiance(lit, in.rays, in.lights, samplerPaths(settings), settings.bounces, in.seed, log.radiosity,
                     RadianceUse::Sampling);
  }
  VplChanges changes;
  {
    CpuScope scope(log.stages, "replace");
    std::vector<uint32_t> index;
    std::vector<DensityPoint> queries;
    for (const Vpl& v : candidates) queries.push_back({v.position, v.normal});
    const std::vector<float> areas =
        representedAreas(queries, densityPoints(set.slots, index), false, 1, settings.density, areaLimit(set));
    for (size_t i = 0; i < candidates.size(); ++i) candidates[i].candidateArea = areas[i];
    size_t alive = 0, invalid = 0;
    for (const Vpl& v : set.slots) alive += v.alive, invalid += v.alive && !v.valid;
    const bool burst = now.mayBurst && invalid * 2 > alive;
    changes = replaceVpls(set, candidates, burst ? settings.vpls : now.moves, settings.density);
    changes.burst = burst;
    estimateSamplerDensities(set, settings);
  }
  return changes;
}

/// Rows of the same name add up: a burst or the warm-up runs the stages several times.
void mergeStages(std::vector<StageTime>& stages) {
  std::vector<StageTime> merged;
  for (const StageTime& s : stages) {
    const auto same = std::find_if(merged.begin(), merged.end(), [&](const StageTime& m) { return m.name == s.name; });
    if (same == merged.end())
      merged.push_back(s);
    else
      same->cpuMs += s.cpuMs;
  }
  stages = std::move(merged);
}

} // namespace

VplChanges updateVpls(VplSet& set, const VplUpdate& in, VplUpdateLog& log,
                      const std::function<void(int, int)>& progress) {
  const SmcSettings& settings = in.settings;
  const SceneChanges& changed = in.view.changes;
  const bool start = set.slots.empty();
  std::vector<uint32_t> moved;
  set.slots.resize(settings.vpls);
  if (changed.geometry || changed.instances) carryAlong(set, in.view, moved);

  Iteration now;
  now.moves = settings.moves;
  now.geometryMoved = changed.geometry || changed.instances;
  now.mayBurst = changed.camera && !start;
  const bool relight =
      changed.lights || now.geometryMoved || set.litPaths != settings.paths || set.litBounces != settings.bounces;
  const bool estimatorChanged = set.cells.empty() == (settings.density == DensityEstimator::Cells);
  now.relight = relight;
  set.litPaths = settings.paths;
  set.litBounces = settings.bounces;

  VplChanges all = iterate(set, in, now, log);
  moved.insert(moved.end(), all.movedSlots.begin(), all.movedSlots.end());
  // The set as first sampled, and the set after a cut, are only candidates: let the sampler settle before the picture.
  constexpr int kBurstIterations = 3;
  const int more = start ? settings.warmup : all.burst ? kBurstIterations : 0;
  now.relight = now.geometryMoved = now.mayBurst = false;
  if (!start) now.moves = std::max(settings.moves, settings.vpls / 8);
  for (int i = 0; i < more; ++i) {
    if (progress) progress(i, more);
    const VplChanges again = iterate(set, in, now, log);
    moved.insert(moved.end(), again.movedSlots.begin(), again.movedSlots.end());
    all.invalid = again.invalid;
    all.alive = again.alive;
    all.strong = again.strong;
  }
  if (progress && more) progress(more, more);
  std::sort(moved.begin(), moved.end());
  moved.erase(std::unique(moved.begin(), moved.end()), moved.end());
  estimateLight(set, in, moved, relight || estimatorChanged, log);
  all.movedSlots = std::move(moved);
  all.kept = all.alive - std::min<uint32_t>(all.alive, uint32_t(all.movedSlots.size()));
  mergeStages(log.stages);
  return all;
}

} // namespace lambent

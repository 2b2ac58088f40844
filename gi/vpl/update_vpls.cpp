// Paper 1, algorithm 1: the stages in order. Two things differ. VPLs are re-lit before they are compared with
// candidates: the paper compares fresh candidates with last frame's values, so a switched light would misjudge both for
// a frame. And the sampler judges by an estimate of its own, so that its choices do not bias the light (see
// estimateRadiance).
#include "gi/vpl/smc.h"

#include "engine/view/surface_point.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace lambent {

namespace {

/// What happened since the last update, in the terms of the stages.
struct ChangesSince {
  bool camera = false, lights = false, instances = false;
  DirtyRegion moved;
  std::vector<uint8_t> carried; // by slot: moved with its object; empty: none did

  bool geometry() const { return !moved.empty() || instances; }
};

/// Lamps that move, come or go are lights that change.
bool emittersChanged(const VplUpdate& in) {
  return in.view.changes.instances ||
         std::any_of(in.lights.emitters.begin(), in.lights.emitters.end(),
                     [&](const Emitter& e) { return in.view.instances[e.instance].moved; });
}

/// Puts a VPL where its place on the carrier is now.
void place(Vpl& v, const SceneView& view, uint32_t instanceIndex) {
  const InstanceView& carrier = view.instances[instanceIndex];
  const SurfacePlace& on = v.place;
  if (view.assets) {
    const SurfacePoint p = surfacePoint(view, instanceIndex, on.primitive, on.triangle, on.barycentric);
    const float side = on.back ? -1.0f : 1.0f;
    v.position = p.position;
    v.geometricNormal = side * p.geometricNormal;
    v.normal = glm::dot(p.normal, p.geometricNormal) > 0 ? side * p.normal : v.geometricNormal;
  } else {
    const mat3 normalFromObject = glm::transpose(glm::inverse(mat3(carrier.worldFromObject)));
    v.position = vec3(carrier.worldFromObject * vec4(on.position, 1));
    v.normal = glm::normalize(normalFromObject * on.normal);
    v.geometricNormal = glm::normalize(normalFromObject * on.geometricNormal);
  }
  // Squashed to nothing.
  if (!isFinite(v.position) || !isFinite(v.normal) || !(glm::dot(v.geometricNormal, v.geometricNormal) > 0.5f))
    v.alive = v.valid = false;
}

/// No VPL stands for more than this, m²: 16 times the mean share. An isolated VPL's disk would else reach far beyond
/// the surface it is on (the paper's clothes line).
float areaLimit(const VplSet& set) { return 16 * set.visibleArea / float(std::max<size_t>(16, set.slots.size())); }

/// Half the paths rank well enough, so two estimates cost what paper 1's one for VPLs and one for candidates did.
int samplerPaths(const SmcSettings& settings) { return std::max(1, settings.paths / 2); }

/// The sampler's densities, k = 1.
void estimateSamplerDensities(VplSet& set, const SmcSettings& settings) {
  const LivePoints live = livePoints<Vpl>(set.slots);
  const std::vector<float> areas =
      representedAreas(live.points, live.points, true, 1, settings.density, areaLimit(set));
  for (size_t i = 0; i < areas.size(); ++i) set.slots[live.slots[i]].candidateArea = areas[i];
}

void light(std::span<const RadianceJob> jobs, const VplUpdate& in, const ChangesSince& since, RadianceUse use,
           VplUpdateLog& log) {
  const RadianceUpdate update{.paths = use == RadianceUse::Rendering ? in.settings.paths : samplerPaths(in.settings),
                              .bounces = in.settings.bounces,
                              .seed = in.seed,
                              .use = use,
                              .moved = &since.moved,
                              .lightsChanged = since.lights,
                              .instancesChanged = since.instances,
                              .lastRays = in.effects.lastRays};
  const PathCounts counts = estimateRadiance(jobs, in.rays, in.lights, update);
  log.paths += counts;
  log.radiosity += counts.rays;
  if (use == RadianceUse::Rendering) log.relit += uint32_t(counts.lit);
}

/// What rendering uses: areas of all VPLs, radiance of `moved` slots and of those whose cell changed, or of all.
void estimateLight(VplSet& set, const VplUpdate& in, const ChangesSince& since, std::span<const uint32_t> moved,
                   bool all, VplUpdateLog& log) {
  const SmcSettings& settings = in.settings;
  const bool cells = settings.density == DensityEstimator::Cells;
  std::vector<uint32_t> changed(moved.begin(), moved.end());
  {
    CpuScope scope(log.stages, key(StageId::Density));
    if (cells) {
      changed = updateCells(set, in.rays, since.moved, moved, std::sqrt(areaLimit(set) / kPi), in.seed, log.cells);
    } else {
      set.cells.clear();
      const LivePoints live = livePoints<Vpl>(set.slots);
      const std::vector<float> areas = representedAreas(
          live.points, live.points, true, neighboursForRendering(settings), settings.density, areaLimit(set));
      for (size_t i = 0; i < areas.size(); ++i) set.slots[live.slots[i]].area = areas[i];
    }
  }
  CpuScope scope(log.stages, key(StageId::Radiosity));
  if (all) {
    changed.clear();
    for (uint32_t i = 0; i < set.slots.size(); ++i) changed.push_back(i);
  }
  std::vector<RadianceJob> jobs;
  for (uint32_t slot : changed)
    if (set.slots[slot].alive)
      jobs.push_back(
          {&set.slots[slot], cells ? &set.cells[slot] : nullptr, settings.cache ? &set.lightPaths[slot] : nullptr});
  light(jobs, in, since, RadianceUse::Rendering, log);
  if (all) log.relitForChange = log.relit;
}

/// Drops candidates that the camera no longer sees by their mailbox, and makes room for those of this frame. Returns
/// how many are to be drawn: a share of N, twice that while lights or objects move, since light then comes to places
/// where none was looked for (a door that opens: error over that at rest 1.24 or 1.02), and as many as there are empty
/// slots, which only new places with light fill.
int makeRoomInPool(VplSet& set, const SmcSettings& settings, bool changing) {
  const auto isEmpty = [](const Vpl& v) { return !v.alive; };
  const int empty = int(std::count_if(set.slots.begin(), set.slots.end(), isEmpty));
  const int mean = (settings.vpls + settings.poolFrames - 1) / settings.poolFrames;
  const int share = std::min(settings.vpls, std::max(changing ? 2 * mean : mean, empty));
  size_t kept = 0;
  for (size_t i = 0; i < set.pool.size(); ++i) {
    if (!set.pool[i].valid || set.pool[i].alive) continue; // lost, or taken
    if (kept != i) {
      set.pool[kept] = set.pool[i];
      std::swap(set.poolPaths[kept], set.poolPaths[i]);
    }
    ++kept;
  }
  const size_t room = size_t(std::max(0, settings.vpls - share));
  const size_t oldest = kept > room ? kept - room : 0;
  set.pool.resize(kept);
  set.poolPaths.resize(kept);
  set.pool.erase(set.pool.begin(), set.pool.begin() + oldest);
  set.poolPaths.erase(set.poolPaths.begin(), set.poolPaths.begin() + oldest);
  return settings.vpls - int(set.pool.size());
}

/// Winners keep the paths that they were judged by.
void handOverPaths(VplSet& set, std::span<const uint32_t> movedSlots) {
  std::unordered_map<uint64_t, size_t> byId;
  for (size_t i = 0; i < set.pool.size(); ++i)
    if (set.pool[i].alive) byId.emplace(set.pool[i].id, i);
  for (uint32_t slot : movedSlots) std::swap(set.samplerPaths[slot], set.poolPaths[byId.at(set.slots[slot].id)]);
}

struct Iteration {
  int moves;
  bool relight;  // all values of the sampler
  bool mayBurst; // the camera changed: a cut is possible
  bool changing; // lights or objects are
};

VplChanges iterate(VplSet& set, const VplUpdate& in, const ChangesSince& since, const Iteration& now,
                   VplUpdateLog& log) {
  const SmcSettings& settings = in.settings;
  ++set.frame;
  std::vector<VisiblePoint> points;
  int draws = 0;
  {
    CpuScope scope(log.stages, key(StageId::Validate));
    const VisibilityUpdate changed{since.camera, &since.moved, since.carried};
    verifyMailboxes(set.slots, in.rays, in.view.camera, changed, log.validation);
    verifyMailboxes(set.pool, in.rays, in.view.camera, {since.camera, &since.moved}, log.validation);
    draws = makeRoomInPool(set, settings, now.changing);
  }
  const auto open = [](const Vpl& v) { return v.alive && !v.valid; };
  const bool anyOpen = std::any_of(set.slots.begin(), set.slots.end(), open);
  {
    CpuScope scope(log.stages, key(StageId::Points));
    // As many rays towards candidates leave each point whether few or all candidates are drawn.
    const int wanted = anyOpen ? settings.points : int(int64_t(settings.points) * draws / settings.vpls);
    points = findVisiblePoints(in.rays, in.view.camera, std::max(1, wanted), in.seed, set.frame, log.points);
  }
  if (points.empty()) { // the camera faces the sky: nothing can be verified, nothing is lost
    VplChanges none;
    for (const Vpl& v : set.slots) none.alive += v.alive;
    none.kept = none.alive;
    set.settling.observe(0, 0, settings.vpls, now.moves);
    return none;
  }
  if (anyOpen) {
    CpuScope scope(log.stages, key(StageId::Validate));
    verifyByPoints(set, in.rays, points, settings.validationRays, in.seed, log.validation);
  }
  std::vector<CandidateHit> hits;
  {
    CpuScope scope(log.stages, key(StageId::Candidates));
    hits = traceCandidates(in.rays, points, settings.candidateRays * draws, in.seed, set.frame, log.candidates);
  }
  Resampled resampled;
  {
    CpuScope scope(log.stages, key(StageId::Resample));
    resampled = resampleUniformInArea(hits, draws, in.seed, set.frame);
    // A slow average: the limit on areas must not flicker.
    const float area = float(resampled.area);
    set.visibleArea = set.visibleArea > 0 ? glm::mix(set.visibleArea, area, 1.0f / 16) : area;
  }
  {
    CpuScope scope(log.stages, key(StageId::Radiosity));
    const size_t old = now.relight ? 0 : set.pool.size();
    for (uint32_t pick : resampled.picks) set.pool.push_back(vplAt(hits[pick], in.view, set.nextId++));
    set.poolPaths.resize(set.pool.size());
    std::vector<RadianceJob> jobs;
    if (now.relight)
      for (uint32_t i = 0; i < set.slots.size(); ++i)
        if (set.slots[i].alive)
          jobs.push_back({&set.slots[i], nullptr, settings.cache ? &set.samplerPaths[i] : nullptr});
    for (size_t i = old; i < set.pool.size(); ++i)
      jobs.push_back({&set.pool[i], nullptr, settings.cache ? &set.poolPaths[i] : nullptr});
    light(jobs, in, since, RadianceUse::Sampling, log);
  }
  VplChanges changes;
  {
    CpuScope scope(log.stages, key(StageId::Replace));
    std::vector<DensityPoint> queries;
    for (const Vpl& v : set.pool) queries.push_back({v.position, v.normal, v.share});
    const std::vector<float> areas =
        representedAreas(queries, livePoints<Vpl>(set.slots).points, false, 1, settings.density, areaLimit(set));
    for (size_t i = 0; i < set.pool.size(); ++i) set.pool[i].candidateArea = areas[i];
    size_t alive = 0, invalid = 0;
    for (const Vpl& v : set.slots) alive += v.alive, invalid += v.alive && !v.valid;
    // After a cut the bound is lifted. A third lost at once is one too, though what is left may stay: at 16 a frame
    // half of 2048 would come back within a second only.
    const bool burst = now.mayBurst && invalid * 2 > alive, cut = now.mayBurst && invalid * 3 > alive;
    const int most = burst ? settings.vpls : cut ? std::max(now.moves, int(invalid)) : now.moves;
    changes = replaceVpls(set, set.pool, most, settings.density);
    changes.burst = burst;
    changes.placedSlots = std::move(changes.movedSlots);
    handOverPaths(set, changes.placedSlots);
    estimateSamplerDensities(set, settings);
    set.settling.observe(changes.strong, changes.invalid, settings.vpls, now.moves);
  }
  return changes;
}

/// Rows of the same name add up: a burst or the warm-up runs the stages several times.
void mergeStages(std::vector<StageTime>& stages) {
  std::vector<StageTime> merged;
  for (const StageTime& s : stages) {
    const auto same =
        std::find_if(merged.begin(), merged.end(), [&](const StageTime& m) { return m.stage == s.stage; });
    if (same == merged.end())
      merged.push_back(s);
    else
      same->cpuMs += s.cpuMs;
  }
  stages = std::move(merged);
}

} // namespace

Vpl vplAt(const CandidateHit& h, const SceneView& view, uint64_t id) {
  const InstanceView& carrier = view.instances[h.instance];
  const mat3 normalFromWorld = glm::transpose(mat3(carrier.worldFromObject));
  Vpl v;
  v.albedo = h.albedo;
  v.share = h.share;
  v.mailbox = h.from;
  v.instance = carrier.id;
  v.place = {vec3(glm::inverse(carrier.worldFromObject) * vec4(h.position, 1)),
             glm::normalize(normalFromWorld * h.normal),
             glm::normalize(normalFromWorld * h.geometricNormal),
             carrier.mesh,
             h.primitive,
             h.triangle,
             h.barycentric};
  if (view.assets) {
    const SurfacePoint p = surfacePoint(view, h.instance, h.primitive, h.triangle, h.barycentric);
    v.place.back = glm::dot(p.geometricNormal, h.geometricNormal) < 0;
  }
  v.id = id;
  v.valid = true;
  place(v, view, h.instance); // so that it stands to the bit where it stands when carried nowhere
  return v;
}

std::vector<uint32_t> carryVpls(VplSet& set, const SceneView& view, bool all) {
  std::vector<uint32_t> carried;
  std::unordered_map<uint32_t, uint32_t> indexOf;
  for (uint32_t i = 0; i < view.instances.size(); ++i) indexOf.emplace(view.instances[i].id, i);
  for (uint32_t slot = 0; slot < set.slots.size(); ++slot) {
    Vpl& v = set.slots[slot];
    if (!v.alive) continue;
    const auto carrier = indexOf.find(v.instance);
    if (carrier == indexOf.end() || view.instances[carrier->second].mesh != v.place.mesh) {
      v.alive = v.valid = false;
      continue;
    }
    if (!all && !view.instances[carrier->second].moved) continue;
    const vec3 position = v.position, normal = v.normal, geometricNormal = v.geometricNormal;
    place(v, view, carrier->second);
    if (v.position != position || v.normal != normal || v.geometricNormal != geometricNormal) carried.push_back(slot);
  }
  return carried;
}

VplChanges updateVpls(VplSet& set, const VplUpdate& in, VplUpdateLog& log,
                      const std::function<void(int, int)>& progress) {
  const SmcSettings& settings = in.settings;
  const SceneChanges& changed = in.view.changes;
  const VplEffects& effects = in.effects;
  const bool start = set.slots.empty();
  std::vector<uint32_t> moved;
  set.slots.resize(settings.vpls);
  set.samplerPaths.resize(set.slots.size());
  set.lightPaths.resize(set.slots.size());
  ChangesSince since;
  since.camera = changed.camera;
  since.lights = effects.relightAll ||
                 (effects.relight && (changed.lights || changed.first || in.settingsChanged || emittersChanged(in)));
  since.instances = changed.instances;
  since.moved = DirtyRegion(in.view);
  const bool still = !changed.first && !changed.camera && !changed.lights && !since.geometry() && !in.settingsChanged;
  if (changed.first || !settings.cache || (!effects.relight && since.geometry()))
    for (auto* all : {&set.samplerPaths, &set.lightPaths, &set.poolPaths})
      for (KeptPaths& k : *all) k.clear();
  if (changed.first || (effects.replace && set.sampledLate)) { // nothing of the sampler can be relied on
    set.pool.clear();
    set.poolPaths.clear();
    for (KeptPaths& k : set.samplerPaths) k.clear();
  }
  if (changed.first) set.cells.clear();
  if (changed.geometry || changed.instances || changed.first || effects.carryAll) {
    moved = carryVpls(set, in.view, changed.first || effects.carryAll);
    since.carried.assign(set.slots.size(), 0);
    for (uint32_t slot : moved) since.carried[slot] = 1;
    std::unordered_map<uint32_t, uint32_t> stayed; // meshes by object
    for (const InstanceView& i : in.view.instances)
      if (!i.moved) stayed.emplace(i.id, i.mesh);
    for (Vpl& v : set.pool) {
      const auto carrier = stayed.find(v.instance);
      v.valid = v.valid && carrier != stayed.end() && carrier->second == v.place.mesh;
    }
  }

  const bool settingsChanged = set.litPaths != settings.paths || set.litBounces != settings.bounces;
  const bool relight = since.lights || (effects.relight && (since.geometry() || settingsChanged || !settings.cache));
  const bool estimatorChanged = set.cells.empty() == (settings.density == DensityEstimator::Cells);
  set.litPaths = settings.paths;
  set.litBounces = settings.bounces;
  if (!still) set.settling.restart();

  VplChanges all;
  if (effects.replace || start) {
    ChangesSince sampled = since;
    sampled.camera |= set.sampledLate;
    const bool changing = changed.lights || since.geometry() || emittersChanged(in);
    Iteration now{settings.moves, relight || set.sampledLate, changed.camera && !start, changing};
    set.sampledLate = false;
    all = iterate(set, in, sampled, now, log);
    // The set as first sampled, and the set after a cut, are only candidates: let the sampler settle before the
    // frame.
    constexpr int kBurstIterations = 3;
    const int more = start ? warmupOf(settings, in.view.rayWork) : all.burst ? kBurstIterations : 0;
    now = {start ? settings.moves : std::max(settings.moves, settings.vpls / 8), false, false, false};
    for (int i = 0; i < more; ++i) {
      if (progress) progress(i, more);
      VplChanges next = iterate(set, in, {}, now, log);
      next.burst = all.burst;
      next.placedSlots.insert(next.placedSlots.end(), all.placedSlots.begin(), all.placedSlots.end());
      all = std::move(next);
    }
    if (progress && more) progress(more, more);
  } else {
    set.sampledLate |= !still || relight;
    for (const Vpl& v : set.slots) all.alive += v.alive;
  }
  const auto ascending = [](std::vector<uint32_t>& slots) {
    std::sort(slots.begin(), slots.end());
    slots.erase(std::unique(slots.begin(), slots.end()), slots.end());
  };
  ascending(all.placedSlots);
  moved.insert(moved.end(), all.placedSlots.begin(), all.placedSlots.end());
  ascending(moved);
  estimateLight(set, in, since, moved, relight || estimatorChanged, log);
  all.movedSlots = std::move(moved);
  all.kept = all.alive - std::min<uint32_t>(all.alive, uint32_t(all.movedSlots.size()));
  mergeStages(log.stages);
  return all;
}

} // namespace lambent

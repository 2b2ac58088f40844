// Poisson samples over all surfaces (paper 4, 3.2): virtual lights that stand where they stand whatever the camera
// does, ride on their triangles, and are lit again where the light or what they see changes. The paper lights them by
// rays to the area light; ours take light as every VPL does, so all kinds of lights count, and smc.bounces bounces.
#include "engine/core/parallel.h"
#include "engine/core/rng.h"
#include "engine/core/sampling.h"
#include "engine/view/surface_point.h"
#include "gi/vpl/sources.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace lambent {

namespace {

/// A triangle of an instance, in world space.
struct Piece {
  uint32_t instance, primitive, triangle;
  float area; // m²
};

std::vector<Piece> piecesOf(const SceneView& view) {
  std::vector<Piece> pieces;
  for (uint32_t i = 0; i < view.instances.size(); ++i) {
    const InstanceView& in = view.instances[i];
    const Mesh& mesh = view.assets->meshes[in.mesh];
    const std::vector<vec3>& corners = in.deformed ? in.deformed->positions : mesh.positions;
    const auto at = [&](uint32_t corner) { return vec3(in.worldFromObject * vec4(corners[corner], 1)); };
    for (uint32_t p = 0; p < mesh.primitives.size(); ++p) {
      const Primitive& primitive = mesh.primitives[p];
      if (maxComponent(view.assets->materials[primitive.material].baseColor) <= 0) continue; // reflects nothing
      for (uint32_t t = 0; t < primitive.triangleCount; ++t) {
        const uvec3 c = mesh.triangles[primitive.firstTriangle + t];
        const vec3 a = at(c.x);
        const float area = glm::length(glm::cross(at(c.y) - a, at(c.z) - a)) / 2;
        if (area > 0 && std::isfinite(area)) pieces.push_back({i, p, t, area});
      }
    }
  }
  return pieces;
}

/// Points uniform over both sides of the pieces, `count` of them; without those where a mask leaves nothing, and
/// those that something else covers. `area`: of all that is left, m².
std::vector<CandidateHit> drawPoints(const VplUpdate& in, std::span<const Piece> pieces, uint32_t count, double& area) {
  std::vector<float> areas;
  for (const Piece& p : pieces) areas.push_back(p.area);
  const Distribution byArea(areas);
  std::vector<Ray> rays;
  for (uint32_t i = 0; i < count; ++i) {
    Rng rng(in.seed, Stream::SurfaceSamples, i);
    const Piece& p = pieces[byArea.sample((float(i) + rng.next()) / float(count))];
    const vec2 u = rng.next2();
    const SurfacePoint at = surfacePoint(in.view, p.instance, p.primitive, p.triangle, sampleTriangle(u));
    const vec3 side = rng.next() < 0.5f ? -at.geometricNormal : at.geometricNormal;
    const float off = glm::distance(offsetPoint(at.position, side, in.rays.rayEpsilon()), at.position);
    rays.push_back({at.position + side * off, -side, 2 * off});
  }
  std::vector<SurfaceHit> hits(rays.size());
  in.rays.closest(rays, hits);
  std::vector<CandidateHit> points;
  for (size_t i = 0; i < hits.size(); ++i) {
    const SurfaceHit& h = hits[i];
    if (!h.valid() || !isFinite(h.position) || !isFinite(h.normal)) continue;
    points.push_back({h.position, h.normal, h.geometricNormal, h.albedo, rays[i].origin, h.instance, h.primitive,
                      h.triangle, h.barycentric});
  }
  area = 2 * byArea.total() * double(points.size()) / double(count);
  return points;
}

/// `count` of them, no two of one side nearer to each other than need be: in the order given, whoever keeps the
/// distance is taken, and where too few do, the distance shrinks.
std::vector<uint32_t> thinned(std::span<const CandidateHit> points, uint32_t count, double area) {
  std::vector<uint32_t> taken, left(points.size());
  // Drawn in order along the surfaces; here they come in another.
  const std::vector<uint32_t> order = spreadOrder(uint32_t(points.size()), 0.6180339887498949);
  std::copy(order.begin(), order.end(), left.begin());
  // Of the densest packing of circles two thirds are reached by throwing.
  float distance = float(std::sqrt(2 * area / (std::sqrt(3.0) * std::max(1u, count)))) * 0.85f;
  while (taken.size() < count && !left.empty()) {
    std::unordered_multimap<uint64_t, uint32_t> grid;
    const auto cellOf = [&](const vec3& p) { return ivec3(glm::floor((p - points[0].position) / distance)); };
    const auto keyOf = [](const ivec3& c) {
      return uint64_t(uint32_t(c.x)) * 73856093u ^ uint64_t(uint32_t(c.y)) * 19349663u << 16 ^
             uint64_t(uint32_t(c.z)) * 83492791u << 32;
    };
    const auto crowded = [&](const CandidateHit& p) {
      for (int i = 0; i < 27; ++i) {
        const ivec3 cell = cellOf(p.position) + ivec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        const auto [first, last] = grid.equal_range(keyOf(cell));
        for (auto it = first; it != last; ++it) {
          const CandidateHit& other = points[it->second];
          if (glm::distance(other.position, p.position) < distance &&
              sameSide(other.geometricNormal, p.geometricNormal))
            return true;
        }
      }
      return false;
    };
    for (uint32_t t : taken) grid.emplace(keyOf(cellOf(points[t].position)), t);
    std::vector<uint32_t> refused;
    for (uint32_t i : left) {
      if (taken.size() >= count || crowded(points[i])) {
        refused.push_back(i);
        continue;
      }
      grid.emplace(keyOf(cellOf(points[i].position)), i);
      taken.push_back(i);
    }
    left = std::move(refused);
    distance *= 0.8f;
  }
  return taken;
}

/// Of each point the nearest kept one of its surface, which sees it and faces about the same way: who stands for it.
/// (On the other side of a wall its light would be lost, or be where none is.)
std::vector<uint32_t> ownersOf(std::span<const CandidateHit> points, std::span<const uint32_t> kept,
                               const RayQuery& rays) {
  constexpr size_t kAsked = 12;
  std::vector<DensityPoint> places;
  for (uint32_t k : kept) places.push_back({points[k].position, points[k].geometricNormal});
  const NeighbourTree tree(places);
  const auto off = [&](const DensityPoint& p) { return offsetPoint(p.position, p.normal, rays.rayEpsilon()); };
  std::vector<uint32_t> owners(points.size());
  parallelFor(points.size(), 256, [&](size_t begin, size_t end) {
    uint32_t near[kAsked];
    float distance2[kAsked];
    for (size_t i = begin; i < end; ++i) {
      const DensityPoint point{points[i].position, points[i].geometricNormal};
      const size_t found = tree.nearest(point.position, kAsked, near, distance2);
      const auto standsFor = [&](uint32_t n) {
        return glm::dot(places[n].normal, point.normal) > 0.5f && (!rays.occluded(segment(off(point), off(places[n]))));
      };
      const uint32_t* last = near + found;
      const uint32_t* owner = std::find_if(static_cast<const uint32_t*>(near), last, standsFor);
      owners[i] = owner == last ? kNone : *owner;
    }
  });
  return owners;
}

/// Cells from the points, where these stand now. Of the pool each slot has as many as its cell, one slot after another.
void fillCells(VplSet& set) {
  size_t next = 0;
  for (size_t slot = 0; slot < set.slots.size(); ++slot) {
    Vpl& v = set.slots[slot];
    v.area = 0;
    for (CellPoint& point : set.cells[slot].points) {
      const Vpl& p = set.pool[next++];
      point = {p.position, p.normal, p.geometricNormal, p.albedo, p.alive ? p.area : 0};
      v.area += point.area;
    }
    v.alive = v.alive && v.area > 0;
    v.candidateArea = v.area;
  }
}

void placeAll(VplSet& set, const VplUpdate& in) {
  const uint32_t count = uint32_t(in.settings.vpls);
  set.slots.assign(count, {});
  set.lightPaths.assign(count, {});
  set.cells.assign(count, {});
  set.pool.clear();
  const std::vector<Piece> pieces = in.view.assets ? piecesOf(in.view) : std::vector<Piece>();
  if (pieces.empty()) return;
  constexpr uint32_t kChoice = 16; // points drawn for each that is kept
  double area = 0;
  const std::vector<CandidateHit> points = drawPoints(in, pieces, kChoice * count, area);
  const std::vector<uint32_t> kept = thinned(points, count, area);
  if (kept.empty()) return;
  const std::vector<uint32_t> owners = ownersOf(points, kept, in.rays);
  std::vector<std::vector<uint32_t>> owned(kept.size());
  for (uint32_t i = 0; i < points.size(); ++i)
    if (owners[i] != kNone) owned[owners[i]].push_back(i);
  for (uint32_t slot = 0; slot < kept.size(); ++slot) {
    const CandidateHit& middle = points[kept[slot]];
    Vpl& v = set.slots[slot];
    v = vplAt(middle, in.view, set.nextId++);
    v.alive = v.valid;
    v.bornFrame = set.frame;
    std::stable_sort(owned[slot].begin(), owned[slot].end(), [&](uint32_t a, uint32_t b) {
      return glm::distance(points[a].position, middle.position) < glm::distance(points[b].position, middle.position);
    });
    set.cells[slot].points.resize(owned[slot].size());
    for (uint32_t i : owned[slot]) {
      Vpl& p = set.pool.emplace_back(vplAt(points[i], in.view, 0));
      p.alive = p.valid;
      p.area = float(area / double(points.size()));
    }
  }
  fillCells(set);
}

/// Slots that stand elsewhere.
std::vector<uint32_t> carry(VplSet& set, const VplUpdate& in) {
  VplSet points;
  std::swap(points.slots, set.pool);
  carryVpls(points, in.view, in.effects.carryAll);
  std::swap(points.slots, set.pool);
  const std::vector<uint32_t> moved = carryVpls(set, in.view, in.effects.carryAll);
  fillCells(set);
  return moved;
}

} // namespace

VplChanges placeOverSurfaces(VplSet& set, const VplUpdate& in, VplUpdateLog& log) {
  const SceneChanges& changed = in.view.changes;
  ++set.frame;
  const bool fresh = changed.first || changed.instances || set.slots.size() != size_t(in.settings.vpls);
  VplChanges changes;
  if (fresh) {
    CpuScope scope(log.stages, key(StageId::Candidates));
    placeAll(set, in);
    for (uint32_t i = 0; i < set.slots.size(); ++i) changes.movedSlots.push_back(i);
    changes.placedSlots = changes.movedSlots;
  } else if (changed.geometry || in.effects.carryAll) {
    changes.movedSlots = carry(set, in);
  }
  for (const Vpl& v : set.slots) changes.alive += v.alive;
  changes.kept = changes.alive - std::min<uint32_t>(changes.alive, uint32_t(changes.movedSlots.size()));

  const bool lampsMoved = std::any_of(in.lights.emitters.begin(), in.lights.emitters.end(),
                                      [&](const Emitter& e) { return in.view.instances[e.instance].moved; });
  const bool settingsChanged = set.litPaths != in.settings.paths || set.litBounces != in.settings.bounces;
  const bool lightsChanged = in.effects.relightAll || (in.effects.relight && (changed.lights || in.settingsChanged));
  if (!fresh && !settingsChanged && !lightsChanged && !(in.effects.relight && (changed.geometry || lampsMoved)))
    return changes;
  set.litPaths = in.settings.paths;
  set.litBounces = in.settings.bounces;
  CpuScope scope(log.stages, key(StageId::Radiosity));
  const DirtyRegion moved(in.view);
  std::vector<RadianceJob> jobs;
  for (uint32_t i = 0; i < set.slots.size(); ++i) {
    if (!in.settings.cache || (!in.effects.relight && changed.geometry)) set.lightPaths[i].clear();
    if (set.slots[i].alive)
      jobs.push_back({&set.slots[i], &set.cells[i], in.settings.cache ? &set.lightPaths[i] : nullptr});
  }
  const PathCounts counts = estimateRadiance(jobs, in.rays, in.lights,
                                             {.paths = in.settings.paths,
                                              .bounces = in.settings.bounces,
                                              .seed = in.seed,
                                              .moved = &moved,
                                              .lightsChanged = lightsChanged || lampsMoved || fresh,
                                              .instancesChanged = changed.instances,
                                              .lastRays = in.effects.lastRays});
  log.paths += counts;
  log.radiosity += counts.rays;
  log.relit += uint32_t(counts.lit);
  log.relitForChange = log.relit;
  return changes;
}

} // namespace lambent

// Poisson samples over all surfaces (paper 4, 3.2): virtual lights that stand where they stand whatever the camera
// does, ride on their triangles, and are lit anew where the light or what they see changes. The paper lights them by
// rays to the area light; ours take light as every VPL does, so all kinds of lights count, and smc.bounces bounces.
#include "engine/core/rng.h"
#include "engine/core/sampling.h"
#include "engine/scene/surface_point.h"
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
/// those that something else covers. Adds up the share that is left.
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
    const float off = glm::distance(offsetPoint(at.position, side, in.rays.grain()), at.position);
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

void placeAnew(VplSet& set, const VplUpdate& in) {
  const uint32_t count = uint32_t(in.settings.vpls);
  set.slots.assign(count, {});
  set.lightPaths.assign(count, {});
  if (!in.view.assets) return;
  const std::vector<Piece> pieces = piecesOf(in.view);
  if (pieces.empty()) return;
  constexpr uint32_t kChoice = 5; // points drawn for each that is kept
  double area = 0;
  const std::vector<CandidateHit> points = drawPoints(in, pieces, kChoice * count, area);
  const std::vector<uint32_t> kept = thinned(points, count, area);
  for (uint32_t slot = 0; slot < kept.size(); ++slot) {
    Vpl& v = set.slots[slot];
    v = vplAt(points[kept[slot]], in.view, set.nextId++);
    v.alive = v.valid;
    v.bornFrame = set.frame;
    v.area = v.candidateArea = float(area / double(kept.size()));
  }
}

} // namespace

VplChanges placeOverSurfaces(VplSet& set, const VplUpdate& in, VplUpdateLog& log) {
  const SceneChanges& changed = in.view.changes;
  ++set.frame;
  const bool anew = changed.first || changed.instances || set.slots.size() != size_t(in.settings.vpls);
  VplChanges changes;
  if (anew) {
    CpuScope scope(log.stages, key(StageId::Candidates));
    placeAnew(set, in);
    for (uint32_t i = 0; i < set.slots.size(); ++i) changes.movedSlots.push_back(i);
    changes.placedSlots = changes.movedSlots;
  } else if (changed.geometry || in.effects.carryAll) {
    changes.movedSlots = carryVpls(set, in.view, in.effects.carryAll);
  }
  for (const Vpl& v : set.slots) changes.alive += v.alive;
  changes.kept = changes.alive - std::min<uint32_t>(changes.alive, uint32_t(changes.movedSlots.size()));

  const bool lampsMoved = std::any_of(in.lights.emitters.begin(), in.lights.emitters.end(),
                                      [&](const Emitter& e) { return in.view.instances[e.instance].moved; });
  const bool settingsChanged = set.litPaths != in.settings.paths || set.litBounces != in.settings.bounces;
  const bool lightsChanged = in.effects.relightAll || (in.effects.relight && (changed.lights || in.settingsChanged));
  if (!anew && !settingsChanged && !lightsChanged && !(in.effects.relight && (changed.geometry || lampsMoved)))
    return changes;
  set.litPaths = in.settings.paths;
  set.litBounces = in.settings.bounces;
  CpuScope scope(log.stages, key(StageId::Radiosity));
  const Disturbance moved(in.view);
  std::vector<RadianceJob> jobs;
  for (uint32_t i = 0; i < set.slots.size(); ++i) {
    if (!in.settings.cache || (!in.effects.relight && changed.geometry)) set.lightPaths[i].clear();
    if (set.slots[i].alive) jobs.push_back({&set.slots[i], nullptr, in.settings.cache ? &set.lightPaths[i] : nullptr});
  }
  const PathCounts counts = estimateRadiance(jobs, in.rays, in.lights,
                                             {.paths = in.settings.paths,
                                              .bounces = in.settings.bounces,
                                              .seed = in.seed,
                                              .moved = &moved,
                                              .lightsChanged = lightsChanged || lampsMoved || anew,
                                              .instancesChanged = changed.instances,
                                              .lastRays = in.effects.lastRays});
  log.paths += counts;
  log.radiosity += counts.rays;
  log.relit += uint32_t(counts.lit);
  log.relitForChange = log.relit;
  return changes;
}

} // namespace lambent

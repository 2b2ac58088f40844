// What a VPL stands for, without guessing from its neighbours' distances: its cell, the surface that is nearer to it
// than to any other VPL on the same side. Cells cover the surface once, so the light that leaves all of them is the
// light of the scene, whatever the density of VPLs does. Densities by nearest neighbours (paper 1, 3.2.4) err where it
// changes within the neighbourhood: at rims of sunlit patches, on thin parts, in corners.
//
// The surface is sampled around every VPL when it is placed: chords of spheres about it meet surfaces. Half of the
// chords run along the normal, half in all directions (a surface of any orientation is met in proportion to its area,
// Cauchy–Crofton), in spheres of several sizes, so that neither a dense set nor a lone VPL is sampled poorly. A point
// belongs to the nearest VPL that is connected to it, whoever drew it, and stands for the inverse of the density that
// all who could have drawn it leave there together (the balance heuristic: Veach and Guibas 1995). With the density of
// its own VPL's chords alone the few points in the largest sphere stand for up to 25 squared radii each, and one of
// them in the sun brought a quarter of a classroom's light. When a VPL moves only the points around it are looked at
// again; where an object moves, the chords and segments that meet where it was or is.
#include "engine/core/parallel.h"
#include "engine/core/rng.h"
#include "engine/core/sampling.h"
#include "gi/vpl/smc.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

namespace lambent {

namespace {

/// Sizes of spheres, in radii of the cell's scale, and their shares of the chords.
struct Scale {
  float radius;
  int chords;
};
constexpr std::array<Scale, 4> kScales{{{0.35f, 8}, {1, 32}, {2, 16}, {4, 8}}};
constexpr size_t kChords = [] {
  size_t chords = 0;
  for (const Scale& s : kScales) chords += size_t(s.chords);
  return chords;
}();
constexpr int kHitsPerChord = 4;
constexpr size_t kKept = 12; // samples are kept where their VPL is among so many nearest: it may come to be among kNear
// Where light comes up in the dark the first VPLs are few, and their cells would take in the whole room: places from
// which no such light leaves (a lift that opens the way for light: error in motion over that at rest 1.5 without this
// limit, 1.1 with it; Cornell box and hall at rest: no difference).
constexpr float kReachLimit = 2; // of the limit on radii

/// Samples per m² that the chords of a VPL leave at `p`, at squared distance `distance2` from it. Chords along the
/// normal, uniform over a disk: |c|/(π R²) each, with c the cosine between the normals. Isotropic chords: half the mean
/// of |cos| over directions, 1/(2 π R²) each.
float chordDensity(const Vpl& vpl, float radius, const SurfaceSample& p, float distance2, float limit) {
  if (distance2 > limit * limit || !sameSide(p.normal, vpl.normal)) return 0;
  const float c = std::abs(glm::dot(p.geometricNormal, vpl.geometricNormal));
  float density = 0;
  for (const Scale& s : kScales) {
    const float r2 = radius * radius * s.radius * s.radius;
    if (distance2 < r2) density += float(s.chords) * (0.5f * c + 0.25f) / (kPi * r2);
  }
  return density;
}

/// Whether a VPL and a point near it lie on one piece of surface, not on two sides of a wall or of a solid: a segment
/// between them is clear, close to the surface or else lifted off it, over edges and bulges.
struct Connection {
  static constexpr float kLift = 0.3f; // of the distance
  const RayQuery& rays;
  RayCounts& counts;

  /// Nothing where the segment would have to cross a surface: it stops short of its end, so it must come from the
  /// front.
  std::optional<Ray> close(const Vpl& v, const SurfaceSample& p) const {
    const vec3 from = offsetPoint(v.position, v.geometricNormal, rays.rayEpsilon()),
               to = offsetPoint(p.position, p.geometricNormal, rays.rayEpsilon());
    if (glm::dot(from - p.position, p.geometricNormal) <= 0 || glm::dot(to - v.position, v.geometricNormal) <= 0)
      return {};
    return segment(from, to);
  }
  Ray lifted(const Vpl& v, const SurfaceSample& p, float distance) const {
    return segment(offsetPoint(v.position, v.geometricNormal, rays.rayEpsilon()) + kLift * distance * v.geometricNormal,
                   offsetPoint(p.position, p.geometricNormal, rays.rayEpsilon()) +
                       kLift * distance * p.geometricNormal);
  }
  bool operator()(const Vpl& v, const SurfaceSample& p, float distance2) const {
    const std::optional<Ray> ray = close(v, p);
    counts.occlusion += ray ? 1 : 0;
    if (ray && !rays.occluded(*ray)) return true;
    ++counts.occlusion;
    return !rays.occluded(lifted(v, p, std::sqrt(distance2)));
  }
};

/// The VPLs as samples look for them; radii are those of set.cells.
struct Neighbours {
  const VplSet& set;
  const LivePoints& vpls;
  const NeighbourTree& tree;
  float limit; // m: no sample lies farther from who draws or has it

  struct Found {
    std::array<uint32_t, kKept> slots;
    std::array<float, kKept> distance2;
    size_t count = 0;
    bool has(uint32_t slot) const {
      return std::find(slots.begin(), slots.begin() + count, slot) != slots.begin() + count;
    }
  };
  Found around(const vec3& position) const {
    Found found;
    found.count = tree.nearest(position, kKept, found.slots, found.distance2);
    for (size_t j = 0; j < found.count; ++j) found.slots[j] = vpls.slots[found.slots[j]];
    return found;
  }
  /// Sets what stands nearest to `p`, and its density.
  void enter(SurfaceSample& p, uint32_t drawer, const Found& found) const {
    const size_t count = std::min(found.count, SurfaceSample::kNear);
    p.near.fill(kNone);
    p.reach2 = count < SurfaceSample::kNear ? kInfinity : found.distance2[count - 1];
    float density = 0;
    bool among = false;
    for (size_t j = 0; j < count; ++j) {
      const uint32_t slot = p.near[j] = found.slots[j];
      among |= slot == drawer;
      density += chordDensity(set.slots[slot], set.cells[slot].radius, p, found.distance2[j], limit);
    }
    p.density = among ? density : 0;
  }
  float distance2(const SurfaceSample& p, uint32_t slot) const {
    const vec3 d = set.slots[slot].position - p.position;
    return glm::dot(d, d);
  }
  /// Gives `p` to the nearest of `near` that may have it. `known`: whether what was found out when it got its owner
  /// still holds for a VPL. The owner was connected then, nearer ones were not, others were not tried.
  template <class Known> void giveToNearest(SurfaceSample& p, const Connection& connected, const Known& known) const {
    const uint32_t owner = p.owner;
    const float owner2 = p.owner2;
    p.owner = kNone;
    if (!(p.density > 0)) return;
    for (const uint32_t slot : p.near) {
      if (slot == kNone) return;
      const float d2 = distance2(p, slot);
      if (d2 > limit * limit) return;
      if (!sameSide(p.normal, set.slots[slot].normal)) continue;
      const bool settled = owner != kNone && d2 <= owner2 && known(slot);
      if (settled ? slot != owner : !connected(set.slots[slot], p, d2)) continue;
      p.owner = slot;
      p.owner2 = d2;
      return;
    }
  }
};

/// Samples the surface around one VPL. Scratch is kept between calls.
class CellSampler {
 public:
  CellSampler(const RayQuery& rays, const Neighbours& neighbours, uint32_t seed)
      : rays_(rays), neighbours_(neighbours), seed_(seed) {}

  /// Draws all chords of a VPL, or those that meet what `moved`, in place of the samples that the cell has of them,
  /// whose owners are noted. New ones stand behind those that stay; returns how many these are.
  size_t draw(uint32_t slot, VplCell& cell, const DirtyRegion* moved, std::vector<uint32_t>& owners,
              RayCounts& counts) {
    found_.clear();
    chords(neighbours_.set.slots[slot], cell.radius);
    std::array<bool, kChords> met;
    for (size_t i = 0; i < kChords; ++i) met[i] = !moved || moved->touches(batch_[i]);
    for (const SurfaceSample& p : cell.samples) {
      if (!met[p.chord])
        found_.push_back(p);
      else if (p.owner != kNone)
        owners.push_back(p.owner);
    }
    thin([&](size_t i) { return met[i]; });
    const size_t stay = found_.size();
    for (int round = 0; round < kHitsPerChord && !batch_.empty(); ++round) {
      hits_.resize(batch_.size());
      rays_.closest(batch_, hits_);
      counts.closest += batch_.size();
      thin([&](size_t i) {
        Ray& ray = batch_[i];
        const SurfaceHit& h = hits_[i];
        if (!h.valid()) return false;
        addSides(slot, cell.radius, numbers_[i], h);
        // Beyond what was met, also where positions are coarse: else it is met, and counts, twice.
        const float step = h.t + std::max(2e-4f * ray.tMax, 0x1p-20f * maxComponent(glm::abs(h.position)));
        ray = {ray.origin + ray.direction * step, ray.direction, ray.tMax - step};
        return ray.tMax > 0;
      });
    }
    // Room for just these: cells that kept the most that they ever had would grow for as long as objects move.
    cell.samples = std::vector<SurfaceSample>(found_.begin(), found_.end());
    return stay;
  }

 private:
  void chords(const Vpl& vpl, float radius) {
    batch_.clear();
    numbers_.resize(kChords);
    std::iota(numbers_.begin(), numbers_.end(), uint8_t(0));
    Rng rng(seed_, Stream::Cells, uint32_t(mix64(vpl.id)));
    const vec3 shift = rng.next3();
    const vec2 shiftDisk = rng.next2();
    uint32_t number = 0;
    for (const Scale& scale : kScales) {
      const float r = radius * scale.radius;
      for (int i = 0; i < scale.chords; ++i, ++number) {
        const vec3 u = additiveRecurrence3(number, shift);
        const vec3 along = i % 2 ? sampleSphere({u.x, u.y}) : -vpl.geometricNormal;
        const vec2 v = i % 2 ? vec2(u.z, glm::fract(u.x * 7.31f + shiftDisk.y)) : vec2(u.x, u.y);
        const float rho = std::sqrt(v.x), phi = 2 * kPi * v.y;
        const vec3 helper = std::abs(along.y) < 0.9f ? vec3(0, 1, 0) : vec3(1, 0, 0);
        const vec3 s = glm::normalize(glm::cross(helper, along)), t = glm::cross(along, s);
        const float half = r * std::sqrt(std::max(0.0f, 1 - rho * rho));
        const vec3 middle = vpl.position + r * rho * (std::cos(phi) * s + std::sin(phi) * t);
        batch_.push_back({middle - half * along, along, 2 * half});
      }
    }
  }

  /// Only chords of the batch that `stays` says so of, by place.
  template <class Stays> void thin(const Stays& stays) {
    size_t count = 0;
    for (size_t i = 0; i < batch_.size(); ++i) {
      if (!stays(i)) continue;
      batch_[count] = batch_[i];
      numbers_[count++] = numbers_[i];
    }
    batch_.resize(count);
    numbers_.resize(count);
  }

  /// Both sides of the surface met, where they may belong to a VPL's.
  void addSides(uint32_t slot, float radius, uint8_t chord, const SurfaceHit& h) {
    if (!isFinite(h.position) || !isFinite(h.normal)) return;
    const Vpl& vpl = neighbours_.set.slots[slot];
    const vec3 d = h.position - vpl.position;
    std::optional<Neighbours::Found> found;
    for (const float side : {1.0f, -1.0f}) {
      SurfaceSample p;
      p.chord = chord;
      p.position = h.position;
      p.normal = side * h.normal;
      p.geometricNormal = side * h.geometricNormal;
      p.albedo = h.albedo;
      if (!(chordDensity(vpl, radius, p, glm::dot(d, d), neighbours_.limit) > 0)) continue;
      if (!found) found = neighbours_.around(p.position);
      if (!found->has(slot)) return;
      neighbours_.enter(p, slot, *found);
      found_.push_back(p);
    }
  }

  const RayQuery& rays_;
  const Neighbours& neighbours_;
  const uint32_t seed_;
  std::vector<SurfaceSample> found_;
  std::vector<Ray> batch_;
  std::vector<uint8_t> numbers_; // of the chords in the batch
  std::vector<SurfaceHit> hits_;
};

/// Notes who looks at the VPL: mailbox points of the VPLs nearest to it, not its own, which sees it by definition. Only
/// that one where none of them does.
void findViewers(const Vpl& vpl, const VplSet& set, const LivePoints& vpls, const NeighbourTree& tree,
                 const RayQuery& rays, VplCell& cell, RayCounts& counts) {
  std::array<uint32_t, SurfaceSample::kNear> index;
  std::array<float, SurfaceSample::kNear> distance2;
  const size_t found = tree.nearest(vpl.position, SurfaceSample::kNear, index, distance2);
  cell.viewers.clear();
  cell.seenVpl = 0;
  const vec3 to = offsetPoint(vpl.position, vpl.geometricNormal, rays.rayEpsilon());
  for (size_t j = 0; j < found; ++j) {
    const Vpl& other = set.slots[vpls.slots[index[j]]];
    if (&other == &vpl) continue;
    cell.viewers.push_back(other.mailbox);
    if (glm::dot(other.mailbox - vpl.position, vpl.geometricNormal) <= 0) continue;
    ++counts.occlusion;
    cell.seenVpl += !rays.occluded(segment(other.mailbox, to));
  }
  if (cell.seenVpl > 0) return;
  cell.viewers = {vpl.mailbox};
  cell.seenVpl = 1;
}

/// Whether something moved between a place and those who look at it.
bool viewChanged(const VplCell& cell, const vec3& position, const vec3& normal, const DirtyRegion& dirty,
                 const RayQuery& rays) {
  if (dirty.empty()) return false;
  const vec3 to = offsetPoint(position, normal, rays.rayEpsilon());
  return std::any_of(cell.viewers.begin(), cell.viewers.end(),
                     [&](const vec3& from) { return dirty.touches(segment(from, to)); });
}

/// Light leaves a cell from the place of its VPL, so a sample counts by how well it is seen compared with that place:
/// the number of viewers that see it over the number that see the VPL, two at most. What none sees counts nothing: the
/// sunlit outside of a wall next to a window.
float seenBy(const VplCell& cell, const SurfaceSample& p, const RayQuery& rays, RayCounts& counts) {
  const vec3 to = offsetPoint(p.position, p.geometricNormal, rays.rayEpsilon());
  float seen = 0;
  for (const vec3& from : cell.viewers) {
    if (glm::dot(from - p.position, p.geometricNormal) <= 0) continue;
    ++counts.occlusion;
    seen += !rays.occluded(segment(from, to));
  }
  return std::min(2.0f, seen / cell.seenVpl);
}

/// A sample and whose it is.
struct Share {
  uint32_t owner;
  SurfaceSample* sample;
};

/// Makes the cell of `vpl` of the samples that it has. Where these may be the same as before (`perhaps`) only if one of
/// them is seen otherwise than before; returns whether it was made.
bool assemble(Vpl& vpl, VplCell& cell, std::span<Share> shares, const DirtyRegion& dirty, bool perhaps,
              const RayQuery& rays, RayCounts& counts) {
  std::stable_sort(shares.begin(), shares.end(),
                   [](const Share& a, const Share& b) { return a.sample->owner2 < b.sample->owner2; });
  bool same = perhaps;
  for (const Share& share : shares) {
    SurfaceSample& p = *share.sample;
    if (p.weighed == cell.drawing && !viewChanged(cell, p.position, p.geometricNormal, dirty, rays)) continue;
    const float seen = seenBy(cell, p, rays, counts);
    same &= p.weighed == cell.drawing && seen == p.seen;
    p.seen = seen;
    p.weighed = cell.drawing;
  }
  if (same) return false;
  std::vector<CellPoint> points;
  vpl.area = 0;
  for (const Share& share : shares) {
    const SurfaceSample& p = *share.sample;
    if (!(p.seen > 0)) continue;
    points.push_back({p.position, p.normal, p.geometricNormal, p.albedo, p.seen / p.density});
    vpl.area += points.back().area;
  }
  cell.points = std::vector<CellPoint>(points.begin(), points.end());
  return true;
}

} // namespace

std::vector<uint32_t> updateCells(VplSet& set, const RayQuery& rays, const DirtyRegion& dirty,
                                  std::span<const uint32_t> moved, float radiusLimit, uint32_t seed,
                                  RayCounts& counts) {
  const size_t slots = set.slots.size();
  // The limit is a running figure: densities of kept samples are for the one that they were drawn with.
  const bool drifted = !(set.cellLimit > 0.8f * radiusLimit && set.cellLimit < 1.25f * radiusLimit);
  if (drifted) set.cellLimit = radiusLimit;
  radiusLimit = set.cellLimit;
  if (set.cells.size() != slots) set.cells.assign(slots, {}); // slots may have changed: redraw all
  const LivePoints vpls = livePoints<Vpl>(set.slots);
  const NeighbourTree tree(vpls.points);
  const Neighbours neighbours{set, vpls, tree, kReachLimit * radiusLimit};
  // Scale of a cell: 0.9 of the distance to its third neighbour. Chords reach four times as far.
  constexpr int kScaleNeighbour = 3;
  constexpr float kTried = 1 + Connection::kLift; // connections stay this near, in distances of their ends
  const std::vector<float> shares =
      representedAreas(vpls.points, vpls.points, true, kScaleNeighbour, DensityEstimator::KnnSide, kInfinity);

  // Slots whose samples are redrawn: VPLs that stand elsewhere or have other neighbours, and those where something
  // moved.
  std::vector<uint8_t> redrawn(slots, 0), near(slots, 0), touched(slots, 0);
  std::vector<vec3> places; // where VPLs came or went, or draw otherwise
  for (uint32_t slot : moved) redrawn[slot] = 1;
  for (size_t n = 0; n < vpls.slots.size(); ++n) {
    const uint32_t slot = vpls.slots[n];
    const float radius =
        std::max(rays.rayEpsilon(), std::min(radiusLimit, 0.9f * std::sqrt(shares[n] * float(kScaleNeighbour) / kPi)));
    VplCell& cell = set.cells[slot];
    const Vpl& vpl = set.slots[slot];
    // (A light may have been carried along with its object before this update.)
    redrawn[slot] |=
        drifted || cell.centre != vpl.position || !(cell.radius > 0.7f * radius && cell.radius < 2 * radius);
    if (!redrawn[slot]) {
      near[slot] = dirty.touches(vpl.position, kScales.back().radius * cell.radius);
      const bool nobodySaw = cell.viewers.size() == 1;
      if ((near[slot] && nobodySaw) || viewChanged(cell, vpl.position, vpl.geometricNormal, dirty, rays)) {
        cell.viewers.clear(); // found again below
        cell.drawing = ++set.drawings;
      }
      continue;
    }
    if (cell.radius > 0) places.push_back(cell.centre);
    places.push_back(vpl.position);
    cell.radius = radius;
    cell.centre = vpl.position;
    cell.drawing = ++set.drawings;
  }
  for (uint32_t slot = 0; slot < slots; ++slot) {
    VplCell& cell = set.cells[slot];
    if (set.slots[slot].alive || cell.radius == 0) continue;
    places.push_back(cell.centre);
  }
  if (places.empty() && dirty.empty()) return {};

  constexpr size_t kGrain = 32;
  std::vector<std::vector<uint32_t>> concerned((slots + kGrain - 1) / kGrain); // slots that got or lost samples
  parallelCount(slots, kGrain, counts, [&](size_t begin, size_t end, RayCounts& count) {
    std::vector<uint32_t>& owners = concerned[begin / kGrain];
    CellSampler sampler(rays, neighbours, seed);
    const Connection connected{rays, count};
    std::vector<vec3> around;
    for (uint32_t slot = uint32_t(begin); slot < end; ++slot) {
      VplCell& cell = set.cells[slot];
      const Vpl& vpl = set.slots[slot];
      if (cell.radius == 0) continue;
      size_t stay = cell.samples.size();
      if (!vpl.alive) {
        for (const SurfaceSample& p : cell.samples)
          if (p.owner != kNone) owners.push_back(p.owner);
        cell = {};
        owners.push_back(slot);
        continue;
      }
      if (redrawn[slot] || cell.viewers.empty()) {
        findViewers(vpl, set, vpls, tree, rays, cell, count);
        owners.push_back(slot);
      }
      if (redrawn[slot] || near[slot]) {
        owners.push_back(slot);
        stay = sampler.draw(slot, cell, redrawn[slot] ? nullptr : &dirty, owners, count);
      }
      around.clear();
      for (const vec3& place : places)
        if (glm::distance(place, vpl.position) < cell.reach) around.push_back(place);
      const std::span<SurfaceSample> samples = cell.samples;
      for (SurfaceSample& p : samples.first(stay)) {
        const float tried = kTried * std::sqrt(p.owner == kNone ? p.reach2 : p.owner2);
        const bool inDirty = dirty.touches(p.position, tried);
        const bool others = std::any_of(around.begin(), around.end(), [&](const vec3& place) {
          const vec3 d = place - p.position;
          return glm::dot(d, d) <= p.reach2;
        });
        if (!inDirty && !others) continue;
        const uint32_t owner = p.owner;
        const float density = p.density;
        const std::array<uint32_t, SurfaceSample::kNear> before = p.near;
        if (others) neighbours.enter(p, slot, neighbours.around(p.position));
        neighbours.giveToNearest(p, connected, [&](uint32_t other) {
          return !inDirty && !redrawn[other] && std::find(before.begin(), before.end(), other) != before.end();
        });
        if (p.owner == owner && p.density == density) continue;
        if (p.owner != owner) p.weighed = 0; // also where it comes back to the one that it had before
        for (const uint32_t o : {owner, p.owner})
          if (o != kNone) owners.push_back(o);
      }
      for (SurfaceSample& p : samples.subspan(stay)) {
        neighbours.giveToNearest(p, connected, [](uint32_t) { return false; });
        if (p.owner != kNone) owners.push_back(p.owner);
      }
      if (stay < cell.samples.size())
        std::stable_sort(cell.samples.begin(), cell.samples.end(),
                         [](const SurfaceSample& a, const SurfaceSample& b) { return a.chord < b.chord; });
      cell.reach = 0;
      for (const SurfaceSample& p : cell.samples)
        cell.reach = std::max(cell.reach, glm::distance(p.position, vpl.position) + std::sqrt(p.reach2));
    }
    std::sort(owners.begin(), owners.end());
    owners.erase(std::unique(owners.begin(), owners.end()), owners.end());
  });
  for (const auto& owners : concerned)
    for (const uint32_t slot : owners) touched[slot] = 1;

  // Something may also have moved between a cell's samples and who looks at it.
  std::vector<float> extent2(slots, 0); // m², of what each has
  std::vector<uint8_t> perhaps(slots, 0);
  for (const VplCell& cell : set.cells)
    for (const SurfaceSample& p : cell.samples)
      if (p.owner != kNone) extent2[p.owner] = std::max(extent2[p.owner], p.owner2);
  for (uint32_t slot = 0; slot < slots && !dirty.empty(); ++slot) {
    if (touched[slot] || !set.slots[slot].alive) continue;
    const vec3 middle = set.slots[slot].position, extent(std::sqrt(extent2[slot]));
    for (const vec3& from : set.cells[slot].viewers)
      perhaps[slot] |= dirty.touches(Aabb{glm::min(from, middle - extent), glm::max(from, middle + extent)});
  }

  std::vector<Share> all;
  for (VplCell& cell : set.cells)
    for (SurfaceSample& p : cell.samples)
      if (p.owner != kNone && (touched[p.owner] || perhaps[p.owner])) all.push_back({p.owner, &p});
  const auto byOwner = [](const Share& a, const Share& b) { return a.owner < b.owner; };
  std::stable_sort(all.begin(), all.end(), byOwner);
  std::vector<uint32_t> candidates;
  std::vector<std::span<Share>> shared; // of `all`, by place in `candidates`; found before any of them is sorted
  for (uint32_t slot = 0; slot < slots; ++slot) {
    if (!touched[slot] && !perhaps[slot]) continue;
    const auto [first, last] = std::equal_range(all.begin(), all.end(), Share{slot, nullptr}, byOwner);
    candidates.push_back(slot);
    shared.emplace_back(first, last);
  }
  std::vector<uint8_t> made(candidates.size());
  parallelCount(candidates.size(), kGrain, counts, [&](size_t begin, size_t end, RayCounts& count) {
    for (size_t i = begin; i < end; ++i) {
      const uint32_t slot = candidates[i];
      made[i] = assemble(set.slots[slot], set.cells[slot], shared[i], dirty, perhaps[slot], rays, count);
    }
  });
  std::vector<uint32_t> changed;
  for (size_t i = 0; i < candidates.size(); ++i)
    if (made[i]) changed.push_back(candidates[i]);
  return changed;
}

} // namespace lambent

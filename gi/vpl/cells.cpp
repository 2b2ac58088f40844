// What a VPL stands for, without guessing from its neighbours' distances: its cell, the surface that is nearer to it
// than to any other VPL on the same side. Cells cover the surface once, so the light that leaves all of them is the
// light of the scene, whatever the density of VPLs does. Densities by nearest neighbours (paper 1, 3.2.4) err where it
// changes within the neighbourhood: at rims of sunlit patches, on thin parts, in corners.
//
// A cell is a set of points drawn around the VPL when it is placed: chords of spheres about it meet surfaces. Half of
// the chords run along the normal, half in all directions (a surface of any orientation is met in proportion to its
// area, Cauchy–Crofton), in spheres of several sizes, so that neither a dense set nor a lone VPL is sampled poorly.
// Each point knows its rival, the nearest other VPL that is nearer than its own and connected to it; without one it is
// owned. When a VPL moves only the points around it are looked at again.
#include "engine/core/parallel.h"
#include "engine/core/rng.h"
#include "engine/core/sampling.h"
#include "gi/vpl/smc.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace lambent {

namespace {

constexpr int kChords = 64;
/// Sizes of spheres, in radii of the cell's scale, and their shares of the chords.
struct Scale {
  float radius;
  int chords;
};
constexpr std::array<Scale, 4> kScales{{{0.35f, 8}, {1, 32}, {2, 16}, {4, 8}}};
constexpr int kHitsPerChord = 4;
constexpr size_t kNeighbours = 8; // VPLs looked at around a point

/// Points per m² that all chords together leave on a surface element at squared distance `d2`, with cosine `c` between
/// its normal and the VPL's. Chords along the normal, uniform over a disk: |c|/(π R²) each. Isotropic chords: half the
/// mean of |cos| over directions, 1/(2 π R²) each.
float chordDensity(float radius, float d2, float c) {
  float density = 0;
  for (const Scale& s : kScales) {
    const float r2 = radius * radius * s.radius * s.radius;
    if (d2 < r2) density += float(s.chords) * (0.5f * std::abs(c) + 0.25f) / (kPi * r2);
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
  std::optional<Ray> close(const Vpl& v, const CellPoint& p) const {
    const vec3 from = offsetPoint(v.position, v.geometricNormal, rays.grain()),
               to = offsetPoint(p.position, p.geometricNormal, rays.grain());
    if (glm::dot(from - p.position, p.geometricNormal) <= 0 || glm::dot(to - v.position, v.geometricNormal) <= 0)
      return {};
    return segment(from, to);
  }
  Ray lifted(const Vpl& v, const CellPoint& p, float distance) const {
    return segment(offsetPoint(v.position, v.geometricNormal, rays.grain()) + kLift * distance * v.geometricNormal,
                   offsetPoint(p.position, p.geometricNormal, rays.grain()) + kLift * distance * p.geometricNormal);
  }
  bool operator()(const Vpl& v, const CellPoint& p, float distance2) const {
    const std::optional<Ray> ray = close(v, p);
    counts.occlusion += ray ? 1 : 0;
    if (ray && !rays.occluded(*ray)) return true;
    ++counts.occlusion;
    return !rays.occluded(lifted(v, p, std::sqrt(distance2)));
  }
};

/// Draws the points of one cell. Scratch is kept between calls.
class CellSampler {
 public:
  /// No point lies farther than `reachLimit` from its VPL, m.
  CellSampler(const RayQuery& rays, float reachLimit, uint32_t seed)
      : rays_(rays), reachLimit_(reachLimit), seed_(seed) {}

  /// `viewers` see what is around here.
  void draw(const Vpl& vpl, float radius, std::span<const vec3> viewers, VplCell& cell, RayCounts& counts) {
    points_.clear();
    chords(vpl, radius);
    for (int round = 0; round < kHitsPerChord && !batch_.empty(); ++round) {
      hits_.resize(batch_.size());
      rays_.closest(batch_, hits_);
      counts.closest += batch_.size();
      size_t alive = 0;
      for (size_t i = 0; i < batch_.size(); ++i) {
        const Ray ray = batch_[i];
        const SurfaceHit& h = hits_[i];
        if (!h.valid()) continue;
        addSides(vpl, radius, h);
        const float step = h.t + 2e-4f * ray.tMax;
        if (step < ray.tMax) batch_[alive++] = {ray.origin + ray.direction * step, ray.direction, ray.tMax - step};
      }
      batch_.resize(alive);
    }
    keepConnected(vpl, counts);
    weighByVisibility(vpl, viewers, counts);
    // Room for just these: cells that kept the most that they ever had would grow for as long as objects move.
    cell.points = std::vector<CellPoint>(points_.begin(), points_.end());
    cell.radius = radius;
  }

 private:
  void chords(const Vpl& vpl, float radius) {
    batch_.clear();
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

  /// Both sides of the surface met, where they may belong to the VPL's.
  void addSides(const Vpl& vpl, float radius, const SurfaceHit& h) {
    if (!isFinite(h.position) || !isFinite(h.normal)) return;
    const vec3 d = h.position - vpl.position;
    const float d2 = glm::dot(d, d);
    const float density = chordDensity(radius, d2, glm::dot(h.geometricNormal, vpl.geometricNormal));
    if (density <= 0 || d2 > reachLimit_ * reachLimit_) return;
    for (const float side : {1.0f, -1.0f})
      if (sameSide(side * h.normal, vpl.normal))
        points_.push_back({h.position, side * h.normal, side * h.geometricNormal, h.albedo, 1 / density, d2});
  }

  void keepConnected(const Vpl& vpl, RayCounts& counts) {
    open_.assign(points_.size(), 0);
    const Connection connection{rays_, counts};
    for (const bool lifted : {false, true}) {
      batch_.clear();
      which_.clear();
      for (uint32_t i = 0; i < points_.size(); ++i) {
        if (open_[i]) continue;
        const CellPoint& p = points_[i];
        if (const auto ray = lifted ? connection.lifted(vpl, p, std::sqrt(p.own2)) : connection.close(vpl, p)) {
          batch_.push_back(*ray);
          which_.push_back(i);
        }
      }
      test(counts);
    }
    keepOpen();
  }

  /// Light leaves a cell from the place of its VPL, so a point counts by how well it is seen compared with that place:
  /// the number of viewers, points that the camera sees, that see it over the number that see the VPL, two at most.
  /// What none sees counts nothing: the sunlit outside of a wall beside a window.
  void weighByVisibility(const Vpl& vpl, std::span<const vec3> viewers, RayCounts& counts) {
    std::vector<uint16_t> seen(points_.size(), 0);
    open_.assign(points_.size(), 0);
    float seenVpl = 0;
    for (const vec3& from : viewers) {
      batch_.clear();
      which_.clear();
      if (glm::dot(from - vpl.position, vpl.geometricNormal) > 0) {
        ++counts.occlusion;
        seenVpl += !rays_.occluded(segment(from, offsetPoint(vpl.position, vpl.geometricNormal, rays_.grain())));
      }
      for (uint32_t i = 0; i < points_.size(); ++i) {
        const CellPoint& p = points_[i];
        if (glm::dot(from - p.position, p.geometricNormal) <= 0) continue;
        batch_.push_back(segment(from, offsetPoint(p.position, p.geometricNormal, rays_.grain())));
        which_.push_back(i);
      }
      open_.assign(points_.size(), 0);
      test(counts);
      for (size_t i = 0; i < open_.size(); ++i) seen[i] += open_[i];
    }
    const bool own = viewers.size() == 1 && viewers[0] == vpl.mailbox;
    if (seenVpl == 0 && !own) return weighByVisibility(vpl, {&vpl.mailbox, 1}, counts); // looked at from there only
    for (size_t i = 0; i < points_.size(); ++i) {
      open_[i] = seen[i] > 0;
      points_[i].area *= seenVpl > 0 ? std::min(2.0f, float(seen[i]) / seenVpl) : 1.0f;
    }
    keepOpen();
  }

  /// Opens what the segments reach.
  void test(RayCounts& counts) {
    blocked_.resize(batch_.size());
    rays_.occluded(batch_, blocked_);
    counts.occlusion += batch_.size();
    for (size_t j = 0; j < which_.size(); ++j) open_[which_[j]] = !blocked_[j];
  }

  void keepOpen() {
    size_t kept = 0;
    for (size_t i = 0; i < points_.size(); ++i)
      if (open_[i]) points_[kept++] = points_[i];
    points_.resize(kept);
  }

  const RayQuery& rays_;
  const float reachLimit_;
  const uint32_t seed_;
  std::vector<CellPoint> points_;
  std::vector<Ray> batch_;
  std::vector<SurfaceHit> hits_;
  std::vector<uint8_t> open_, blocked_;
  std::vector<uint32_t> which_;
};

/// VPLs of the set with the slots they are in.
struct Standing {
  std::vector<DensityPoint> points;
  std::vector<uint32_t> slots;
};

Standing standing(const VplSet& set) {
  Standing s;
  for (uint32_t i = 0; i < set.slots.size(); ++i)
    if (set.slots[i].alive) {
      s.points.push_back({set.slots[i].position, set.slots[i].normal});
      s.slots.push_back(i);
    }
  return s;
}

/// Whether the VPL in slot `a` has the point rather than the one in `b`, by squared distances; of two VPLs in one place
/// only one has it.
bool nearer(float a2, uint32_t a, float b2, uint32_t b) { return a2 < b2 || (a2 == b2 && a < b); }

/// Nearest connected VPL that is nearer to `p` than its own, the one in `own`.
void findRival(CellPoint& p, uint32_t own, const VplSet& set, const Standing& vpls, const NeighbourTree& tree,
               const Connection& connected) {
  std::array<uint32_t, kNeighbours> index;
  std::array<float, kNeighbours> distance2;
  const size_t found = tree.nearest(p.position, kNeighbours, index, distance2);
  p.rival = kNone;
  for (size_t j = 0; j < found && distance2[j] <= p.own2; ++j) {
    const uint32_t slot = vpls.slots[index[j]];
    if (slot == own || !nearer(distance2[j], slot, p.own2, own)) continue;
    if (!sameSide(p.normal, set.slots[slot].normal) || !connected(set.slots[slot], p, distance2[j])) continue;
    p.rival = slot;
    p.rival2 = distance2[j];
    return;
  }
}

/// Mailbox points of the VPLs nearest to this one: what looks this way. Not its own, which sees it by definition.
std::vector<vec3> viewersOf(const Vpl& vpl, const VplSet& set, const Standing& vpls, const NeighbourTree& tree) {
  std::array<uint32_t, kNeighbours> index;
  std::array<float, kNeighbours> distance2;
  const size_t found = tree.nearest(vpl.position, kNeighbours, index, distance2);
  std::vector<vec3> viewers;
  for (size_t j = 0; j < found; ++j)
    if (&set.slots[vpls.slots[index[j]]] != &vpl) viewers.push_back(set.slots[vpls.slots[index[j]]].mailbox);
  return viewers;
}

} // namespace

std::vector<uint32_t> updateCells(VplSet& set, const RayQuery& rays, const Disturbance& disturbance,
                                  std::span<const uint32_t> moved, float radiusLimit, uint32_t seed,
                                  RayCounts& counts) {
  if (set.cells.size() != set.slots.size()) set.cells.assign(set.slots.size(), {}); // rivals may be gone: draw all anew
  const Standing vpls = standing(set);
  const NeighbourTree tree(vpls.points);
  // Scale of a cell: 0.9 of the distance to its third neighbour. Chords reach four times as far.
  constexpr int kScaleNeighbour = 3;
  // Where light comes up in the dark the first VPLs are few, and their cells would take in the whole room: places from
  // which no such light leaves (a lift that opens the way for light: error in motion over that at rest 1.5 without this
  // limit, 1.1 with it; Cornell box and hall at rest: no difference).
  constexpr float kReachLimit = 2;                // of radiusLimit
  constexpr float kTried = 1 + Connection::kLift; // connections stay this near, in distances of their ends
  const std::vector<float> shares =
      representedAreas(vpls.points, vpls.points, true, kScaleNeighbour, DensityEstimator::KnnSide, kInfinity);
  std::vector<uint8_t> placed(set.slots.size(), 0), changed(set.slots.size(), 0);
  for (uint32_t slot : moved) placed[slot] = 1;

  constexpr size_t kGrain = 32;
  std::vector<RayCounts> perBlock((vpls.slots.size() + kGrain - 1) / kGrain);
  parallelFor(vpls.slots.size(), kGrain, [&](size_t begin, size_t end) {
    RayCounts& count = perBlock[begin / kGrain];
    CellSampler sampler(rays, kReachLimit * radiusLimit, seed);
    const Connection connected{rays, count};
    std::vector<uint32_t> near;
    for (size_t n = begin; n < end; ++n) {
      const uint32_t slot = vpls.slots[n];
      Vpl& vpl = set.slots[slot];
      VplCell& cell = set.cells[slot];
      const float spacing = std::sqrt(shares[n] * float(kScaleNeighbour) / kPi);
      const float radius = std::min(0.9f * spacing, radiusLimit);
      const bool draw = placed[slot] || !(cell.radius > 0.5f * radius && cell.radius < 2 * radius) ||
                        disturbance.touches(vpl.position, kTried * kScales.back().radius * cell.radius);
      if (draw) {
        sampler.draw(vpl, std::max(radius, rays.grain()), viewersOf(vpl, set, vpls, tree), cell, count);
        for (CellPoint& p : cell.points) findRival(p, slot, set, vpls, tree, connected);
        changed[slot] = 1;
      } else {
        near.clear(); // moved VPLs that can be nearer to a point than its own
        const float reach = 2 * kScales.back().radius * cell.radius;
        for (uint32_t other : moved) {
          const vec3 d = set.slots[other].position - vpl.position;
          if (set.slots[other].alive && glm::dot(d, d) < reach * reach) near.push_back(other);
        }
        for (CellPoint& p : cell.points) {
          const bool before = p.owned();
          if ((p.rival != kNone && (placed[p.rival] || !set.slots[p.rival].alive)) ||
              disturbance.touches(p.position, kTried * std::sqrt(p.own2))) // its rivals stand no farther than its own
            findRival(p, slot, set, vpls, tree, connected);
          for (uint32_t other : near) {
            const Vpl& v = set.slots[other];
            const vec3 d = v.position - p.position;
            const float d2 = glm::dot(d, d);
            const bool wins = p.owned() ? nearer(d2, other, p.own2, slot) : nearer(d2, other, p.rival2, p.rival);
            if (!wins || !sameSide(p.normal, v.normal) || !connected(v, p, d2)) continue;
            p.rival = other;
            p.rival2 = d2;
          }
          changed[slot] |= before != p.owned();
        }
      }
      float area = 0;
      for (const CellPoint& p : cell.points)
        if (p.owned()) area += p.area;
      vpl.area = area;
    }
  });
  for (const RayCounts& c : perBlock) counts += c;
  std::vector<uint32_t> slots;
  for (uint32_t i = 0; i < changed.size(); ++i)
    if (changed[i]) slots.push_back(i);
  return slots;
}

} // namespace lambent

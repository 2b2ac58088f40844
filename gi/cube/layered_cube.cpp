#include "gi/cube/layered_cube.h"

#include "engine/core/error.h"
#include "engine/core/free_memory.h"
#include "engine/core/memory.h"
#include "engine/core/parallel.h"
#include "gi/vpl/smc.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace lambent {

namespace {

constexpr size_t kTile = 64;                       // entries near one another, as rays ask for them
constexpr size_t kRun = 1024;                      // as sums are made
constexpr size_t kHemicubeBytes = size_t(1) << 30; // at once: 64 of 2048 texels a side would take 13 GB

size_t bytesOfHemicube(int resolution) {
  return Hemicube{.resolution = resolution, .texels = {}}.size() * sizeof(HemicubeTexel);
}

size_t hemicubesAtOnce(int resolution) {
  return std::clamp(kHemicubeBytes / bytesOfHemicube(resolution), size_t(1), size_t(64)); // 64: bits of a word
}

bool sameHemisphere(const VirtualLight& a, const VirtualLight& b) {
  return a.alive && b.alive && a.position == b.position && a.normal == b.normal &&
         a.geometricNormal == b.geometricNormal;
}
bool sameLight(const VirtualLight& a, const VirtualLight& b) {
  return a.alive == b.alive && (!a.alive || (sameHemisphere(a, b) && a.radiance == b.radiance && a.area == b.area));
}

/// Whether a segment that runs within `radius` of this one may touch what moved.
bool touches(const DirtyRegion& moved, const Ray& ray, float radius) {
  return std::any_of(moved.boxes().begin(), moved.boxes().end(), [&](const Aabb& box) {
    return crosses(ray, {box.lo - radius, box.hi + radius});
  });
}

/// Whether anything within `reach` of a box is in front of a light.
bool sees(const VirtualLight& light, const Aabb& box, float reach) {
  const vec3 farthest = glm::mix(box.lo, box.hi, glm::greaterThan(light.normal, vec3(0)));
  return glm::dot(farthest - light.position, light.normal) > -reach;
}

size_t memoryFor(const CubeInputs& in) { return in.memory == 0 ? freeMemory() : in.memory; }

/// Throws RunError where there are not so many bytes.
void refuseBeyond(size_t memory, double needed) {
  if (needed <= double(memory)) return;
  throw RunError("the layered depth cube needs " +
                 moreThanIsLeft(needed, "lower cube.resolution, cube.levels, cube.hemicube or smc.vpls"));
}

} // namespace

size_t LayeredCube::bytesKept() const {
  return surfaces_.entries().size_bytes() + sums_.size() * sizeof(dvec3) + seen_.size() * sizeof(Word);
}

void LayeredCube::clear(size_t memory) {
  double needed = double(surfaces_.entries().size()) * bytesOfEntry();
  if (settings_.visibility == CubeVisibility::Hemicubes) {
    const size_t atOnce = std::clamp(in_.size(), size_t(1), hemicubesAtOnce(settings_.hemicube));
    needed += double(atOnce) * double(bytesOfHemicube(settings_.hemicube) + surfaces_.entries().size()); // with marks
  }
  refuseBeyond(memory, needed);
  seen_.assign(surfaces_.entries().size() * words(), 0);
  sums_.assign(surfaces_.entries().size(), dvec3(0));
  for (VirtualLight& light : in_) light.alive = false;
}

/// W/m² at an entry from a light that it sees.
dvec3 LayeredCube::bring(const CubeEntry& entry, const VirtualLight& light) const {
  const vec3 d = light.position - entry.position;
  if (!(glm::dot(d, entry.normal) > 0)) return dvec3(0);
  const float r2 = glm::dot(d, d), inverse = 1 / std::sqrt(r2);
  return light.radiance * (light.area * geometryTerm(glm::dot(d, entry.shading) * inverse,
                                                     -glm::dot(d, light.normal) * inverse, r2, light.area, gather_));
}

/// Takes light out of an entry's sum, which `seen_` and `in_` know no more. Where what stays is as small as the
/// rounding of what went, as after a flash, it is summed anew.
void LayeredCube::take(size_t entry, const dvec3& light) {
  constexpr double kExact = 1e-9;
  if (light == dvec3(0)) return;
  dvec3& sum = sums_[entry];
  sum -= light;
  if (!glm::any(glm::lessThan(glm::abs(sum), kExact * light))) return;
  sum = dvec3(0);
  for (size_t w = 0; w < words(); ++w)
    for (Word left = seen_[entry * words() + w]; left; left &= left - 1)
      sum += bring(surfaces_.entries()[entry], in_[w * kBatch + size_t(std::countr_zero(left))]);
}

CubeWork LayeredCube::update(const CubeInputs& in, uint32_t most) {
  try {
    return advance(in, most);
  } catch (...) { // what is half done begins anew
    *this = {};
    throw;
  }
}

CubeWork LayeredCube::advance(const CubeInputs& in, uint32_t most) {
  CubeWork work;
  const bool fresh = surfaces_.empty() || in.newScene || !isOf(in.settings, in.gather, in.lights.size()) ||
                     !surfaces_.holds(in.boundsWorld);
  if (fresh) {
    *this = {}; // room for what comes
    settings_ = in.settings;
    gather_ = in.gather;
    constexpr double kBytesOfColumn = 200; // while it is cast, with an entry or two
    refuseBeyond(memoryFor(in), 3.0 * settings_.resolution * settings_.resolution * kBytesOfColumn);
    surfaces_.build(in.boundsWorld, settings_, in.rays, work.rays, memoryFor(in));
    in_.assign(in.lights.size(), {});
    clear(memoryFor(in));
    work.entriesAnew = uint32_t(sums_.size());
    work.changed = true;
  } else if (!in.moved.empty()) {
    adoptSurfaces(in, work);
  }
  pending_ = 0;
  for (size_t w = 0; w < words(); ++w) {
    Word out = 0, relit = 0, add = 0;
    std::vector<VirtualLight> next(in_.begin() + w * kBatch, in_.begin() + std::min((w + 1) * kBatch, in_.size()));
    for (size_t b = 0; b < next.size(); ++b) {
      const VirtualLight& light = in.lights[w * kBatch + b];
      if (sameLight(next[b], light)) continue;
      const Word bit = Word(1) << b;
      if (sameHemisphere(next[b], light) && next[b].radiance != vec3(0)) // black ones were not looked at
        relit |= bit;
      else if (next[b].alive)
        out |= bit;
      if (light.alive && !(relit & bit)) {
        if (work.lightsIn >= most) {
          ++pending_;
          if (out & bit) next[b].alive = false;
          continue;
        }
        add |= bit;
        ++work.lightsIn;
      }
      next[b] = light;
    }
    work.lightsOut += uint32_t(std::popcount(out));
    if (!(out | relit | add)) continue;
    work.changed = true;
    const std::vector<VirtualLight> before(in_.begin() + w * kBatch, in_.begin() + w * kBatch + next.size());
    std::copy(next.begin(), next.end(), in_.begin() + w * kBatch);
    parallelFor(sums_.size(), kRun, [&](size_t begin, size_t end) {
      for (size_t e = begin; e < end; ++e) {
        Word& seen = seen_[e * words() + w];
        Word left = seen & (out | relit);
        seen &= ~out;
        dvec3 taken(0);
        for (; left; left &= left - 1) {
          const int b = std::countr_zero(left);
          taken += bring(surfaces_.entries()[e], before[size_t(b)]);
          if (relit >> b & 1) sums_[e] += bring(surfaces_.entries()[e], next[size_t(b)]);
        }
        take(e, taken);
      }
    });
    if (add) put(in, w, add, work, nullptr);
  }
  return work;
}

/// Looks at the entries from lights `which` of a word, and brings bits and sums up to date.
void LayeredCube::put(const CubeInputs& in, size_t word, Word which, CubeWork& work,
                      const std::vector<uint8_t>* isNew) {
  const std::vector<Word> seen = settings_.visibility == CubeVisibility::Rays
                                     ? byRays(in, word, which, work.rays, isNew)
                                     : byHemicubes(in, word, which, work.rays);
  parallelFor(sums_.size(), kRun, [&](size_t begin, size_t end) {
    for (size_t e = begin; e < end; ++e) {
      Word& bits = seen_[e * words() + word];
      const Word before = std::exchange(bits, (bits & ~which) | seen[e]);
      dvec3 taken(0);
      for (Word left = before ^ bits; left; left &= left - 1) {
        const int b = std::countr_zero(left);
        (bits >> b & 1 ? sums_[e] : taken) += bring(surfaces_.entries()[e], in_[word * kBatch + size_t(b)]);
      }
      take(e, taken);
    }
  });
}

/// By entry: bits of the lights `which` of a word that see it. With `isNew`: only entries that are, and segments where
/// something moved, are asked again.
std::vector<LayeredCube::Word> LayeredCube::byRays(const CubeInputs& in, size_t word, Word which, RayCounts& counts,
                                                   const std::vector<uint8_t>* isNew) const {
  const std::span<const CubeEntry> entries = surfaces_.entries();
  std::vector<Word> seen(entries.size(), 0);
  parallelCount(entries.size(), kTile, counts, [&](size_t begin, size_t end, RayCounts& count) {
    std::vector<Ray> asked;
    std::vector<std::pair<uint32_t, int>> of;
    std::vector<uint8_t> blocked;
    Aabb tile;
    bool anyNew = !isNew;
    for (size_t e = begin; e < end; ++e) {
      tile.add(entries[e].position);
      anyNew |= isNew && (*isNew)[e];
    }
    for (Word left = which; left; left &= left - 1) {
      const int b = std::countr_zero(left);
      const VirtualLight& light = in_[word * kBatch + size_t(b)];
      const vec3 to = offsetPoint(light.position, light.geometricNormal, in.rays.rayEpsilon());
      const bool shaft = !isNew || touches(in.moved, segment(tile.centre(), to), 0.5f * tile.diameter());
      for (size_t e = begin; e < end; ++e) {
        const Ray ray = segment(offsetPoint(entries[e].position, entries[e].normal, in.rays.rayEpsilon()), to);
        const bool ask = !isNew || (*isNew)[e] || (shaft && in.moved.touches(ray));
        if (!ask) {
          seen[e] |= seen_[e * words() + word] & Word(1) << b;
        } else if (bring(entries[e], light) != dvec3(0)) {
          asked.push_back(ray);
          of.emplace_back(uint32_t(e), b);
        }
      }
    }
    blocked.resize(asked.size());
    in.rays.occluded(asked, blocked);
    count.occlusion += asked.size();
    for (size_t i = 0; i < of.size(); ++i)
      if (!blocked[i]) seen[of[i].first] |= Word(1) << of[i].second;
  });
  return seen;
}

std::vector<LayeredCube::Word> LayeredCube::byHemicubes(const CubeInputs& in, size_t word, Word which,
                                                        RayCounts& counts) const {
  std::vector<Word> seen(sums_.size(), 0);
  const size_t atOnce = hemicubesAtOnce(settings_.hemicube);
  while (which) {
    std::vector<int> bits;
    std::vector<Hemicube> hemicubes;
    for (; which && bits.size() < atOnce; which &= which - 1) {
      const size_t slot = word * kBatch + size_t(bits.emplace_back(std::countr_zero(which)));
      const int resolution = slot < in.firstLights ? settings_.hemicube : settings_.hemicube / 2;
      hemicubes.push_back(hemicubeAt(in_[slot], resolution, in.rays.rayEpsilon()));
    }
    if (in.hemicubes) in.hemicubes->make(hemicubes);
    std::vector<std::vector<uint8_t>> marks(bits.size());
    parallelCount(bits.size(), 1, counts, [&](size_t i, size_t, RayCounts& count) {
      if (!in.hemicubes) castHemicube(hemicubes[i], in.rays, count);
      marks[i].assign(sums_.size(), 0);
      splat(hemicubes[i], surfaces_, marks[i]);
    });
    for (size_t i = 0; i < bits.size(); ++i)
      for (size_t e = 0; e < seen.size(); ++e)
        if (marks[i][e]) seen[e] |= Word(1) << bits[i];
  }
  return seen;
}

/// Surfaces where objects moved; then who sees whom there.
void LayeredCube::adoptSurfaces(const CubeInputs& in, CubeWork& work) {
  const std::vector<uint32_t> from = surfaces_.update(in.moved, in.rays, work.rays, memoryFor(in));
  refuseBeyond(memoryFor(in), double(from.size()) * bytesOfEntry());
  std::vector<Word> seen(from.size() * words(), 0);
  std::vector<dvec3> sums(from.size(), dvec3(0));
  for (size_t e = 0; e < from.size(); ++e) {
    work.entriesAnew += from[e] == kNone;
    if (from[e] == kNone) continue;
    std::copy_n(seen_.begin() + size_t(from[e]) * words(), words(), seen.begin() + e * words());
    sums[e] = sums_[from[e]];
  }
  seen_ = std::move(seen);
  sums_ = std::move(sums);
  work.changed = true;
  std::vector<uint8_t> isNew(from.size());
  std::vector<Aabb> places(in.moved.boxes().begin(), in.moved.boxes().end());
  Aabb grown; // also behind what moved, and where a tree grew
  for (size_t e = 0; e < from.size(); ++e) {
    isNew[e] = from[e] == kNone;
    if (isNew[e]) grown.add(surfaces_.entries()[e].position);
  }
  if (!grown.empty()) places.push_back(grown);
  for (size_t w = 0; w < words(); ++w) {
    Word which = 0;
    for (size_t b = 0; b < kBatch && w * kBatch + b < in_.size(); ++b) {
      const VirtualLight& light = in_[w * kBatch + size_t(b)];
      // A hemicube that sees the place of a mover, or new entries next to it, is made again.
      const auto inFront = [&](const Aabb& box) { return sees(light, box, 4 * surfaces_.texel()); };
      if (light.alive && (settings_.visibility == CubeVisibility::Rays || std::ranges::any_of(places, inFront)))
        which |= Word(1) << b;
    }
    if (which) put(in, w, which, work, &isNew);
  }
}

} // namespace lambent

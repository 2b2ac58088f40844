#include "gi/lists/light_change.h"

#include "engine/core/parallel.h"
#include "gi/lists/light_columns.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

constexpr LightChange kAllUnknown{.share = 1};

/// What lights say of a frame and the one before, at equal areas: a light takes area from its neighbours when it comes.
struct ChangedLights {
  LightColumns larger;                     // power: the larger of before and now
  std::vector<float> gained, colour, came; // power: luminance; red less blue; of lights that were not there
  float gone = 0;                          // share of the light before whose lights are no more
  bool differ = false;

  ChangedLights(std::span<const VirtualLight> lights, std::span<const vec3> before, float disk) {
    std::vector<uint32_t> order;
    double all = 0, lost = 0;
    for (uint32_t slot = 0; slot < lights.size(); ++slot) {
      const VirtualLight& l = lights[slot];
      const vec3 was = slot < before.size() ? before[slot] : vec3(kOtherLight);
      const float larger = std::max(luminance(l.radiance), luminance(was)) * l.area;
      if (was.x >= 0) all += double(luminance(was));
      if (was.x >= 0 && !l.alive) lost += double(luminance(was));
      if (!l.alive || !(larger > 0) || !std::isfinite(larger) || !std::isfinite(glm::dot(l.position, l.position)))
        continue;
      order.push_back(slot);
      const vec3 change = was.x >= 0 ? (l.radiance - was) * l.area : vec3(0);
      gained.push_back(luminance(change));
      colour.push_back(change.x - change.z);
      came.push_back(was.x >= 0 ? 0 : larger);
      differ |= change != vec3(0) || !(was.x >= 0);
    }
    larger = columnsOf(lights, order, disk);
    for (size_t i = 0; i < order.size(); ++i) {
      const vec3 was = order[i] < before.size() ? before[order[i]] : vec3(0);
      larger.power[i] = std::max(luminance(lights[order[i]].radiance), luminance(was)) * lights[order[i]].area;
    }
    for (std::vector<float>* column : {&gained, &colour, &came}) column->resize(larger.x.size(), 0.0f);
    gone = all > 0 ? float(lost / all) : 0;
  }
};

/// The change at one place.
LightChange changeAt(const ChangedLights& of, const SurfaceHit& place) {
  const Unshadowed unshadowed(of.larger, place);
  const float *power = of.larger.power.data(), *gained = of.gained.data(), *colour = of.colour.data(),
              *came = of.came.data();
  Lanes all{}, gain{}, tint{}, square{}, fresh{};
  for (size_t first = 0; first < of.larger.x.size(); first += kLanes)
    for (size_t k = 0; k < kLanes; ++k) {
      const size_t i = first + k;
      const float reaches = unshadowed(i), change = reaches * gained[i];
      all[k] += reaches * power[i];
      gain[k] += change;
      tint[k] += reaches * colour[i];
      square[k] += change * change;
      fresh[k] += reaches * came[i];
    }
  const float sum = sumOf(all);
  if (!(sum > 0) || !std::isfinite(sum)) return {.share = of.gone};
  // What single lights gain and lose adds up as noise does: paths that flip are many and small, lamps that move few.
  const float share = std::max({std::abs(sumOf(gain)), std::abs(sumOf(tint)), std::sqrt(sumOf(square))}) / sum;
  return {std::min(1.0f, share + sumOf(fresh) / sum + of.gone), sumOf(gain) / sum};
}

/// Share of the light at a place that comes through one of the spheres.
float shadedAt(const LightColumns& lights, const SurfaceHit& place, std::span<const MovedSphere> spheres,
               std::vector<float>& outside) {
  outside.assign(lights.x.size(), 1.0f);
  const float *x = lights.x.data(), *y = lights.y.data(), *z = lights.z.data(), *power = lights.power.data();
  float* out = outside.data();
  for (const MovedSphere& s : spheres) {
    const vec3 p = place.position, c = s.centre - p;
    const float distance2 = glm::dot(c, c), radius2 = s.radius * s.radius;
    for (size_t i = 0; i < outside.size(); ++i) { // squared distance of the segment from the centre
      const float dx = x[i] - p.x, dy = y[i] - p.y, dz = z[i] - p.z;
      const float length2 = dx * dx + dy * dy + dz * dz + lights.least, along = dx * c.x + dy * c.y + dz * c.z;
      float t = along / length2;
      t = t < 0 ? 0 : t > 1 ? 1 : t;
      const float apart2 = distance2 + t * (t * length2 - 2 * along);
      out[i] = apart2 < radius2 ? 0 : out[i];
    }
  }
  const Unshadowed unshadowed(lights, place);
  Lanes all{}, through{};
  for (size_t first = 0; first < outside.size(); first += kLanes)
    for (size_t k = 0; k < kLanes; ++k) {
      const float brings = unshadowed(first + k) * power[first + k];
      all[k] += brings;
      through[k] += brings * (1 - out[first + k]);
    }
  const float share = sumOf(through) / sumOf(all);
  return std::isfinite(share) ? share : 0;
}

} // namespace

std::vector<LightChange> lightChanges(const LightChangeInputs& in) {
  const size_t perTile = size_t(in.perTile), tiles = in.places.size() / perTile;
  if (in.before.empty()) return std::vector<LightChange>(tiles, kAllUnknown);
  std::vector<LightChange> changes(tiles);
  const ChangedLights lights(in.lights, in.before, in.disk);
  if (!lights.differ && in.moved.empty()) {
    for (LightChange& c : changes) c.share = lights.gone;
    return changes;
  }
  constexpr size_t kGrain = 8;
  parallelFor(tiles, kGrain, [&](size_t begin, size_t end) {
    std::vector<float> scratch;
    for (size_t t = begin; t < end; ++t) {
      const std::span<const SurfaceHit> places = in.places.subspan(t * perTile, perTile);
      // Two places that lie apart speak for a tile.
      const auto valid = [](const SurfaceHit& p) { return p.valid(); };
      const auto first = std::ranges::find_if(places, valid);
      if (first == places.end()) continue;
      const SurfaceHit* last = &*std::find_if(places.rbegin(), places.rend(), valid);
      LightChange& tile = changes[t];
      int count = 0;
      for (const SurfaceHit* place = &*first;; place = last) {
        LightChange c = lights.differ ? changeAt(lights, *place) : LightChange{.share = lights.gone};
        if (!in.moved.empty()) c.share = std::max(c.share, shadedAt(lights.larger, *place, in.moved, scratch));
        // Where they disagree it is not known.
        const float apart = count > 0 ? std::abs(c.gained - tile.gained) : 0;
        tile.share = std::max({tile.share, c.share, apart});
        tile.gained = (tile.gained * float(count) + c.gained) / float(count + 1);
        ++count;
        if (place == last) break;
      }
    }
  });
  return changes;
}

} // namespace lambent

#include "gi/lists/light_change.h"

#include "engine/core/parallel.h"
#include "gi/lists/light_columns.h"

#include <algorithm>
#include <cfloat>
#include <cmath>

namespace lambent {

namespace {

constexpr float kTint = 0.02f; // of a light's luminance
constexpr LightChange kAllUnknown{.share = 1};

/// What lights say of a frame and the one before, at equal areas: a light takes area from its neighbours when it comes.
struct ChangedLights {
  LightColumns larger;                  // power: the larger of before and now
  std::vector<float> gained, came;      // power: of lights that stay; of those that were not there
  std::vector<float> colour, brightest; // W/sr: red less blue of what they gained; the largest component
  float gone = 0;                       // share of the light before whose lights are no more
  bool differ = false, tinted = false;  // any light; by more than a little in its colour

  ChangedLights(std::span<const VirtualLight> lights, std::span<const vec3> before, float disk) {
    std::vector<uint32_t> order;
    std::vector<float> power;
    double all = 0, lost = 0;
    for (uint32_t slot = 0; slot < lights.size(); ++slot) {
      const VirtualLight& l = lights[slot];
      const vec3 was = slot < before.size() ? before[slot] : vec3(kOtherLight);
      const float most = std::max(luminance(l.radiance), luminance(was)) * l.area;
      if (was.x >= 0) all += double(luminance(was));
      if (was.x >= 0 && !l.alive) lost += double(luminance(was));
      if (!l.alive || !(most > 0) || !std::isfinite(most) || !std::isfinite(glm::dot(l.position, l.position))) continue;
      order.push_back(slot);
      power.push_back(most);
      const vec3 change = was.x >= 0 ? (l.radiance - was) * l.area : vec3(0);
      gained.push_back(luminance(change));
      colour.push_back(change.x - change.z);
      brightest.push_back(std::max(maxComponent(l.radiance), maxComponent(was)) * l.area);
      came.push_back(was.x >= 0 ? 0 : most);
      // Light of the same colour changes all components alike.
      const float ratio = luminance(change) / most;
      for (int c = 0; c < 3; ++c)
        tinted |= std::abs(change[c] - ratio * std::max(l.radiance[c], was[c]) * l.area) > kTint * most;
      differ |= change != vec3(0) || !(was.x >= 0);
    }
    larger = columnsOf(lights, order, disk);
    larger.power = std::move(power);
    for (std::vector<float>* column : {&larger.power, &gained, &came, &colour, &brightest})
      column->resize(larger.x.size(), 0.0f);
    gone = all > 0 ? float(lost / all) : 0;
  }
};

/// Says what changed at single places.
class PlaceChange {
 public:
  PlaceChange(const ChangedLights& lights, std::span<const MovedSphere> moved)
      : lights_(lights), moved_(moved), reaches_(lights.larger.x.size()) {}

  LightChange at(const SurfaceHit& place) {
    const Unshadowed unshadowed(lights_.larger, place);
    const float *power = lights_.larger.power.data(), *gained = lights_.gained.data(), *came = lights_.came.data();
    Lanes all{}, gain{}, square{}, fresh{};
    for (size_t first = 0; first < reaches_.size(); first += kLanes) {
      Lanes reaches;
      for (size_t k = 0; k < kLanes; ++k) reaches[k] = unshadowed(first + k);
      for (size_t k = 0; k < kLanes; ++k) {
        const float change = reaches[k] * gained[first + k];
        all[k] += reaches[k] * power[first + k];
        gain[k] += change;
        square[k] += change * change;
        fresh[k] += reaches[k] * came[first + k];
      }
      std::ranges::copy(reaches, reaches_.begin() + ptrdiff_t(first));
    }
    const float sum = sumOf(all);
    if (!(sum > 0) || !std::isfinite(sum)) return {.share = lights_.gone};
    LightChange change{.gained = sumOf(gain) / sum};
    // What single lights gain and lose adds up as noise does: paths that flip are many and small, lamps that move few.
    change.share = std::max({std::abs(change.gained), std::sqrt(sumOf(square)) / sum, lights_.tinted ? tint() : 0.0f});
    change.share += sumOf(fresh) / sum + lights_.gone;
    if (!moved_.empty()) change.share = std::max(change.share, through(place) / sum);
    change.share = std::isfinite(change.share) ? std::min(1.0f, change.share) : 1;
    return change;
  }

 private:
  /// Change of colour: of red less blue, of the largest component.
  float tint() const {
    const float *colour = lights_.colour.data(), *brightest = lights_.brightest.data(), *reaches = reaches_.data();
    Lanes change{}, all{};
    for (size_t first = 0; first < reaches_.size(); first += kLanes)
      for (size_t k = 0; k < kLanes; ++k) {
        change[k] += reaches[first + k] * colour[first + k];
        all[k] += reaches[first + k] * brightest[first + k];
      }
    return std::abs(sumOf(change)) / std::max(sumOf(all), FLT_MIN);
  }
  /// What comes through one of the spheres.
  float through(const SurfaceHit& place) {
    const LightColumns& l = lights_.larger;
    const float *x = l.x.data(), *y = l.y.data(), *z = l.z.data(), *power = l.power.data(), *reaches = reaches_.data();
    const vec3 p = place.position;
    Lanes sums{};
    for (size_t first = 0; first < reaches_.size(); first += kLanes) {
      Lanes nearest; // squared distance of segments from the centres, in radii, less 1
      nearest.fill(0);
      for (const MovedSphere& s : moved_) {
        const vec3 c = s.centre - p;
        const float scale = 1 / std::max(s.radius * s.radius, FLT_MIN), centre2 = glm::dot(c, c) * scale - 1;
        for (size_t k = 0; k < kLanes; ++k) {
          const float dx = x[first + k] - p.x, dy = y[first + k] - p.y, dz = z[first + k] - p.z;
          const float length2 = dx * dx + dy * dy + dz * dz + l.least, along = dx * c.x + dy * c.y + dz * c.z;
          const float ahead = along > 0 ? along : 0, at = ahead < length2 ? ahead : length2;
          const float from = centre2 + at / length2 * (at - 2 * along) * scale;
          nearest[k] = from < nearest[k] ? from : nearest[k];
        }
      }
      constexpr float kEdge = 8; // the rim counts by degrees
      for (size_t k = 0; k < kLanes; ++k) {
        const float inside = -kEdge * nearest[k];
        sums[k] += reaches[first + k] * power[first + k] * (inside < 1 ? inside : 1.0f);
      }
    }
    return sumOf(sums);
  }

  const ChangedLights& lights_;
  std::span<const MovedSphere> moved_;
  std::vector<float> reaches_; // irradiance per power of each light
};

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
    PlaceChange change(lights, in.moved);
    for (size_t t = begin; t < end; ++t) {
      // The first place that is seen speaks for the tile.
      const std::span<const SurfaceHit> places = in.places.subspan(t * perTile, perTile);
      const auto place = std::ranges::find_if(places, [](const SurfaceHit& p) { return p.valid(); });
      if (place != places.end()) changes[t] = change.at(*place);
    }
  });
  return changes;
}

} // namespace lambent

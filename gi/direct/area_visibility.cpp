#include "gi/direct/area_visibility.h"

namespace lambent {

namespace {

/// Rays go to the lights in proportion to what these bring: ray k to part k/n of all light. Each of four quarters,
/// whose rays follow each other in turn, is spread over the lights as evenly as all.
constexpr int kQuarterOf[4] = {0, 2, 3, 1}; // by sub-fragment: of those that lie opposite, next to each other
constexpr int kPartOf[4] = {0, 3, 1, 2};    // the inverse
constexpr int kMostAll = 4 * kMostAreaRays;

} // namespace

struct AreaVisibility::Rays {
  std::array<uint32_t, kMostAll> lights, samples; // where they end
  std::array<Ray, kMostAll> segments;
  std::array<float, kMostAll> weights; // of a sample's light, for a receiver; 0: not traced
  std::array<bool, kMostAll> open;
};

AreaVisibility::Place AreaVisibility::placeAt(const glm::ivec2& pixel) const {
  const PictureSurfaces& s = surfaces_;
  const vec3 view = positionViewFromDepth(s.camera, vec2(pixel) + 0.5f, s.depth[s.at(pixel)]);
  return {vec3(s.camera.worldFromView * vec4(view, 1)), glm::normalize(vec3(s.normal[s.at(pixel)]))};
}

std::array<AreaVisibility::Place, 4> AreaVisibility::partsOf(const glm::ivec2& texel, int level) const {
  const int side = 1 << level;
  std::array<Place, 4> parts;
  for (int s = 0; s < 4; ++s) {
    const glm::ivec2 within = side / 4 + side / 2 * glm::ivec2(s & 1, s >> 1); // of 2×2 pixels one each
    const glm::ivec2 pixel = clamped(texel * side + within);
    parts[size_t(s)] = placeAt(surfaces_.seen(pixel) ? pixel : clamped(texel * side));
  }
  return parts;
}

AreaVisibility::Unshadowed AreaVisibility::unshadowedAt(const Place& place) const {
  Unshadowed out{std::vector<vec3>(lights_.lights.size())};
  for (size_t l = 0; l < out.light.size(); ++l) {
    out.light[l] = unshadowed(lights_, lights_.lights[l], place.position, place.normal);
    out.total += luminance(out.light[l]);
  }
  return out;
}

AreaVisibility::Unshadowed AreaVisibility::unshadowedAround(const Place& middle, const std::array<Place, 4>& parts) const {
  Unshadowed from = unshadowedAt(middle);
  for (size_t s = 0; s < 4 && !(from.total > 0); ++s) from = unshadowedAt(parts[s]);
  return from;
}

void AreaVisibility::choose(const Unshadowed& from, Rays& to) const {
  float below = 0; // light before `l`, share of all
  size_t l = 0;
  for (int k = 0; k < all(); ++k) {
    const float u = (float(k) + 0.5f) / float(all());
    const auto share = [&] { return luminance(from.light[l]) / from.total; };
    while (l + 1 < from.light.size() && below + share() <= u) {
      below += share();
      ++l;
    }
    const AreaLight& light = lights_.lights[l];
    const float within = std::max(u - below, 0.0f) / std::max(share(), 1e-30f);
    to.lights[size_t(k)] = uint32_t(l);
    to.samples[size_t(k)] = light.firstSample + std::min(uint32_t(within * float(light.samples)), light.samples - 1);
  }
}

void AreaVisibility::aim(const Place& place, int k, Rays& rays) const {
  const AreaSample& sample = lights_.samples[rays.samples[size_t(k)]];
  const bool doubleSided = lights_.lights[rays.lights[size_t(k)]].doubleSided;
  const vec3 way = sample.position - place.position;
  const float distance2 = std::max(glm::dot(way, way), 1e-20f);
  const float cosine = std::max(glm::dot(place.normal, way), 0.0f), cosineLight = -glm::dot(sample.normal, way);
  rays.weights[size_t(k)] =
      cosine * (doubleSided ? std::abs(cosineLight) : std::max(cosineLight, 0.0f)) / (distance2 * distance2);
  rays.segments[size_t(k)] =
      segment(offsetPoint(place.position, place.normal, rays_.grain()),
              offsetPoint(sample.position, cosineLight < 0 ? -sample.normal : sample.normal, rays_.grain()));
}

/// The rays of these quarters, in the order of the lights. Says how many.
uint64_t AreaVisibility::trace(Rays& rays, int quarter, int other, int third, int fourth) const {
  std::array<Ray, kMostAll> segments;
  std::array<uint8_t, kMostAll> blocked;
  std::array<int, kMostAll> numbers;
  size_t count = 0;
  for (int k = 0; k < all(); ++k) {
    const int q = k % 4;
    if ((q != quarter && q != other && q != third && q != fourth) || !(rays.weights[size_t(k)] > 0)) continue;
    segments[count] = rays.segments[size_t(k)];
    numbers[count++] = k;
  }
  rays_.occluded(std::span(segments).first(count), std::span(blocked).first(count));
  for (size_t i = 0; i < count; ++i) rays.open[size_t(numbers[i])] = !blocked[i];
  return count;
}

/// The share that the rays found open, over their weights: 1 where all are.
void AreaVisibility::addUp(const Unshadowed& from, const Rays& rays, AreaSeen& to) const {
  vec3 lit(0), whole(0);
  for (int k = 0; k < all();) {
    const uint32_t light = rays.lights[size_t(k)];
    vec3 open(0), sum(0);
    for (; k < all() && rays.lights[size_t(k)] == light; ++k) {
      if (!(rays.weights[size_t(k)] > 0)) continue;
      const vec3 weight = rays.weights[size_t(k)] * lights_.samples[rays.samples[size_t(k)]].radiance;
      sum += weight;
      if (!rays.open[size_t(k)]) continue;
      open += weight;
      to.bits[size_t(kPartOf[k % 4])] |= uint64_t(1) << (k / 4);
    }
    // A light that is due less than one ray stands for others like it.
    const vec3& own = from.light[light];
    const float share = std::max(1.0f, from.total / (float(all()) * std::max(luminance(own), 1e-30f)));
    for (int c = 0; c < 3; ++c) {
      if (!(sum[c] > 0)) continue;
      whole[c] += share * own[c];
      lit[c] += share * own[c] * (open[c] / sum[c]);
    }
  }
  for (int c = 0; c < 3; ++c) to.visible[c] = whole[c] > 0 ? std::min(lit[c] / whole[c], 1.0f) : 0;
}

AreaSeen AreaVisibility::ofPatch(const glm::ivec2& texel, int level) const {
  const std::array<Place, 4> parts = partsOf(texel, level);
  const Unshadowed from = unshadowedAround(placeAt(middleOf(texel, level)), parts);
  if (!(from.total > 0)) return {};
  Rays rays;
  choose(from, rays);
  for (int k = 0; k < all(); ++k) aim(parts[size_t(kPartOf[k % 4])], k, rays);
  AreaSeen seen;
  seen.rays = trace(rays, 0, 1, 2, 3);
  addUp(from, rays, seen);
  return seen;
}

AreaSeen AreaVisibility::ofPixel(const glm::ivec2& pixel, bool askAll) const {
  const Place place = placeAt(pixel);
  const Unshadowed from = unshadowedAt(place);
  if (!(from.total > 0)) return {};
  Rays rays;
  choose(from, rays);
  for (int k = 0; k < all(); ++k) aim(place, k, rays);
  AreaSeen seen;
  seen.rays = trace(rays, 1);
  int opened = 0, traced = 0;
  for (int k = 1; k < all(); k += 4) {
    if (!(rays.weights[size_t(k)] > 0)) continue;
    ++traced;
    opened += rays.open[size_t(k)];
  }
  if (!askAll && traced > 0 && (opened == 0 || opened == traced)) {
    for (int k = 0; k < all(); ++k) rays.open[size_t(k)] = opened > 0;
  } else {
    seen.rays += trace(rays, 0, 2, 3);
  }
  addUp(from, rays, seen);
  return seen;
}

std::array<AreaSeen, 4> AreaVisibility::ofQuad(const glm::ivec2& texel, const AreaSeen& patch) const {
  const std::array<Place, 4> parts = partsOf(texel, 1);
  const Unshadowed from = unshadowedAround(placeAt(middleOf(texel, 1)), parts); // as when the patch was asked
  Rays rays;
  choose(from, rays);
  std::array<AreaSeen, 4> out;
  for (int s = 0; s < 4; ++s) {
    for (int k = 0; k < all(); ++k) aim(parts[size_t(s)], k, rays);
    const int asked = kQuarterOf[s];
    for (int k = asked; k < all(); k += 4) rays.open[size_t(k)] = patch.bits[size_t(s)] >> (k / 4) & 1;
    out[size_t(s)].rays = trace(rays, (asked + 1) % 4, (asked + 2) % 4, (asked + 3) % 4);
    addUp(from, rays, out[size_t(s)]);
  }
  return out;
}

} // namespace lambent

#include "gi/direct/area_fragments.h"

#include "engine/core/error.h"
#include "engine/core/parallel.h"

#include <algorithm>
#include <array>
#include <bit>

namespace lambent {

namespace {

constexpr int kMostRays = 64; // per sub-fragment: bits of a word
constexpr size_t kGrain = 32; // fragments

enum State : uint8_t { Nothing, Test, Split }; // Split: into four without a test

vec3 positionAt(const PictureSurfaces& s, const glm::ivec2& pixel) {
  const vec3 view = positionViewFromDepth(s.camera, vec2(pixel) + 0.5f, s.depth[s.at(pixel)]);
  return vec3(s.camera.worldFromView * vec4(view, 1));
}

struct Place {
  vec3 position, normal;
};

Place placeAt(const PictureSurfaces& s, const glm::ivec2& pixel) {
  return {positionAt(s, pixel), glm::normalize(vec3(s.normal[s.at(pixel)]))};
}

/// A ray of a fragment: to a sample of a light.
struct Target {
  uint32_t light, sample;
};

/// What a fragment saw.
struct Seen {
  std::array<uint64_t, 4> bits{}; // by sub-fragment
  vec3 visible{0};                // share of the unshadowed light
  bool lit = false;               // any bit is set
};

class Visibility {
 public:
  Visibility(const RayQuery& rays, const AreaLights& lights, const PictureSurfaces& surfaces, int raysPerPart)
      : rays_(rays), lights_(lights), surfaces_(surfaces), count_(raysPerPart) {}

  /// Of 2^level pixels of which `texel` is the number; light is measured at `centre`.
  Seen of(const glm::ivec2& texel, int level) const;

 private:
  glm::ivec2 clamped(const glm::ivec2& p) const {
    return glm::min(p, glm::ivec2(surfaces_.width - 1, surfaces_.height - 1));
  }
  Seen measure(const std::array<Place, 4>& parts, const std::vector<vec3>& light, float total) const;

  const RayQuery& rays_;
  const AreaLights& lights_;
  const PictureSurfaces& surfaces_;
  int count_;
};

Seen Visibility::of(const glm::ivec2& texel, int level) const {
  const int side = 1 << level;
  const glm::ivec2 origin = texel * side;
  std::array<Place, 4> parts;
  for (int s = 0; s < 4; ++s) {
    const glm::ivec2 within = level == 0   ? glm::ivec2(0)
                              : level == 1 ? glm::ivec2(s & 1, s >> 1)
                                           : side / 4 + side / 2 * glm::ivec2(s & 1, s >> 1);
    glm::ivec2 pixel = clamped(origin + within);
    if (!surfaces_.seen(pixel)) pixel = clamped(origin);
    parts[size_t(s)] = placeAt(surfaces_, pixel);
  }
  const Place centre = placeAt(surfaces_, clamped(origin + side / 2));
  std::vector<vec3> light(lights_.lights.size());
  float total = 0;
  for (size_t l = 0; l < light.size(); ++l) {
    light[l] = unshadowed(lights_, lights_.lights[l], centre.position, centre.normal);
    total += luminance(light[l]);
  }
  if (!(total > 0)) return {};
  return measure(parts, light, total);
}

/// Rays go to the lights in proportion to what these bring; ray k of a sub-fragment to the same sixteenth (of 16) of them
/// in all four, each to another quarter of it.
Seen Visibility::measure(const std::array<Place, 4>& parts, const std::vector<vec3>& light, float total) const {
  constexpr int kQuarter[4] = {0, 2, 3, 1}; // by sub-fragment: those that lie opposite share no border
  const int all = 4 * count_;
  std::array<Target, 4 * kMostRays> targets;
  std::array<Ray, 4 * kMostRays> segments;
  std::array<uint8_t, 4 * kMostRays> blocked;
  std::array<float, 4 * kMostRays> weights;
  std::array<int, 4> partOf;
  for (int s = 0; s < 4; ++s) partOf[size_t(kQuarter[s])] = s;
  float below = 0; // light before `l`, share of all
  size_t l = 0;
  for (int k = 0; k < all; ++k) {
    const float u = (float(k) + 0.5f) / float(all);
    while (l + 1 < light.size() && below + luminance(light[l]) / total <= u) below += luminance(light[l++]) / total;
    const AreaLight& to = lights_.lights[l];
    const float within = (u - below) * total / std::max(luminance(light[l]), 1e-30f);
    const uint32_t sample = std::min(uint32_t(std::max(within, 0.0f) * float(to.samples)), to.samples - 1);
    targets[size_t(k)] = {uint32_t(l), to.firstSample + sample};
    const AreaSample& point = lights_.samples[to.firstSample + sample];
    const Place& part = parts[size_t(partOf[size_t(k % 4)])];
    const vec3 way = point.position - part.position;
    const float distance2 = std::max(glm::dot(way, way), 1e-20f);
    const float cosineLight = -glm::dot(point.normal, way);
    weights[size_t(k)] = std::max(glm::dot(part.normal, way), 0.0f) *
                         (to.doubleSided ? std::abs(cosineLight) : std::max(cosineLight, 0.0f)) / (distance2 * distance2);
    const vec3 outward = cosineLight < 0 && to.doubleSided ? -point.normal : point.normal;
    segments[size_t(k)] = segment(offsetPoint(part.position, part.normal, rays_.grain()),
                                  offsetPoint(point.position, outward, rays_.grain()));
    if (!(weights[size_t(k)] > 0)) segments[size_t(k)].tMax = -1; // is not traced
  }
  rays_.occluded(std::span(segments).first(size_t(all)), std::span(blocked).first(size_t(all)));

  Seen seen;
  vec3 lit(0), whole(0);
  for (int k = 0; k < all;) {
    const uint32_t at = targets[size_t(k)].light;
    vec3 open(0), sum(0);
    for (; k < all && targets[size_t(k)].light == at; ++k) {
      if (!(weights[size_t(k)] > 0)) continue;
      const vec3 weight = weights[size_t(k)] * lights_.samples[targets[size_t(k)].sample].radiance;
      sum += weight;
      if (blocked[size_t(k)]) continue;
      open += weight;
      seen.bits[size_t(partOf[size_t(k % 4)])] |= uint64_t(1) << (k / 4);
    }
    // A light that is due less than one ray stands for others like it.
    const float share = std::max(1.0f, total / (float(all) * std::max(luminance(light[at]), 1e-30f)));
    for (int c = 0; c < 3; ++c) {
      if (!(sum[c] > 0)) continue;
      whole[c] += share * light[at][c];
      lit[c] += share * light[at][c] * open[c] / sum[c];
    }
  }
  for (int c = 0; c < 3; ++c) seen.visible[c] = whole[c] > 0 ? std::min(lit[c] / whole[c], 1.0f) : 0;
  seen.lit = std::any_of(seen.bits.begin(), seen.bits.end(), [](uint64_t b) { return b != 0; });
  return seen;
}

struct Fragment {
  glm::ivec2 texel;
  Seen seen = {};
};

uint64_t bitsApart(const Seen& a, const Seen& b) {
  uint64_t bits = 0;
  for (int s = 0; s < 4; ++s) bits += uint64_t(std::popcount(a.bits[size_t(s)] ^ b.bits[size_t(s)]));
  return bits;
}

/// SFVT: whether sub-fragments see unlike parts of the lights. In `twice` those that GASS splits two levels at once.
bool isSplit(const Seen& seen, const AreaSettings& settings, std::array<bool, 4>& twice) {
  constexpr int kRound[4] = {0, 1, 3, 2}; // neighbours follow each other
  bool split = false;
  twice = {};
  for (int i = 0; i < 4; ++i) {
    const int a = kRound[i], b = kRound[(i + 1) % 4];
    split |= std::popcount(seen.bits[size_t(a)] ^ seen.bits[size_t(b)]) >= settings.threshold;
    const int gradient = std::abs(std::popcount(seen.bits[size_t(a)]) - std::popcount(seen.bits[size_t(b)]));
    if (settings.gradient > 0 && gradient > settings.gradient) twice[size_t(a)] = twice[size_t(b)] = true;
  }
  return split;
}

} // namespace

FragmentCounts shareVisible(const RayQuery& rays, const AreaLights& lights, const PictureSurfaces& surfaces,
                            const AreaSettings& settings, std::span<FragmentLevel> levels) {
  CHECK(!levels.empty() && settings.rays <= kMostRays);
  const Visibility visibility(rays, lights, surfaces, settings.rays);
  const bool neighbours = settings.refinement == AreaRefinement::Neighbours;
  FragmentCounts counts;
  std::vector<std::vector<uint8_t>> states(levels.size());
  for (size_t l = 0; l < levels.size(); ++l) {
    states[l].assign(levels[l].smooth.size(), Nothing);
    levels[l].visible.assign(levels[l].smooth.size(), vec4(0));
  }
  std::fill(states.back().begin(), states.back().end(), Test);
  std::vector<glm::ivec2> extra; // single pixels in large fragments
  const auto split = [&](int level, const glm::ivec2& texel, const std::array<bool, 4>& twice) {
    FragmentLevel& finer = levels[size_t(level - 1)];
    for (int s = 0; s < 4; ++s) {
      const glm::ivec2 child = texel * 2 + glm::ivec2(s & 1, s >> 1);
      states[size_t(level - 1)][size_t(child.y * finer.size.x + child.x)] =
          twice[size_t(s)] && level > 1 ? Split : Test;
    }
  };

  for (int level = int(levels.size()) - 1; level >= 0; --level) {
    FragmentLevel& at = levels[size_t(level)];
    std::vector<Fragment> fragments;
    for (int y = 0; y < at.size.y; ++y)
      for (int x = 0; x < at.size.x; ++x) {
        const size_t i = size_t(y * at.size.x + x);
        const State state = State(states[size_t(level)][i]);
        const glm::ivec2 origin = glm::ivec2(x, y) * (1 << level);
        if (state == Nothing || origin.x >= surfaces.width || origin.y >= surfaces.height) continue;
        if (level > 0 && (state == Split || !at.smooth[i]))
          split(level, {x, y}, {});
        else if (at.smooth[i])
          fragments.push_back({{x, y}});
      }
    parallelFor(fragments.size(), kGrain, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) fragments[i].seen = visibility.of(fragments[i].texel, level);
    });
    counts.rays.occlusion += fragments.size() * 4 * uint64_t(settings.rays);

    std::vector<int> numbers; // of fragments, by texel
    if (neighbours) {
      numbers.assign(at.smooth.size(), -1);
      for (size_t i = 0; i < fragments.size(); ++i)
        numbers[size_t(fragments[i].texel.y * at.size.x + fragments[i].texel.x)] = int(i);
    }
    for (const Fragment& f : fragments) {
      std::array<bool, 4> twice{};
      bool apart = false;
      if (level > 0 && neighbours) {
        for (int k = 0; k < 9 && !apart; ++k) {
          const glm::ivec2 there = f.texel + glm::ivec2(k % 3 - 1, k / 3 - 1);
          if (there.x < 0 || there.y < 0 || there.x >= at.size.x || there.y >= at.size.y) continue;
          const int n = numbers[size_t(there.y * at.size.x + there.x)];
          apart = n >= 0 && bitsApart(f.seen, fragments[size_t(n)].seen) >= uint64_t(settings.threshold);
        }
      } else if (level > 0) {
        apart = f.seen.lit && isSplit(f.seen, settings, twice);
      }
      if (apart) {
        split(level, f.texel, twice);
        continue;
      }
      at.visible[size_t(f.texel.y * at.size.x + f.texel.x)] = vec4(f.seen.visible, 1);
      ++counts.fragments;
      counts.dark += !f.seen.lit;
      if (settings.extra && !neighbours && level > 2 && f.seen.lit) {
        const int side = 1 << level;
        for (const glm::ivec2 within : {glm::ivec2(side / 2, side - 1), glm::ivec2(0, side - 1), glm::ivec2(0, side / 2)})
          extra.push_back(f.texel * side + within);
      }
    }
  }

  std::erase_if(extra, [&](const glm::ivec2& p) {
    return p.x >= surfaces.width || p.y >= surfaces.height || !surfaces.seen(p);
  });
  parallelFor(extra.size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      levels[0].visible[size_t(extra[i].y * levels[0].size.x + extra[i].x)] =
          vec4(visibility.of(extra[i], 0).visible, 1);
  });
  counts.extra = extra.size();
  counts.fragments += extra.size();
  counts.rays.occlusion += extra.size() * 4 * uint64_t(settings.rays);
  return counts;
}

} // namespace lambent

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

/// What a fragment saw.
struct Seen {
  std::array<uint64_t, 4> bits{}; // by sub-fragment; of a single pixel by quarter of its rays
  vec3 visible{0};                // share of the unshadowed light
  uint64_t rays = 0;              // that were traced

  bool lit() const {
    return std::any_of(bits.begin(), bits.end(), [](uint64_t b) { return b != 0; });
  }
};

/// Rays go to the lights in proportion to what these bring: ray k to part k/n of all light. Each of four quarters,
/// whose rays follow each other in turn, is spread over the lights as evenly as all.
constexpr int kQuarterOf[4] = {0, 2, 3, 1}; // by sub-fragment: of those that lie opposite, next to each other
constexpr int kPartOf[4] = {0, 3, 1, 2};    // the inverse
constexpr int kMostAll = 4 * kMostRays;

struct Rays {
  std::array<uint32_t, kMostAll> lights, samples; // where they end
  std::array<Ray, kMostAll> segments;
  std::array<float, kMostAll> weights; // of a sample's light, for a receiver; 0: not traced
  std::array<bool, kMostAll> open;
};

class Visibility {
 public:
  Visibility(const RayQuery& rays, const AreaLights& lights, const PictureSurfaces& surfaces, int raysPerPart)
      : rays_(rays), lights_(lights), surfaces_(surfaces), count_(raysPerPart) {}

  /// Of the patch of 2^level pixels, level ≥ 1, of which `texel` is the number.
  Seen ofPatch(const glm::ivec2& texel, int level) const;
  /// Of a pixel. Unless all rays are asked for: where a quarter of them agree, the others are not.
  Seen ofPixel(const glm::ivec2& pixel, bool askAll = false) const;
  glm::ivec2 middleOf(const glm::ivec2& texel, int level) const {
    return clamped(texel * (1 << level) + (1 << level) / 2);
  }
  /// Of the four pixels of a patch of level 1 that has been asked: all its rays, of which the patch's are a quarter.
  std::array<Seen, 4> ofQuad(const glm::ivec2& texel, const Seen& patch) const;

 private:
  /// What the lights bring where nothing is between.
  struct Unshadowed {
    std::vector<vec3> light;
    float total = 0; // luminance
  };
  Unshadowed unshadowedAt(const Place& place) const;
  std::array<Place, 4> partsOf(const glm::ivec2& texel, int level) const;
  Place centreOf(const glm::ivec2& texel, int level) const { return placeAt(surfaces_, middleOf(texel, level)); }
  glm::ivec2 clamped(const glm::ivec2& p) const {
    return glm::min(p, glm::ivec2(surfaces_.width - 1, surfaces_.height - 1));
  }
  void choose(const Unshadowed& from, Rays& to) const;
  void aim(const Place& place, int k, Rays& rays) const;
  uint64_t trace(Rays& rays, int quarter, int other = -1, int third = -1, int fourth = -1) const;
  void addUp(const Unshadowed& from, const Rays& rays, Seen& to) const;

  int all() const { return 4 * count_; }

  const RayQuery& rays_;
  const AreaLights& lights_;
  const PictureSurfaces& surfaces_;
  int count_; // of a quarter
};

std::array<Place, 4> Visibility::partsOf(const glm::ivec2& texel, int level) const {
  const int side = 1 << level;
  std::array<Place, 4> parts;
  for (int s = 0; s < 4; ++s) {
    const glm::ivec2 within = side / 4 + side / 2 * glm::ivec2(s & 1, s >> 1); // of 2×2 pixels one each
    const glm::ivec2 pixel = clamped(texel * side + within);
    parts[size_t(s)] = placeAt(surfaces_, surfaces_.seen(pixel) ? pixel : clamped(texel * side));
  }
  return parts;
}

Visibility::Unshadowed Visibility::unshadowedAt(const Place& place) const {
  Unshadowed out{std::vector<vec3>(lights_.lights.size())};
  for (size_t l = 0; l < out.light.size(); ++l) {
    out.light[l] = unshadowed(lights_, lights_.lights[l], place.position, place.normal);
    out.total += luminance(out.light[l]);
  }
  return out;
}

void Visibility::choose(const Unshadowed& from, Rays& to) const {
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

void Visibility::aim(const Place& place, int k, Rays& rays) const {
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
uint64_t Visibility::trace(Rays& rays, int quarter, int other, int third, int fourth) const {
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
void Visibility::addUp(const Unshadowed& from, const Rays& rays, Seen& to) const {
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

Seen Visibility::ofPatch(const glm::ivec2& texel, int level) const {
  const Unshadowed from = unshadowedAt(centreOf(texel, level));
  if (!(from.total > 0)) return {};
  const std::array<Place, 4> parts = partsOf(texel, level);
  Rays rays;
  choose(from, rays);
  for (int k = 0; k < all(); ++k) aim(parts[size_t(kPartOf[k % 4])], k, rays);
  Seen seen;
  seen.rays = trace(rays, 0, 1, 2, 3);
  addUp(from, rays, seen);
  return seen;
}

Seen Visibility::ofPixel(const glm::ivec2& pixel, bool askAll) const {
  const Place place = placeAt(surfaces_, pixel);
  const Unshadowed from = unshadowedAt(place);
  if (!(from.total > 0)) return {};
  Rays rays;
  choose(from, rays);
  for (int k = 0; k < all(); ++k) aim(place, k, rays);
  Seen seen;
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

std::array<Seen, 4> Visibility::ofQuad(const glm::ivec2& texel, const Seen& patch) const {
  const Unshadowed from = unshadowedAt(centreOf(texel, 1)); // as when the patch was asked
  const std::array<Place, 4> parts = partsOf(texel, 1);
  Rays rays;
  choose(from, rays);
  std::array<Seen, 4> out;
  for (int s = 0; s < 4; ++s) {
    for (int k = 0; k < all(); ++k) aim(parts[size_t(s)], k, rays);
    const int asked = kQuarterOf[s];
    for (int k = asked; k < all(); k += 4) rays.open[size_t(k)] = patch.bits[size_t(s)] >> (k / 4) & 1;
    out[size_t(s)].rays = trace(rays, (asked + 1) % 4, (asked + 2) % 4, (asked + 3) % 4);
    addUp(from, rays, out[size_t(s)]);
  }
  return out;
}

/// Of a large fragment that have samples of their own: in the middle of its top, in the corner, in the middle of its
/// left.
std::array<glm::ivec2, 3> singlePixels(int side) {
  return {glm::ivec2(side / 2, side - 1), glm::ivec2(0, side - 1), glm::ivec2(0, side / 2)};
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

/// Nichols et al. 2010: all rays from the middle of each fragment and from those of the eight patches around it, whether
/// or not these are fragments; says which fragments are split. `level` above 0.
std::vector<uint8_t> askAround(const Visibility& visibility, const PictureSurfaces& surfaces, int level,
                               const glm::ivec2& size, int threshold, std::vector<Fragment>& fragments, uint64_t& rays) {
  std::vector<int> numbers(size_t(size.x) * size_t(size.y), -1); // of what is asked, by texel
  std::vector<Fragment> asked;
  const auto forAround = [&](const Fragment& f, auto&& with) {
    for (int k = 0; k < 9; ++k) {
      const glm::ivec2 there = f.texel + glm::ivec2(k % 3 - 1, k / 3 - 1);
      if (there.x < 0 || there.y < 0 || there.x >= size.x || there.y >= size.y) continue;
      if (surfaces.seen(visibility.middleOf(there, level))) with(there, numbers[size_t(there.y * size.x + there.x)]);
    }
  };
  for (const Fragment& f : fragments)
    forAround(f, [&](const glm::ivec2& there, int& number) {
      if (number >= 0) return;
      number = int(asked.size());
      asked.push_back({there});
    });
  parallelFor(asked.size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      asked[i].seen = visibility.ofPixel(visibility.middleOf(asked[i].texel, level), true);
  });
  for (const Fragment& f : asked) rays += f.seen.rays;
  std::vector<uint8_t> split(fragments.size(), 0);
  for (size_t i = 0; i < fragments.size(); ++i) {
    Fragment& f = fragments[i];
    const int own = numbers[size_t(f.texel.y * size.x + f.texel.x)];
    if (own >= 0) f.seen = asked[size_t(own)].seen;
    forAround(f, [&](const glm::ivec2&, int number) {
      split[i] |= bitsApart(f.seen, asked[size_t(number)].seen) >= uint64_t(threshold);
    });
  }
  return split;
}

const vec4* fragmentAt(std::span<const FragmentLevel> levels, const glm::ivec2& pixel) {
  for (size_t l = 0; l < levels.size(); ++l) {
    const glm::ivec2 at(pixel.x >> l, pixel.y >> l);
    if (at.x >= levels[l].size.x || at.y >= levels[l].size.y) continue;
    const vec4& visible = levels[l].visible[size_t(at.y * levels[l].size.x + at.x)];
    if (visible.w > 0) return &visible;
  }
  return nullptr;
}

/// w = kBetween for large fragments around which, or in which, others hold something else: their pixels lie between.
void markBorders(std::span<FragmentLevel> levels) {
  for (size_t l = 3; l < levels.size(); ++l) {
    FragmentLevel& at = levels[l];
    parallelFor(size_t(at.size.y), 1, [&](size_t begin, size_t end) {
      for (int y = int(begin); y < int(end); ++y)
        for (int x = 0; x < at.size.x; ++x) {
          vec4& own = at.visible[size_t(y * at.size.x + x)];
          if (own.w == 0) continue;
          const int side = 1 << l;
          const glm::ivec2 lo = glm::ivec2(x, y) * side;
          const auto differs = [&](const glm::ivec2& pixel) {
            if (pixel.x < 0 || pixel.y < 0) return false;
            const vec4* other = fragmentAt(levels, pixel);
            return other && vec3(*other) != vec3(own);
          };
          bool between = false;
          for (int i = -1; i <= side && !between; ++i)
            between = differs(lo + glm::ivec2(i, -1)) || differs(lo + glm::ivec2(i, side)) ||
                      differs(lo + glm::ivec2(-1, i)) || differs(lo + glm::ivec2(side, i));
          for (const glm::ivec2& within : singlePixels(side)) between = between || differs(lo + within);
          if (between) own.w = kBetween;
        }
    });
  }
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
    std::vector<uint8_t> around;
    if (neighbours && level > 0) {
      around = askAround(visibility, surfaces, level, at.size, settings.threshold, fragments, counts.rays.occlusion);
    } else {
      parallelFor(fragments.size(), kGrain, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
          Fragment& f = fragments[i];
          f.seen = level == 0 ? visibility.ofPixel(f.texel, neighbours) : visibility.ofPatch(f.texel, level);
        }
      });
      for (const Fragment& f : fragments) counts.rays.occlusion += f.seen.rays;
    }
    const auto keep = [&](const glm::ivec2& texel, FragmentLevel& in, const Seen& seen) {
      in.visible[size_t(texel.y * in.size.x + texel.x)] = vec4(seen.visible, 1);
      ++counts.fragments;
      counts.dark += !seen.lit();
    };

    std::vector<Fragment> quads; // of pixels
    for (size_t i = 0; i < fragments.size(); ++i) {
      const Fragment& f = fragments[i];
      std::array<bool, 4> twice{};
      bool apart = false;
      if (level > 0) apart = neighbours ? around[i] != 0 : f.seen.lit() && isSplit(f.seen, settings, twice);
      if (apart && level == 1 && !neighbours) {
        quads.push_back(f);
        continue;
      }
      if (apart) {
        split(level, f.texel, twice);
        continue;
      }
      keep(f.texel, at, f.seen);
      if (settings.extra && !neighbours && level > 2 && f.seen.lit()) {
        const int side = 1 << level;
        for (const glm::ivec2& within : singlePixels(side)) extra.push_back(f.texel * side + within);
      }
    }
    std::vector<std::array<Seen, 4>> pixels(quads.size());
    parallelFor(quads.size(), kGrain, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) pixels[i] = visibility.ofQuad(quads[i].texel, quads[i].seen);
    });
    for (size_t i = 0; i < quads.size(); ++i)
      for (int s = 0; s < 4; ++s) {
        keep(quads[i].texel * 2 + glm::ivec2(s & 1, s >> 1), levels[0], pixels[i][size_t(s)]);
        counts.rays.occlusion += pixels[i][size_t(s)].rays;
      }
  }

  std::erase_if(
      extra, [&](const glm::ivec2& p) { return p.x >= surfaces.width || p.y >= surfaces.height || !surfaces.seen(p); });
  std::vector<uint64_t> traced(extra.size());
  parallelFor(extra.size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Seen seen = visibility.ofPixel(extra[i]);
      levels[0].visible[size_t(extra[i].y * levels[0].size.x + extra[i].x)] = vec4(seen.visible, 1);
      traced[i] = seen.rays;
    }
  });
  counts.extra = extra.size();
  counts.fragments += extra.size();
  for (uint64_t rays : traced) counts.rays.occlusion += rays;
  markBorders(levels);
  return counts;
}

} // namespace lambent

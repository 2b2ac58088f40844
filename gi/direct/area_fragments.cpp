#include "gi/direct/area_fragments.h"

#include "engine/core/error.h"
#include "engine/core/parallel.h"

#include <bit>

namespace lambent {

namespace {

enum State : uint8_t { Nothing, Test, Split }; // Split: into four without a test

/// Of a large fragment that have samples of their own: in the middle of its top, in the corner, in the middle of its
/// left.
std::array<glm::ivec2, 3> singlePixels(int side) {
  return {glm::ivec2(side / 2, side - 1), glm::ivec2(0, side - 1), glm::ivec2(0, side / 2)};
}

struct Fragment {
  glm::ivec2 texel;
  AreaSeen seen = {};
};

uint64_t bitsApart(const AreaSeen& a, const AreaSeen& b) {
  uint64_t bits = 0;
  for (int s = 0; s < 4; ++s) bits += uint64_t(std::popcount(a.bits[size_t(s)] ^ b.bits[size_t(s)]));
  return bits;
}

int countsApart(uint64_t a, uint64_t b) { return std::abs(std::popcount(a) - std::popcount(b)); }

/// Whether sub-fragments see unlike parts of the lights: answers that differ (SFVT), or how many are open. In `twice`
/// those that GASS splits two levels at once.
bool isSplit(const AreaSeen& seen, const AreaSettings& settings, std::array<bool, 4>& twice) {
  constexpr int kRound[4] = {0, 1, 3, 2}; // neighbours follow each other
  const bool byCounts = settings.refinement == AreaRefinement::Counts;
  bool split = false;
  twice = {};
  for (int i = 0; i < 4; ++i) {
    const int a = kRound[i], b = kRound[(i + 1) % 4];
    const uint64_t one = seen.bits[size_t(a)], other = seen.bits[size_t(b)];
    const int gradient = countsApart(one, other);
    split |= (byCounts ? gradient : std::popcount(one ^ other)) >= settings.threshold;
    if (settings.gradient > 0 && gradient > settings.gradient) twice[size_t(a)] = twice[size_t(b)] = true;
  }
  return split;
}

/// Fragments of one level by texel; −1: none there.
std::vector<int> numbersOf(std::span<const Fragment> fragments, const glm::ivec2& size) {
  std::vector<int> numbers(size_t(size.x) * size_t(size.y), -1);
  for (size_t i = 0; i < fragments.size(); ++i)
    numbers[size_t(fragments[i].texel.y * size.x + fragments[i].texel.x)] = int(i);
  return numbers;
}

/// Whether sub-fragments on both sides of one of its borders see unlike amounts of light: asks no further rays.
bool differsBeyondBorders(const Fragment& f, std::span<const Fragment> fragments, std::span<const int> numbers,
                          const glm::ivec2& size, int threshold) {
  for (int axis = 0; axis < 2; ++axis)
    for (int up = 0; up < 2; ++up) {
      glm::ivec2 there = f.texel;
      there[axis] += up ? 1 : -1;
      if (there.x < 0 || there.y < 0 || there.x >= size.x || there.y >= size.y) continue;
      const int n = numbers[size_t(there.y * size.x + there.x)];
      if (n < 0) continue;
      for (int k = 0; k < 2; ++k) { // along the border
        const int own = axis == 0 ? up + 2 * k : k + 2 * up, other = axis == 0 ? 1 - up + 2 * k : k + 2 * (1 - up);
        if (countsApart(f.seen.bits[size_t(own)], fragments[size_t(n)].seen.bits[size_t(other)]) >= threshold)
          return true;
      }
    }
  return false;
}

/// Nichols et al. 2010: all rays from the middle of each fragment and from those of the eight patches around it,
/// whether or not these are fragments; says which fragments are split. `level` above 0.
std::vector<uint8_t> askAround(const AreaVisibility& visibility, const PictureSurfaces& surfaces, int level,
                               const glm::ivec2& size, int threshold, std::vector<Fragment>& fragments,
                               uint64_t& rays) {
  std::vector<int> numbers(size_t(size.x) * size_t(size.y), -1); // of what is asked, by texel
  std::vector<glm::ivec2> asked;                                 // pixels
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
      asked.push_back(visibility.middleOf(there, level));
    });
  const std::vector<AreaSeen> seen = visibility.ofPixels(asked, true);
  for (const AreaSeen& s : seen) rays += s.rays;
  std::vector<uint8_t> split(fragments.size(), 0);
  for (size_t i = 0; i < fragments.size(); ++i) {
    Fragment& f = fragments[i];
    const int own = numbers[size_t(f.texel.y * size.x + f.texel.x)];
    if (own >= 0) f.seen = seen[size_t(own)];
    forAround(f, [&](const glm::ivec2&, int number) {
      split[i] |= bitsApart(f.seen, seen[size_t(number)]) >= uint64_t(threshold);
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
  CHECK(!levels.empty() && settings.rays <= kMostAreaRays);
  const AreaVisibility visibility(rays, lights, surfaces, settings.rays);
  const bool neighbours = settings.refinement == AreaRefinement::Neighbours;
  FragmentCounts counts;
  std::vector<std::vector<uint8_t>> states(levels.size());
  for (size_t l = 0; l < levels.size(); ++l) {
    states[l].assign(levels[l].smooth.size(), Nothing);
    levels[l].visible.assign(levels[l].smooth.size(), vec4(0));
  }
  std::fill(states.back().begin(), states.back().end(), Test);
  std::array<std::vector<glm::ivec2>, 2> extra; // single pixels in large fragments that are fully lit, and others
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
      std::vector<glm::ivec2> texels;
      for (const Fragment& f : fragments) texels.push_back(f.texel);
      const std::vector<AreaSeen> seen =
          level == 0 ? visibility.ofPixels(texels, neighbours) : visibility.ofPatches(texels, level);
      for (size_t i = 0; i < fragments.size(); ++i) fragments[i].seen = seen[i];
      for (const Fragment& f : fragments) counts.rays.occlusion += f.seen.rays;
    }
    const auto keep = [&](const glm::ivec2& texel, FragmentLevel& in, const AreaSeen& seen) {
      in.visible[size_t(texel.y * in.size.x + texel.x)] = vec4(seen.visible, 1);
      ++counts.fragments;
      counts.dark += !seen.lit();
    };

    const bool byCounts = level > 0 && settings.refinement == AreaRefinement::Counts;
    const std::vector<int> numbers = byCounts ? numbersOf(fragments, at.size) : std::vector<int>();
    std::vector<glm::ivec2> quads; // patches of which all pixels are asked
    std::vector<AreaSeen> quadsSeen;
    for (size_t i = 0; i < fragments.size(); ++i) {
      const Fragment& f = fragments[i];
      std::array<bool, 4> twice{};
      bool apart = false;
      if (level > 0) apart = neighbours ? around[i] != 0 : f.seen.lit() && isSplit(f.seen, settings, twice);
      if (byCounts && !apart) apart = differsBeyondBorders(f, fragments, numbers, at.size, settings.threshold);
      if (apart && level == 1 && !neighbours) {
        quads.push_back(f.texel);
        quadsSeen.push_back(f.seen);
        continue;
      }
      if (apart) {
        split(level, f.texel, twice);
        continue;
      }
      keep(f.texel, at, f.seen);
      if (settings.extra && settings.upsample == AreaUpsample::Rbf && !neighbours && level > 2 && f.seen.lit()) {
        const int side = 1 << level;
        for (const glm::ivec2& within : singlePixels(side)) {
          const glm::ivec2 pixel = f.texel * side + within;
          if (pixel.x < surfaces.width && pixel.y < surfaces.height && surfaces.seen(pixel))
            extra[f.seen.visible != vec3(1)].push_back(pixel);
        }
      }
    }
    const std::vector<AreaSeen> pixels = visibility.ofQuads(quads, quadsSeen);
    for (size_t i = 0; i < pixels.size(); ++i) {
      keep(quads[i / 4] * 2 + glm::ivec2(i & 1, i >> 1 & 1), levels[0], pixels[i]);
      counts.rays.occlusion += pixels[i].rays;
    }
  }

  for (const bool partly : {false, true}) { // a quarter of the rays does not tell a little shadow from none
    const std::vector<AreaSeen> seen = visibility.ofPixels(extra[partly], partly);
    for (size_t i = 0; i < seen.size(); ++i) {
      const glm::ivec2& pixel = extra[partly][i];
      levels[0].visible[size_t(pixel.y * levels[0].size.x + pixel.x)] = vec4(seen[i].visible, 1);
      counts.rays.occlusion += seen[i].rays;
    }
    counts.extra += seen.size();
    counts.fragments += seen.size();
  }
  markBorders(levels);
  return counts;
}

} // namespace lambent

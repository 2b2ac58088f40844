#include "gi/direct/area_fragments.h"

#include "engine/core/error.h"
#include "engine/core/parallel.h"

#include <algorithm>
#include <bit>
#include <set>
#include <tuple>
#include <utility>

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

/// Nichols et al. 2010: all rays, to the same samples, from the middle of each fragment and from those of the eight
/// patches around it, whether or not these are fragments; says which fragments are split. `level` above 0.
std::vector<uint8_t> askAround(const AreaVisibility& visibility, const FrameSurfaces& surfaces, int level,
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
  const std::vector<AreaSeen> seen = visibility.ofPixelsAlike(asked);
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

/// The fragments of an image: tested from the coarsest level down, split, kept.
class Fragments {
 public:
  Fragments(const RayQuery& rays, const AreaLights& lights, const FrameSurfaces& surfaces, const AreaSettings& settings,
            std::span<FragmentLevel> levels)
      : visibility_(rays, lights, surfaces, settings.rays,
                    settings.refinement == AreaRefinement::SubFragments ? AreaAims::Same : AreaAims::Own),
        surfaces_(surfaces), settings_(settings), levels_(levels),
        neighbours_(settings.refinement == AreaRefinement::Neighbours),
        byCounts_(settings.refinement == AreaRefinement::Counts), states_(levels.size()), open_(levels.size()) {
    for (size_t l = 0; l < levels.size(); ++l) {
      states_[l].assign(levels[l].smooth.size(), Nothing);
      levels[l].visible.assign(levels[l].smooth.size(), vec4(0));
      open_[l].assign(levels[l].smooth.size(), kNotAsked);
    }
    std::fill(states_.back().begin(), states_.back().end(), Test);
  }

  FragmentCounts run() {
    descend();
    // Adjacent fragments of other levels, and the single pixels in it, may show what its own rays missed.
    while (byCounts_ && splitNextToOthers()) descend();
    while (askExtra()) {
      descend();
      while (splitNextToOthers()) descend();
    }
    return counts_;
  }

 private:
  using Open = std::array<float, 4>; // AreaSeen::open
  static constexpr Open kNotAsked = {-1, -1, -1, -1};

  size_t index(int level, const glm::ivec2& texel) const {
    return size_t(texel.y * levels_[size_t(level)].size.x + texel.x);
  }

  void split(int level, const glm::ivec2& texel, const std::array<bool, 4>& twice) {
    for (int s = 0; s < 4; ++s)
      states_[size_t(level - 1)][index(level - 1, texel * 2 + glm::ivec2(s & 1, s >> 1))] =
          twice[size_t(s)] && level > 1 ? Split : Test;
  }

  void keep(int level, const glm::ivec2& texel, const AreaSeen& seen) {
    const size_t i = index(level, texel);
    levels_[size_t(level)].visible[i] = vec4(seen.visible, 1);
    for (size_t s = 0; s < 4; ++s) open_[size_t(level)][i][s] = seen.open(s);
    if (level == 0) open_[0][i].fill(seen.rays > 0 || seen.lit() ? luminance(seen.visible) : -1);
    ++counts_.fragments;
    counts_.dark += !seen.lit();
  }

  /// Undoes keep() and splits.
  void splitKept(int level, const glm::ivec2& texel) {
    const size_t i = index(level, texel);
    const Open& open = open_[size_t(level)][i];
    counts_.dark -= std::ranges::all_of(open, [](float o) { return o <= 0; });
    --counts_.fragments;
    levels_[size_t(level)].visible[i] = vec4(0);
    open_[size_t(level)][i] = kNotAsked;
    split(level, texel, {});
  }

  void descend() {
    for (int level = int(levels_.size()) - 1; level >= 0; --level) {
      const std::vector<Fragment> fragments = fragmentsOf(level);
      if (!fragments.empty()) decide(level, fragments);
    }
  }

  /// What is to be tested of a level; what needs no test is split.
  std::vector<Fragment> fragmentsOf(int level) {
    std::vector<Fragment> fragments;
    FragmentLevel& at = levels_[size_t(level)];
    for (int y = 0; y < at.size.y; ++y)
      for (int x = 0; x < at.size.x; ++x) {
        const size_t i = index(level, {x, y});
        const State state = State(std::exchange(states_[size_t(level)][i], uint8_t(Nothing)));
        const glm::ivec2 origin = glm::ivec2(x, y) * (1 << level);
        if (state == Nothing || origin.x >= surfaces_.width || origin.y >= surfaces_.height) continue;
        if (level > 0 && (state == Split || !at.smooth[i]))
          split(level, {x, y}, {});
        else if (at.smooth[i])
          fragments.push_back({{x, y}});
      }
    return fragments;
  }

  void decide(int level, std::vector<Fragment> fragments) {
    const glm::ivec2 size = levels_[size_t(level)].size;
    std::vector<uint8_t> around;
    if (neighbours_ && level > 0) {
      around = askAround(visibility_, surfaces_, level, size, settings_.threshold, fragments, counts_.rays.occlusion);
    } else {
      std::vector<glm::ivec2> texels;
      for (const Fragment& f : fragments) texels.push_back(f.texel);
      const std::vector<AreaSeen> seen =
          level == 0 ? visibility_.ofPixels(texels, !byCounts_) : visibility_.ofPatches(texels, level);
      for (size_t i = 0; i < fragments.size(); ++i) fragments[i].seen = seen[i];
      for (const Fragment& f : fragments) counts_.rays.occlusion += f.seen.rays;
    }
    const bool beyond = byCounts_ && level > 0;
    const std::vector<int> numbers = beyond ? numbersOf(fragments, size) : std::vector<int>();
    std::vector<glm::ivec2> quads; // patches of which all pixels are asked
    std::vector<AreaSeen> quadsSeen;
    for (size_t i = 0; i < fragments.size(); ++i) {
      const Fragment& f = fragments[i];
      std::array<bool, 4> twice{};
      bool apart = false;
      if (level > 0) apart = neighbours_ ? around[i] != 0 : f.seen.lit() && isSplit(f.seen, settings_, twice);
      if (beyond && !apart) apart = differsBeyondBorders(f, fragments, numbers, size, settings_.threshold);
      if (apart && level == 1 && !neighbours_) {
        quads.push_back(f.texel);
        quadsSeen.push_back(f.seen);
      } else if (apart) {
        split(level, f.texel, twice);
      } else {
        keep(level, f.texel, f.seen);
      }
    }
    const std::vector<AreaSeen> pixels = visibility_.ofQuads(quads, quadsSeen);
    for (size_t i = 0; i < pixels.size(); ++i) {
      keep(0, quads[i / 4] * 2 + glm::ivec2(i & 1, i >> 1 & 1), pixels[i]);
      counts_.rays.occlusion += pixels[i].rays;
    }
  }

  /// By as many rays as the threshold; next to what is dark, by one: a step from nothing is seen however small.
  bool apart(float a, float b) const {
    if (a < 0 || b < 0) return false;
    const float rays = std::abs(a - b) * float(settings_.rays);
    return rays >= float(std::min(a, b) > 0 ? settings_.threshold : 1);
  }

  /// Splits fragments whose sub-fragments see other shares than finer ones, or others as large, across a border.
  bool splitNextToOthers() {
    std::vector<std::pair<int, glm::ivec2>> found;
    for (int level = 1; level < int(levels_.size()); ++level) {
      const glm::ivec2 size = levels_[size_t(level)].size;
      std::vector<uint8_t> differs(levels_[size_t(level)].smooth.size(), 0);
      parallelFor(size_t(size.y), 1, [&](size_t begin, size_t end) {
        for (int y = int(begin); y < int(end); ++y)
          for (int x = 0; x < size.x; ++x)
            differs[index(level, {x, y})] =
                levels_[size_t(level)].visible[index(level, {x, y})].w > 0 && differsAround(level, {x, y});
      });
      for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x)
          if (differs[index(level, {x, y})]) found.emplace_back(level, glm::ivec2(x, y));
    }
    for (const auto& [level, texel] : found) splitKept(level, texel);
    return !found.empty();
  }

  bool differsAround(int level, const glm::ivec2& texel) const {
    const int side = 1 << level, step = std::max(side / 8, 1);
    const glm::ivec2 lo = texel * side;
    const Open& own = open_[size_t(level)][index(level, texel)];
    for (int i = step / 2; i < side; i += step)
      for (int border = 0; border < 4; ++border) {
        const int along = border & 2 ? 1 : 0, up = border & 1; // axis across the border
        glm::ivec2 inside = lo + i;
        inside[along] = lo[along] + (up ? side - 1 : 0);
        glm::ivec2 outside = inside;
        outside[along] += up ? 1 : -1;
        if (apart(own[quarterOf(inside - lo, side)], openAt(outside, level)) && visibility_.oneSurface(inside, outside))
          return true;
      }
    return false;
  }

  static size_t quarterOf(const glm::ivec2& within, int side) {
    return size_t(2 * within.x >= side) + 2 * size_t(2 * within.y >= side);
  }

  /// What the fragment at a pixel sees there, if it is not coarser than a level.
  float openAt(const glm::ivec2& pixel, int coarsest) const {
    if (pixel.x < 0 || pixel.y < 0 || pixel.x >= surfaces_.width || pixel.y >= surfaces_.height) return -1;
    for (int level = 0; level <= coarsest; ++level) {
      const glm::ivec2 texel = pixel >> level;
      const size_t i = index(level, texel);
      if (levels_[size_t(level)].visible[i].w > 0)
        return open_[size_t(level)][i][level == 0 ? 0 : quarterOf(pixel - texel * (1 << level), 1 << level)];
    }
    return -1;
  }

  /// Single pixels in large fragments that have none yet. Says whether one of them differs from the fragment
  /// around it, which is then split.
  bool askExtra() {
    if (!settings_.extra || !fitsBasisFunctions(settings_.upsample) || neighbours_) return false;
    struct Extra {
      glm::ivec2 pixel;
      int level;
    };
    std::array<std::vector<Extra>, 2> extra; // in fragments that are fully lit, and others
    for (int level = 3; level < int(levels_.size()); ++level) {
      const FragmentLevel& at = levels_[size_t(level)];
      for (int y = 0; y < at.size.y; ++y)
        for (int x = 0; x < at.size.x; ++x) {
          const size_t i = index(level, {x, y});
          const vec4& visible = at.visible[i];
          const bool lit = std::ranges::any_of(open_[size_t(level)][i], [](float o) { return o > 0; });
          if (visible.w == 0 || !lit || hasExtra({x, y}, level)) continue;
          for (const glm::ivec2& within : singlePixels(1 << level)) {
            const glm::ivec2 pixel = glm::ivec2(x, y) * (1 << level) + within;
            if (pixel.x < surfaces_.width && pixel.y < surfaces_.height && surfaces_.seen(pixel))
              extra[vec3(visible) != vec3(1)].push_back({pixel, level});
          }
        }
    }
    std::set<std::tuple<int, int, int>> differ; // level, texel
    for (const bool partly : {false, true}) {   // a quarter of the rays does not tell a little shadow from none
      std::vector<glm::ivec2> pixels;
      for (const Extra& e : extra[partly]) pixels.push_back(e.pixel);
      const std::vector<AreaSeen> seen = visibility_.ofPixels(pixels, partly || !byCounts_);
      for (size_t i = 0; i < seen.size(); ++i) {
        const auto [pixel, level] = extra[partly][i];
        const glm::ivec2 texel = pixel >> level;
        counts_.rays.occlusion += seen[i].rays;
        const float here = luminance(seen[i].visible),
                    around =
                        open_[size_t(level)][index(level, texel)][quarterOf(pixel - texel * (1 << level), 1 << level)];
        if (byCounts_ && seen[i].rays > 0 && apart(here, around)) differ.emplace(level, texel.x, texel.y);
        levels_[0].visible[index(0, pixel)] = vec4(seen[i].visible, 1);
        open_[0][index(0, pixel)].fill(seen[i].rays > 0 ? here : -1);
      }
      counts_.extra += seen.size();
      counts_.fragments += seen.size();
    }
    for (const auto& [level, x, y] : differ) {
      for (const glm::ivec2& within : singlePixels(1 << level)) {
        const glm::ivec2 pixel = glm::ivec2(x, y) * (1 << level) + within;
        if (pixel.x >= surfaces_.width || pixel.y >= surfaces_.height || !surfaces_.seen(pixel)) continue;
        levels_[0].visible[index(0, pixel)] = vec4(0);
        open_[0][index(0, pixel)] = kNotAsked;
        --counts_.extra;
        --counts_.fragments;
      }
      splitKept(level, {x, y});
    }
    return !differ.empty();
  }

  bool hasExtra(const glm::ivec2& texel, int level) const {
    for (const glm::ivec2& within : singlePixels(1 << level)) {
      const glm::ivec2 pixel = texel * (1 << level) + within;
      if (pixel.x < surfaces_.width && pixel.y < surfaces_.height && levels_[0].visible[index(0, pixel)].w > 0)
        return true;
    }
    return false;
  }

  const AreaVisibility visibility_;
  const FrameSurfaces& surfaces_;
  const AreaSettings& settings_;
  const std::span<FragmentLevel> levels_;
  const bool neighbours_, byCounts_;
  std::vector<std::vector<uint8_t>> states_; // State, by level and texel
  std::vector<std::vector<Open>> open_;      // of what is kept
  FragmentCounts counts_;
};

} // namespace

FragmentCounts shareVisible(const RayQuery& rays, const AreaLights& lights, const FrameSurfaces& surfaces,
                            const AreaSettings& settings, std::span<FragmentLevel> levels) {
  CHECK(!levels.empty() && settings.rays <= kMostAreaRays);
  const FragmentCounts counts = Fragments(rays, lights, surfaces, settings, levels).run();
  markBorders(levels);
  return counts;
}

} // namespace lambent

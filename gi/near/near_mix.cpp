#include "gi/near/near_mix.h"

#include "engine/core/parallel.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>

namespace lambent {

namespace {

/// Between which pixels near light may pass. Symmetric: what one gives the other takes.
struct EdgeStop {
  float reach, flatReach; // in cells: between the surfaces seen; between those in one plane
  float slope;            // sine: how far a neighbour may be off the plane, over its distance

  bool passes(const NeighbourSurfaces& seen, size_t a, size_t b) const {
    constexpr float kAlike = 0.3f; // cosine between normals
    constexpr float kFlat = 0.05f; // slope of what lies in the plane
    const vec3 d = seen.positions[b] - seen.positions[a];
    const float off = glm::dot(seen.normals[a], d), offThere = glm::dot(seen.normals[b], d);
    const float apart2 = glm::dot(d, d), off2 = std::max(off * off, offThere * offThere);
    const float most = seen.cell * (off2 <= kFlat * kFlat * apart2 ? flatReach : reach);
    return apart2 <= most * most && glm::dot(seen.normals[b], seen.normals[a]) >= kAlike &&
           off2 <= slope * slope * apart2;
  }
};

/// Which neighbours a pixel's light is mixed with.
struct Mixture {
  std::array<std::array<float, 3>, 3> weights; // by how many columns and rows apart
  EdgeStop edge;
  float whole; // of the weights, the pixel's own filling up; 0: those that count are all
};

constexpr Mixture kTent{{{{1, 1, 0.5f}, {1, 1, 0.5f}, {0.5f, 0.5f, 0.25f}}}, {1, 1, 1}, 0};
// A tent over one colour of the chessboard, in which each of four patterns has the same weight. On floors seen at a
// grazing angle the next row is far off: with the shorter reach for planes too, patterns show as combs of single
// pixels.
constexpr Mixture kQuincunx{{{{4, 0, 1}, {0, 2, 0}, {1, 0, 0}}}, {0.2f, 0.8f, 0.4f}, 16};
constexpr Mixture kTent5{{{{9, 6, 3}, {6, 4, 2}, {3, 2, 1}}}, {0.2f, 0.4f, 0.4f}, 81};

/// Calls each(u, v, other) for the pixels of an image within `radius` of one, it included.
template <class Each> void aroundPixel(int x, int y, int radius, int width, int height, const Each& each) {
  for (int v = std::max(y - radius, 0); v <= std::min(y + radius, height - 1); ++v)
    for (int u = std::max(x - radius, 0); u <= std::min(x + radius, width - 1); ++u)
      each(u, v, size_t(v) * size_t(width) + size_t(u));
}

/// Calls each(x, y, pixel) for all, rows side by side.
template <class Each> void forPixels(const NeighbourSurfaces& seen, int height, const Each& each) {
  parallelFor(size_t(height), 8, [&](size_t begin, size_t end) {
    for (int y = int(begin); y < int(end); ++y)
      for (int x = 0; x < seen.width; ++x) each(x, y, size_t(y) * size_t(seen.width) + size_t(x));
  });
}

void mix(std::vector<vec3>& light, const NeighbourSurfaces& seen, const Mixture& mixture) {
  const std::vector<vec3> traced = light;
  const int width = seen.width, height = int(light.size()) / width;
  forPixels(seen, height, [&](int x, int y, size_t at) {
    vec3 sum(0);
    float weights = 0;
    aroundPixel(x, y, 2, width, height, [&](int u, int v, size_t other) {
      const float weight = mixture.weights[std::abs(u - x)][std::abs(v - y)];
      if (weight == 0 || !mixture.edge.passes(seen, at, other)) return;
      sum += weight * traced[other];
      weights += weight;
    });
    const float kept = std::max(0.0f, mixture.whole - weights);
    if (weights > 0) light[at] = (sum + kept * traced[at]) / (weights + kept);
  });
}

} // namespace

void mixPatterns(std::vector<vec3>& light, const NeighbourSurfaces& seen) { mix(light, seen, kQuincunx); }

void mixBlocks(std::vector<vec3>& light, const NeighbourSurfaces& seen) { mix(light, seen, kTent); }

void spreadOutliers(std::vector<vec3>& light, std::span<const float> before, const NeighbourSurfaces& seen) {
  constexpr int kAround = 3;        // pixels
  constexpr float kOutlier = 8;     // times what its neighbours have on the mean
  constexpr float kAboveBefore = 4; // and times what it had before
  constexpr EdgeStop kEdge{0.4f, 0.4f, 0.4f};
  static_assert((2 * kAround + 1) * (2 * kAround + 1) <= 64, "a bit for each");
  struct Outlier {
    int x, y;
    uint64_t takers;  // of the pixels around, in their order
    vec3 kept, given; // given: to itself and to each taker
  };
  const int width = seen.width, height = int(light.size()) / width;
  std::vector<std::vector<Outlier>> found(light.size() / size_t(width)); // by rows
  forPixels(seen, height, [&](int x, int y, size_t at) {
    const float own = luminance(light[at]);
    if (!(own > kAboveBefore * before[at])) return;
    float sum = 0;
    uint64_t takers = 0, bit = 1;
    aroundPixel(x, y, kAround, width, height, [&](int, int, size_t other) {
      if (other != at && kEdge.passes(seen, at, other)) {
        sum += luminance(light[other]);
        takers |= bit;
      }
      bit <<= 1;
    });
    const float neighbours = float(std::popcount(takers));
    const float most = std::max(kOutlier * sum / std::max(neighbours, 1.0f), kAboveBefore * before[at]);
    if (takers == 0 || !(own > most) || !std::isfinite(own)) return;
    const vec3 kept = light[at] * (most / own);
    found[size_t(y)].push_back({x, y, takers, kept, (light[at] - kept) / (neighbours + 1)});
  });
  for (const std::vector<Outlier>& row : found)
    for (const Outlier& o : row) light[size_t(o.y) * size_t(width) + size_t(o.x)] = o.kept + o.given;
  for (const std::vector<Outlier>& row : found)
    for (const Outlier& o : row) {
      uint64_t takers = o.takers;
      aroundPixel(o.x, o.y, kAround, width, height, [&](int, int, size_t other) {
        if (takers & 1) light[other] += o.given;
        takers >>= 1;
      });
    }
}

void mixPixels(std::vector<vec3>& light, const NeighbourSurfaces& seen) { mix(light, seen, kTent5); }

} // namespace lambent

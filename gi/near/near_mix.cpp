#include "gi/near/near_mix.h"

#include "engine/core/parallel.h"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace lambent {

namespace {

/// Which neighbours a pixel's light is mixed with.
struct Mixture {
  std::array<std::array<float, 3>, 3> weights; // by how many columns and rows apart
  float reach, flatReach;                      // in cells: between the surfaces seen; between those in one plane
  float slope;                                 // sine: how far a neighbour may be off the plane, over its distance
  float whole; // of the weights, the pixel's own filling up; 0: those that count are all
};

constexpr Mixture kTent{{{{1, 1, 0.5f}, {1, 1, 0.5f}, {0.5f, 0.5f, 0.25f}}}, 1, 1, 1, 0};
// A tent over one colour of the chessboard, in which each of four patterns has the same weight. On floors seen at a
// grazing angle the next row is far off: with the shorter reach for planes too, patterns show as combs of single
// pixels.
constexpr Mixture kQuincunx{{{{4, 0, 1}, {0, 2, 0}, {1, 0, 0}}}, 0.2f, 0.8f, 0.4f, 16};
constexpr Mixture kTent5{{{{9, 6, 3}, {6, 4, 2}, {3, 2, 1}}}, 0.2f, 0.4f, 0.4f, 81};

void mix(std::vector<vec3>& light, const NeighbourSurfaces& seen, const Mixture& mixture) {
  constexpr float kAlike = 0.3f; // cosine between normals
  constexpr float kFlat = 0.05f; // slope of what lies in the plane
  const std::vector<vec3> traced = light;
  const int width = seen.width, height = int(light.size()) / width;
  parallelFor(size_t(height), 8, [&](size_t begin, size_t end) {
    for (int y = int(begin); y < int(end); ++y)
      for (int x = 0; x < width; ++x) {
        const size_t at = size_t(y) * width + x;
        vec3 sum(0);
        float weights = 0;
        for (int v = std::max(y - 2, 0); v <= std::min(y + 2, height - 1); ++v)
          for (int u = std::max(x - 2, 0); u <= std::min(x + 2, width - 1); ++u) {
            const float weight = mixture.weights[std::abs(u - x)][std::abs(v - y)];
            const size_t other = size_t(v) * width + u;
            const vec3 d = seen.positions[other] - seen.positions[at];
            const float off = glm::dot(seen.normals[at], d), offThere = glm::dot(seen.normals[other], d);
            const float apart2 = glm::dot(d, d), off2 = std::max(off * off, offThere * offThere);
            const float reach = seen.cell * (off2 <= kFlat * kFlat * apart2 ? mixture.flatReach : mixture.reach);
            if (weight == 0 || !(apart2 <= reach * reach) || glm::dot(seen.normals[other], seen.normals[at]) < kAlike ||
                off2 > mixture.slope * mixture.slope * apart2)
              continue;
            sum += weight * traced[other];
            weights += weight;
          }
        const float kept = std::max(0.0f, mixture.whole - weights);
        if (weights > 0) light[at] = (sum + kept * traced[at]) / (weights + kept);
      }
  });
}

} // namespace

void mixPatterns(std::vector<vec3>& light, const NeighbourSurfaces& seen) { mix(light, seen, kQuincunx); }

void mixBlocks(std::vector<vec3>& light, const NeighbourSurfaces& seen) { mix(light, seen, kTent); }

void mixPixels(std::vector<vec3>& light, const NeighbourSurfaces& seen) { mix(light, seen, kTent5); }

} // namespace lambent

#include "tools/content/hall_parts.h"

#include "engine/core/error.h"

#include <cmath>

namespace lambent::content {

namespace {

/// Points on a quarter turn or an S between two profile points: `bulge` > 0 swells to the outside.
ProfilePiece curve(const dvec2& from, const dvec2& to, double bulge, uint32_t steps) {
  ProfilePiece piece;
  const dvec2 along = to - from, outward = dvec2(along.y, -along.x);
  for (uint32_t i = 0; i <= steps; ++i) {
    const double t = double(i) / steps;
    // The end points are taken as they are, so that neighbouring pieces meet exactly.
    piece.push_back(i == 0 ? from : i == steps ? to : from + t * along + bulge * 4 * t * (1 - t) * outward);
  }
  return piece;
}

} // namespace

Geometry column(double height, uint32_t segments) {
  constexpr double kPlinth = 0.14, kAbacus = 0.12, kHalf = 0.31; // the block above and below is 0.62 m wide
  const double foot = kPlinth, head = height - kAbacus;
  const std::vector<ProfilePiece> profile{
      {{0, foot}, {0.26, foot}},
      curve({0.26, foot}, {0.26, foot + 0.10}, 0.35, 4), // torus
      {{0.26, foot + 0.10}, {0.235, foot + 0.10}},
      curve({0.235, foot + 0.10}, {0.225, foot + 0.16}, -0.25, 2), // hollow that leads to the shaft
      curve({0.225, foot + 0.16}, {0.19, head - 0.34}, 0.004, 4),  // shaft, slightly swollen
      {{0.19, head - 0.34}, {0.215, head - 0.34}},
      curve({0.215, head - 0.34}, {0.215, head - 0.29}, 0.4, 2), // neck ring
      {{0.215, head - 0.29}, {0.195, head - 0.29}},
      curve({0.195, head - 0.29}, {0.29, head}, -0.18, 4), // bell of the capital
      {{0.29, head}, {0, head}},
  };
  Geometry g = lathe(profile, segments);
  g.add(box({-kHalf, 0, -kHalf}, {kHalf, kPlinth, kHalf}));
  g.add(box({-kHalf, head, -kHalf}, {kHalf, height, kHalf}));
  return g;
}

Geometry baluster(double height, uint32_t segments) {
  const double neck = 0.72 * height;
  return lathe({{{0, 0}, {0.06, 0}},
                {{0.06, 0}, {0.06, 0.08}},
                curve({0.06, 0.08}, {0.035, neck}, 0.06, 4),
                curve({0.035, neck}, {0.06, height}, -0.12, 2),
                {{0.06, height}, {0, height}}},
               segments);
}

Geometry basin() {
  return lathe({{{0, 0}, {0.9, 0}},
                {{0.9, 0}, {0.9, 0.12}},
                {{0.9, 0.12}, {0.55, 0.18}},
                curve({0.55, 0.18}, {1.25, 0.62}, 0.22, 6),
                {{1.25, 0.62}, {1.25, 0.72}},
                {{1.25, 0.72}, {1.1, 0.72}},
                curve({1.1, 0.72}, {0, 0.42}, -0.12, 6)},
               32);
}

Geometry wallWithOpening(const dvec3& lo, const dvec3& hi, const dvec2& openingLo, const dvec2& openingHi) {
  CHECK(openingLo.x > lo.x && openingHi.x < hi.x && openingLo.y >= lo.y && openingHi.y < hi.y);
  Geometry g;
  g.add(box(lo, {openingLo.x, hi.y, hi.z}));
  g.add(box({openingHi.x, lo.y, lo.z}, hi));
  g.add(box({openingLo.x, openingHi.y, lo.z}, {openingHi.x, hi.y, hi.z}));
  if (openingLo.y > lo.y) g.add(box({openingLo.x, lo.y, lo.z}, {openingHi.x, openingLo.y, hi.z}));
  return g;
}

Geometry crossWallWithOpening(const dvec3& lo, const dvec3& hi, const dvec2& openingLo, const dvec2& openingHi) {
  // A quarter turn around +Y takes (x, y, z) to (z, y, -x).
  Geometry g = wallWithOpening({-hi.z, lo.y, lo.x}, {-lo.z, hi.y, hi.x}, {-openingHi.x, openingLo.y},
                               {-openingLo.x, openingHi.y});
  for (auto* vectors : {&g.positions, &g.normals})
    for (dvec3& v : *vectors) v = {v.z, v.y, -v.x};
  return g;
}

} // namespace lambent::content

#include "tools/content/citadel_parts.h"

#include "tools/content/hall_parts.h"
#include "tools/content/scene_builder.h"

#include <array>
#include <cmath>
#include <vector>

namespace lambent::content {

namespace {

constexpr double kFront = 0.4, kWall = 0.3, kSlab = 0.25; // thicknesses

struct Opening {
  double lo, hi, sill, head; // x from, to; y from, to above the storey's floor
};

const std::vector<Opening>& openings(int storey) {
  static const std::vector<Opening> ground{{-2.6, -1.4, 1.0, 2.3}, {0.9, 2.1, 0, 2.4}};
  static const std::vector<Opening> upper{{-2.6, -1.7, 0.9, 2.3}, {-0.45, 0.45, 0.9, 2.3}, {1.7, 2.6, 0.9, 2.3}};
  return storey == 0 ? ground : upper;
}

/// Closed block over a quadrilateral `low` and one `high` above it, both counter-clockwise from above.
Geometry hexahedron(const std::array<dvec3, 4>& low, const std::array<dvec3, 4>& high) {
  Geometry g;
  g.addQuad(high[0], high[1], high[2], high[3]);
  g.addQuad(low[3], low[2], low[1], low[0]);
  for (size_t i = 0; i < 4; ++i) g.addQuad(low[i], low[(i + 1) % 4], high[(i + 1) % 4], high[i]);
  return g;
}

} // namespace

Geometry houseShell(int storeys) {
  const double half = 0.5 * kHouseWidth, top = storeys * kStorey;
  Geometry g;
  for (int s = 0; s < storeys; ++s) {
    // The front of a storey, from the street or the floor below up: columns beside and between the openings.
    const double y = s * kStorey, lo = s ? y : -0.05, hi = y + kStorey;
    double x = -half;
    for (const Opening& o : openings(s)) {
      g.add(box({x, lo, 0}, {o.lo, hi, kFront}));
      g.add(box({o.lo, y + o.head, 0}, {o.hi, hi, kFront}));
      if (o.sill > 0) g.add(box({o.lo, lo, 0}, {o.hi, y + o.sill, kFront}));
      x = o.hi;
    }
    g.add(box({x, lo, 0}, {half, hi, kFront}));
    g.add(box({-half + kWall, hi - kSlab, kFront}, {half - kWall, hi, kHouseDepth - kWall}));
    if (s) g.add(box({-half, y - 0.1, -0.06}, {half, y + 0.05, 0.05})); // string course
  }
  g.add(box({-half, -0.05, kFront}, {-half + kWall, top, kHouseDepth}));
  g.add(box({half - kWall, -0.05, kFront}, {half, top, kHouseDepth}));
  g.add(box({-half + kWall, -0.05, kHouseDepth - kWall}, {half - kWall, top, kHouseDepth}));
  return g;
}

Geometry houseWoodwork(int storeys) {
  Geometry g;
  for (int s = 0; s < storeys; ++s)
    for (const Opening& o : openings(s)) {
      const double y = s * kStorey;
      if (o.sill == 0) { // the door stands open, inside
        g.add(box({o.hi + 0.02, 0.01, kFront + 0.02}, {o.hi + 0.08, o.head - 0.02, kFront + 1.1}));
        continue;
      }
      const double half = 0.5 * (o.hi - o.lo);
      for (const double side : {o.lo - half, o.hi + 0.02}) { // shutters of slats in a frame
        const double from = side, to = side + half - 0.02;
        g.add(box({from, y + o.sill, -0.03}, {from + 0.05, y + o.head, 0.01}));
        g.add(box({to - 0.05, y + o.sill, -0.03}, {to, y + o.head, 0.01}));
        for (double slat = y + o.sill + 0.02; slat < y + o.head - 0.07; slat += 0.1)
          g.add(box({from + 0.05, slat, -0.02}, {to - 0.05, slat + 0.07, 0.01}));
      }
      g.add(box({o.lo - 0.08, y + o.sill - 0.06, -0.1}, {o.hi + 0.08, y + o.sill - 0.01, 0.05})); // sill
      const double middle = 0.5 * (o.lo + o.hi), z = 0.25;
      g.add(box({middle - 0.025, y + o.sill - 0.02, z}, {middle + 0.025, y + o.head + 0.02, z + 0.05}));
      g.add(box({o.lo - 0.02, y + o.head - 0.45, z}, {o.hi + 0.02, y + o.head - 0.4, z + 0.05}));
    }
  return g;
}

Geometry houseRoof(double tileWidth, double tileLength) {
  constexpr double kOverhang = 0.4, kRidge = 2.2, kThick = 0.06;
  const double half = 0.5 * kHouseWidth - 0.02; // neighbours' gables stay apart
  const double middle = 0.5 * kHouseDepth, eaves = middle + kOverhang;
  Geometry g;
  // The body is a prism; its slopes lie 2 cm below the tiles' tops.
  const dvec3 a(-half, 0, -kOverhang), b(half, 0, -kOverhang), c(half, 0, kHouseDepth + kOverhang),
      d(-half, 0, kHouseDepth + kOverhang), e(-half, kRidge, middle), f(half, kRidge, middle);
  g.addQuad(a, b, c, d);
  g.addQuad(b, a, e, f);
  g.addQuad(d, c, f, e);
  for (const auto& [p, q, r] : {std::array{a, d, e}, std::array{c, b, f}}) {
    const dvec3 normal = glm::normalize(glm::cross(q - p, r - p));
    for (const dvec3& corner : {p, q, r}) g.indices.push_back(g.addVertex(corner, normal));
  }

  const double slope = std::hypot(eaves, kRidge);
  const int rows = int(slope / tileLength), columns = int(2 * half / tileWidth + 0.5);
  const double across = 2 * half / columns, down = slope / rows;
  for (const double side : {-1.0, 1.0}) {
    const dvec3 along = dvec3(0, -kRidge, side * eaves) / slope, out = dvec3(0, eaves, side * kRidge) / slope;
    const auto at = [&](double x, double s, double h) { return dvec3(x, kRidge, middle) + s * along + h * out; };
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column) {
        const uint32_t id = uint32_t((row * columns + column) * 2 + (side > 0));
        const double x0 = -half + across * column + 0.004, x1 = x0 + across - 0.008;
        const double s0 = down * row + 0.01, s1 = s0 + down - 0.005, lift = kThick * (0.5 + 0.3 * hashed(id));
        // The upper edge is tucked in, the lower one stands off.
        const std::array<dvec3, 4> low{at(x0, s1, -0.02), at(x1, s1, -0.02), at(x1, s0, -0.02), at(x0, s0, -0.02)};
        const std::array<dvec3, 4> high{at(x0, s1, lift), at(x1, s1, lift), at(x1, s0, 0.012), at(x0, s0, 0.012)};
        if (side > 0)
          g.add(hexahedron(low, high));
        else
          g.add(hexahedron({low[1], low[0], low[3], low[2]}, {high[1], high[0], high[3], high[2]}));
      }
  }
  return g;
}

Geometry houseBalcony(uint32_t segments) {
  constexpr double kHalf = 2.9, kReach = 0.8, kRail = 0.9;
  Geometry g = box({-kHalf, -0.14, -kReach}, {kHalf, 0.02, 0.1});
  g.add(box({-kHalf, kRail - 0.08, -kReach}, {kHalf, kRail, -kReach + 0.12}));
  for (int i = 0; i < 22; ++i)
    g.add(baluster(kRail - 0.1, segments), {-kHalf + 0.13 + 0.2685 * i, 0.01, -kReach + 0.07});
  for (const double x : {-kHalf, kHalf - 0.08}) g.add(box({x, kRail - 0.08, -kReach + 0.12}, {x + 0.08, kRail, 0.1}));
  for (const double x : {-2.2, 2.0}) g.add(box({x, -0.4, -0.5}, {x + 0.2, -0.14, 0.1})); // consoles
  return g;
}

Geometry cobbles(double length, double width, double pitch) {
  Geometry g;
  const int columns = int(length / pitch + 0.5), rows = int(width / pitch + 0.5);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const uint32_t id = uint32_t(row * columns + column);
      const double x = pitch * (column + 0.5), z = pitch * (row + 0.5) - 0.5 * width;
      const double foot = 0.485 * pitch, head = foot - 0.015, y = 0.02 + 0.01 * hashed(id, 5);
      const auto corners = [&](double h, double level) {
        return std::array<dvec3, 4>{dvec3(x - h, level, z + h), dvec3(x + h, level, z + h), dvec3(x + h, level, z - h),
                                    dvec3(x - h, level, z - h)};
      };
      g.add(hexahedron(corners(foot, -0.02), corners(head, y)));
    }
  return g;
}

} // namespace lambent::content

#include "tools/content/furniture.h"

#include "tools/content/scene_builder.h"

namespace lambent::content {

namespace {

/// Points on a quarter turn or an S between two profile points: `bulge` > 0 swells to the outside.
ProfilePiece curve(const dvec2& from, const dvec2& to, double bulge, uint32_t steps) {
  ProfilePiece piece;
  const dvec2 along = to - from, outward = dvec2(along.y, -along.x);
  for (uint32_t i = 1; i <= steps; ++i) {
    const double t = double(i) / steps;
    piece.push_back(i == steps ? to : from + t * along + bulge * 4 * t * (1 - t) * outward);
  }
  return piece;
}

} // namespace

Geometry column(double height, uint32_t segments) {
  constexpr double kPlinth = 0.14, kAbacus = 0.12, kHalf = 0.31; // the block above and below is 0.62 m wide
  const double foot = kPlinth, head = height - kAbacus;
  Geometry g = lathe({0, foot},
                     {
                         {{0.26, foot}},
                         curve({0.26, foot}, {0.26, foot + 0.10}, 0.35, 4), // torus
                         {{0.235, foot + 0.10}},
                         curve({0.235, foot + 0.10}, {0.225, foot + 0.16}, -0.25, 2), // hollow that leads to the shaft
                         curve({0.225, foot + 0.16}, {0.19, head - 0.34}, 0.004, 4),  // shaft, slightly swollen
                         {{0.215, head - 0.34}},
                         curve({0.215, head - 0.34}, {0.215, head - 0.29}, 0.4, 2), // neck ring
                         {{0.195, head - 0.29}},
                         curve({0.195, head - 0.29}, {0.29, head}, -0.18, 4), // bell of the capital
                         {{0, head}},
                     },
                     segments);
  g.add(box({-kHalf, 0, -kHalf}, {kHalf, kPlinth, kHalf}));
  g.add(box({-kHalf, head, -kHalf}, {kHalf, height, kHalf}));
  return g;
}

Geometry baluster(double height, uint32_t segments) {
  const double neck = 0.72 * height;
  return lathe({0, 0},
               {{{0.06, 0}},
                {{0.06, 0.08}},
                curve({0.06, 0.08}, {0.035, neck}, 0.06, 4),
                curve({0.035, neck}, {0.06, height}, -0.12, 2),
                {{0, height}}},
               segments);
}

Geometry basin() {
  return lathe({0, 0},
               {{{0.9, 0}},
                {{0.9, 0.12}},
                {{0.55, 0.18}},
                curve({0.55, 0.18}, {1.25, 0.62}, 0.22, 6),
                {{1.25, 0.72}},
                {{1.1, 0.72}},
                curve({1.1, 0.72}, {0, 0.42}, -0.12, 6)},
               32);
}

Geometry basinWater() { return lathe({0, 0.5}, {{{0.95, 0.5}}, {{0.95, 0.56}}, {{0, 0.56}}}, 32); }

Geometry chair(uint32_t segments) {
  // Cushion, post and hub on a lathe; five feet and a back of two slats and a rest.
  Geometry g = lathe(
      {0, 0.42}, {{{0.2, 0.42}}, {{0.235, 0.44}, {0.24, 0.47}, {0.225, 0.5}, {0.19, 0.515}}, {{0, 0.51}}}, segments);
  g.add(lathe({0, 0.1}, {{{0.05, 0.1}}, {{0.05, 0.2}, {0.028, 0.22}, {0.028, 0.43}}, {{0, 0.43}}}, segments / 2));
  Geometry foot = box({-0.025, 0.05, 0.02}, {0.025, 0.12, 0.3});
  foot.add(sphere(0.03, std::max(6u, segments / 2)), {0, 0.03, 0.28}); // castor
  for (int i = 0; i < 5; ++i) g.add(turned(foot, 72.0 * i));
  for (const double x : {-0.12, 0.08}) g.add(box({x, 0.46, 0.19}, {x + 0.04, 0.92, 0.215}));
  g.add(box({-0.2, 0.62, 0.21}, {0.2, 0.98, 0.25}));
  return g;
}

Geometry table(double width, double depth, bool pedestals) {
  const double x = 0.5 * width, z = 0.5 * depth;
  Geometry g = box({-x, 0.7, -z}, {x, 0.74, z});
  if (pedestals) {
    for (const double side : {-1.0, 1.0}) {
      const double middle = side * (x - 0.24);
      g.add(box({middle - 0.2, 0.0, -z + 0.05}, {middle + 0.2, 0.7, z - 0.05}));
      for (int drawer = 0; drawer < 3; ++drawer) {
        const double y = 0.08 + 0.21 * drawer;
        g.add(box({middle - 0.18, y, z - 0.06}, {middle + 0.18, y + 0.18, z - 0.03}));
        g.add(box({middle - 0.05, y + 0.11, z - 0.04}, {middle + 0.05, y + 0.125, z - 0.01}));
      }
    }
    g.add(box({-x + 0.4, 0.35, -z + 0.1}, {x - 0.4, 0.7, -z + 0.13}));
  } else {
    for (const double lx : {-x + 0.05, x - 0.11})
      for (const double lz : {-z + 0.05, z - 0.11}) g.add(box({lx, 0, lz}, {lx + 0.06, 0.7, lz + 0.06}));
  }
  return g;
}

Geometry screen() {
  Geometry g = box({-0.12, 0, -0.08}, {0.12, 0.015, 0.08});
  g.add(box({-0.025, 0.01, -0.02}, {0.025, 0.2, 0.0}));
  g.add(box({-0.28, 0.1, 0.0}, {0.28, 0.44, 0.035}));
  return g;
}

Geometry keyboard(uint32_t columns) {
  const double width = 0.42, pitch = width / columns;
  Geometry g = box({-0.5 * width - 0.01, 0, -0.08}, {0.5 * width + 0.01, 0.015, 0.08});
  for (uint32_t row = 0; row < 5; ++row)
    for (uint32_t column = 0; column < columns; ++column) {
      const double x = -0.5 * width + pitch * column, z = -0.07 + 0.028 * row;
      g.add(box({x + 0.1 * pitch, 0.01, z}, {x + 0.9 * pitch, 0.024, z + 0.022}));
    }
  return g;
}

Geometry shelf(double width, double height, double depth, uint32_t boards) {
  constexpr double kBoard = 0.025;
  const double x = 0.5 * width, z = 0.5 * depth;
  Geometry g = box({-x, 0, -z}, {-x + kBoard, height, z});
  g.add(box({x - kBoard, 0, -z}, {x, height, z}));
  g.add(box({-x + kBoard, 0, -z}, {x - kBoard, height, -z + 0.02}));
  for (uint32_t i = 0; i <= boards; ++i) {
    const double y = i == boards ? height - kBoard : (height - kBoard) * i / boards;
    g.add(box({-x + kBoard, y, -z + 0.02}, {x - kBoard, y + kBoard, z - 0.005}));
  }
  return g;
}

Geometry books(double width, double height, double depth, uint32_t boards, uint32_t kind, double meanThickness) {
  constexpr double kBoard = 0.025;
  Geometry g;
  const double compartment = (height - kBoard) / boards - kBoard;
  for (uint32_t board = 0; board < boards; ++board) {
    const double y = (height - kBoard) * board / boards + kBoard;
    double x = -0.5 * width + kBoard + 0.01;
    for (uint32_t i = 0;; ++i) {
      const double thickness = meanThickness * (0.6 + 0.8 * hashed(i, board * 2));
      if (x + thickness > 0.5 * width - kBoard - 0.05) break;
      if (uint32_t(3 * hashed(i, board * 2 + 1)) == kind && hashed(i, 77 + board) > 0.08) {
        const double tall = compartment * (0.6 + 0.32 * hashed(i, 100 + board));
        const double front = 0.5 * depth - 0.03 - 0.05 * hashed(i, 200 + board);
        g.add(box({x, y, -0.5 * depth + 0.03}, {x + thickness - 0.002, y + tall, front}));
      }
      x += thickness;
    }
  }
  return g;
}

Geometry pot(double radius, double height, uint32_t segments) {
  return lathe({0, 0},
               {{{0.7 * radius, 0}},
                {{0.85 * radius, 0.5 * height}, {0.95 * radius, height}},
                {{radius, height}},
                {{radius, 1.12 * height}},
                {{0.88 * radius, 1.12 * height}},
                {{0.86 * radius, height}},
                {{0, height}}},
               segments);
}

Geometry fronds(uint32_t count, double length, double height, uint32_t steps) {
  Geometry g;
  for (uint32_t i = 0; i < count; ++i) {
    // Each leaf rises, leans over and narrows to its tip; the golden angle spreads them.
    const double reach = length * (0.7 + 0.3 * hashed(i, 11)), rise = length * (0.5 + 0.7 * hashed(i, 12));
    const auto edge = [&](uint32_t step, double side) {
      const double t = double(step) / steps;
      const double half = 0.07 * length * (0.25 + 2.2 * t * (1 - t) + 0.04);
      return dvec3(side * half, height + rise * (1.6 * t - 1.1 * t * t), 0.03 * length + reach * t);
    };
    Geometry leaf;
    for (uint32_t step = 0; step < steps; ++step)
      leaf.addQuad(edge(step, -1), edge(step, 1), edge(step + 1, 1), edge(step + 1, -1));
    g.add(turned(leaf, 137.508 * i));
  }
  return g;
}

Geometry barrel(uint32_t segments) {
  return lathe(
      {0, 0},
      {{{0.26, 0}}, {{0.31, 0.2}, {0.33, 0.42}, {0.31, 0.64}, {0.26, 0.84}}, {{0.23, 0.84}}, {{0.23, 0.8}}, {{0, 0.8}}},
      segments);
}

Geometry mug(uint32_t segments) {
  return lathe({0, 0}, {{{0.035, 0}}, {{0.04, 0.03}, {0.04, 0.095}}, {{0.034, 0.095}}, {{0.034, 0.02}}, {{0, 0.015}}},
               segments);
}

Geometry lampShade(uint32_t segments) {
  return lathe({0, -0.16},
               {{{0.03, -0.18}}, {{0.19, -0.28}}, {{0.2, -0.27}}, {{0.04, -0.15}}, {{0.025, 0.02}}, {{0, 0.02}}},
               segments);
}

Geometry plinth(double width, double depth, double height) {
  const double x = 0.5 * width, z = 0.5 * depth;
  Geometry g = box({-x - 0.05, -0.02, -z - 0.05}, {x + 0.05, 0.1, z + 0.05});
  g.add(box({-x, 0.09, -z}, {x, height - 0.05, z}));
  g.add(box({-x - 0.04, height - 0.06, -z - 0.04}, {x + 0.04, height, z + 0.04}));
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

Geometry bench(const dvec3& seatLo, const dvec3& seatHi, const dvec3& legLo, const dvec3& legHi) {
  Geometry g = box(seatLo, seatHi);
  g.add(box({-legHi.x, legLo.y, legLo.z}, {-legLo.x, legHi.y, legHi.z}));
  g.add(box(legLo, legHi));
  return g;
}

Geometry downwardSheet(const dvec3& lo, const dvec3& hi) {
  Geometry g;
  g.addQuad(lo, {hi.x, lo.y, lo.z}, hi, {lo.x, lo.y, hi.z});
  return g;
}

Geometry panelHousing(double width, double depth) {
  return box({-0.5 * width - 0.04, -0.05, -0.5 * depth - 0.04}, {0.5 * width + 0.04, 0.02, 0.5 * depth + 0.04});
}

Geometry panelEmitter(double width, double depth) {
  return downwardSheet({-0.5 * width, -0.06, -0.5 * depth}, {0.5 * width, -0.06, 0.5 * depth});
}

} // namespace lambent::content

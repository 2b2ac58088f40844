// A street in a walled town under one sun: gabled houses with rooms behind their windows, arches across the street,
// laundry on thin lines, a flight of stairs at the east end. X runs along the street (east), which is 6 m wide; its
// paving is y = 0.
#include "tools/content/furniture.h"
#include "tools/content/recipes.h"

#include <cmath>

namespace lambent::content {

namespace {

constexpr double kHalfStreet = 3.0;
constexpr double kStairs = 4.2, kTerrace = 6.0; // lengths beyond the last house
constexpr int kSteps = 14;
constexpr double kRise = 0.17; // of a step
constexpr double kHouseWidth = 7.0, kHouseDepth = 6.0, kStorey = 3.1;
constexpr double kFront = 0.4, kWall = 0.3, kSlab = 0.25; // thicknesses

// The parts that a house is made of. Frame of all: x = 0 is the middle of the front, z = 0 its outer face, +Z goes into
// the house, y = 0 the street.

const std::vector<Opening>& openings(int storey) {
  static const std::vector<Opening> ground{{-2.6, -1.4, 1.0, 2.3}, {0.9, 2.1, 0, 2.4}};
  static const std::vector<Opening> upper{{-2.6, -1.7, 0.9, 2.3}, {-0.45, 0.45, 0.9, 2.3}, {1.7, 2.6, 0.9, 2.3}};
  return storey == 0 ? ground : upper;
}

/// Walls, floors and ceiling: hollow, with a door and a window below and three windows on every storey above.
Geometry houseShell(int storeys) {
  const double half = 0.5 * kHouseWidth, top = storeys * kStorey;
  Geometry g;
  for (int s = 0; s < storeys; ++s) {
    const double y = s * kStorey, hi = y + kStorey;
    g.add(wallWithOpenings(openings(s), half, kFront, s ? y : -0.05, y, hi)); // from the street or the floor below up
    g.add(box({-half + kWall, hi - kSlab, kFront}, {half - kWall, hi, kHouseDepth - kWall}));
    if (s) g.add(box({-half, y - 0.1, -0.06}, {half, y + 0.05, 0.05})); // string course
  }
  g.add(box({-half, -0.05, kFront}, {-half + kWall, top, kHouseDepth}));
  g.add(box({half - kWall, -0.05, kFront}, {half, top, kHouseDepth}));
  g.add(box({-half + kWall, -0.05, kHouseDepth - kWall}, {half - kWall, top, kHouseDepth}));
  return g;
}

/// Open shutters, sills, door and window crosses of that shell.
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

/// Gabled roof on y = 0 with tiles of the given width along the house and length down the slope.
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

/// Balcony whose floor is at y = 0, with a balustrade; `segments` around a baluster.
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

class Citadel : public SceneBuilder {
 public:
  explicit Citadel(const Order& order) : SceneBuilder(order), houses_(full() ? 8 : 3) {
    addGround();
    addHouses();
    addArches();
    addEnds();
    addLaundry();
    addProps();
    sun({0.38, -0.8, 0.42}, {1, 0.93, 0.82}, 20);
    camera("street", {1.5, 1.7, 0.3}, {12, 2.2, -0.6});
    camera("to the stairs", {length() - 5, 1.7, 0.8}, {length() + 4, 2.4, 0});
    camera("back", {length() - 1, 1.7, -1.2}, {0, 3.2, 0.5});
  }

 private:
  double length() const { return kHouseWidth * houses_; }
  double houseX(int i) const { return kHouseWidth * (i + 0.5); }
  /// How far a house stands back from the line of the street; never the same as its neighbours.
  static double setBack(int i) { return 0.07 * (i % 3); }

  void addGround() {
    place("ground", box({-12, -0.4, -16}, {length() + 24, 0, 16}), earth_);
    const double patch = full() ? 2.0 : 7.0;
    const Index stones = mesh("cobbles", cobbles(patch, 2 * kHalfStreet, full() ? 0.2 : 1.0), stone_);
    for (int i = 0; i < int(length() / patch + 0.5); ++i)
      place("cobbles " + std::to_string(i), stones, {patch * i, 0, 0});
  }

  void addHouses() {
    const std::array<Index, 4> paints{paint("limewash", {0.74, 0.7, 0.6}), paint("ochre wash", {0.7, 0.5, 0.26}),
                                      paint("rose wash", {0.66, 0.4, 0.32}), paint("grey wash", {0.5, 0.52, 0.5})};
    std::array<std::array<Index, 4>, 2> shells;
    std::array<Index, 2> details;
    for (int i = 0; i < 2; ++i) {
      const std::string storeys = std::to_string(i + 2) + " storeys";
      shells[size_t(i)][0] = mesh("house " + storeys + " 0", houseShell(i + 2), paints[0]);
      for (size_t k = 1; k < paints.size(); ++k)
        shells[size_t(i)][k] = variant("house " + storeys + " " + std::to_string(k), shells[size_t(i)][0], paints[k]);
      details[size_t(i)] = mesh("woodwork " + storeys, houseWoodwork(i + 2), timber_);
    }
    const Index roof = mesh("roof", houseRoof(full() ? 0.25 : kHouseWidth - 0.04, full() ? 0.26 : 0.9), tile_);
    const Index balcony = mesh("balcony", houseBalcony(detail(10, 5)), stone_);
    for (const auto& [side, sign, turn] : kSides)
      for (int i = 0; i < houses_; ++i) {
        const bool south = sign > 0;
        const int kind = (i * 5 + (south ? 2 : 0)) % 7;
        const int storeys = kind % 2 ? 3 : 2;
        const std::string name = side + " house " + std::to_string(i);
        const dvec3 at(houseX(i), 0, sign * (kHalfStreet + setBack(i + south)));
        place(name, shells[size_t(storeys - 2)][size_t(kind) % 4], at, turn);
        place(name + " woodwork", details[size_t(storeys - 2)], at, turn);
        place(name + " roof", roof, at + dvec3(0, storeys * kStorey, 0), turn);
        if (kind % 3 == 1) place(name + " balcony", balcony, at + dvec3(0, kStorey, 0), turn);
      }
  }

  void addArches() {
    // Across the street at joints of houses; their ends are sunk into the walls.
    Geometry g = moved(
        turned(arch({.bay = 6.6, .height = 3.2, .thickness = 0.5, .radius = 2.5, .segments = detail(36, 10)}), 90),
        {0, 2.9, 0});
    for (const double side : {-1.0, 1.0}) g.add(box({-0.25, -0.05, side * 2.9 - 0.4}, {0.25, 2.9, side * 2.9 + 0.4}));
    const Index gate = mesh("street arch", g, stone_);
    for (int i = 1; i < houses_; i += 3) place("street arch " + std::to_string(i), gate, {kHouseWidth * i, 0, 0});
  }

  void addEnds() {
    const double x1 = length(), top = x1 + kStairs, rise = kSteps * kRise, end = top + kTerrace;
    Geometry stairs;
    for (int i = 0; i < kSteps; ++i)
      stairs.add(box({x1 + kStairs * i / kSteps, kRise * i - 0.02, -2.2}, {top, kRise * (i + 1), 2.2}));
    stairs.add(box({top, -0.05, -kHalfStreet - 1}, {end, rise, kHalfStreet + 1}));
    place("stairs", stairs, stone_);

    // Walls beside the stairs and around the terrace, and the town wall at the west end.
    Geometry wall;
    for (const double side : {-1.0, 1.0}) {
      const double outer = side * (kHalfStreet + 1.2);
      wall.add(box({x1, -0.05, side * 2.2}, {top, rise + 1.0, outer}));
      wall.add(box({top, rise - 0.05, side * (kHalfStreet + 0.6)}, {end, rise + 5, outer}));
    }
    wall.add(wallWithArch(
        {.bay = 2 * kHalfStreet + 1.2, .height = 2.6, .thickness = 0.6, .radius = 1.6, .segments = detail(36, 10)},
        rise, end + 0.3));
    wall.add(wallWithArch(
        {.bay = 2 * kHalfStreet + 1.2, .height = 3.4, .thickness = 0.8, .radius = 1.9, .segments = detail(36, 10)}, 0,
        -0.4));
    for (const double side : {-1.0, 1.0})
      wall.add(box({-3.4, -0.05, side * 4.6 - 1.4}, {-0.01, 9.5, side * 4.6 + 1.4}));
    place("town walls", wall, stone_);
    place("far yard", box({end + 4, -0.05, -8}, {end + 4.5, 8, 8}), earth_);
    place("west yard", box({-7.5, -0.05, -8}, {-7, 7, 8}), earth_);
  }

  /// An arch on two piers across the street, standing on y = `foot`, its middle at x.
  static Geometry wallWithArch(const ArchShape& shape, double foot, double x) {
    constexpr double kPier = 1.9;
    Geometry g = moved(turned(arch(shape), 90), {x, foot + kPier, 0});
    for (const double side : {-1.0, 1.0})
      g.add(box({x - 0.5 * shape.thickness, foot - 0.05, side * shape.radius},
                {x + 0.5 * shape.thickness, foot + kPier, side * 0.5 * shape.bay}));
    return g;
  }

  void addLaundry() {
    const std::array<Index, 4> cloths{fabric("white linen", {0.76, 0.75, 0.72}),
                                      fabric("red linen", {0.62, 0.08, 0.06}), fabric("blue linen", {0.08, 0.18, 0.56}),
                                      fabric("yellow linen", {0.74, 0.56, 0.1})};
    std::array<Index, 4> sheets;
    sheets[0] = mesh("laundry 0",
                     turned(cloth({.width = 0.8,
                                   .drop = 1.1,
                                   .folds = 2.5,
                                   .foldDepthTop = 0.015,
                                   .foldDepthBottom = 0.05,
                                   .columns = detail(30, 8),
                                   .rows = detail(14, 4)}),
                            90),
                     cloths[0]);
    for (size_t k = 1; k < sheets.size(); ++k)
      sheets[k] = variant("laundry " + std::to_string(k), sheets[0], cloths[k]);
    for (int line = 0; line < (full() ? 5 : 2); ++line) {
      const double x = 4.6 + line * (full() ? 10.4 : 10.0), y = 4.6 + 0.5 * (line % 2), half = kHalfStreet + 0.3,
                   sag = 0.3;
      // A parabola: the shape of a line that carries its load evenly.
      const auto height = [&](double z) { return y - sag * (1 - (z / half) * (z / half)); };
      std::vector<dvec3> points;
      const uint32_t pieces = detail(24, 8);
      for (uint32_t i = 0; i <= pieces; ++i) {
        const double z = -half + 2 * half * i / pieces;
        points.emplace_back(0, height(z), z);
      }
      const std::string name = "clothes line " + std::to_string(line);
      place(name, rod(points, 0.006, 6), timber_, {x, 0, 0});
      for (int i = 0; i < 5; ++i) {
        const double z = -2.1 + 1.05 * i;
        place(name + " cloth " + std::to_string(i), sheets[size_t(i * 3 + line) % 4], {x, height(z), z});
      }
    }
  }

  void addProps() {
    Geometry store = barrel(detail(32, 10));
    store.add(barrel(detail(32, 10)), {0.7, 0, 0.08});
    store.add(box({1.15, 0, -0.3}, {1.8, 0.6, 0.3}));
    const Index barrels = mesh("barrels", store, timber_);
    Geometry pair = pot(0.24, 0.4, detail(40, 10));
    pair.add(pot(0.17, 0.3, detail(40, 10)), {0.52, 0, 0.05});
    const Index pots = mesh("pots", pair, tile_);
    const Index plant =
        mesh("plant", fronds(detail(40, 10), 0.36, 0.42, detail(10, 3)), fabric("leaf", {0.12, 0.34, 0.09}));
    for (int i = 0; i < houses_; ++i)
      for (const auto& [side, sign, turn] : kSides) {
        const std::string name = side + " side " + std::to_string(i);
        const double z = sign * (kHalfStreet - 0.42);
        if ((i + (sign > 0)) % 2) {
          place(name + " barrels", barrels, {houseX(i) - 0.9, 0.02, z}, turn);
        } else {
          place(name + " pots", pots, {houseX(i) + 0.2, 0.02, z});
          place(name + " plant", plant, {houseX(i) + 0.2, 0.02, z});
        }
      }
  }

  int houses_; // on each side
  const Index stone_ = paint("stone", {0.56, 0.52, 0.45}), earth_ = paint("earth", {0.36, 0.29, 0.21});
  const Index timber_ = paint("timber", {0.3, 0.19, 0.11}), tile_ = paint("roof tile", {0.52, 0.2, 0.12});
};

} // namespace

GeneratedScene writeCitadel(const Order& order) { return Citadel(order).write(); }

} // namespace lambent::content

// A street in a walled town under one sun: gabled houses with rooms behind their windows, arches across the street,
// laundry on thin lines, a flight of stairs at the east end. X runs along the street (east), which is 6 m wide; its
// paving is y = 0.
#include "tools/content/citadel_parts.h"
#include "tools/content/furniture.h"
#include "tools/content/hall_parts.h"
#include "tools/content/recipes.h"

#include <array>
#include <string>

namespace lambent::content {

namespace {

constexpr double kHalfStreet = 3.0;
constexpr double kStairs = 4.2, kTerrace = 6.0; // lengths beyond the last house
constexpr int kSteps = 14;
constexpr double kRise = 0.17; // of a step

class CitadelBuilder {
 public:
  explicit CitadelBuilder(SceneSize size) : full_(size == SceneSize::Full), houses_(full_ ? 8 : 3) {}

  GeneratedScene write(const std::filesystem::path& folder) {
    addGround();
    addHouses();
    addArches();
    addEnds();
    addLaundry();
    addProps();
    s_.sun({0.38, -0.8, 0.42}, {1, 0.93, 0.82}, 20);
    s_.camera("street", {1.5, 1.7, 0.3}, {12, 2.2, -0.6});
    s_.camera("to the stairs", {length() - 5, 1.7, 0.8}, {length() + 4, 2.4, 0});
    s_.camera("back", {length() - 1, 1.7, -1.2}, {0, 3.2, 0.5});
    return s_.gltf.write(folder, full_ ? "citadel" : "citadel-small");
  }

 private:
  double length() const { return kHouseWidth * houses_; }
  double houseX(int i) const { return kHouseWidth * (i + 0.5); }
  uint32_t detail(uint32_t full, uint32_t small) const { return full_ ? full : small; }
  /// How far a house stands back from the line of the street; never the same as its neighbours.
  static double setBack(int i) { return 0.07 * (i % 3); }

  void addGround() {
    s_.place("ground", box({-12, -0.4, -16}, {length() + 24, 0, 16}), earth_);
    const double patch = full_ ? 2.0 : 7.0;
    const Index stones = s_.mesh("cobbles", cobbles(patch, 2 * kHalfStreet, full_ ? 0.2 : 1.0), stone_);
    for (int i = 0; i < int(length() / patch + 0.5); ++i)
      s_.place("cobbles " + std::to_string(i), stones, {patch * i, 0, 0});
  }

  void addHouses() {
    const std::array<Index, 4> paints{s_.paint("limewash", {0.74, 0.7, 0.6}), s_.paint("ochre wash", {0.7, 0.5, 0.26}),
                                      s_.paint("rose wash", {0.66, 0.4, 0.32}),
                                      s_.paint("grey wash", {0.5, 0.52, 0.5})};
    std::array<std::array<Index, 4>, 2> shells;
    std::array<Index, 2> details;
    for (int i = 0; i < 2; ++i) {
      const std::string storeys = std::to_string(i + 2) + " storeys";
      shells[size_t(i)][0] = s_.mesh("house " + storeys + " 0", houseShell(i + 2), paints[0]);
      for (size_t k = 1; k < paints.size(); ++k)
        shells[size_t(i)][k] =
            s_.gltf.addMeshVariant("house " + storeys + " " + std::to_string(k), shells[size_t(i)][0], paints[k]);
      details[size_t(i)] = s_.mesh("woodwork " + storeys, houseWoodwork(i + 2), timber_);
    }
    const Index roof = s_.mesh("roof", houseRoof(full_ ? 0.25 : kHouseWidth - 0.04, full_ ? 0.26 : 0.9), tile_);
    const Index balcony = s_.mesh("balcony", houseBalcony(detail(10, 5)), stone_);
    for (const bool south : {true, false})
      for (int i = 0; i < houses_; ++i) {
        const int kind = (i * 5 + (south ? 2 : 0)) % 7;
        const int storeys = kind % 2 ? 3 : 2;
        const std::string name = std::string(south ? "south" : "north") + " house " + std::to_string(i);
        const double z = (kHalfStreet + setBack(i + (south ? 1 : 0))) * (south ? 1 : -1), turn = south ? 0 : 180;
        const dvec3 at(houseX(i), 0, z);
        s_.place(name, shells[size_t(storeys - 2)][size_t(kind) % 4], at, turn);
        s_.place(name + " woodwork", details[size_t(storeys - 2)], at, turn);
        s_.place(name + " roof", roof, at + dvec3(0, storeys * kStorey, 0), turn);
        if (kind % 3 == 1) s_.place(name + " balcony", balcony, at + dvec3(0, kStorey, 0), turn);
      }
  }

  void addArches() {
    // Across the street at joints of houses; their ends are sunk into the walls.
    Geometry a =
        turned(arch({.bay = 6.6, .height = 3.2, .thickness = 0.5, .radius = 2.5, .segments = detail(36, 10)}), 90);
    Geometry g;
    g.add(a, {0, 2.9, 0});
    for (const double side : {-1.0, 1.0}) g.add(box({-0.25, -0.05, side * 2.9 - 0.4}, {0.25, 2.9, side * 2.9 + 0.4}));
    const Index gate = s_.mesh("street arch", g, stone_);
    for (int i = 1; i < houses_; i += 3) s_.place("street arch " + std::to_string(i), gate, {kHouseWidth * i, 0, 0});
  }

  void addEnds() {
    const double x1 = length(), top = x1 + kStairs, rise = kSteps * kRise, end = top + kTerrace;
    Geometry stairs;
    for (int i = 0; i < kSteps; ++i)
      stairs.add(box({x1 + kStairs * i / kSteps, kRise * i - 0.02, -2.2}, {top, kRise * (i + 1), 2.2}));
    stairs.add(box({top, -0.05, -kHalfStreet - 1}, {end, rise, kHalfStreet + 1}));
    s_.place("stairs", stairs, stone_);

    // Walls beside the stairs and around the terrace, and the town wall at the west end.
    Geometry wall;
    for (const double side : {-1.0, 1.0}) {
      const double a = side * 2.2, b = side * (kHalfStreet + 1.2);
      wall.add(box({x1, -0.05, std::min(a, b)}, {top, rise + 1.0, std::max(a, b)}));
      const double c = side * (kHalfStreet + 0.6);
      wall.add(box({top, rise - 0.05, std::min(b, c)}, {end, rise + 5, std::max(b, c)}));
    }
    wall.add(wallWithArch(
        {.bay = 2 * kHalfStreet + 1.2, .height = 2.6, .thickness = 0.6, .radius = 1.6, .segments = detail(36, 10)},
        rise, end + 0.3));
    wall.add(wallWithArch(
        {.bay = 2 * kHalfStreet + 1.2, .height = 3.4, .thickness = 0.8, .radius = 1.9, .segments = detail(36, 10)}, 0,
        -0.4));
    for (const double side : {-1.0, 1.0})
      wall.add(box({-3.4, -0.05, side * 4.6 - 1.4}, {-0.01, 9.5, side * 4.6 + 1.4}));
    s_.place("town walls", wall, stone_);
    s_.place("far yard", box({end + 4, -0.05, -8}, {end + 4.5, 8, 8}), earth_);
    s_.place("west yard", box({-7.5, -0.05, -8}, {-7, 7, 8}), earth_);
  }

  /// An arch on two piers across the street, standing on y = `foot`, its middle at x.
  static Geometry wallWithArch(const ArchShape& shape, double foot, double x) {
    constexpr double kPier = 1.9;
    Geometry g;
    g.add(turned(arch(shape), 90), {x, foot + kPier, 0});
    for (const double side : {-1.0, 1.0}) {
      const double inner = side * shape.radius, outer = side * 0.5 * shape.bay;
      g.add(box({x - 0.5 * shape.thickness, foot - 0.05, std::min(inner, outer)},
                {x + 0.5 * shape.thickness, foot + kPier, std::max(inner, outer)}));
    }
    return g;
  }

  void addLaundry() {
    const std::array<Index, 4> cloths{
        s_.fabric("white linen", {0.76, 0.75, 0.72}), s_.fabric("red linen", {0.62, 0.08, 0.06}),
        s_.fabric("blue linen", {0.08, 0.18, 0.56}), s_.fabric("yellow linen", {0.74, 0.56, 0.1})};
    std::array<Index, 4> sheets;
    sheets[0] = s_.mesh("laundry 0",
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
      sheets[k] = s_.gltf.addMeshVariant("laundry " + std::to_string(k), sheets[0], cloths[k]);
    for (int line = 0; line < (full_ ? 5 : 2); ++line) {
      const double x = 4.6 + line * (full_ ? 10.4 : 10.0), y = 4.6 + 0.5 * (line % 2), half = kHalfStreet + 0.3,
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
      s_.place(name, rod(points, 0.006, 6), timber_, {x, 0, 0});
      for (int i = 0; i < 5; ++i) {
        const double z = -2.1 + 1.05 * i;
        s_.place(name + " cloth " + std::to_string(i), sheets[size_t(i * 3 + line) % 4], {x, height(z), z});
      }
    }
  }

  void addProps() {
    const Index barrels = s_.mesh(
        "barrels",
        [&] {
          Geometry g = barrel(detail(32, 10));
          g.add(barrel(detail(32, 10)), {0.7, 0, 0.08});
          g.add(box({1.15, 0, -0.3}, {1.8, 0.6, 0.3}));
          return g;
        }(),
        timber_);
    const Index pots = s_.mesh(
        "pots",
        [&] {
          Geometry g = pot(0.24, 0.4, detail(40, 10));
          g.add(pot(0.17, 0.3, detail(40, 10)), {0.52, 0, 0.05});
          return g;
        }(),
        tile_);
    const Index plant =
        s_.mesh("plant", fronds(detail(40, 10), 0.36, 0.42, detail(10, 3)), s_.fabric("leaf", {0.12, 0.34, 0.09}));
    for (int i = 0; i < houses_; ++i)
      for (const bool south : {true, false}) {
        const std::string name = std::string(south ? "south" : "north") + " side " + std::to_string(i);
        const double z = (kHalfStreet - 0.42) * (south ? 1 : -1);
        if ((i + south) % 2) {
          s_.place(name + " barrels", barrels, {houseX(i) - 0.9, 0.02, z}, south ? 0 : 180);
        } else {
          s_.place(name + " pots", pots, {houseX(i) + 0.2, 0.02, z});
          s_.place(name + " plant", plant, {houseX(i) + 0.2, 0.02, z});
        }
      }
  }

  bool full_;
  int houses_; // on each side
  SceneBuilder s_;
  const Index stone_ = s_.paint("stone", {0.56, 0.52, 0.45}), earth_ = s_.paint("earth", {0.36, 0.29, 0.21});
  const Index timber_ = s_.paint("timber", {0.3, 0.19, 0.11}), tile_ = s_.paint("roof tile", {0.52, 0.2, 0.12});
};

} // namespace

GeneratedScene writeCitadel(const std::filesystem::path& folder, SceneSize size) {
  return CitadelBuilder(size).write(folder);
}

} // namespace lambent::content

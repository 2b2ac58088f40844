// An indoor garden: a glasshouse with whitewashed panes, beds behind low walls on both sides of a paved path, pots on
// the path and plants of five kinds, under one spot below the ridge. Thin leaves in front of far walls and a floor that
// is seen at a grazing angle are what it is for. The house's middle is x = z = 0, its length is along X, Z is south,
// the floor is y = 0.
#include "tools/content/furniture.h"
#include "tools/content/plants.h"
#include "tools/content/recipes.h"
#include "tools/content/textures.h"

#include <algorithm>
#include <cmath>

namespace lambent::content {

namespace {

constexpr double kHalfLength = 5.4, kHalfWidth = 3.3, kEaves = 2.7, kRidge = 4.1, kWall = 0.25; // inside, metres
constexpr double kSunk = 0.05;      // walls reach that far into floor, roof and each other
constexpr double kBay = 1.35;       // from one frame to the next
constexpr double kBed = 1.15;       // |z| of the beds' walls towards the path
constexpr double kBedWall = 0.42;   // their height
constexpr double kBedWidth = 0.16;  // their thickness
constexpr double kSoil = 0.34;      // height of the beds' soil
constexpr double kPlinthWall = 0.7; // brick base of the outer walls

/// Height of the roof's inside above |z|.
double roofAt(double z) { return kRidge + (kEaves - kRidge) * std::abs(z) / kHalfWidth; }

class Garden : public SceneBuilder {
 public:
  explicit Garden(const Order& order) : SceneBuilder(order) {
    addHouse();
    addFrames();
    addBeds();
    addColumns();
    addPlanting();
    addPots();
    spot("spot", {1, 0.93, 0.78}, 110, {-2.7, 3.75, 0.4}, {0.6, -1, -0.15});
    camera("path", {-4.9, 1.55, 0.35}, {1.5, 0.85, -0.2}, 60);
    camera("low", {-3.2, 0.35, 0.5}, {3, 0.45, -0.3}, 55);
  }

 private:
  void addHouse() {
    const double x = kHalfLength, z = kHalfWidth, w = kWall, out = z + w + 0.1;
    place("floor", mappedFromAbove(box({-x - w - 0.1, -0.3, -out}, {x + w + 0.1, 0, out}), 1.6),
          paint("paving", {0.95, 0.86, 0.78}, texture(stoneSlabs("slabs"))));

    Geometry walls;
    for (const double side : {-1.0, 1.0}) {
      walls.add(box({-x - kSunk, -kSunk, side * z}, {x + kSunk, kEaves + kSunk, side * (z + w)}));
      // Gable wall: reaches a little into the roof.
      const double from = side < 0 ? -x - w : x, to = from + w;
      const double top = roofAt(z + kSunk) + kSunk;
      walls.add(
          prism({{z + kSunk, -kSunk}, {-z - kSunk, -kSunk}, {-z - kSunk, top}, {0, kRidge + kSunk}, {z + kSunk, top}},
                from, to));
    }
    place("walls", walls, panes_);
    Geometry roof;
    for (const double side : {-1.0, 1.0}) {
      // The two slopes overlap at the ridge.
      const dvec2 eaves(side * out, roofAt(out)), ridge(-side * 0.1, 2 * kRidge - roofAt(0.1));
      std::vector<dvec2> slope{eaves, ridge, ridge + dvec2(0, 0.2), eaves + dvec2(0, 0.2)};
      if (side < 0) std::swap(slope[1], slope[3]);
      roof.add(prism(slope, -x - w - 0.1, x + w + 0.1));
    }
    place("roof", roof, panes_);

    const double in = 0.07; // the brick base stands in front of the panes
    Geometry base = box({-x - kSunk, -kSunk, -z - kSunk}, {x + kSunk, kPlinthWall, -z + in});
    base.add(box({-x - kSunk, -kSunk, z - in}, {x + kSunk, kPlinthWall, z + kSunk}));
    base.add(box({-x - kSunk, -kSunk, -z}, {-x + in, kPlinthWall, z}));
    base.add(box({x - in, -kSunk, -z}, {x + kSunk, kPlinthWall, z}));
    place("brick base", base, brick_);
  }

  /// Glazing bars of walls and roof, in front of the panes.
  void addFrames() {
    constexpr double kBar = 0.03, kDeep = 0.06; // half width, depth; metres
    const double z = kHalfWidth, low = kPlinthWall - 0.02;
    Geometry frame;
    for (const double side : {-1.0, 1.0}) {
      frame.add(box({-kBar, low, side * (z - kDeep)}, {kBar, kEaves + 0.02, side * (z + 0.02)}));
      // Rafter, from the post to a little beyond the ridge, where it meets the other one.
      const double slope = (kRidge - kEaves) / z;
      const dvec2 foot(side * (z - 0.01), kEaves), top(-side * 0.01, kRidge + 0.01 * slope);
      std::vector<dvec2> rafter{foot - dvec2(0, kDeep), top - dvec2(0, kDeep), top + dvec2(0, 0.03),
                                foot + dvec2(0, 0.03)};
      if (side < 0) std::swap(rafter[1], rafter[3]);
      frame.add(prism(rafter, -0.8 * kBar, 0.8 * kBar));
    }
    const Index bars = mesh("frame", frame, paint_);
    const int bays = int(2 * kHalfLength / kBay);
    for (int i = 1; i < bays; ++i) place("frame " + std::to_string(i), bars, {i * kBay - kHalfLength, 0, 0});
    // Rails along the walls and bars of the gables.
    const double x = kHalfLength;
    Geometry rails;
    for (const double y : {kPlinthWall + 0.01, 1.65, kEaves - 0.06})
      for (const double side : {-1.0, 1.0}) {
        rails.add(box({-x - 0.02, y, side * (z - kDeep + 0.01)}, {x + 0.02, y + 0.05, side * (z + 0.02)}));
        rails.add(box({side * (x - kDeep + 0.01), y, -z}, {side * (x + 0.02), y + 0.05, z}));
      }
    for (const double side : {-1.0, 1.0})
      for (int i = -2; i <= 2; ++i) {
        const double at = 1.1 * i;
        rails.add(box({side * (x - kDeep), low, at - kBar},
                      {side * (x + 0.02), roofAt(std::abs(at) + kBar) + 0.01, at + kBar}));
      }
    place("rails", rails, paint_);
    place("ridge beam", box({-x - 0.02, kRidge - 0.16, -0.04}, {x + 0.02, kRidge + 0.02, 0.04}), paint_);
  }

  /// Walls of the beds with a stone coping, and the soil behind them.
  void addBeds() {
    const double x = kHalfLength - 0.02;
    for (const double side : {-1.0, 1.0}) {
      const std::string name = side < 0 ? "north " : "south ";
      const auto along = [&](double in, double out, double y0, double y1) { // |z| from, to
        return box({-x - 0.01, y0, side * in}, {x + 0.01, y1, side * out});
      };
      place(name + "bed wall", box({-x, -0.02, side * kBed}, {x, kBedWall, side * (kBed + kBedWidth)}), brick_);
      place(name + "coping", along(kBed - 0.03, kBed + kBedWidth + 0.03, kBedWall - 0.01, kBedWall + 0.05), stone_);
      place(name + "soil", along(kBed + 0.1, kHalfWidth + 0.01, -0.03, kSoil), soil_);
    }
  }

  /// Slender iron columns on the bed walls; they carry a beam under the rafters on each side.
  void addColumns() {
    const double z = kBed + 0.5 * kBedWidth, foot = kBedWall + 0.04, head = roofAt(z) - 0.16;
    const Geometry shape = lathe({0, foot},
                                 {{{0.075, foot}},
                                  {{0.075, foot + 0.1}},
                                  {{0.05, foot + 0.16}, {0.04, head - 0.2}},
                                  {{0.06, head - 0.19}, {0.06, head - 0.15}, {0.04, head - 0.14}},
                                  {{0.085, head}},
                                  {{0, head}}},
                                 detail(32, 10));
    const Index column = mesh("column", shape, iron_);
    for (const double side : {-1.0, 1.0}) {
      const std::string name = side < 0 ? "north " : "south ";
      for (int i = -1; i <= 1; ++i)
        place(name + "column " + std::to_string(i + 2), column, {2 * kBay * i + 0.5 * kBay, 0, side * z});
      const double x = kHalfLength + 0.01;
      place(name + "beam", box({-x, head - 0.01, side * z - 0.05}, {x, head + 0.1, side * z + 0.05}), iron_);
    }
  }

  struct Kind {
    std::string name;
    Index stems = kAbsent, leaves = kAbsent;
  };

  Kind kind(const std::string& name, const Plant& plant, Index leaf) {
    Kind k{name};
    if (!plant.stems.indices.empty()) k.stems = mesh(name + " stems", plant.stems, stem_);
    k.leaves = mesh(name + " leaves", plant.leaves, leaf);
    return k;
  }

  void plant(const Kind& k, const dvec3& at, double turn) {
    const std::string number = " " + std::to_string(++planted_);
    if (k.stems != kAbsent) place(k.name + " stems" + number, k.stems, at, turn);
    place(k.name + " leaves" + number, k.leaves, at, turn);
  }

  /// Tall plants stand at the outer walls, low ones at the path.
  void addPlanting() {
    const double deep = kHalfWidth - kBed - kBedWidth;
    const uint32_t places = detail(11, 5);
    for (uint32_t bed = 0; bed < 2; ++bed) {
      const double side = bed == 0 ? -1 : 1;
      const auto inRow = [&](uint32_t i, uint32_t count, double depth, uint32_t seed) { // depth 0 is the bed wall
        const double along = (i + 0.5 + 0.5 * (hashed(i, seed + bed) - 0.5)) / count;
        const double across = depth + 0.1 * (hashed(i, seed + 10 + bed) - 0.5);
        return dvec3((2 * along - 1) * (kHalfLength - 0.55), kSoil, side * (kBed + kBedWidth + across * deep));
      };
      const auto turn = [&](uint32_t i, uint32_t seed) { return 360 * hashed(i, seed + bed); };
      for (uint32_t i = 0; i < places; ++i) {
        const dvec3 back = inRow(i, places, 0.58, 700);
        if (i % 3 == bed)
          plant(tree_, {back.x, back.y, side * (kBed + kBedWidth + 0.48 * deep)}, turn(i, 720));
        else
          plant(bamboo_, back, turn(i, 720));
        plant(i % 2 == bed ? broad_ : fern_, inRow(i, places, 0.42, 740), turn(i, 760));
        if (i % 3 != 0) plant(red_, inRow(i, places, 0.22, 780), turn(i, 800));
      }
      for (uint32_t i = 0; i < 2 * places; ++i) plant(grass_, inRow(i, 2 * places, 0.13, 820), turn(i, 840));
    }
  }

  /// Pots on the path, one with a tree.
  void addPots() {
    const Index small = mesh("pot", pot(0.19, 0.36, detail(40, 12)), clay_);
    const Index large = mesh("tub", pot(0.3, 0.5, detail(48, 12)), clay_);
    const std::array<std::pair<dvec3, const Kind*>, 5> planted{{{dvec3(-2.3, 0, 0.82), &fern_},
                                                                {dvec3(-1.2, 0, -0.86), &red_},
                                                                {dvec3(0.3, 0, 0.85), &broad_},
                                                                {dvec3(2.9, 0, -0.75), &grass_},
                                                                {dvec3(3.6, 0, 0.8), &fern_}}};
    for (size_t i = 0; i < planted.size(); ++i) {
      place("pot " + std::to_string(i + 1), small, planted[i].first);
      plant(*planted[i].second, planted[i].first + dvec3(0, 0.355, 0), 75.0 * double(i));
    }
    place("tub", large, {4.3, 0, -0.1});
    plant(tree_, {4.3, 0.495, -0.1}, 200);
  }

  uint32_t planted_ = 0;
  const Index panes_ = paint("whitewashed panes", {0.71, 0.73, 0.7}), paint_ = paint("frame", {0.3, 0.42, 0.36});
  const Index brick_ = paint("brick", {0.47, 0.22, 0.14}), stone_ = paint("stone", {0.58, 0.55, 0.48});
  const Index soil_ = paint("soil", {0.12, 0.085, 0.06}), iron_ = paint("iron", {0.62, 0.62, 0.58});
  const Index clay_ = paint("clay", {0.55, 0.27, 0.16}), stem_ = paint("stem", {0.24, 0.27, 0.11});
  const PlantDetail leafy_{detail(3, 2), detail(4, 3)};
  const Kind broad_ =
      kind("broad-leaved", broadLeaved(detail(16, 9), 0.85, leafy_), fabric("broad leaf", {0.1, 0.33, 0.07}));
  const Kind red_ = kind("red-leaved", broadLeaved(detail(14, 8), 0.4, leafy_), fabric("red leaf", {0.5, 0.06, 0.1}));
  const Kind fern_ =
      kind("fern", fern(detail(11, 6), detail(11, 5), 0.62, leafy_), fabric("fern leaf", {0.17, 0.42, 0.08}));
  const Kind grass_ = kind("grass", grass(detail(56, 24), 0.55, leafy_), fabric("grass blade", {0.36, 0.5, 0.15}));
  const Kind bamboo_ =
      kind("bamboo", bamboo(detail(8, 5), detail(16, 8), 2.1, leafy_), fabric("bamboo leaf", {0.22, 0.46, 0.12}));
  const Kind tree_ = kind("tree", tree(detail(11, 6), detail(5, 3), detail(8, 5), 1.6, leafy_),
                          fabric("tree leaf", {0.12, 0.36, 0.1}));
};

} // namespace

GeneratedScene writeGarden(const Order& order) { return Garden(order).write(); }

} // namespace lambent::content

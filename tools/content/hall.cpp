// The default scene: a hall of 23.8 × 8 m between two-storey arcades, with galleries behind them. The sun comes through
// the open middle of the roof and lights the north side; the south galleries and the chamber behind the east doorway
// see only light that has bounced. X runs along the hall (east), Z to the south, the floor is y = 0.
#include "tools/content/furniture.h"
#include "tools/content/recipes.h"
#include "tools/content/textures.h"

#include <cmath>

namespace lambent::content {

namespace {

// Plan, metres.
constexpr double kBay = 3.4;
constexpr int kBays = 7;
constexpr double kEnd = 0.5 * kBay * kBays;          // |x| of the end walls' inner faces
constexpr double kArcade = 4.25, kArcadeHalf = 0.25; // |z| of the arcade's middle, half its thickness
constexpr double kGalleryBack = 7.7;                 // |z| of the gallery's back wall
constexpr double kWall = 0.4;                        // outer walls
constexpr double kNave = kArcade - kArcadeHalf;      // |z| of the arcade's face to the nave
constexpr double kOpenBays = 3;                      // without roof, in the middle
// Heights.
constexpr double kLowerSpring = 2.6, kArchHeight = 1.8; // the same arch on both storeys
constexpr double kGalleryFloor = 4.8, kSlab = 0.4;
constexpr double kUpperSpring = kGalleryFloor + 2.0;
constexpr double kEaves = kUpperSpring + kArchHeight, kRoof = 0.4;
constexpr double kRailHeight = 0.95;

double columnX(int i) { return (i - 0.5 * kBays) * kBay; }
double bayX(int i) { return (i + 0.5 - 0.5 * kBays) * kBay; }

class Hall : public SceneBuilder {
 public:
  explicit Hall(const Order& order) : SceneBuilder(order) {
    addShell();
    addArcades();
    addBalustrades();
    addCloth();
    addChamber();
    addFurniture();
    addLightsAndMotion();
    camera("hall", {-10.6, 1.8, 1.6}, {2.0, 3.0, -0.8});
    camera("gallery", {-9.5, 1.7, 6.2}, {2.0, 1.7, 4.2});
    camera("upstairs", {-3.4, 6.6, 3.9}, {4.0, 2.6, -3.6});
    camera("chamber", {kEnd + kWall + 0.7, 1.7, 1.9}, {kEnd + kWall + 3.6, 1.3, -1.0});
  }

 private:
  void addShell() {
    const double outerX = kEnd + kWall, outerZ = kGalleryBack + kWall;
    place("floor", mappedFromAbove(box({-outerX, -0.3, -outerZ}, {outerX, 0, outerZ}), 2.4), floor_);

    const double top = kEaves + kRoof;
    const Index side = mesh("side wall", box({-outerX, 0, 0}, {outerX, top, kWall}), plaster_);
    place("south wall", side, {0, 0, kGalleryBack});
    place("north wall", side, {0, 0, -kGalleryBack - kWall});
    place("east wall",
          crossWallWithOpening({kEnd, 0, -kGalleryBack}, {outerX, top, kGalleryBack}, {-1.3, 0}, {1.3, 3.2}), plaster_);
    place("west wall",
          crossWallWithOpening({-outerX, 0, -kGalleryBack}, {-kEnd, top, kGalleryBack}, {-1.1, 4.6}, {1.1, 7.6}),
          plaster_);

    // The lattice in the west window stands in the middle of the wall.
    Geometry lattice;
    const double x = -kEnd - 0.5 * kWall;
    lattice.addQuad({x, 4.6, 1.1}, {x, 4.6, -1.1}, {x, 7.6, -1.1}, {x, 7.6, 1.1});
    lattice.uvs = {{0, 10}, {22.0 / 3, 10}, {22.0 / 3, 0}, {0, 0}}; // square cells of 0.3 m
    place("window lattice", lattice, lattice_);

    // Gallery floors stand out a little from the arcade, as a cornice.
    const double depth = kGalleryBack - kNave;
    Geometry slab = box({-kEnd, 0, -0.1}, {kEnd, kSlab, depth});
    slab.add(box({-kEnd, 0.12, -0.2}, {kEnd, kSlab - 0.1, -0.1}));
    const Index gallery = mesh("gallery floor", slab, stone_);
    const Index roof = mesh("gallery roof", box({-kEnd, 0, -0.1}, {kEnd, kRoof, depth}), plaster_);
    for (const auto& [name, sign, turn] : kSides) {
      const double z = sign * kNave;
      place(name + " gallery floor", gallery, {0, kGalleryFloor - kSlab, z}, turn);
      place(name + " gallery roof", roof, {0, kEaves, z}, turn);
    }

    // The nave is roofed over its end bays; beams cross the opening.
    const double open = 0.5 * kBay * kOpenBays, inner = kNave - 0.1;
    const Index ends = mesh("nave roof", box({open, 0, -inner}, {kEnd, kRoof, inner}), plaster_);
    place("nave roof east", ends, {0, kEaves, 0});
    place("nave roof west", ends, {0, kEaves, 0}, 180);
    const Index beam = mesh("beam", box({-0.16, 0, -kArcade}, {0.16, 0.36, kArcade}), timber_);
    for (int i = 1; i < kBays; ++i) place("beam " + std::to_string(i), beam, {columnX(i), kEaves - 0.36, 0});
  }

  void addArcades() {
    const Index lower = mesh("lower column", column(kLowerSpring), stone_);
    const Index upper = mesh("upper column", column(kUpperSpring - kGalleryFloor), stone_);
    const Index wall = mesh("arch", arch({.bay = kBay, .height = kArchHeight, .thickness = 2 * kArcadeHalf}), plaster_);
    // Transverse beams carry the gallery floor and the gallery roof.
    const double from = kArcade + kArcadeHalf, to = kGalleryBack;
    const Index joist = mesh("joist", box({-0.13, -0.26, from}, {0.13, 0, to}), timber_);
    for (const auto& [side, sign, turn] : kSides)
      for (int storey = 0; storey < 2; ++storey) {
        const std::string name = side + (storey ? " upper" : " lower");
        const double z = sign * kArcade;
        const double ceiling = storey ? kEaves : kGalleryFloor - kSlab;
        for (int i = 0; i <= kBays; ++i) {
          const std::string number = std::to_string(i);
          place(name + " column " + number, storey ? upper : lower, {columnX(i), storey ? kGalleryFloor : 0.0, z});
          if (i > 0 && i < kBays) place(name + " joist " + number, joist, {columnX(i), ceiling, 0}, turn);
          if (i < kBays)
            place(name + " arch " + number, wall, {bayX(i), storey ? kUpperSpring : kLowerSpring, z},
                  180 - turn); // the moulding faces the nave
        }
      }
  }

  void addBalustrades() {
    constexpr int kPerBay = 6;
    const double half = 0.5 * kBay - 0.31; // between the plinths of two columns
    const Index stub = mesh("baluster", baluster(kRailHeight - 0.1), stone_);
    const Index rail = mesh("rail", box({-half, kRailHeight - 0.1, -0.1}, {half, kRailHeight, 0.1}), stone_);
    for (const Side& side : kSides)
      for (int bay = 0; bay < kBays; ++bay) {
        const std::string name = side.name + " rail " + std::to_string(bay);
        const dvec3 at(bayX(bay), kGalleryFloor, side.sign * kArcade);
        place(name, rail, at);
        for (int i = 0; i < kPerBay; ++i)
          place(name + " baluster " + std::to_string(i), stub,
                at + dvec3((i + 0.5 - 0.5 * kPerBay) * 2 * half / kPerBay, 0, 0));
      }
  }

  void addCloth() {
    // Banners hang from the rails into the nave, curtains in some of the lower arches.
    const Index banner =
        mesh("red banner",
             cloth({.width = 1.5, .drop = 2.9, .folds = 3.5, .foldDepthTop = 0.02, .foldDepthBottom = 0.07}), red_);
    const Index curtain = mesh(
        "red curtain",
        cloth({.width = 1.5, .drop = 2.35, .folds = 5, .foldDepthTop = 0.05, .foldDepthBottom = 0.09, .gather = 0.25}),
        red_);
    const Index rod = mesh("rod", box({-0.5 * kBay + 0.2, -0.025, -0.025}, {0.5 * kBay - 0.2, 0.025, 0.025}), timber_);
    struct Kind {
      std::string color;
      Index banner, curtain;
    };
    const auto dyed = [&](const std::string& color, Index material) {
      return Kind{color, variant(color + " banner", banner, material), variant(color + " curtain", curtain, material)};
    };
    const std::array<Kind, 4> kinds{Kind{"red", banner, curtain}, dyed("blue", blue_), dyed("gold", gold_),
                                    dyed("green", green_)};
    for (const auto& [side, sign, turn] : kSides) {
      const bool south = sign > 0;
      const double inwards = 180 - turn; // the front faces the nave
      for (int bay = 0; bay < kBays; ++bay) {
        const Kind& kind = kinds[size_t(bay + (south ? 2 : 0)) % kinds.size()];
        if (bay % 2 == 1) {
          const double z = kNave - 0.36; // clear of the cornice
          place(side + " banner rod " + std::to_string(bay), rod, {bayX(bay), kGalleryFloor + 0.03, sign * z});
          place(side + " banner " + kind.color + " " + std::to_string(bay), kind.banner,
                {bayX(bay), kGalleryFloor + 0.02, sign * z}, inwards);
        }
        const bool curtained = south ? (bay == 1 || bay == 4) : (bay == 2 || bay == 4 || bay == 6);
        if (curtained) {
          const dvec3 at(bayX(bay), kLowerSpring - 0.16, sign * kArcade);
          place(side + " rod " + std::to_string(bay), rod, at);
          place(side + " curtain " + kind.color + " " + std::to_string(bay), kind.curtain,
                at + dvec3(sign * 0.55, -0.03, 0), inwards);
        }
      }
    }
  }

  /// A room behind the east doorway, and a cross wall that makes a cabinet of the south gallery's last two bays.
  void addChamber() {
    const double x0 = kEnd + kWall, x1 = x0 + 4.6, z = 2.6, height = 3.6, wall = 0.3;
    place("chamber floor", mappedFromAbove(box({x0, -0.3, -z - wall}, {x1 + wall, 0, z + wall}), 2.4), floor_);
    Geometry walls = box({x1, 0, -z}, {x1 + wall, height, z});
    walls.add(box({x0, 0, z}, {x1 + wall, height, z + wall}));
    walls.add(box({x0, 0, -z - wall}, {x1 + wall, height, -z}));
    place("chamber walls", walls, chamber_);
    place("chamber ceiling", box({x0, height, -z - wall}, {x1 + wall, height + wall, z + wall}), plaster_);
    Geometry statue = moved(sphere(0.42, 28), {0, 1.42, 0});
    statue.add(box({-0.35, 0, -0.35}, {0.35, 1.0, 0.35}));
    place("chamber globe", statue, stone_, {x1 - 1.3, 0, -0.9});

    // The cabinet wall is thicker than the joist above it, which it swallows: level faces would fight.
    const double from = kArcade + kArcadeHalf, cross = columnX(5);
    place("cabinet wall",
          crossWallWithOpening({cross - 0.15, 0, from}, {cross + 0.15, kGalleryFloor - kSlab, kGalleryBack}, {5.4, 0},
                               {6.7, 2.5}),
          plaster_);
  }

  void addFurniture() {
    place("basin", basin(), stone_, {kBay, 0, 0.4});
    place("basin water", basinWater(), water_, {kBay, 0, 0.4});
    const Index seat =
        mesh("bench", bench({-0.9, 0.38, -0.22}, {0.9, 0.46, 0.22}, {0.63, 0, -0.2}, {0.75, 0.38, 0.2}), timber_);
    for (const Side& side : kSides)
      for (const int bay : {1, 3, 5})
        place(side.name + " bench " + std::to_string(bay), seat, {bayX(bay), 0, side.sign * (kGalleryBack - 0.4)});
  }

  void addLightsAndMotion() {
    sun({0.34, -0.83, -0.44}, {1, 0.92, 0.80}, 18, 15);

    constexpr double kPeriod = 24; // seconds, there and back
    // The lamp is carried up and down the south gallery at the height of a hand.
    const double reach = columnX(5) - 1.0;
    const Index carried = lamp("lamp", {1, 0.72, 0.42}, 5, {-reach, 1.6, 6.0});
    animate(carried, kPeriod,
            [&](double phase) { return dvec3(-reach * std::cos(phase), 1.6, 6.0 + 0.4 * std::sin(phase)); });

    // The ball rolls along the north side of the nave (it has one colour, so its turning is left out).
    constexpr double kRadius = 0.6, kReach = 8.5, kBallZ = -2.2;
    const Index ball = place("ball", sphere(kRadius, 32), ball_, {-kReach, kRadius, kBallZ});
    animate(ball, kPeriod, [&](double phase) { return dvec3(-kReach * std::cos(phase), kRadius, kBallZ); });
  }

  const Index stone_ = paint("stone", {0.68, 0.63, 0.54}), plaster_ = paint("plaster", {0.72, 0.66, 0.56});
  const Index floor_ = paint("floor", dvec3(1), texture(stoneSlabs("slabs")));
  const Index timber_ = paint("timber", {0.33, 0.21, 0.12});
  const Index red_ = fabric("red cloth", {0.66, 0.06, 0.05}), blue_ = fabric("blue cloth", {0.07, 0.16, 0.58});
  const Index green_ = fabric("green cloth", {0.08, 0.42, 0.13}), gold_ = fabric("gold cloth", {0.76, 0.50, 0.10});
  const Index ball_ = paint("ball", {0.72, 0.10, 0.06});
  const Index lattice_ = material({.name = "lattice",
                                   .albedo = {0.6, 0.5, 0.4},
                                   .texture = texture(lattice("lattice")),
                                   .alphaMask = true,
                                   .doubleSided = true});
  const Index chamber_ = paint("chamber", {0.32, 0.52, 0.62}), water_ = paint("water", {0.16, 0.34, 0.36});
};

} // namespace

GeneratedScene writeHall(const Order& order) { return Hall(order).write(); }

} // namespace lambent::content

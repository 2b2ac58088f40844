// The default scene: a hall of 23.8 × 8 m between two-storey arcades, with galleries behind them. The sun comes through
// the open middle of the roof and lights the north side; the south galleries and the chamber behind the east doorway
// see only light that has bounced. X runs along the hall (east), Z to the south, the floor is y = 0.
#include "tools/content/gltf_writer.h"
#include "tools/content/hall_parts.h"
#include "tools/content/recipes.h"
#include "tools/content/textures.h"

#include <glm/gtc/quaternion.hpp>

#include <array>
#include <cmath>
#include <string>

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

glm::dquat aroundY(double degrees) { return glm::angleAxis(glm::radians(degrees), dvec3(0, 1, 0)); }

struct Materials {
  Index stone, plaster, floor, timber, red, blue, green, gold, ball, lattice, chamber, water;
};

Materials addMaterials(GltfWriter& gltf) {
  const Index slabs = gltf.addTexture(stoneSlabs("slabs"));
  const Index bars = gltf.addTexture(lattice("lattice"));
  const auto cloth = [&](const char* name, const dvec3& albedo) {
    return gltf.addMaterial({.name = name, .albedo = albedo, .doubleSided = true});
  };
  Materials m;
  m.stone = gltf.addMaterial({.name = "stone", .albedo = {0.68, 0.63, 0.54}});
  m.plaster = gltf.addMaterial({.name = "plaster", .albedo = {0.72, 0.66, 0.56}});
  m.floor = gltf.addMaterial({.name = "floor", .albedo = {1, 1, 1}, .texture = slabs});
  m.timber = gltf.addMaterial({.name = "timber", .albedo = {0.33, 0.21, 0.12}});
  m.red = cloth("red cloth", {0.66, 0.06, 0.05});
  m.blue = cloth("blue cloth", {0.07, 0.16, 0.58});
  m.green = cloth("green cloth", {0.08, 0.42, 0.13});
  m.gold = cloth("gold cloth", {0.76, 0.50, 0.10});
  m.ball = gltf.addMaterial({.name = "ball", .albedo = {0.72, 0.10, 0.06}});
  m.lattice = gltf.addMaterial(
      {.name = "lattice", .albedo = {0.6, 0.5, 0.4}, .texture = bars, .alphaMask = true, .doubleSided = true});
  m.chamber = gltf.addMaterial({.name = "chamber", .albedo = {0.32, 0.52, 0.62}});
  m.water = gltf.addMaterial({.name = "water", .albedo = {0.16, 0.34, 0.36}});
  return m;
}

class HallBuilder {
 public:
  HallBuilder() : material_(addMaterials(gltf_)) {}

  GeneratedScene write(const std::filesystem::path& folder) {
    addShell();
    addArcades();
    addBalustrades();
    addCloth();
    addChamber();
    addFurniture();
    addLightsAndMotion();
    addCameras();
    return gltf_.write(folder, "hall");
  }

 private:
  Index place(const std::string& name, const Geometry& geometry, Index material, const dvec3& at = dvec3(0)) {
    return gltf_.addNode({.name = name, .translation = at, .mesh = gltf_.addMesh(name, geometry, material)});
  }

  void addShell() {
    const double outerX = kEnd + kWall, outerZ = kGalleryBack + kWall;
    Geometry floor = box({-outerX, -0.3, -outerZ}, {outerX, 0, outerZ});
    mapFromAbove(floor, 2.4);
    place("floor", floor, material_.floor);

    const double top = kEaves + kRoof;
    const Index side = gltf_.addMesh("side wall", box({-outerX, 0, 0}, {outerX, top, kWall}), material_.plaster);
    gltf_.addNode({.name = "south wall", .translation = {0, 0, kGalleryBack}, .mesh = side});
    gltf_.addNode({.name = "north wall", .translation = {0, 0, -kGalleryBack - kWall}, .mesh = side});
    place("east wall",
          crossWallWithOpening({kEnd, 0, -kGalleryBack}, {outerX, top, kGalleryBack}, {-1.3, 0}, {1.3, 3.2}),
          material_.plaster);
    place("west wall",
          crossWallWithOpening({-outerX, 0, -kGalleryBack}, {-kEnd, top, kGalleryBack}, {-1.1, 4.6}, {1.1, 7.6}),
          material_.plaster);

    // The lattice in the west window stands in the middle of the wall.
    Geometry lattice;
    const double x = -kEnd - 0.5 * kWall;
    lattice.addQuad({x, 4.6, 1.1}, {x, 4.6, -1.1}, {x, 7.6, -1.1}, {x, 7.6, 1.1});
    lattice.uvs = {{0, 10}, {22.0 / 3, 10}, {22.0 / 3, 0}, {0, 0}}; // square cells of 0.3 m
    place("window lattice", lattice, material_.lattice);

    // Gallery floors stand out a little from the arcade, as a cornice.
    const double depth = kGalleryBack - kNave;
    Geometry slab = box({-kEnd, 0, -0.1}, {kEnd, kSlab, depth});
    slab.add(box({-kEnd, 0.12, -0.2}, {kEnd, kSlab - 0.1, -0.1}));
    const Index gallery = gltf_.addMesh("gallery floor", slab, material_.stone);
    const Index roof = gltf_.addMesh("gallery roof", box({-kEnd, 0, -0.1}, {kEnd, kRoof, depth}), material_.plaster);
    for (const bool south : {true, false}) {
      const std::string name = south ? "south" : "north";
      const glm::dquat turn = aroundY(south ? 0 : 180);
      const double z = south ? kNave : -kNave;
      gltf_.addNode({name + " gallery floor", {0, kGalleryFloor - kSlab, z}, turn, gallery});
      gltf_.addNode({name + " gallery roof", {0, kEaves, z}, turn, roof});
    }

    // The nave is roofed over its end bays; beams cross the opening.
    const double open = 0.5 * kBay * kOpenBays, inner = kNave - 0.1;
    const Index ends = gltf_.addMesh("nave roof", box({open, 0, -inner}, {kEnd, kRoof, inner}), material_.plaster);
    gltf_.addNode({.name = "nave roof east", .translation = {0, kEaves, 0}, .mesh = ends});
    gltf_.addNode({"nave roof west", {0, kEaves, 0}, aroundY(180), ends});
    const Index beam = gltf_.addMesh("beam", box({-0.16, 0, -kArcade}, {0.16, 0.36, kArcade}), material_.timber);
    for (int i = 1; i < kBays; ++i)
      gltf_.addNode({.name = "beam " + std::to_string(i), .translation = {columnX(i), kEaves - 0.36, 0}, .mesh = beam});
  }

  void addArcades() {
    const Index lower = gltf_.addMesh("lower column", column(kLowerSpring), material_.stone);
    const Index upper = gltf_.addMesh("upper column", column(kUpperSpring - kGalleryFloor), material_.stone);
    const Index wall = gltf_.addMesh("arch", arch({.bay = kBay, .height = kArchHeight, .thickness = 2 * kArcadeHalf}),
                                     material_.plaster);
    // Transverse beams carry the gallery floor and the gallery roof.
    const double from = kArcade + kArcadeHalf, to = kGalleryBack;
    const Index joist = gltf_.addMesh("joist", box({-0.13, -0.26, from}, {0.13, 0, to}), material_.timber);
    for (const bool south : {true, false})
      for (int storey = 0; storey < 2; ++storey) {
        const std::string name = std::string(south ? "south" : "north") + (storey ? " upper" : " lower");
        const double z = south ? kArcade : -kArcade;
        const glm::dquat turn = aroundY(south ? 180 : 0); // the moulding faces the nave
        const double ceiling = storey ? kEaves : kGalleryFloor - kSlab;
        for (int i = 0; i <= kBays; ++i) {
          const std::string number = std::to_string(i);
          gltf_.addNode({.name = name + " column " + number,
                         .translation = {columnX(i), storey ? kGalleryFloor : 0.0, z},
                         .mesh = storey ? upper : lower});
          if (i > 0 && i < kBays)
            gltf_.addNode({name + " joist " + number, {columnX(i), ceiling, 0}, aroundY(south ? 0 : 180), joist});
          if (i < kBays)
            gltf_.addNode({name + " arch " + number, {bayX(i), storey ? kUpperSpring : kLowerSpring, z}, turn, wall});
        }
      }
  }

  void addBalustrades() {
    constexpr int kPerBay = 6;
    const double half = 0.5 * kBay - 0.31; // between the plinths of two columns
    const Index stub = gltf_.addMesh("baluster", baluster(kRailHeight - 0.1), material_.stone);
    const Index rail =
        gltf_.addMesh("rail", box({-half, kRailHeight - 0.1, -0.1}, {half, kRailHeight, 0.1}), material_.stone);
    for (const bool south : {true, false})
      for (int bay = 0; bay < kBays; ++bay) {
        const std::string name = std::string(south ? "south" : "north") + " rail " + std::to_string(bay);
        const dvec3 at(bayX(bay), kGalleryFloor, south ? kArcade : -kArcade);
        gltf_.addNode({.name = name, .translation = at, .mesh = rail});
        for (int i = 0; i < kPerBay; ++i)
          gltf_.addNode({.name = name + " baluster " + std::to_string(i),
                         .translation = at + dvec3((i + 0.5 - 0.5 * kPerBay) * 2 * half / kPerBay, 0, 0),
                         .mesh = stub});
      }
  }

  void addCloth() {
    // Banners hang from the rails into the nave, curtains in some of the lower arches.
    const Index banner = gltf_.addMesh(
        "red banner", cloth({.width = 1.5, .drop = 2.9, .folds = 3.5, .foldDepthTop = 0.02, .foldDepthBottom = 0.07}),
        material_.red);
    const Index curtain = gltf_.addMesh(
        "red curtain",
        cloth({.width = 1.5, .drop = 2.35, .folds = 5, .foldDepthTop = 0.05, .foldDepthBottom = 0.09, .gather = 0.25}),
        material_.red);
    const Index rod = gltf_.addMesh("rod", box({-0.5 * kBay + 0.2, -0.025, -0.025}, {0.5 * kBay - 0.2, 0.025, 0.025}),
                                    material_.timber);
    struct Kind {
      const char* color;
      Index banner, curtain;
    };
    const auto variant = [&](const char* color, Index material) {
      return Kind{color, gltf_.addMeshVariant(std::string(color) + " banner", banner, material),
                  gltf_.addMeshVariant(std::string(color) + " curtain", curtain, material)};
    };
    const std::array<Kind, 4> kinds{Kind{"red", banner, curtain}, variant("blue", material_.blue),
                                    variant("gold", material_.gold), variant("green", material_.green)};
    for (const bool south : {true, false}) {
      const std::string side = south ? "south" : "north";
      const glm::dquat turn = aroundY(south ? 180 : 0); // the front faces the nave
      for (int bay = 0; bay < kBays; ++bay) {
        const Kind& kind = kinds[size_t(bay + (south ? 2 : 0)) % kinds.size()];
        if (bay % 2 == 1) {
          const double z = kNave - 0.36; // clear of the cornice
          gltf_.addNode({.name = side + " banner rod " + std::to_string(bay),
                         .translation = {bayX(bay), kGalleryFloor + 0.03, south ? z : -z},
                         .mesh = rod});
          gltf_.addNode({side + " banner " + kind.color + " " + std::to_string(bay),
                         {bayX(bay), kGalleryFloor + 0.02, south ? z : -z},
                         turn,
                         kind.banner});
        }
        const bool curtained = south ? (bay == 1 || bay == 4) : (bay == 2 || bay == 4 || bay == 6);
        if (curtained) {
          const dvec3 at(bayX(bay), kLowerSpring - 0.16, south ? kArcade : -kArcade);
          gltf_.addNode({.name = side + " rod " + std::to_string(bay), .translation = at, .mesh = rod});
          gltf_.addNode({side + " curtain " + kind.color + " " + std::to_string(bay),
                         at + dvec3(south ? 0.55 : -0.55, -0.03, 0), turn, kind.curtain});
        }
      }
    }
  }

  /// A room behind the east doorway, and a cross wall that makes a cabinet of the south gallery's last two bays.
  void addChamber() {
    const double x0 = kEnd + kWall, x1 = x0 + 4.6, z = 2.6, height = 3.6, wall = 0.3;
    Geometry floor = box({x0, -0.3, -z - wall}, {x1 + wall, 0, z + wall});
    mapFromAbove(floor, 2.4);
    place("chamber floor", floor, material_.floor);
    Geometry walls = box({x1, 0, -z}, {x1 + wall, height, z});
    walls.add(box({x0, 0, z}, {x1 + wall, height, z + wall}));
    walls.add(box({x0, 0, -z - wall}, {x1 + wall, height, -z}));
    place("chamber walls", walls, material_.chamber);
    place("chamber ceiling", box({x0, height, -z - wall}, {x1 + wall, height + wall, z + wall}), material_.plaster);
    Geometry statue = sphere(0.42, 28);
    for (dvec3& p : statue.positions) p.y += 1.42;
    statue.add(box({-0.35, 0, -0.35}, {0.35, 1.0, 0.35}));
    place("chamber globe", statue, material_.stone, {x1 - 1.3, 0, -0.9});

    // The cabinet wall is thicker than the joist above it, which it swallows: level faces would fight.
    const double from = kArcade + kArcadeHalf, cross = columnX(5);
    place("cabinet wall",
          crossWallWithOpening({cross - 0.15, 0, from}, {cross + 0.15, kGalleryFloor - kSlab, kGalleryBack}, {5.4, 0},
                               {6.7, 2.5}),
          material_.plaster);
  }

  void addFurniture() {
    place("basin", basin(), material_.stone, {kBay, 0, 0.4});
    place("basin water", lathe({{{0, 0.5}, {0.95, 0.5}}, {{0.95, 0.5}, {0.95, 0.56}}, {{0.95, 0.56}, {0, 0.56}}}, 32),
          material_.water, {kBay, 0, 0.4});
    Geometry bench = box({-0.9, 0.38, -0.22}, {0.9, 0.46, 0.22});
    for (const double x : {-0.75, 0.63}) bench.add(box({x, 0, -0.2}, {x + 0.12, 0.38, 0.2}));
    const Index mesh = gltf_.addMesh("bench", bench, material_.timber);
    for (const bool south : {true, false})
      for (const int bay : {1, 3, 5}) {
        const double z = kGalleryBack - 0.4;
        gltf_.addNode({.name = std::string(south ? "south" : "north") + " bench " + std::to_string(bay),
                       .translation = {bayX(bay), 0, south ? z : -z},
                       .mesh = mesh});
      }
  }

  void addLightsAndMotion() {
    const Index sun = gltf_.addDirectionalLight("sun", {1, 0.92, 0.80}, 18);
    gltf_.addNode({.name = "sun", .translation = {0, 15, 0}, .rotation = facing({0.34, -0.83, -0.44}), .light = sun});

    constexpr double kPeriod = 24; // seconds, there and back
    constexpr int kKeys = 24;      // per period; linear between keys

    // The lamp is carried up and down the south gallery at the height of a hand.
    const Index lamp = gltf_.addPointLight("lamp", {1, 0.72, 0.42}, 5);
    const double away = 6.0, height = 1.6, reach = columnX(5) - 1.0;
    const Index lampNode = gltf_.addNode({.name = "lamp", .translation = {-reach, height, away}, .light = lamp});
    std::vector<double> times;
    std::vector<dvec3> places;
    for (int i = 0; i <= kKeys; ++i) {
      const double phase = 2 * glm::pi<double>() * i / kKeys;
      times.push_back(kPeriod * i / kKeys);
      places.emplace_back(-reach * std::cos(phase), height, away + 0.4 * std::sin(phase));
    }
    gltf_.animateTranslation(lampNode, times, places);

    // The ball rolls along the north side of the nave (it has one colour, so its turning is left out).
    constexpr double kRadius = 0.6, kReach = 8.5, kBallZ = -2.2;
    const Index ball = place("ball", sphere(kRadius, 32), material_.ball, {-kReach, kRadius, kBallZ});
    places.clear();
    for (int i = 0; i <= kKeys; ++i)
      places.emplace_back(-kReach * std::cos(2 * glm::pi<double>() * i / kKeys), kRadius, kBallZ);
    gltf_.animateTranslation(ball, times, places);
  }

  void addCameras() {
    const auto camera = [&](const char* name, double fovDegrees, const dvec3& eye, const dvec3& target) {
      gltf_.addNode({.name = name,
                     .translation = eye,
                     .rotation = facing(target - eye),
                     .camera = gltf_.addPerspectiveCamera(name, fovDegrees)});
    };
    camera("hall", 60, {-10.6, 1.8, 1.6}, {2.0, 3.0, -0.8});
    camera("gallery", 60, {-9.5, 1.7, 6.2}, {2.0, 1.7, 4.2});
    camera("upstairs", 60, {-3.4, 6.6, 3.9}, {4.0, 2.6, -3.6});
    camera("chamber", 60, {kEnd + kWall + 0.7, 1.7, 1.9}, {kEnd + kWall + 3.6, 1.3, -1.0});
  }

  GltfWriter gltf_;
  Materials material_;
};

} // namespace

GeneratedScene writeHall(const std::filesystem::path& folder) { return HallBuilder().write(folder); }

} // namespace lambent::content

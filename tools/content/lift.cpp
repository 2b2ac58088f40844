// A hall of three storeys without a lamp of its own. Three lit rooms, one above the other, open into it from the west,
// and node "cabin" of the lift rises before them: it takes the light of one storey after the other and throws it back
// into the room. The hall's middle is x = z = 0, Z is south, the floor is y = 0.
#include "tools/content/furniture.h"
#include "tools/content/recipes.h"

namespace lambent::content {

namespace {

constexpr double kHalf = 2.5, kStorey = 3.0, kWall = 0.3; // inside, metres
constexpr int kStoreys = 3;
constexpr double kRoomDepth = 2.8, kRoomHalf = 1.6, kSlab = 0.2;
constexpr double kDoorHalf = 0.75, kSill = 0.1, kDoorHeight = 2.2;
constexpr double kSunk = 0.05; // walls reach that far into floor, ceiling and each other
// The cabin: open towards the rooms, its floor at the node's height.
constexpr double kCabin = 1.7, kCabinHeight = 2.4, kCabinWall = 0.1, kCabinGap = 0.15;

Geometry cabin() {
  const double h = 0.5 * kCabin, t = kCabinWall, top = kCabinHeight;
  Geometry g = box({-h, -t, -h}, {h, 0, h});
  g.add(box({-h, top, -h}, {h, top + t, h}));
  g.add(box({h - t, 0, -h}, {h, top, h}));
  for (const double side : {-h, h - t}) g.add(box({-h, 0, side}, {h - t, top, side + t}));
  return g;
}

} // namespace

GeneratedScene writeLift(const Order& order) {
  SceneBuilder s(order);
  const Index white = s.paint("white paint", {0.74, 0.73, 0.7}), stone = s.paint("stone", {0.52, 0.49, 0.45});
  const Index steel = s.paint("lacquer", {0.26, 0.5, 0.5}), pale = s.paint("pale paint", {0.78, 0.77, 0.74});
  const Index wood = s.paint("wood", {0.46, 0.3, 0.17});

  const double h = kHalf, w = kWall, top = kStorey * kStoreys, lo = -kSunk, hi = top + kSunk;
  const double face = -h - w, back = face - kRoomDepth; // x of the rooms' two ends
  s.place("ground", box({back - w - 0.1, -0.3, -h - w - 0.1}, {h + w + 0.1, 0, h + w + 0.1}), stone);
  s.place("roof", box({back - w - 0.2, top, -h - w - 0.2}, {h + w + 0.2, top + 0.3, h + w + 0.2}), pale);
  Geometry walls = box({h, lo, -h - kSunk}, {h + w, hi, h + kSunk});
  walls.add(box({-h - kSunk, lo, h}, {h + kSunk, hi, h + w}));
  walls.add(box({-h - kSunk, lo, -h - w}, {h + kSunk, hi, -h}));
  walls.add(box({back - w, lo, -kRoomHalf - kSunk}, {back, hi, kRoomHalf + kSunk}));
  walls.add(box({back - kSunk, lo, kRoomHalf}, {face + kSunk, hi, kRoomHalf + w}));
  walls.add(box({back - kSunk, lo, -kRoomHalf - w}, {face + kSunk, hi, -kRoomHalf}));
  for (int i = 0; i < kStoreys; ++i) {
    const double y = kStorey * i, from = i == 0 ? lo : y, to = i + 1 == kStoreys ? hi : y + kStorey;
    walls.add(crossWallWithOpening({face, from, -h - kSunk}, {-h, to, h + kSunk}, {-kDoorHalf, y + kSill},
                                   {kDoorHalf, y + kDoorHeight}));
  }
  s.place("walls", walls, white);

  // Glowing panels beside the openings: what passes these directly falls on the hall's north-east.
  constexpr std::array<dvec3, kStoreys> kColors{dvec3(1, 0.72, 0.45), dvec3(1, 0.95, 0.88), dvec3(0.62, 0.8, 1)};
  const Index housing = s.mesh("panel housing", panelHousing(0.6, 0.9), wood);
  const Index desk = s.mesh("table", turned(table(1.2, 0.6, false), 90), wood);
  const Index slab =
      s.mesh("slab", box({back - kSunk, -kSlab, -kRoomHalf - kSunk}, {face + kSunk, 0, kRoomHalf + kSunk}), stone);
  for (int i = 0; i < kStoreys; ++i) {
    const std::string storey = std::to_string(i + 1);
    const double y = kStorey * i, ceiling = y + kStorey - (i + 1 < kStoreys ? kSlab : 0);
    if (i > 0) s.place("slab " + storey, slab, {0, y, 0});
    const dvec3 hung(face - 0.9, ceiling, 0.95);
    s.place("panel housing " + storey, housing, hung);
    s.place("panel " + storey, panelEmitter(0.6, 0.9), s.glowing("light " + storey, kColors[size_t(i)], 60), hung);
    s.place("table " + storey, desk, {back + 0.45, y, -0.7});
  }

  // Rails of the lift, a plinth with a globe in the hall.
  for (const double side : {-1.0, 1.0})
    s.place(side < 0 ? "north rail" : "south rail", box({-0.05, lo, -0.06}, {0.05, hi, 0.06}), steel,
            {-h + 0.02, 0, side * (0.5 * kCabin + 0.12)});
  Geometry globe = moved(sphere(0.38, 16), {0, 1.2, 0});
  globe.add(box({-0.3, -0.01, -0.3}, {0.3, 0.85, 0.3}));
  s.place("globe", globe, pale, {1.1, 0, -1.3});
  s.place("bench", box({0.2, -0.01, 1.95}, {1.8, 0.45, 2.4}), wood);

  s.place("cabin", cabin(), steel, {-h + kCabinGap + 0.5 * kCabin, kCabinWall + 0.02, 0});
  s.camera("hall", {2.15, 1.6, 2.1}, {-1.1, 3.5, -1.5}, 78);
  s.camera("above", {2.15, 7.6, 2.1}, {-1.1, 4.0, -1.5}, 78);
  return s.write();
}

} // namespace lambent::content

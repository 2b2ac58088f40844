// Two rooms that share a wall with a doorway. The northern one has the only lamp, beside the doorway, so that its light
// reaches the southern one on a small part of the floor and on the door leaf; the rest of that room has light that has
// bounced. Node "door leaf" turns around its hinge: rotation 0 is shut, 90 degrees stands out into the dark room. The
// doorway's middle is the origin, on the dark room's side of the wall; Z is south, the floor is y = 0.
#include "tools/content/furniture.h"
#include "tools/content/recipes.h"

namespace lambent::content {

namespace {

constexpr double kHalfWidth = 2.4, kDark = 4.6, kBright = 4.2, kHeight = 2.6; // of the rooms inside, metres
constexpr double kDivider = 0.2, kOuterWall = 0.3;
constexpr double kSunk = 0.05; // walls reach that far into floor, ceiling and each other
constexpr double kDoorHalf = 0.45, kDoorHeight = 2.1;
// The leaf covers the doorway like a lid, sunk 4 mm into the wall and the floor, so that no light passes it when it is
// shut.
constexpr double kOverlap = 0.08, kSeal = 0.004, kLeaf = 0.06;
constexpr uint32_t kDetail = 12; // segments of round things

} // namespace

GeneratedScene writeDoor(const Order& order) {
  SceneBuilder s(order);
  const Index white = s.paint("white paint", {0.74, 0.72, 0.68}), ochre = s.paint("ochre paint", {0.68, 0.46, 0.16});
  const Index boards = s.paint("boards", {0.44, 0.31, 0.2}), wood = s.paint("wood", {0.5, 0.33, 0.18});
  const Index blue = s.paint("blue cloth", {0.2, 0.27, 0.5}), pale = s.paint("pale paint", {0.78, 0.76, 0.7});

  const double x = kHalfWidth, w = kOuterWall, north = -kDivider - kBright, south = kDark;
  const double lo = -kSunk, hi = kHeight + kSunk;
  s.place("floor", box({-x - w - 0.1, -0.3, north - w - 0.1}, {x + w + 0.1, 0, south + w + 0.1}), boards);
  s.place("ceiling", box({-x - w - 0.2, kHeight, north - w - 0.2}, {x + w + 0.2, kHeight + 0.3, south + w + 0.2}),
          pale);
  Geometry walls = box({-x - w, lo, north - kSunk}, {-x, hi, south + kSunk});
  walls.add(box({x, lo, north - kSunk}, {x + w, hi, south + kSunk}));
  walls.add(box({-x - kSunk, lo, south}, {x + kSunk, hi, south + w}));
  s.place("walls", walls, white);
  s.place("north wall", box({-x - kSunk, lo, north - w}, {x + kSunk, hi, north}), ochre);
  s.place("door wall",
          wallWithOpening({-x - kSunk, lo, -kDivider}, {x + kSunk, hi, 0}, {-kDoorHalf, lo}, {kDoorHalf, kDoorHeight}),
          white);

  Geometry leaf = box({-2 * (kDoorHalf + kOverlap), -kSeal, 0}, {0, kDoorHeight + kOverlap, kLeaf});
  leaf.add(box({-1.0, 1.0, kLeaf - 0.01}, {-0.88, 1.03, kLeaf + 0.04})); // handle
  s.place("door leaf", leaf, wood, {kDoorHalf + kOverlap, 0, -kSeal});

  // The dark room: a shelf beside the door, a table with a chair at the east wall, a chest in the south-east corner.
  s.place("shelf", moved(shelf(1.0, 1.9, 0.32, 5), {-1.75, 0, 0.17}), wood);
  s.place("books", moved(books(1.0, 1.9, 0.32, 5, 1, 0.12), {-1.75, 0, 0.17}), blue);
  s.place("table", turned(table(1.3, 0.7, false), 90), wood, {2.0, 0, 2.4});
  s.place("chair", turned(chair(kDetail), 260), blue, {1.35, 0, 2.5});
  s.place("chest", box({1.5, -0.01, 3.9}, {2.3, 0.6, 4.5}), ochre);
  // The bright room.
  s.place("sofa", box({-1.2, -0.01, north + 0.1}, {1.0, 0.42, north + 0.95}), blue);
  const Index glow = s.glowing("panel light", {1, 0.86, 0.66}, 60);
  s.place("panel housing", panelHousing(0.9, 0.6), wood, {-1.2, kHeight, -1.5});
  s.place("panel", panelEmitter(0.9, 0.6), glow, {-1.2, kHeight, -1.5});

  s.camera("dark room", {-1.95, 1.6, 4.2}, {0.75, 1.15, 0.5}, 65);
  s.camera("bright room", {1.9, 1.6, -3.9}, {-0.4, 1.2, 0}, 65);
  return s.write();
}

} // namespace lambent::content

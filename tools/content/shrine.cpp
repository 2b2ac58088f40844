// A sunlit court, a dark passage around a corner, and an altar in the room at its end, which no sunlight reaches: the
// walls on the way swallow it. Two white boards carry it there, one in the sun before the open door and one at the
// corner; the walkthrough gives them, and measures the globe that its node's name makes a goal. Node "door leaf" is as
// in the scene "door": rotation 0 is shut. The doorway's middle is the origin, on the court's side; Z is south, the
// floor is y = 0.
#include "tools/content/furniture.h"
#include "tools/content/recipes.h"

namespace lambent::content {

namespace {

constexpr double kHeight = 2.8, kWall = 0.3, kDivider = 0.2; // metres
constexpr double kSunk = 0.05;                               // walls reach that far into floor, ceiling and each other
constexpr double kCourtHalf = 1.6, kCourtSouth = 5.6;
constexpr double kPassageHalf = 0.9, kPassageNorth = -2.6, kDeadEnd = -2.2; // the passage goes on to the west
constexpr double kRoomWest = 1.1, kRoomEast = 3.3, kRoomNorth = -3.0, kRoomSouth = -0.6;
constexpr double kAltarX = 2.8, kAltarZ = -1.8; // the middle of its front
constexpr double kDoorHalf = 0.6, kDoorHeight = 2.1;
// The leaf is a lid, sunk 4 mm into wall and floor: no light passes it when it is shut.
constexpr double kOverlap = 0.06, kSeal = 0.004, kLeaf = 0.06;

} // namespace

GeneratedScene writeShrine(const Order& order) {
  SceneBuilder s(order);
  const Index slate = s.paint("slate", {0.06, 0.06, 0.065}), basalt = s.paint("basalt", {0.08, 0.075, 0.07});
  const Index plaster = s.paint("plaster", {0.6, 0.52, 0.42}), stone = s.paint("stone", {0.5, 0.46, 0.4});
  const Index wood = s.paint("wood", {0.16, 0.1, 0.06});

  const double lo = -kSunk, hi = kHeight + kSunk, w = kWall, top = kHeight + 0.2;
  s.place("floor", box({-2.8, -0.3, kRoomNorth - w - 0.1}, {kRoomEast + w + 0.1, 0, kCourtSouth + w + 0.1}), slate);

  // The court: its roof is open over a strip beside the door.
  Geometry roof = box({-kCourtHalf - w - 0.1, kHeight, 1.7}, {kCourtHalf + w + 0.1, top, kCourtSouth + w + 0.1});
  roof.add(box({-kCourtHalf - w - 0.1, kHeight, -0.1}, {kCourtHalf + w + 0.1, top, 0.2}));
  for (const double side : {-1.0, 1.0})
    roof.add(box({side * 0.8, kHeight, 0.2}, {side * (kCourtHalf + w + 0.1), top, 1.7}));
  s.place("court roof", roof, basalt);
  Geometry court = box({-kCourtHalf - w, lo, -kSunk}, {-kCourtHalf, hi, kCourtSouth + kSunk});
  court.add(box({kCourtHalf, lo, -kSunk}, {kCourtHalf + w, hi, kCourtSouth + kSunk}));
  court.add(box({-kCourtHalf - kSunk, lo, kCourtSouth}, {kCourtHalf + kSunk, hi, kCourtSouth + w}));
  court.add(wallWithOpening({-2.6, lo, -kDivider}, {kRoomEast + w, hi, 0}, {-kDoorHalf, lo}, {kDoorHalf, kDoorHeight}));
  s.place("court walls", court, basalt);

  Geometry leaf = box({-2 * (kDoorHalf + kOverlap), -kSeal, 0}, {0, kDoorHeight + kOverlap, kLeaf});
  leaf.add(box({-1.24, 1.0, kLeaf - 0.01}, {-1.12, 1.03, kLeaf + 0.04})); // handle
  s.place("door leaf", leaf, wood, {kDoorHalf + kOverlap, 0, -kSeal});

  // The passage north of the door: a dead end to the west, the altar's room to the east.
  s.place("ceiling", box({-2.7, kHeight, kRoomNorth - w - 0.2}, {kRoomEast + w + 0.2, top, -kDivider + 0.02}), slate);
  Geometry passage = box({kDeadEnd - w, lo, kPassageNorth - w}, {kRoomWest - 0.02, hi, kPassageNorth});
  passage.add(box({kDeadEnd - w, lo, kPassageNorth - kSunk}, {kDeadEnd, hi, -kDivider + kSunk}));
  passage.add(box({kDeadEnd - kSunk, lo, -1.4}, {-kPassageHalf, hi, -kDivider + kSunk}));
  passage.add(crossWallWithOpening({kPassageHalf, lo, kPassageNorth - kSunk}, {kRoomWest - 0.02, hi, -kDivider + kSunk},
                                   {-2.45, lo}, {-1.15, 2.2}));
  s.place("passage walls", passage, basalt);

  Geometry room = crossWallWithOpening({kRoomWest - 0.1, lo, kRoomNorth - kSunk}, {kRoomWest, hi, kRoomSouth + kSunk},
                                       {-2.4, lo}, {-1.2, 2.15});
  room.add(box({kRoomEast, lo, kRoomNorth - kSunk}, {kRoomEast + w, hi, kRoomSouth + kSunk}));
  room.add(box({kRoomWest - 0.1, lo, kRoomNorth - w}, {kRoomEast + kSunk, hi, kRoomNorth}));
  room.add(box({kRoomWest - 0.1, lo, kRoomSouth}, {kRoomEast + kSunk, hi, kRoomSouth + w}));
  s.place("room walls", room, plaster);
  Geometry altar = box({0, -0.01, -0.55}, {0.4, 0.62, 0.55});
  altar.add(box({0.06, 0.6, -0.42}, {0.3, 1.5, 0.42}));
  s.place("altar stone", altar, stone, {kAltarX - 0.06, 0, kAltarZ});
  Geometry tablet;
  tablet.addQuad({0, 0.7, -0.32}, {0, 0.7, 0.32}, {0, 1.4, 0.32}, {0, 1.4, -0.32}); // its front is west
  s.place("altar, goal 0.01", tablet, s.fabric("gold", {0.78, 0.62, 0.3}), {kAltarX - 0.01, 0, kAltarZ});

  s.sun({0, -0.88, 0.47}, {1, 0.93, 0.82}, 40);
  s.camera("court", {0, 1.6, 5.2}, {0, 1.0, 0}, 65);
  s.camera("altar", {1.4, 1.6, -1.2}, {kAltarX, 1.0, kAltarZ}, 65);
  return s.write();
}

} // namespace lambent::content

// The Cornell box, with the measurements that Cornell University publishes (millimetres, x to the left of the camera,
// z away from it), at five times the size: a room of 2.76 × 2.74 × 2.80 m. Walls are 0.2 m thick. `cornell` is lit by
// the published emitter, `cornell-spot` by a spot below the ceiling's middle.
#include "tools/content/recipes.h"

namespace lambent::content {

namespace {

constexpr double kScale = 1.0 / 200.0; // metres per published millimetre
constexpr double kWidth = 552.8, kHeight = 548.8, kDepth = 559.2;
constexpr double kWall = 0.2; // metres

/// Published coordinates to ours: half a turn around the vertical axis, centred, so that the camera looks along -Z.
dvec3 placed(double x, double y, double z) {
  return {(0.5 * kWidth - x) * kScale, y * kScale, (0.5 * kDepth - z) * kScale};
}

/// Upright block over four corners (published x and z), counter-clockwise from above.
Geometry block(const std::array<dvec2, 4>& corners, double height) {
  std::array<dvec3, 4> low, high;
  for (size_t i = 0; i < 4; ++i) {
    low[i] = placed(corners[i].x, 0, corners[i].y);
    high[i] = placed(corners[i].x, height, corners[i].y);
  }
  return hexahedron(low, high);
}

/// The room and its two blocks; what lights them is left to the caller.
void addRoom(SceneBuilder& s) {
  const Index white = s.paint("white", {0.73, 0.73, 0.73});
  const Index red = s.paint("red", {0.63, 0.065, 0.05}), green = s.paint("green", {0.14, 0.45, 0.091});
  const dvec3 lo = placed(kWidth, 0, kDepth), hi = placed(0, kHeight, 0); // inside of the room
  s.place("floor", box({lo.x - kWall, lo.y - kWall, lo.z - kWall}, {hi.x + kWall, lo.y, hi.z}), white);
  s.place("ceiling", box({lo.x - kWall, hi.y, lo.z - kWall}, {hi.x + kWall, hi.y + kWall, hi.z}), white);
  s.place("back wall", box({lo.x - kWall, lo.y, lo.z - kWall}, {hi.x + kWall, hi.y, lo.z}), white);
  s.place("left wall", box({lo.x - kWall, lo.y, lo.z}, {lo.x, hi.y, hi.z}), red);
  s.place("right wall", box({hi.x, lo.y, lo.z}, {hi.x + kWall, hi.y, hi.z}), green);
  s.place("short block", block({dvec2(130, 65), dvec2(82, 225), dvec2(240, 272), dvec2(290, 114)}, 165), white);
  s.place("tall block", block({dvec2(423, 247), dvec2(265, 296), dvec2(314, 456), dvec2(472, 406)}, 330), white);
}

/// With its camera.
GeneratedScene finished(SceneBuilder& s) {
  const dvec3 eye = placed(278, 273, -800);
  s.camera("front", eye, eye - dvec3(0, 0, 1), 39.3);
  return s.write();
}

} // namespace

GeneratedScene writeCornell(const Order& order) {
  SceneBuilder s(order);
  addRoom(s);
  // Hangs 5 mm below the ceiling; it lights the side that it faces, so the gap stays dark.
  Geometry emitter;
  const double below = kHeight - 1.0;
  emitter.addQuad(placed(343, below, 227), placed(343, below, 332), placed(213, below, 332), placed(213, below, 227));
  s.place("emitter", emitter, s.glowing("emitter", {1, 0.706, 0.235}, 17, 0.78));
  return finished(s);
}

GeneratedScene writeCornellSpot(const Order& order) {
  SceneBuilder s(order);
  addRoom(s);
  // Tilted to the red wall: that wall, the floor and both blocks are lit, ceiling and green wall by reflected light
  // alone.
  s.spot("spot", {1, 0.93, 0.8}, 22, {0, 0.97 * kHeight * kScale, 0.35}, {-0.45, -1, -0.3});
  return finished(s);
}

} // namespace lambent::content

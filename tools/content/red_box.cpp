// A white corridor of 12 m with two glowing panels. Node "red box" is to be carried along it, from the unlit west end
// under the first panel and on. X runs along the corridor from the west end, Z to the south from its middle, the floor
// is y = 0.
#include "tools/content/furniture.h"
#include "tools/content/recipes.h"

namespace lambent::content {

namespace {

constexpr double kLength = 12, kHalfWidth = 1.3, kHeight = 2.6, kWall = 0.3; // inside, metres
constexpr double kSunk = 0.05;                                               // walls reach that far into their like
constexpr double kBox = 1.0;                                                 // edge
constexpr uint32_t kDetail = 12;                                             // segments of round things

} // namespace

GeneratedScene writeRedBox(const Order& order) {
  SceneBuilder s(order);
  const Index white = s.paint("white paint", {0.76, 0.76, 0.75}), ceiling = s.paint("ceiling", {0.79, 0.79, 0.78});
  const Index floor = s.paint("floor", {0.56, 0.55, 0.53}), red = s.paint("red", {0.72, 0.03, 0.02});
  const Index wood = s.paint("wood", {0.48, 0.32, 0.18}), clay = s.paint("clay", {0.5, 0.4, 0.34});
  const Index leaf = s.fabric("leaf", {0.14, 0.36, 0.1});

  const double z = kHalfWidth, w = kWall, lo = -kSunk, hi = kHeight + kSunk;
  s.place("floor", box({-w - 0.1, -0.3, -z - w - 0.1}, {kLength + w + 0.1, 0, z + w + 0.1}), floor);
  s.place("ceiling", box({-w - 0.2, kHeight, -z - w - 0.2}, {kLength + w + 0.2, kHeight + 0.3, z + w + 0.2}), ceiling);
  Geometry walls = box({-kSunk, lo, -z - w}, {kLength + kSunk, hi, -z});
  walls.add(box({-kSunk, lo, z}, {kLength + kSunk, hi, z + w}));
  walls.add(box({-w, lo, -z - kSunk}, {0, hi, z + kSunk}));
  walls.add(box({kLength, lo, -z - kSunk}, {kLength + w, hi, z + kSunk}));
  s.place("walls", walls, white);

  // Wall piers every 3 m, a bench and two plants between them.
  const Index pier = s.mesh("pier", box({-0.15, lo, -0.12}, {0.15, hi, 0.12}), white);
  for (int i = 1; i < 4; ++i)
    for (const double side : {-1.0, 1.0})
      s.place((side < 0 ? "north pier " : "south pier ") + std::to_string(i), pier, {3.0 * i, 0, side * (z - 0.02)});
  s.place("bench", bench({-0.8, 0.4, -0.19}, {0.8, 0.46, 0.19}, {0.6, -0.01, -0.17}, {0.7, 0.41, 0.17}), wood,
          {4.6, 0, z - 0.24});
  const Index pots = s.mesh("pot", pot(0.16, 0.34, kDetail), clay);
  const Index plants = s.mesh("plant", fronds(14, 0.45, 0.4, 3), leaf);
  int number = 0;
  for (const double x : {3.5, 8.4}) {
    const std::string n = std::to_string(++number);
    s.place("pot " + n, pots, {x, 0, z - 0.3});
    s.place("plant " + n, plants, {x, 0, z - 0.3});
  }

  const Index glow = s.glowing("panel light", {1, 0.95, 0.86}, 20);
  const Index housing = s.mesh("panel housing", panelHousing(1.2, 0.5), wood);
  const Index panel = s.mesh("panel", panelEmitter(1.2, 0.5), glow);
  for (const bool east : {false, true}) {
    const std::string end = east ? " east" : " west";
    const dvec3 at(east ? 10.4 : 4.9, kHeight, 0);
    s.place("panel housing" + end, housing, at);
    s.place("panel" + end, panel, at);
  }

  const double half = 0.5 * kBox;
  s.place("red box", box({-half, -half, -half}, {half, half, half}), red, {6, 0.9, -0.5});

  s.camera("along", {0.5, 1.65, 0.75}, {7.5, 1.2, -0.15}, 62);
  return s.write();
}

} // namespace lambent::content

// A carved knot on a plinth in a plain room under one spot: a curved, finely tessellated surface with relief, where
// neighbouring pixels differ in normal more than in depth. The room's middle is x = z = 0, Z is south, the floor y = 0.
#include "tools/content/recipes.h"

#include <algorithm>
#include <cmath>

namespace lambent::content {

namespace {

constexpr double kHalfWidth = 3.2, kHalfDepth = 3.4, kHeight = 3.6, kWall = 0.3; // inside, metres
constexpr double kSunk = 0.05;                                                   // walls reach that far into their like
constexpr double kPlinth = 0.55;                                                 // top of the plinth

// A trefoil: it winds twice around a torus's axis, which is Z here, and three times around its core. Strands that pass
// each other on opposite sides of the core are 2 kCore apart, the tube is at most kTube + 0.06 thick: it never meets
// itself.
constexpr double kRing = 0.5, kCore = 0.24, kTube = 0.15; // metres
constexpr double kTurns = 2, kWindings = 3;

dvec3 knotLine(double t) {
  const double r = kRing + kCore * std::cos(kWindings * t);
  return {r * std::cos(kTurns * t), r * std::sin(kTurns * t), kCore * std::sin(kWindings * t)};
}

/// Thickness of the tube; s goes once along it, a once around it, both in turns. All terms are periodic, so the surface
/// closes without a seam.
double knotRadius(double s, double a, bool fine) {
  const auto wave = [](double turns) { return std::sin(kTau * turns); };
  const double swell = 0.022 * wave(7 * s + 0.1) + 0.01 * wave(16 * s + 0.3);
  // Five carved grooves that twist around the tube, rounded at the bottom and broad between.
  const double lobe = std::abs(wave(2.5 * a + 6 * s + 0.08 * wave(8 * s)));
  const double grooves = 0.04 * (std::sqrt(lobe * lobe + 0.08) - 1.0);
  // Rows of knobs across the grooves.
  const double knobs = 0.013 * wave(3 * a - 29 * s) * wave(2 * a + 23 * s);
  const double grain = fine ? 0.0035 * wave(11 * a + 53 * s) * wave(9 * a - 71 * s) : 0;
  return kTube + swell + grooves + knobs + grain;
}

dvec3 knotPoint(double s, double a, bool fine) {
  const double t = kTau * s, step = 1e-5;
  const dvec3 along = glm::normalize(knotLine(t + step) - knotLine(t - step));
  // The torus's own normal stands square to every curve on it, and comes back to itself after one round.
  const dvec3 ring(kRing * std::cos(kTurns * t), kRing * std::sin(kTurns * t), 0);
  const dvec3 out = (knotLine(t) - ring) / kCore;
  const double angle = kTau * a;
  return knotLine(t) + knotRadius(s, a, fine) * (std::cos(angle) * out + std::sin(angle) * glm::cross(along, out));
}

/// The tube as a closed grid. `fine` adds grain that only a dense grid can show.
Geometry knot(uint32_t rings, uint32_t sides, bool fine) {
  constexpr double kStep = 1e-5; // of the parameters, for the tangents
  Geometry g;
  for (uint32_t i = 0; i < rings; ++i)
    for (uint32_t k = 0; k < sides; ++k) {
      const double s = double(i) / rings, a = double(k) / sides;
      const dvec3 lengthwise = knotPoint(s + kStep, a, fine) - knotPoint(s - kStep, a, fine);
      const dvec3 around = knotPoint(s, a + kStep, fine) - knotPoint(s, a - kStep, fine);
      g.addVertex(knotPoint(s, a, fine), glm::normalize(glm::cross(around, lengthwise)));
    }
  g.addGrid(0, rings, sides, true, true);
  return g;
}

Geometry plinth() {
  const double half = 0.36;
  Geometry g = box({-half - 0.08, -0.02, -half - 0.08}, {half + 0.08, 0.09, half + 0.08});
  g.add(box({-half, 0.08, -half}, {half, kPlinth - 0.07, half}));
  g.add(box({-half - 0.06, kPlinth - 0.08, -half - 0.06}, {half + 0.06, kPlinth, half + 0.06}));
  return g;
}

} // namespace

GeneratedScene writeKnot(const Order& order) {
  SceneBuilder s(order);
  const Index pale = s.paint("pale paint", {0.74, 0.72, 0.67}), ochre = s.paint("ochre paint", {0.68, 0.36, 0.1});
  const Index blue = s.paint("blue paint", {0.13, 0.27, 0.56}), floor = s.paint("floor", {0.4, 0.29, 0.2});
  const Index stone = s.paint("stone", {0.52, 0.5, 0.47}), marble = s.paint("marble", {0.7, 0.67, 0.61});

  const double x = kHalfWidth, z = kHalfDepth, w = kWall, lo = -kSunk, hi = kHeight + kSunk;
  s.place("floor", box({-x - w - 0.1, -0.3, -z - w - 0.1}, {x + w + 0.1, 0, z + w + 0.1}), floor);
  s.place("ceiling", box({-x - w - 0.2, kHeight, -z - w - 0.2}, {x + w + 0.2, kHeight + 0.3, z + w + 0.2}), pale);
  s.place("west wall", box({-x - w, lo, -z - kSunk}, {-x, hi, z + kSunk}), ochre);
  s.place("east wall", box({x, lo, -z - kSunk}, {x + w, hi, z + kSunk}), blue);
  Geometry ends = box({-x - w + 0.02, lo, -z - w}, {x + w - 0.02, hi, -z});
  ends.add(box({-x - w + 0.02, lo, z}, {x + w - 0.02, hi, z + w}));
  s.place("end walls", ends, pale);

  s.place("plinth", plinth(), stone);
  const Geometry carved = s.full() ? knot(1050, 150, true) : knot(280, 40, false);
  double lowest = 0;
  for (const dvec3& p : carved.positions) lowest = std::min(lowest, p.y);
  s.place("knot", carved, marble, {0, kPlinth - 0.015 - lowest, 0});

  s.spot("spot", {1, 0.94, 0.84}, 60, {-2.3, 3.3, 1.4}, {1.05, -1, -0.6});
  s.camera("front", {-0.4, 1.6, 3.0}, {-0.12, 1.25, 0}, 54);
  return s.write();
}

} // namespace lambent::content

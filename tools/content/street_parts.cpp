#include "tools/content/street_parts.h"

#include "engine/core/error.h"

#include <array>
#include <cmath>
#include <string>

namespace lambent::content {

namespace {

constexpr double kHalf = 0.5 * kFrontWidth, kThick = 0.35, kDepth = 7.0;
constexpr double kWindowWidth = 1.2, kWindowSill = 0.85, kWindowHead = 2.55;
constexpr double kShopLo = -4.2, kShopHi = 1.4, kDoorLo = 2.2, kDoorHi = 3.4, kShopHead = 2.9, kShopSill = 0.5;

double storeyFloor(int storey) { return storey == 0 ? 0 : kShopHeight + kUpperHeight * (storey - 1); }
double windowX(int window) { return kFrontWidth / kWindows * (window + 0.5) - kHalf; }

std::vector<Opening> openings(int storey) {
  if (storey == 0) return {{kShopLo, kShopHi, kShopSill, kShopHead}, {kDoorLo, kDoorHi, 0, kShopHead}};
  std::vector<Opening> row;
  for (int i = 0; i < kWindows; ++i)
    row.push_back({windowX(i) - 0.5 * kWindowWidth, windowX(i) + 0.5 * kWindowWidth, kWindowSill, kWindowHead});
  return row;
}

/// Bodies of revolution lie along +Y; this one turns them to lie along Z.
Geometry laidDown(Geometry g) {
  for (auto* vectors : {&g.positions, &g.normals})
    for (dvec3& v : *vectors) v = {v.x, -v.z, v.y};
  return g;
}

/// Solid along Z between z0 and z1 from its outline in (x, y), counter-clockwise seen from +Z.
Geometry profiled(const std::vector<dvec2>& outline, double z0, double z1) {
  Geometry g;
  const size_t corners = outline.size();
  const auto at = [&](size_t i, double z) { return dvec3(outline[i % corners], z); };
  for (size_t i = 0; i < corners; ++i) g.addQuad(at(i, z0), at(i + 1, z0), at(i + 1, z1), at(i, z1));
  for (const bool front : {true, false})
    for (size_t i = 1; i + 1 < corners; ++i) {
      const dvec3 normal(0, 0, front ? 1 : -1);
      const std::array<size_t, 3> fan{0, front ? i : i + 1, front ? i + 1 : i};
      for (const size_t k : fan) g.indices.push_back(g.addVertex(at(k, front ? z1 : z0), normal));
    }
  return g;
}

/// Quad in the plane x = `x` that faces +X or -X.
void addFacing(Geometry& g, double x, bool forward, const dvec2& middle, const dvec2& half) {
  const auto at = [&](double y, double z) { return dvec3(x, middle.x + y * half.x, middle.y + z * half.y); };
  if (forward)
    g.addQuad(at(-1, 1), at(-1, -1), at(1, -1), at(1, 1));
  else
    g.addQuad(at(-1, -1), at(-1, 1), at(1, 1), at(1, -1));
}

/// 5 × 7 dots of each letter, row by row from above.
constexpr std::pair<char, std::string_view> kDots[] = {
    {'A', "01110100011000111111100011000110001"}, {'B', "11110100011000111110100011000111110"},
    {'C', "01110100011000010000100001000101110"}, {'E', "11111100001000011110100001000011111"},
    {'F', "11111100001000011110100001000010000"}, {'H', "10001100011000111111100011000110001"},
    {'I', "01110001000010000100001000010001110"}, {'K', "10001100101010011000101001001010001"},
    {'L', "10000100001000010000100001000011111"}, {'M', "10001110111010110101100011000110001"},
    {'N', "10001110011010110011100011000110001"}, {'O', "01110100011000110001100011000101110"},
    {'R', "11110100011000111110101001001010001"}, {'S', "01111100001000001110000010000111110"},
    {'T', "11111001000010000100001000010000100"},
};

std::string_view dots(char letter) {
  for (const auto& [known, dots] : kDots)
    if (known == letter) return dots;
  throw RunError(std::string("no dots for the letter ") + letter);
}

} // namespace

dvec3 paneAt(int storey, int window) { return {windowX(window), storeyFloor(storey) + kWindowSill, 0.27}; }

Geometry frontMasonry(int storeys) {
  const double top = storeyFloor(storeys), wall = 0.3;
  Geometry g;
  for (int s = 0; s < storeys; ++s) {
    const double y = storeyFloor(s);
    g.add(wallWithOpenings(openings(s), kHalf, kThick, s ? y : -0.05, y, storeyFloor(s + 1)));
  }
  // The upper storeys are solid behind their panes; the shop is a room.
  g.add(box({-kHalf, kShopHeight - 0.3, kThick}, {kHalf, top, kDepth}));
  g.add(box({-kHalf, -0.05, kThick}, {-kHalf + wall, kShopHeight - 0.3, kShopDepth}));
  g.add(box({kHalf - wall, -0.05, kThick}, {kHalf, kShopHeight - 0.3, kShopDepth}));
  g.add(box({-kHalf, -0.05, kShopDepth}, {kHalf, kShopHeight - 0.3, kDepth}));
  return g;
}

Geometry frontStonework(int storeys) {
  Geometry g;
  for (int s = 1; s < storeys; ++s) {
    const double y = storeyFloor(s);
    g.add(box({-kHalf + 0.01, y - 0.12, -0.08}, {kHalf - 0.01, y + 0.06, 0.05}));
    for (const Opening& o : openings(s)) {
      g.add(box({o.lo - 0.1, y + o.sill - 0.1, -0.12}, {o.hi + 0.1, y + o.sill - 0.005, 0.3}));
      g.add(box({o.lo - 0.12, y + o.head + 0.005, -0.05}, {o.hi + 0.12, y + o.head + 0.22, 0.05})); // lintel
    }
  }
  const double top = storeyFloor(storeys);
  g.add(box({-kHalf + 0.01, top - 0.3, -0.12}, {kHalf - 0.01, top - 0.1, 0.1}));
  g.add(box({-kHalf + 0.005, top - 0.12, -0.35}, {kHalf - 0.005, top + 0.08, 0.3}));
  for (int i = 0; i < 20; ++i) // dentils
    g.add(box({-kHalf + 0.15 + 0.5 * i, top - 0.26, -0.28}, {-kHalf + 0.35 + 0.5 * i, top - 0.11, -0.1}));
  return g;
}

Geometry frontWoodwork(int storeys) {
  Geometry g;
  for (int s = 1; s < storeys; ++s)
    for (const Opening& o : openings(s)) {
      const double y = storeyFloor(s), middle = 0.5 * (o.lo + o.hi), z0 = 0.18, z1 = 0.25;
      for (const double x : {o.lo + 0.03, middle, o.hi - 0.03}) // each reaches into the masonry or the next bar
        g.add(box({x - 0.04, y + o.sill - 0.02, z0}, {x + 0.04, y + o.head + 0.02, z1}));
      for (const double bar : {o.sill + 0.03, o.head - 0.5, o.head - 0.03})
        g.add(box({o.lo - 0.02, y + bar - 0.035, z0 + 0.005}, {o.hi + 0.02, y + bar + 0.035, z1 - 0.005}));
    }
  for (const double x : {kShopLo + 0.04, kShopLo + 1.87, kShopHi - 1.87, kShopHi - 0.04})
    g.add(box({x - 0.06, kShopSill - 0.02, 0.1}, {x + 0.06, kShopHead + 0.02, 0.2}));
  g.add(box({kShopLo - 0.02, kShopSill - 0.03, 0.08}, {kShopHi + 0.02, kShopSill + 0.08, 0.22}));
  g.add(box({kShopLo - 0.02, kShopHead - 0.5, 0.11}, {kShopHi + 0.02, kShopHead - 0.42, 0.19}));
  g.add(box({kShopLo - 0.1, kShopHead + 0.05, -0.07}, {kDoorHi + 0.1, kShopHeight - 0.2, 0.02})); // board of the sign
  g.add(box({kDoorHi - 0.1, 0.01, 0.4}, {kDoorHi - 0.04, kShopHead - 0.3, 1.5}));                 // door, open
  return g;
}

Geometry pane() {
  const double x = 0.5 * kWindowWidth, h = kWindowHead - kWindowSill;
  Geometry g;
  g.addQuad({x, 0, 0}, {-x, 0, 0}, {-x, h, 0}, {x, h, 0});
  return g;
}

Geometry shopFittings() {
  Geometry g = box({-3.6, -0.01, 1.9}, {-0.6, 0.95, 2.4}); // counter
  g.add(box({-3.7, 0.94, 1.8}, {-0.5, 1.0, 2.45}));
  for (const double y : {0.3, 1.2, 1.8, 2.4})
    g.add(box({-4.5, y, kShopDepth - 0.35}, {1.6, y + 0.04, kShopDepth + 0.02}));
  for (const double x : {-4.52, -1.5, 1.55})
    g.add(box({x, -0.01, kShopDepth - 0.34}, {x + 0.05, 2.6, kShopDepth + 0.02}));
  g.add(box({-3.9, 0.45, 0.45}, {1.2, 0.5, 1.0})); // in the window
  for (const double x : {-3.7, 0.9}) g.add(box({x, -0.01, 0.55}, {x + 0.1, 0.46, 0.9}));
  return g;
}

Geometry awning(bool odd) {
  constexpr int kStripes = 14;
  const double lo = kShopLo - 0.1, width = (kShopHi - kShopLo + 0.2) / kStripes;
  const dvec3 out(0, -0.55, -1.25), drop(0, -0.22, -0.02);
  Geometry g;
  for (int i = odd; i < kStripes; i += 2) {
    const dvec3 a(lo + width * i, kShopHead + 0.02, -0.02), b = a + dvec3(width, 0, 0);
    g.addQuad(a + out, a, b, b + out);
    g.addQuad(a + out + drop, a + out, b + out, b + out + drop);
  }
  return g;
}

Geometry lettering(std::string_view text) {
  constexpr double kDot = 0.36 / 7;
  constexpr int kAdvance = 6; // dots
  const double width = kDot * (kAdvance * double(text.size()) - 1);
  Geometry g;
  for (size_t letter = 0; letter < text.size(); ++letter)
    for (int row = 0; row < 7; ++row)
      for (int from = 0; from < 5;) {
        int to = from;
        while (to < 5 && dots(text[letter])[size_t(5 * row + to)] == '1') ++to;
        if (to > from) {
          // Seen from the street, along +Z, x runs to the left.
          const double x0 = 0.5 * width - kDot * (double(kAdvance * letter) + from), x1 = x0 - kDot * (to - from);
          const double y1 = kDot * (7 - row), y0 = y1 - kDot;
          g.addQuad({x0, y0, 0}, {x1, y0, 0}, {x1, y1, 0}, {x0, y1, 0});
        }
        from = to + 1;
      }
  return g;
}

Geometry streetLamp(uint32_t segments) {
  Geometry g = lathe({{{0, -0.02}, {0.16, -0.02}},
                      {{0.16, -0.02}, {0.16, 0.12}},
                      {{0.16, 0.12}, {0.11, 0.16}, {0.1, 0.75}, {0.075, 0.9}},
                      {{0.075, 0.9}, {0.06, 1.0}, {0.045, 5.75}},
                      {{0.045, 5.75}, {0, 5.75}}},
                     segments);
  std::vector<dvec3> arm;
  for (int i = 0; i <= 8; ++i) {
    const double t = i / 8.0;
    arm.emplace_back(0, 5.4 + 0.42 * t - 0.1 * t * t, kArm * t);
  }
  g.add(rod(arm, 0.03, segments));
  g.add(box({-0.16, kLensHeight + 0.01, kArm - 0.4}, {0.16, kLensHeight + 0.14, kArm + 0.4}));
  return g;
}

Geometry lampLens() {
  Geometry g;
  const double y = kLensHeight;
  g.addQuad({-0.12, y, kArm - 0.3}, {0.12, y, kArm - 0.3}, {0.12, y, kArm + 0.3}, {-0.12, y, kArm + 0.3});
  return g;
}

Geometry carBody() {
  // Lower part and cabin are convex outlines; the roof lies on the glass.
  Geometry g = profiled({{-2.1, 0.3},
                         {2.05, 0.28},
                         {2.15, 0.42},
                         {2.12, 0.66},
                         {1.95, 0.76},
                         {0.95, 0.9},
                         {-1.3, 0.93},
                         {-2.05, 0.88},
                         {-2.15, 0.62}},
                        -0.86, 0.86);
  g.add(profiled({{-1.05, 1.4}, {0.3, 1.4}, {0.22, 1.46}, {-0.9, 1.46}}, -0.66, 0.66));
  for (const double z : {-0.71, 0.61}) // posts beside the glass
    g.add(profiled({{-0.36, 0.9}, {-0.26, 0.9}, {-0.3, 1.42}, {-0.4, 1.42}}, z, z + 0.1));
  for (const double x : {-2.2, 2.08}) g.add(box({x, 0.33, -0.8}, {x + 0.12, 0.47, 0.8}));   // bumpers
  for (const double z : {-0.95, 0.83}) g.add(box({0.62, 0.93, z}, {0.72, 1.05, z + 0.12})); // mirrors
  return g;
}

Geometry carGlass() { return profiled({{-1.55, 0.88}, {0.95, 0.86}, {0.3, 1.41}, {-1.05, 1.41}}, -0.69, 0.69); }

Geometry carWheels(uint32_t segments) {
  const Geometry wheel = laidDown(lathe({{{0, 0}, {0.2, 0}},
                                         {{0.2, 0}, {0.22, 0.03}},
                                         {{0.22, 0.03}, {0.3, 0.0}},
                                         {{0.3, 0.0}, {0.325, 0.04}, {0.325, 0.16}, {0.3, 0.2}},
                                         {{0.3, 0.2}, {0.22, 0.17}},
                                         {{0.22, 0.17}, {0.2, 0.2}},
                                         {{0.2, 0.2}, {0, 0.2}}},
                                        segments));
  Geometry g;
  for (const double x : {-1.35, 1.3})
    for (const double z : {-0.9, 0.7}) g.add(wheel, {x, 0.325, z});
  return g;
}

Geometry carHeadlights() {
  Geometry g;
  for (const double z : {-kHeadlightZ, kHeadlightZ})
    addFacing(g, kCarHalfLength + 0.005, true, {kHeadlightY - 0.06, z}, {0.06, 0.14});
  return g;
}

Geometry carTailLights() {
  Geometry g;
  for (const double z : {-0.62, 0.62}) addFacing(g, -kCarHalfLength - 0.005, false, {0.68, z}, {0.06, 0.16});
  return g;
}

} // namespace lambent::content

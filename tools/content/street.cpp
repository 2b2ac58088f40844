// A street at night after rain: street lamps, shops that are open, signs in colour, lit windows, cars, a little
// moonlight. Some fifty lights of unlike strength, each of which matters somewhere and hardly any everywhere. X runs
// along the street (east), which is 7 m wide between pavements of 2.6 m; the road is y = 0.
#include "engine/core/error.h"
#include "tools/content/furniture.h"
#include "tools/content/plants.h"
#include "tools/content/recipes.h"
#include "tools/content/textures.h"

#include <string_view>

namespace lambent::content {

namespace {

constexpr double kHalfRoad = 3.5, kHalfStreet = 6.1, kPavement = 0.12;      // metres
constexpr double kFrontWidth = 10.0, kShopHeight = 3.6, kUpperHeight = 3.1; // metres
constexpr int kWindows = 4;                                                 // on every upper storey
constexpr double kShopDepth = 3.2;
constexpr double kArm = 1.4, kLensHeight = 5.6; // of a street lamp
constexpr double kCarHalfLength = 2.15, kHeadlightY = 0.64, kHeadlightZ = 0.58;

// Fronts of houses: x = 0 is the middle of the front, z = 0 its outer face, +Z goes into the house, y = 0 the pavement.

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
  const double left = forward ? 1 : -1;
  g.addQuad(at(-1, left), at(-1, -left), at(1, -left), at(1, left));
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

/// Where a window of an upper storey (from 1) has its pane: the middle of its lower edge.
dvec3 paneAt(int storey, int window) { return {windowX(window), storeyFloor(storey) + kWindowSill, 0.27}; }

/// Front with windows, the mass behind it, and a shop on the ground floor, hollow and open to the street.
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

/// Sills, bands between the storeys and a cornice.
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

/// Window crosses and shop front: posts, transom, door leaf.
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

/// A window's pane on y = 0, centred on x, facing the street.
Geometry pane() {
  const double x = 0.5 * kWindowWidth, h = kWindowHead - kWindowSill;
  Geometry g;
  g.addQuad({x, 0, 0}, {-x, 0, 0}, {-x, h, 0}, {x, h, 0});
  return g;
}

/// Counter and shelves.
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

/// Sloped cloth over a shop window, only every second stripe: `odd` or even ones.
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

/// Letters of `text`, 0.36 m high, centred on x and standing on y = 0, facing -Z: a sheet.
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

/// Street lamp whose pole stands on y = 0 and whose arm reaches `kArm` towards +Z; the lens is a sheet.
Geometry streetLamp(uint32_t segments) {
  Geometry g = lathe({0, -0.02},
                     {{{0.16, -0.02}},
                      {{0.16, 0.12}},
                      {{0.11, 0.16}, {0.1, 0.75}, {0.075, 0.9}},
                      {{0.06, 1.0}, {0.045, 5.75}},
                      {{0, 5.75}}},
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

Geometry lampLens() { return downwardSheet({-0.12, kLensHeight, kArm - 0.3}, {0.12, kLensHeight, kArm + 0.3}); }

/// Saloon car along X, its front at +X, wheels on y = 0; its lights are sheets.
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
  const Geometry wheel = laidDown(lathe({0, 0},
                                        {{{0.2, 0}},
                                         {{0.22, 0.03}},
                                         {{0.3, 0.0}},
                                         {{0.325, 0.04}, {0.325, 0.16}, {0.3, 0.2}},
                                         {{0.22, 0.17}},
                                         {{0.2, 0.2}},
                                         {{0, 0.2}}},
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

class Street : public SceneBuilder {
 public:
  explicit Street(const Order& order) : SceneBuilder(order), houses_(full() ? 6 : 2) {
    addGround();
    for (const auto& [side, sign, turn] : kSides)
      for (int i = 0; i < houses_; ++i)
        addHouse(side + " house " + std::to_string(i), i * 2 + (sign > 0),
                 {kFrontWidth * (i + 0.5), kPavement, sign * kHalfStreet}, turn);
    addHouse("east house", 1, {length() + 4, kPavement, 0}, 90);
    addHouse("west house", 4, {-4, kPavement, 0}, 270);
    addStreetLamps();
    addTrees();
    addCars();
    sun({0.35, -1, 0.28}, {0.6, 0.75, 1}, 0.05, 30, "moon");
    camera("street", {1.2, 1.7, 4.6}, {12, 2.0, -1.2}, 62);
    camera("middle", {0.5, 1.65, -0.4}, {14, 2.1, 0.6}, 60);
    camera("shop", {8.8, 1.75, -2.9}, {4.2, 1.8, -6.8}, 60);
  }

 private:
  double length() const { return kFrontWidth * houses_; }

  Index glowing(const std::string& name, const dvec3& color, double radiance) {
    return SceneBuilder::glowing(name, color, radiance, 0.6);
  }

  void addGround() {
    const double x0 = -6, x1 = length() + 6;
    const Index road = material({.name = "wet asphalt",
                                 .albedo = {1, 1, 1},
                                 .texture = texture(asphalt("asphalt")),
                                 .roughnessMetalnessTexture = texture(asphaltFinish("asphalt-finish"))});
    place("road", mappedFromSides(box({x0 - 8, -0.4, -14}, {x1 + 8, 0, 14}), 3.0), road);
    Geometry base, kerb;
    for (const double side : {-1.0, 1.0}) {
      const auto strip = [&](double a, double b, double lo, double hi) {
        return box({x0 - lo, lo, side * a}, {x1 + lo, hi, side * b});
      };
      base.add(strip(kHalfRoad + 0.1, kHalfStreet + 8, -0.05, kPavement - 0.015));
      kerb.add(strip(kHalfRoad, kHalfRoad + 0.18, -0.07, kPavement + 0.01));
    }
    for (const double x : {x0, length() + 0.9})
      base.add(box({x, -0.05, -kHalfRoad - 0.2}, {x + 5.1, kPavement - 0.03, kHalfRoad + 0.2}));
    place("pavement base", base, concrete_);
    place("kerb", kerb, stone_);
    const double patch = full() ? 2.0 : 5.0, width = 2.4;
    const Index slabs = mesh("slabs", cobbles(patch, width, full() ? 0.2 : 0.8), concrete_);
    for (const Side& side : kSides)
      for (int i = 0; i < int(length() / patch + 0.5); ++i)
        place(side.name + " slabs " + std::to_string(i), slabs,
              {patch * i, kPavement - 0.015, side.sign * (kHalfRoad + 0.18 + 0.5 * width)});
    Geometry marks;
    for (double x = 1; x + 2 < length(); x += 4) marks.add(box({x, -0.01, -0.07}, {x + 2, 0.005, 0.07}));
    for (int i = 0; i < 7; ++i)
      marks.add(box({8.2, -0.01, -3.2 + 0.93 * i}, {10.6, 0.005, -2.75 + 0.93 * i})); // crossing
    place("road marks", marks, paint("road paint", {0.6, 0.6, 0.58}));
  }

  struct Front {
    std::array<Index, 3> masonry; // brick, two plasters
    Index stonework, woodwork;
  };

  const Front& front(int storeys) {
    Front& f = fronts_[size_t(storeys - 3)];
    if (f.woodwork != kAbsent) return f;
    const std::string name = std::to_string(storeys) + " storeys";
    f.masonry[0] = mesh("brick front " + name, mappedFromSides(frontMasonry(storeys), 1.2), brick_);
    f.masonry[1] = variant("pale front " + name, f.masonry[0], pale_);
    f.masonry[2] = variant("green front " + name, f.masonry[0], green_);
    f.stonework = mesh("stonework " + name, frontStonework(storeys), stone_);
    f.woodwork = mesh("woodwork " + name, frontWoodwork(storeys), wood_);
    return f;
  }

  /// A place in the frame of a house that stands at `at`, turned.
  static dvec3 inFrame(const dvec3& at, double turn, const dvec3& p) { return at + turned(p, turn); }

  void addHouse(const std::string& name, int kind, const dvec3& at, double turn) {
    const int storeys = kind % 3 == 1 ? 3 : 4;
    const Front& f = front(storeys);
    place(name, f.masonry[size_t(kind * 2 + kind / 3) % 3], at, turn);
    place(name + " stonework", f.stonework, at, turn);
    place(name + " woodwork", f.woodwork, at, turn);
    for (int s = 1; s < storeys; ++s)
      for (int w = 0; w < kWindows; ++w) {
        const uint32_t id = uint32_t(kind * 64 + s * 8 + w);
        const double chance = hashed(id, 41);
        const Index mesh = chance < 0.18   ? warmPane_
                           : chance < 0.26 ? coldPane_
                           : chance < 0.31 ? rosePane_
                                           : darkPane_;
        place(name + " pane " + std::to_string(s) + std::to_string(w), mesh, inFrame(at, turn, paneAt(s, w)), turn);
      }
    addShop(name, kind, at, turn);
  }

  void addShop(const std::string& name, int kind, const dvec3& at, double turn) {
    static constexpr std::array<const char*, 8> kSigns{"CAFE",    "BOOKS",  "HOTEL",   "BAR",
                                                       "FLORIST", "CINEMA", "TOBACCO", "THEATRE"};
    const auto fit = [&](const std::string& what, Index mesh, const dvec3& p = dvec3(0)) {
      place(name + " " + what, mesh, inFrame(at, turn, p), turn);
    };
    fit("floor", shopFloor_);
    fit("lining", shopLinings_[size_t(kind) % shopLinings_.size()]);
    fit("fittings", fittings_);
    for (size_t k = 0; k < goods_.size(); ++k)
      fit("goods " + std::to_string(k), goods_[k], {-1.45, 0.34, kShopDepth - 0.17});
    const bool open = kind % 4 != 3;
    if (open) {
      fit("ceiling lamp", housing_, {-1.4, kShopHeight - 0.3, 1.6});
      fit("ceiling light", kind % 2 ? warmPanel_ : coldPanel_, {-1.4, kShopHeight - 0.3, 1.6});
    }
    if (kind % 3 != 2) {
      fit("awning", awnings_[0]);
      fit("awning stripes", awnings_[size_t(1 + kind % 2)]);
    }
    const std::string word = kSigns[size_t(kind) % kSigns.size()];
    fit("sign", mesh(name + " sign", lettering(word), signColors_[size_t(kind) % signColors_.size()]),
        {-0.4, kShopHeight - 0.58, -0.09});
    if (kind % 2 == 0) { // a lantern between window and door
      fit("lantern", lantern_, {1.8, 2.75, -0.3});
      lamp(name + " lantern light", {1, 0.62, 0.3}, 1.6, inFrame(at, turn, {1.8, 2.33, -0.3}));
    }
  }

  void addStreetLamps() {
    const Index post = mesh("street lamp", streetLamp(detail(20, 6)), iron_);
    const Index lens = mesh("lamp lens", lampLens(), glowing("lamp lens", {1, 0.7, 0.36}, 40));
    const int lamps = full() ? 12 : 4;
    for (int i = 0; i < lamps; ++i) {
      const Side& side = kSides[size_t(1 - i % 2)];
      const double x = (i + 0.5) * length() / lamps, z = kHalfRoad + 0.45;
      const dvec3 at(x, kPavement, side.sign * z);
      const std::string number = std::to_string(i + 1);
      place("street lamp " + number, post, at, 180 - side.turn);
      place("lamp lens " + number, lens, at, 180 - side.turn);
      spot("lamp " + number, {1, 0.7, 0.36}, 34, at + dvec3(0, kLensHeight - 0.03, -side.sign * kArm), {0, -1, 0}, 35,
           68);
    }
  }

  void addTrees() {
    const Plant grown =
        full() ? tree(14, 7, 14, 4.6, {.rows = 2, .sides = 6}) : tree(7, 4, 5, 4.2, {.rows = 1, .sides = 4});
    const Index trunk = mesh("tree", grown.stems, bark_), leaves = mesh("leaves", grown.leaves, leaf_);
    const int trees = full() ? 8 : 2;
    for (int i = 0; i < trees; ++i) {
      const dvec3 at((i + 0.85) * length() / trees, kPavement - 0.03, kSides[size_t(i % 2)].sign * (kHalfRoad + 0.75));
      place("tree " + std::to_string(i), trunk, at, 77.0 * i);
      place("leaves " + std::to_string(i), leaves, at, 77.0 * i);
      place("tree pit " + std::to_string(i), pit_, at);
    }
  }

  void addCars() {
    const auto lacquer = [&](const std::string& name, const dvec3& albedo, double roughness = 0.35) {
      return material({.name = name, .albedo = albedo, .roughness = roughness});
    };
    const Index body = mesh("car body", carBody(), lacquer("blue lacquer", {0.06, 0.13, 0.32}));
    const Index red = variant("red car body", body, lacquer("red lacquer", {0.45, 0.04, 0.03}));
    const Index pale = variant("pale car body", body, lacquer("pale lacquer", {0.6, 0.6, 0.56}));
    const Index glass = mesh("car glass", carGlass(), lacquer("dark glass", {0.03, 0.035, 0.04}, 0.3));
    const Index wheels = mesh("car wheels", carWheels(detail(36, 10)), paint("rubber", {0.03, 0.03, 0.03}));
    const Index head = mesh("headlights", carHeadlights(), glowing("headlight", {1, 0.95, 0.85}, 90));
    const Index tail = mesh("tail lights", carTailLights(), glowing("tail light", {1, 0.05, 0.02}, 14));
    const auto car = [&](const std::string& name, Index shell, const dvec3& at, double turn, bool lit) {
      place(name, shell, at, turn);
      place(name + " glass", glass, at, turn);
      place(name + " wheels", wheels, at, turn);
      if (!lit) return;
      place(name + " headlights", head, at, turn);
      place(name + " tail lights", tail, at, turn);
      for (const bool left : {true, false}) {
        const dvec3 ahead = turned(dvec3(1, 0, 0), turn);
        const dvec3 lamp = inFrame(at, turn, {kCarHalfLength + 0.08, kHeadlightY, left ? -kHeadlightZ : kHeadlightZ});
        spot(name + (left ? " left beam" : " right beam"), {1, 0.95, 0.85}, 60, lamp, ahead + dvec3(0, -0.07, 0), 8,
             24);
      }
    };
    car("leaving car", red, {full() ? 13.5 : 12.6, 0, 1.75}, 0, true);
    car("parked car", pale, {5.6, 0, -2.5}, 1, false);
    if (!full()) return;
    car("coming car", body, {31, 0, -1.6}, 180, true);
    car("second parked car", body, {24.5, 0, 2.55}, 179, false);
    car("third parked car", pale, {37.5, 0, 2.5}, 180.5, false);
    car("fourth parked car", red, {44, 0, -2.5}, 0.5, false);
  }

  int houses_;
  const Index bricks_ = texture(bricks("bricks")), plaster_ = texture(plaster("plaster"));
  const Index brick_ = paint("brick", dvec3(1), bricks_), pale_ = paint("pale plaster", {0.8, 0.74, 0.62}, plaster_);
  const Index green_ = paint("green plaster", {0.42, 0.55, 0.5}, plaster_);
  const Index boards_ = paint("boards", dvec3(1), texture(planks("planks")));
  const Index concrete_ = paint("concrete", {0.3, 0.3, 0.29}), stone_ = paint("stone", {0.46, 0.43, 0.38});
  const Index wood_ = paint("painted wood", {0.12, 0.16, 0.14}), iron_ = paint("iron", {0.07, 0.08, 0.08});
  const Index bark_ = paint("bark", {0.16, 0.12, 0.09}), leaf_ = fabric("leaf", {0.12, 0.26, 0.07});
  const Index dark_ = paint("dark pane", {0.04, 0.05, 0.06});
  const Index darkPane_ = mesh("dark pane", box({-0.62, -0.01, 0}, {0.62, 1.72, 0.04}), dark_);
  const Index warmPane_ = mesh("warm pane", pane(), glowing("warm window", {1, 0.68, 0.32}, 1.6));
  const Index coldPane_ = variant("cold pane", warmPane_, glowing("cold window", {0.7, 0.85, 1}, 1.2));
  const Index rosePane_ = variant("rose pane", warmPane_, glowing("rose window", {1, 0.4, 0.3}, 1.1));
  const Index shopFloor_ =
      mesh("shop floor", mappedFromSides(box({-4.75, -0.08, 0.3}, {4.75, 0.0, kShopDepth + 0.02}), 1.6), boards_);
  const std::array<Index, 3> shopLinings_ = [this] {
    Geometry lining = box({-4.72, -0.02, kShopDepth - 0.02}, {4.72, kShopHeight - 0.28, kShopDepth + 0.02});
    lining.add(box({-4.72, kShopHeight - 0.32, 0.34}, {4.72, kShopHeight - 0.28, kShopDepth}));
    const Index ochre =
        mesh("ochre lining", mappedFromSides(lining, 2), paint("ochre plaster", {0.9, 0.7, 0.4}, plaster_));
    return std::array{ochre, variant("white lining", ochre, paint("white plaster", dvec3(1), plaster_)),
                      variant("red lining", ochre, paint("red plaster", {0.75, 0.3, 0.22}, plaster_))};
  }();
  const Index fittings_ = mesh("shop fittings", mappedFromSides(shopFittings(), 1.2), boards_);
  const std::array<Index, 3> goods_ = [this] {
    const std::array<dvec3, 3> colors{dvec3(0.55, 0.12, 0.1), dvec3(0.14, 0.28, 0.5), dvec3(0.7, 0.62, 0.4)};
    std::array<Index, 3> meshes;
    for (uint32_t k = 0; k < 3; ++k) {
      const std::string name = "goods " + std::to_string(k);
      meshes[k] = mesh(name, turned(books(5.9, 2.35, 0.3, 3, k, full() ? 0.07 : 0.5), 180), paint(name, colors[k]));
    }
    return meshes;
  }();
  const Index housing_ = mesh("panel housing", panelHousing(2.4, 0.5), iron_);
  const Index warmPanel_ = mesh("warm panel", panelEmitter(2.4, 0.5), glowing("warm panel light", {1, 0.8, 0.52}, 9));
  const Index coldPanel_ = variant("cold panel", warmPanel_, glowing("cold panel light", {0.85, 0.93, 1}, 8));
  const Index lantern_ = mesh("lantern", lampShade(detail(20, 8)), iron_);
  const std::array<Index, 3> awnings_{mesh("awning", awning(false), fabric("pale cloth", {0.7, 0.66, 0.58})),
                                      mesh("red awning", awning(true), fabric("red cloth", {0.5, 0.08, 0.06})),
                                      mesh("green awning", awning(true), fabric("green cloth", {0.08, 0.3, 0.16}))};
  const std::array<Index, 5> signColors_{
      glowing("red sign", {1, 0.1, 0.05}, 4), glowing("cyan sign", {0.06, 0.7, 1}, 2.5),
      glowing("amber sign", {1, 0.5, 0.06}, 3), glowing("pink sign", {1, 0.1, 0.5}, 3.5),
      glowing("green sign", {0.1, 1, 0.25}, 2)};
  const Index pit_ =
      mesh("tree pit", box({-0.45, -0.05, -0.45}, {0.45, 0.055, 0.45}), paint("earth", {0.12, 0.09, 0.06}));
  std::array<Front, 2> fronts_{Front{{}, kAbsent, kAbsent}, Front{{}, kAbsent, kAbsent}};
};

} // namespace

GeneratedScene writeStreet(const Order& order) { return Street(order).write(); }

} // namespace lambent::content

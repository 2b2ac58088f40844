// A gallery with fifty lamps of unlike size, shape and colour: panels in rows below the ceiling, thin tubes along the
// walls, glowing balls on posts, one of which (node "lantern") is to be carried about. Between them stand what throws
// hard shadows: columns, thin poles, a fence, small trees. X runs along the room from its west end, Z to the south from
// its middle, the floor is y = 0.
#include "tools/content/furniture.h"
#include "tools/content/plants.h"
#include "tools/content/recipes.h"

namespace lambent::content {

namespace {

constexpr double kLength = 16, kHalfWidth = 4, kHeight = 3.6, kWall = 0.3; // inside, metres
constexpr double kSunk = 0.05;                                             // walls reach that far into their like
constexpr uint32_t kDetail = 10;                                           // segments of round things

struct Panel {
  double width, depth; // metres
  dvec3 color;
  double radiance;
};
const std::array<Panel, 4> kPanels{{{0.3, 0.3, {1, 0.9, 0.75}, 9},
                                    {0.9, 0.25, {0.8, 0.9, 1}, 5},
                                    {0.6, 0.6, {1, 0.95, 0.9}, 4},
                                    {0.15, 0.15, {1, 0.5, 0.3}, 40}}};

class Lamps : public SceneBuilder {
 public:
  explicit Lamps(const Order& order) : SceneBuilder(order) {
    for (const Panel& p : kPanels) {
      const std::string kind = std::to_string(housings_.size());
      housings_.push_back(mesh("housing " + kind, panelHousing(p.width, p.depth), metal_));
      panels_.push_back(
          mesh("panel " + kind, panelEmitter(p.width, p.depth), glowing("panel light " + kind, p.color, p.radiance)));
    }
    addRoom();
    addObstacles();
    addLamps();
    camera("along", {0.7, 1.7, 2.6}, {8, 1.0, -0.6}, 62);
  }

 private:
  void addRoom() {
    const double z = kHalfWidth, w = kWall, lo = -kSunk, hi = kHeight + kSunk;
    place("floor", box({-w - 0.1, -0.3, -z - w - 0.1}, {kLength + w + 0.1, 0, z + w + 0.1}),
          paint("floor", {0.5, 0.47, 0.43}));
    place("ceiling", box({-w - 0.2, kHeight, -z - w - 0.2}, {kLength + w + 0.2, kHeight + 0.3, z + w + 0.2}),
          paint("ceiling", {0.75, 0.75, 0.74}));
    Geometry walls = box({-kSunk, lo, -z - w}, {kLength + kSunk, hi, -z});
    walls.add(box({-kSunk, lo, z}, {kLength + kSunk, hi, z + w}));
    walls.add(box({-w, lo, -z - kSunk}, {0, hi, z + kSunk}));
    walls.add(box({kLength, lo, -z - kSunk}, {kLength + w, hi, z + kSunk}));
    place("walls", walls, white_);
  }

  void addObstacles() {
    const Index column = mesh("column", box({-0.2, -kSunk, -0.2}, {0.2, kHeight + kSunk, 0.2}), white_);
    const Index pole = mesh("pole", box({-0.015, -0.01, -0.015}, {0.015, 2.2, 0.015}), metal_);
    for (int i = 0; i < 4; ++i) {
      place("column " + std::to_string(i), column, {3.0 + 3.5 * i, 0, i % 2 ? 1.9 : -1.9});
      place("pole " + std::to_string(i), pole, {4.2 + 0.5 * i, 0, -0.6 + 0.3 * i});
    }
    Geometry fence = box({-1.2, 0.95, -0.02}, {1.2, 1.0, 0.02});
    for (int i = 0; i < 25; ++i) fence.add(box({-1.2 + 0.099 * i, -0.01, -0.01}, {-1.176 + 0.099 * i, 0.96, 0.01}));
    place("fence", fence, metal_, {3.6, 0, 2.4});
    const Plant small = tree(5, 3, 6, 1.7, {.rows = 1, .sides = 3});
    const Index trunk = mesh("tree", small.stems, wood_), leaves = mesh("leaves", small.leaves, leaf_);
    for (int i = 0; i < 3; ++i) {
      const dvec3 at(4.8 + 3.4 * i, 0, i % 2 ? -1.5 : 1.7);
      place("tree " + std::to_string(i), trunk, at, 70.0 * i);
      place("leaves " + std::to_string(i), leaves, at, 70.0 * i);
    }
    const Index tables = mesh("table", table(1.4, 0.8, false), wood_);
    place("table east", tables, {9.5, 0, 0.4}, 20);
    place("table west", tables, {6.4, 0, -2.2}, -35);
  }

  void addLamps() {
    for (int row = 0; row < 4; ++row)
      for (int i = 0; i < 8; ++i) { // 32
        const size_t kind = size_t(3 * row + i) % kPanels.size();
        const std::string name = std::to_string(row) + " " + std::to_string(i);
        const dvec3 at(1.2 + 1.95 * i, kHeight, -3 + 2.0 * row);
        place("panel housing " + name, housings_[kind], at);
        place("panel " + name, panels_[kind], at);
      }
    for (int i = 0; i < 10; ++i) // 42
      place("tube " + std::to_string(i), tube_,
            {1.5 + 1.5 * i, 1.1 + 0.18 * (i % 5), (i % 2 ? 1 : -1) * (kHalfWidth - 0.06)});
    for (int i = 0; i < 7; ++i) { // 49
      const dvec3 at(2.6 + 1.9 * i, 0, i % 2 ? 3.1 : -3.2);
      place("post " + std::to_string(i), post_, at);
      place("ball " + std::to_string(i), ball_, at + dvec3(0, 0.72, 0));
    }
    place("lantern", sphere(0.14, kDetail), glowing("lantern", {1, 0.72, 0.4}, 30), {4.5, 1.3, 1.2}); // 50
  }

  Index white_ = paint("white paint", {0.74, 0.74, 0.72}), wood_ = paint("wood", {0.45, 0.3, 0.17});
  Index metal_ = paint("grey paint", {0.35, 0.36, 0.38}), leaf_ = fabric("leaf", {0.14, 0.36, 0.1});
  std::vector<Index> housings_, panels_; // by kind
  Index tube_ = mesh("tube", box({-0.45, -0.02, -0.02}, {0.45, 0.02, 0.02}), glowing("tube", {0.55, 0.75, 1}, 12));
  Index post_ = mesh("post", box({-0.05, -0.01, -0.05}, {0.05, 0.65, 0.05}), metal_);
  Index ball_ = mesh("ball", sphere(0.08, kDetail), glowing("ball", {1, 0.6, 0.3}, 14));
};

} // namespace

GeneratedScene writeLamps(const Order& order) { return Lamps(order).write(); }

} // namespace lambent::content

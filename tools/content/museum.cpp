// Two rooms of a museum with smooth sculptures, vases and columns, at three tessellations: walls, lamps and where
// things stand are the same, only the number of triangles differs. The wall between the rooms is a board of 2 cm with a
// doorway: the hall has a skylight, a spot and a lamp, the cabinet behind the board sees only what comes through the
// doorway. X runs from the hall (east) into the cabinet, Z to the south, the floor is y = 0.
#include "tools/content/forms.h"
#include "tools/content/furniture.h"
#include "tools/content/recipes.h"

#include <cmath>
#include <map>

namespace lambent::content {

namespace {

constexpr double kHall = 9.0, kCabinet = 5.0, kWidth = 7.0, kHeight = 4.2, kWall = 0.3; // inside, metres
constexpr double kBoard = 0.02;                                                         // the wall between
constexpr double kSunk = 0.05; // walls reach that far into floor and ceiling

/// How finely round things are made.
struct Fineness {
  double cell;       // of sculptures, metres; slender ones are made finer
  uint32_t segments; // around columns and vases
  uint32_t steps;    // along them, per metre
};

const std::map<std::string, Fineness> kFineness{
    {"museum-15k", {0.0613, 14, 4}}, {"museum-26k", {0.0478, 20, 6}}, {"museum-97k", {0.0239, 38, 11}}};

/// A smooth curve through `points` (Catmull-Rom), about `steps` pieces per metre.
ProfilePiece smooth(const std::vector<dvec2>& points, uint32_t steps) {
  ProfilePiece piece;
  for (size_t i = 0; i + 1 < points.size(); ++i) {
    const dvec2 a = points[i ? i - 1 : 0], b = points[i], c = points[i + 1],
                d = points[std::min(i + 2, points.size() - 1)];
    const int pieces = std::max(1, int(std::lround(steps * glm::distance(b, c))));
    for (int k = 1; k <= pieces; ++k) {
      const double t = double(k) / pieces;
      piece.push_back(k == pieces ? c
                                  : 0.5 * (2.0 * b + t * (c - a) + t * t * (2.0 * a - 5.0 * b + 4.0 * c - d) +
                                           t * t * t * (3.0 * b - a - 3.0 * c + d)));
    }
  }
  return piece;
}

/// Vessel turned on a wheel, open above, from its foot up; 0.8 m high.
Geometry vase(const Fineness& f) {
  return lathe({0, 0},
               {{{0.11, 0}},
                smooth({{0.11, 0}, {0.13, 0.05}, {0.235, 0.32}, {0.22, 0.5}, {0.1, 0.66}, {0.095, 0.72}, {0.15, 0.8}},
                       3 * f.steps),
                {{0.135, 0.8}},
                smooth({{0.135, 0.8}, {0.08, 0.71}, {0.085, 0.66}, {0.2, 0.5}}, 2 * f.steps),
                smooth({{0.2, 0.5}, {0.21, 0.32}, {0.12, 0.07}, {0, 0.05}}, 2 * f.steps)},
               f.segments);
}

Geometry roundColumn(const Fineness& f) {
  constexpr double kFoot = 0.16, kHead = kHeight - 0.14;
  Geometry g = lathe({0, kFoot},
                     {{{0.3, kFoot}},
                      smooth({{0.3, kFoot}, {0.335, kFoot + 0.06}, {0.3, kFoot + 0.12}}, 6 * f.steps),
                      {{0.26, kFoot + 0.12}},
                      smooth({{0.26, kFoot + 0.12}, {0.235, kFoot + 0.22}, {0.23, 1.6}, {0.2, kHead - 0.3}}, f.steps),
                      {{0.225, kHead - 0.28}},
                      smooth({{0.225, kHead - 0.28}, {0.22, kHead - 0.2}, {0.32, kHead}}, 4 * f.steps),
                      {{0, kHead}}},
                     f.segments);
  g.add(box({-0.36, -kSunk, -0.36}, {0.36, kFoot, 0.36}));
  g.add(box({-0.34, kHead, -0.34}, {0.34, kHeight + kSunk, 0.34}));
  return g;
}

class Museum : public SceneBuilder {
 public:
  explicit Museum(const Order& order) : SceneBuilder(order), fine_(kFineness.at(order.name)) {
    addRooms();
    addColumns();
    addSculptures();
    addPictures();
    addLights();
    camera("hall", {1.0, 1.65, 4.9}, {6.4, 1.4, 2.6}, 62);
    camera("doorway", {6.6, 1.65, 4.6}, {11.5, 1.3, 3.0}, 60);
    camera("cabinet", {13.4, 1.65, 6.3}, {9.6, 1.3, 2.6}, 62);
  }

 private:
  void addRooms() {
    const double x1 = kHall + kBoard + kCabinet, w = kWall, lo = -kSunk, hi = kHeight + kSunk;
    place("floor", box({-w - 0.1, -0.3, -w - 0.1}, {x1 + w + 0.1, 0, kWidth + w + 0.1}),
          paint("floor", {0.36, 0.25, 0.17}));
    place("ceiling", box({-w - 0.2, kHeight, -w - 0.2}, {x1 + w + 0.2, kHeight + 0.3, kWidth + w + 0.2}), white_);
    Geometry hall = box({-w, lo, -kSunk}, {0, hi, kWidth + kSunk});
    for (const double z : {-w, kWidth}) hall.add(box({-kSunk, lo, z}, {kHall + 0.5 * kBoard, hi, z + w}));
    place("hall walls", hall, paint("grey green paint", {0.42, 0.5, 0.42}));
    Geometry cabinet = box({x1, lo, -kSunk}, {x1 + w, hi, kWidth + kSunk});
    for (const double z : {-w, kWidth}) cabinet.add(box({kHall + 0.5 * kBoard, lo, z}, {x1 + kSunk, hi, z + w}));
    place("cabinet walls", cabinet, paint("red paint", {0.6, 0.24, 0.16}));
    place("board",
          crossWallWithOpening({kHall, lo, -kSunk}, {kHall + kBoard, hi, kWidth + kSunk}, {2.6, lo}, {4.0, 2.6}),
          white_);
    Geometry frame = box({kHall - 0.03, 0, 2.48}, {kHall + kBoard + 0.03, 2.6, 2.62});
    frame.add(box({kHall - 0.03, 0, 3.98}, {kHall + kBoard + 0.03, 2.6, 4.12}));
    frame.add(box({kHall - 0.035, 2.58, 2.44}, {kHall + kBoard + 0.035, 2.74, 4.16}));
    place("door frame", frame, wood_);
  }

  void addColumns() {
    const Index column = mesh("column", roundColumn(fine_), stone_);
    int i = 0;
    for (const double x : {1.9, 6.9})
      for (const double z : {0.75, kWidth - 0.75}) place("column " + std::to_string(i++), column, {x, 0, z});
  }

  void stand(const std::string& name, const Form& form, Index material, const dvec3& at, const dvec2& top,
             double height, double turn = 0, double finer = 1) {
    place(name + " plinth", plinth(top.x, top.y, height), stone_, at);
    place(name, mesh(name, meshed(form, finer * fine_.cell), material), at + dvec3(0, height, 0), turn);
  }

  void addSculptures() {
    const Index marble = paint("marble", {0.74, 0.72, 0.68}), bronze = paint("bronze", {0.32, 0.2, 0.09});
    stand("reclining figure", recliningFigure(), marble, {4.4, 0, 3.4}, {2.3, 1.0}, 0.5);
    stand("draped figure", drapedFigure(), marble, {4.4, 0, 0.9}, {0.8, 0.8}, 0.4, 10, 0.8);
    stand("pierced form", piercedForm(), bronze, {7.7, 0, 5.9}, {0.6, 0.6}, 0.75, 30);
    stand("growth", growth(), paint("plaster", {0.76, 0.75, 0.72}), {11.3, 0, 1.3}, {0.7, 0.6}, 0.7, 200);
    stand("bird", bird(), bronze, {12.9, 0, 3.3}, {0.45, 0.45}, 0.8);

    const Index blue = mesh("blue vase", vase(fine_), paint("blue glaze", {0.08, 0.2, 0.5}));
    const Index ochre = variant("ochre vase", blue, paint("ochre glaze", {0.62, 0.36, 0.1}));
    const Index stand = mesh("vase plinth", plinth(0.5, 0.5, 0.9), stone_);
    int i = 0;
    for (const dvec3& at : {dvec3(0.7, 0, 2.6), dvec3(8.2, 0, 1.2), dvec3(9.8, 0, 5.9)}) {
      place("vase plinth " + std::to_string(i), stand, at);
      place("vase " + std::to_string(i), i % 2 ? ochre : blue, at + dvec3(0, 0.895, 0));
      ++i;
    }
    place("bench", bench({-0.9, 0.4, -0.25}, {0.9, 0.48, 0.25}, {0.65, -0.01, -0.2}, {0.75, 0.41, 0.2}), wood_,
          {4.4, 0, 5.7});
  }

  void addPictures() {
    const Index frame = mesh("frame", box({-0.75, -0.55, -0.01}, {0.75, 0.55, 0.04}), wood_);
    const auto hang = [&](const std::string& name, const dvec3& color, const dvec3& at, double turn) {
      place(name + " frame", frame, at, turn);
      place(name, mesh(name, box({-0.65, -0.45, 0.0}, {0.65, 0.45, 0.05}), paint(name, color)), at, turn);
    };
    hang("yellow picture", {0.7, 0.5, 0.12}, {3.1, 1.9, 0}, 0);
    hang("blue picture", {0.15, 0.35, 0.6}, {5.7, 1.9, 0}, 0);
    hang("red picture", {0.6, 0.2, 0.25}, {4.4, 1.9, kWidth}, 180);
  }

  void addLights() {
    place("skylight frame", panelHousing(3.0, 1.6), wood_, {4.4, kHeight, 3.5});
    place("skylight", panelEmitter(3.0, 1.6), glowing("skylight", {0.92, 0.96, 1}, 7), {4.4, kHeight, 3.5});
    spot("spot", {1, 0.9, 0.75}, 26, {6.0, 3.9, 2.6}, {-1.6, -2.3, -1.7});
    place("lamp shade", lampShade(fine_.segments), paint("brass", {0.6, 0.45, 0.15}), {7.9, kHeight - 1.2, 5.0});
    lamp("lamp", {1, 0.75, 0.45}, 5, {7.9, kHeight - 1.62, 5.0});
  }

  Fineness fine_;
  const Index white_ = paint("white paint", {0.76, 0.75, 0.72}), stone_ = paint("stone", {0.55, 0.53, 0.49});
  const Index wood_ = paint("oak", {0.3, 0.19, 0.1});
};

} // namespace

GeneratedScene writeMuseum(const Order& order) { return Museum(order).write(); }

} // namespace lambent::content

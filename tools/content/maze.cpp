// A maze under a ceiling with 13 static lamps: a column at every junction, walls in four colours. Most of what the
// camera sees is lit around two or three corners. North-west corner at the origin, the floor is y = 0.
#include "tools/content/furniture.h"
#include "tools/content/recipes.h"

#include <string_view>

namespace lambent::content {

namespace {

constexpr double kCell = 2.2, kHeight = 2.8, kHalfWall = 0.12; // metres
constexpr double kSunk = 0.05;                                 // walls reach that far into floor and ceiling

/// A maze, drawn: + a junction, - and | a wall between two junctions, * a cell with a lamp. A square of cells; a text
/// row of junctions and one of cells take turns. Columns go east, rows go south.
using MazePlan = std::vector<std::string_view>;

const MazePlan kFull{
    "+-+-+-+-+-+-+-+-+-+-+-+-+-+-+-+-+", "|*|       |     |  *      |     |", "+ + +-+ +-+ +-+ + + + +-+ + +-+ +",
    "| |   |       |   | | |   | |   |", "+ +-+-+-+-+-+ +-+ + + + + + + +-+", "|   |       |           |   |   |",
    "+-+ + + +-+ +-+-+-+ +-+-+-+-+ + +", "| |   |    *|   |           |*| |", "+ +-+-+ + +-+ + + +-+-+-+-+ + + +",
    "|     | |       |           |   |", "+ + + + + +-+-+ +-+ +-+ + +-+ + +", "| |   |   |   |   |   | |*    | |",
    "+ + + +-+-+ + +-+ +-+-+ + +-+-+ +", "| |   |     |   |      *| |     |", "+ +-+ + +-+ + + +-+-+-+ + + + + +",
    "|  *| |     |     |     |   |   |", "+-+ +-+-+-+ +-+-+ + + + + +-+-+-+", "|   |       |   |  *| | |     | |",
    "+ +-+ +-+-+-+ + +-+-+ + +-+-+ + +", "|     |       |       | |   | |*|", "+ +-+-+ +-+ +-+-+ +-+-+ +-+ + + +",
    "|     | | | |     |         | | |", "+-+-+ + + + + +-+-+ +-+-+-+-+ + +", "| |   | | | |     | |   |       |",
    "+ + +-+ + + +-+-+ + + + + +-+-+ +", "| |   | | | | |   | | |  *|     |", "+ +-+ + + + + + +-+-+ +-+-+ + + +",
    "|   | | | | |*|       |   |   | |", "+ + + + + + + +-+-+-+-+ + + +-+-+", "| | | | |   |           | |     |",
    "+ +-+ + + + + +-+ + + + + + +-+ +", "|  *    |     |       |        *|", "+-+-+-+-+-+-+-+-+-+-+-+-+-+-+-+-+",
};

const MazePlan kSmall{
    "+-+-+-+-+-+-+", "|*    |   |*|", "+ +-+ + + + +", "|  *| |*|   |", "+ + + + +-+ +",
    "|*|   |  *| |", "+ +-+-+-+ +-+", "| |  *  |  *|", "+ +-+ + + + +", "|  *     *  |",
    "+-+-+-+-+-+ +", "|*     *   *|", "+-+-+-+-+-+-+",
};

} // namespace

GeneratedScene writeMaze(const Order& order) {
  const MazePlan& plan = order.size == SceneSize::Full ? kFull : kSmall;
  const size_t cells = plan.size() / 2;
  const double side = kCell * double(cells);
  SceneBuilder s(order);

  const Index floor = s.paint("floor", {0.42, 0.4, 0.37}), ceiling = s.paint("ceiling", {0.74, 0.73, 0.7});
  s.place("floor", box({-0.6, -0.3, -0.6}, {side + 0.6, 0, side + 0.6}), floor);
  s.place("ceiling", box({-0.7, kHeight, -0.7}, {side + 0.7, kHeight + 0.3, side + 0.7}), ceiling);

  // Walls go from the middle of one column to that of the next, so their ends are hidden. Colours change by region.
  const std::array<Index, 4> paints{s.paint("white wall", {0.74, 0.72, 0.68}), s.paint("red wall", {0.62, 0.14, 0.1}),
                                    s.paint("green wall", {0.2, 0.46, 0.18}), s.paint("blue wall", {0.16, 0.26, 0.6})};
  std::array<Geometry, 4> walls;
  for (size_t row = 0; row < plan.size(); ++row)
    for (size_t column = 0; column < plan.size(); ++column) {
      const char c = plan[row][column];
      if (c != '-' && c != '|') continue;
      const double x = kCell * double(column / 2), z = kCell * double(row / 2);
      const size_t region = size_t(5 * hashed(uint32_t(column / 4), uint32_t(row / 4)));
      const dvec3 lo(x, -kSunk, z),
          hi = c == '-' ? dvec3(x + kCell, kHeight + kSunk, z) : dvec3(x, kHeight + kSunk, z + kCell);
      const dvec3 half = c == '-' ? dvec3(0, 0, kHalfWall) : dvec3(kHalfWall, 0, 0);
      walls[region < 2 ? 0 : region - 1].add(box(lo - half, hi + half));
    }
  for (size_t k = 0; k < walls.size(); ++k)
    if (!walls[k].positions.empty()) s.place("walls " + std::to_string(k), walls[k], paints[k]);

  const Index stone = s.paint("stone", {0.66, 0.61, 0.52}), iron = s.paint("iron", {0.16, 0.15, 0.15});
  const Index pillar = s.mesh("column", column(kHeight, s.full() ? 28 : 8), stone);
  for (size_t row = 0; row <= cells; ++row)
    for (size_t column = 0; column <= cells; ++column)
      s.place("column " + std::to_string(row) + " " + std::to_string(column), pillar,
              {kCell * double(column), 0, kCell * double(row)});

  const Index shade = s.mesh("lamp shade", lampShade(s.full() ? 32 : 10), iron);
  constexpr std::array<dvec3, 4> kColors{dvec3(1, 0.75, 0.45), dvec3(1, 0.9, 0.75), dvec3(0.75, 0.88, 1),
                                         dvec3(1, 0.6, 0.35)};
  int lamps = 0;
  for (size_t row = 0; row < plan.size(); ++row)
    for (size_t column = 0; column < plan.size(); ++column) {
      if (plan[row][column] != '*') continue;
      const dvec3 hung(kCell * (double(column / 2) + 0.5), kHeight, kCell * (double(row / 2) + 0.5));
      const std::string number = std::to_string(++lamps);
      s.place("lamp shade " + number, shade, hung);
      s.lamp("lamp " + number, kColors[size_t(lamps) % kColors.size()], 5, hung - dvec3(0, 0.42, 0));
    }

  const double middle = kCell * (double(cells / 2) + 0.5);
  s.camera("middle", {middle, 1.65, middle}, {middle + 1, 1.6, middle + 0.4});
  s.camera("corner", {0.5 * kCell, 1.65, 0.5 * kCell}, {kCell, 1.5, 2 * kCell});
  return s.write();
}

} // namespace lambent::content

#include "tools/content/plants.h"

#include "tools/content/scene_builder.h"

#include <cmath>

namespace lambent::content {

namespace {

constexpr double kPi = 3.141592653589793;
constexpr double kGoldenAngle = 137.508; // degrees: successive parts never stand above each other
const dvec3 kUp(0, 1, 0);

struct Leaf {
  dvec3 base{0}, along{0, 0, 1}; // `along` at the base, any length
  double length = 0.2, width = 0.1;
  double droop = 0;    // sinks by this share of the length towards the tip
  double fold = 0;     // the edges rise by this share of their distance from the midrib
  double widest = 0.4; // place of the greatest width, as share of the length
  uint32_t rows = 4;
};

/// Adds a sheet whose front is above it; folded leaves are two columns wide, flat ones one.
void addLeaf(Geometry& g, const Leaf& leaf) {
  const dvec3 along = glm::normalize(leaf.along);
  const dvec3 side = glm::normalize(glm::cross(along, std::abs(along.y) < 0.99 ? kUp : dvec3(1, 0, 0)));
  const dvec3 up = glm::cross(side, along);
  const uint32_t columns = leaf.fold == 0 ? 1 : 2;
  // Halfway through its sine at the widest place. The ends keep 6 %, so that no triangle is without area.
  const double power = std::log(0.5) / std::log(leaf.widest);
  const auto at = [&](double u, double v) { // u from -1 to 1 across, v from 0 to 1 along
    const double half = 0.5 * leaf.width * (0.06 + 0.94 * std::sin(kPi * std::pow(v, power)));
    return leaf.base + leaf.length * (v * along - leaf.droop * v * v * up) +
           half * (u * side + leaf.fold * std::abs(u) * up);
  };
  const uint32_t first = uint32_t(g.positions.size());
  for (uint32_t row = 0; row <= leaf.rows; ++row)
    for (uint32_t column = 0; column <= columns; ++column)
      g.addVertex(at(2.0 * column / columns - 1, double(row) / leaf.rows), dvec3(0));
  const size_t firstIndex = g.indices.size();
  g.addGrid(first, leaf.rows + 1, columns + 1, false);
  // Smooth: the mean of the faces around a vertex, weighted by their areas.
  for (size_t i = firstIndex; i < g.indices.size(); i += 3) {
    const auto corner = [&](size_t k) { return g.positions[g.indices[i + k]]; };
    const dvec3 area = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
    for (size_t k = 0; k < 3; ++k) g.normals[g.indices[i + k]] += area;
  }
  for (uint32_t i = first; i < g.normals.size(); ++i) g.normals[i] = glm::normalize(g.normals[i]);
}

/// A point `t` in [0, 1] along a stalk that leaves the ground steeply and leans over towards +Z.
dvec3 stalkPoint(double reach, double height, double t) {
  return {0, height * (1.35 * t - 0.35 * t * t), reach * (0.1 * t + 0.9 * t * t)};
}

std::vector<dvec3> stalk(double reach, double height, uint32_t pieces) {
  std::vector<dvec3> line;
  for (uint32_t i = 0; i <= pieces; ++i) line.push_back(stalkPoint(reach, height, double(i) / pieces));
  return line;
}

} // namespace

Plant broadLeaved(uint32_t leaves, double height, PlantDetail detail) {
  Plant plant;
  for (uint32_t i = 0; i < leaves; ++i) {
    const double turn = kGoldenAngle * i, tall = height * (0.45 + 0.55 * hashed(i, 21));
    const double reach = height * (0.25 + 0.3 * hashed(i, 22));
    const std::vector<dvec3> line = stalk(reach, tall, detail.rows);
    const dvec3 foot = 0.02 * turned(dvec3(0, 0, 1), turn); // stalks stand beside each other
    plant.stems.add(turned(rod(line, 0.008, detail.sides, 0.5), turn), foot);
    Geometry blade;
    addLeaf(blade, {.base = line.back(),
                    .along = {0.3 * (hashed(i, 23) - 0.5), -0.1 - 0.3 * hashed(i, 24), 1},
                    .length = height * (0.34 + 0.12 * hashed(i, 25)),
                    .width = height * (0.22 + 0.08 * hashed(i, 26)),
                    .droop = 0.25,
                    .fold = 0.35,
                    .widest = 0.35,
                    .rows = detail.rows + 1});
    plant.leaves.add(turned(blade, turn), foot);
  }
  return plant;
}

Plant grass(uint32_t blades, double height, PlantDetail detail) {
  Plant plant;
  for (uint32_t i = 0; i < blades; ++i) {
    const double turn = kGoldenAngle * i, out = 0.14 * height * std::sqrt((i + 0.5) / blades);
    Geometry blade;
    addLeaf(blade, {.base = {0, -0.01, out},
                    .along = {0.25 * (hashed(i, 31) - 0.5), 1.3, 0.15 + 0.75 * hashed(i, 32)},
                    .length = height * (0.7 + 0.3 * hashed(i, 33)),
                    .width = 0.014 + 0.01 * hashed(i, 34),
                    .droop = 0.15 + 0.5 * hashed(i, 35),
                    .widest = 0.2,
                    .rows = detail.rows});
    plant.leaves.add(turned(blade, turn));
  }
  return plant;
}

Plant fern(uint32_t fronds, uint32_t pairs, double length, PlantDetail detail) {
  Plant plant;
  for (uint32_t i = 0; i < fronds; ++i) {
    const double turn = kGoldenAngle * i, rise = length * (0.45 + 0.3 * hashed(i, 41));
    const auto rachis = [&](double t) { // rises, then hangs over
      return dvec3(0, rise * (1.9 * t - 1.35 * t * t), 0.02 + length * (0.25 * t + 0.6 * t * t));
    };
    std::vector<dvec3> line;
    for (uint32_t k = 0; k <= 2 * detail.rows; ++k) line.push_back(rachis(0.5 * k / detail.rows));
    plant.stems.add(turned(rod(line, 0.005, detail.sides, 0.6), turn));
    Geometry leaflets;
    for (uint32_t k = 0; k < pairs; ++k) {
      const double t = 0.2 + 0.78 * k / (pairs - 1.0);
      const dvec3 along = glm::normalize(rachis(t + 0.01) - rachis(t - 0.01));
      for (const double side : {-1.0, 1.0})
        addLeaf(leaflets, {.base = rachis(t),
                           .along = dvec3(side, -0.15, 0) + 0.55 * along,
                           .length = 0.3 * length * (1.12 - t),
                           .width = 0.6 * length / pairs,
                           .droop = 0.2,
                           .rows = 2});
    }
    plant.leaves.add(turned(leaflets, turn));
  }
  return plant;
}

Plant bamboo(uint32_t canes, uint32_t leavesPerCane, double height, PlantDetail detail) {
  Plant plant;
  for (uint32_t i = 0; i < canes; ++i) {
    const double turn = kGoldenAngle * i, tall = height * (0.6 + 0.4 * hashed(i, 51));
    const double reach = 0.08 * height * (0.4 + hashed(i, 52));
    const dvec3 foot = 0.06 * std::sqrt(i + 0.5) * turned(dvec3(0, 0, 1), turn);
    plant.stems.add(turned(rod(stalk(reach, tall, detail.rows + 1), 0.013, detail.sides, 0.6), turn), foot);
    Geometry leaves;
    for (uint32_t k = 0; k < leavesPerCane; ++k) {
      const double t = 0.3 + 0.7 * (k + 1.0) / leavesPerCane;
      addLeaf(leaves, {.base = stalkPoint(reach, tall, t),
                       .along = turned(dvec3(0, 0.15, 1), kGoldenAngle * k),
                       .length = 0.2 + 0.1 * hashed(k, 53 + i),
                       .width = 0.026,
                       .droop = 0.4 + 0.4 * hashed(k, 73 + i),
                       .widest = 0.3,
                       .rows = detail.rows});
    }
    plant.leaves.add(turned(leaves, turn), foot);
  }
  return plant;
}

Plant tree(uint32_t branches, uint32_t twigs, uint32_t leavesPerTwig, double height, PlantDetail detail) {
  Plant plant;
  const double trunk = 0.72 * height, lean = 0.06 * height;
  plant.stems.add(rod(stalk(lean, trunk, 2 * detail.rows), 0.018 * height, 2 * detail.sides, 0.55));
  for (uint32_t i = 0; i < branches; ++i) {
    // From the trunk's upper half; the lower ones reach farther out.
    const double t = 0.48 + 0.5 * i / branches, turn = kGoldenAngle * i;
    const dvec3 from = stalkPoint(lean, trunk, t);
    const double reach = height * (0.42 - 0.26 * (t - 0.48)), rise = height * (0.16 + 0.1 * hashed(i, 61));
    const auto branch = [&](double u) { return dvec3(0, rise * u, reach * (u - 0.15 * u * u)); };
    std::vector<dvec3> line;
    for (uint32_t k = 0; k <= detail.rows; ++k) line.push_back(branch(double(k) / detail.rows));
    plant.stems.add(turned(rod(line, 0.007 * height, detail.sides, 0.6), turn), from);
    for (uint32_t k = 0; k < twigs; ++k) {
      const double u = 0.35 + 0.65 * (k + 1.0) / twigs, side = k % 2 == 0 ? 1 : -1;
      const dvec3 start = branch(u);
      const dvec3 direction = glm::normalize(dvec3(side * (0.5 + 0.4 * hashed(k, 62 + i)), 0.35, 0.55));
      const double length = height * (0.14 + 0.06 * hashed(k, 82 + i));
      plant.stems.add(turned(rod({start, start + length * direction}, 0.0028 * height, 3, 0.5), turn), from);
      Geometry leaves;
      for (uint32_t n = 0; n < leavesPerTwig; ++n) {
        const dvec3 away = glm::normalize(glm::cross(direction, kUp)) * (n % 2 == 0 ? 1.0 : -1.0);
        const double lift = 0.9 * (hashed(n, 102 + i * twigs + k) - 0.55);
        addLeaf(leaves, {.base = start + length * ((n + 1.0) / leavesPerTwig) * direction,
                         .along = 0.6 * direction + away + lift * kUp,
                         .length = 0.09 + 0.03 * hashed(n, 302 + i * twigs + k),
                         .width = 0.048,
                         .droop = 0.2,
                         .fold = 0.3,
                         .rows = 2});
      }
      plant.leaves.add(turned(leaves, turn), from);
    }
  }
  return plant;
}

} // namespace lambent::content

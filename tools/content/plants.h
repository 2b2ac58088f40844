// Plants of the generated scenes: thin stems, which are solid, and leaves, which are single sheets for a double-sided
// material. Each stands on y = 0 around the vertical axis.
#pragma once

#include "tools/content/shapes.h"

namespace lambent::content {

struct Plant {
  Geometry stems, leaves;
};

/// How finely a plant is made.
struct PlantDetail {
  uint32_t rows = 4;  // of a leaf, along it
  uint32_t sides = 5; // of a stem
};

/// Long stalks that lean outwards, one broad folded leaf on each.
Plant broadLeaved(uint32_t leaves, double height, PlantDetail detail);

/// Tuft of narrow blades without stems.
Plant grass(uint32_t blades, double height, PlantDetail detail);

/// Arched fronds with two rows of leaflets.
Plant fern(uint32_t fronds, uint32_t pairs, double length, PlantDetail detail);

/// Upright canes with narrow hanging leaves.
Plant bamboo(uint32_t canes, uint32_t leavesPerCane, double height, PlantDetail detail);

/// Small tree: a trunk, branches with twigs, and leaves along the twigs.
Plant tree(uint32_t branches, uint32_t twigs, uint32_t leavesPerTwig, double height, PlantDetail detail);

} // namespace lambent::content

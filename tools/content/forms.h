// Organic solids: limbs that flow into each other, given by a distance field and meshed at any fineness.
#pragma once

#include "tools/content/shapes.h"

#include <functional>

namespace lambent::content {

/// Negative inside, zero on the surface, about metres near it. Smooth: the mesh's normals are its gradient.
using Field = std::function<double(const dvec3&)>;

struct Form {
  Field field;
  dvec3 lo, hi; // corners of a box that holds all of it
};

/// The nearer of two distances, rounded where they are within `round` of each other: a union. -joined(-a, -b, round) is
/// the part in common, -joined(-a, b, round) takes b away.
double joined(double a, double b, double round);

/// Straight limb from `a` to `b` whose radius goes from `ra` to `rb`; what comes before is joined over `blend` metres.
struct Limb {
  dvec3 a, b;
  double ra, rb, blend;
  bool carve = false; // taken away instead of added
};

/// The limbs one after the other; carving ones take from what stands before them.
Form limbs(std::vector<Limb> parts);

/// The closed surface of a form as a grid of about `cell` metres sees it: parts thinner than two cells may be lost.
Geometry meshed(const Form& form, double cell);

/// Figures for plinths. Each stands on y = 0 (its foot reaches 2 cm below) around the vertical axis, as high as said.
Form recliningFigure(); // 1.05 m, 2.2 m long along X
Form drapedFigure();    // 1.8 m
Form piercedForm();     // 1.15 m
Form bird();            // 1.55 m
Form growth();          // 1.1 m
Form gourd();           // 0.86 m, with twisted ribs

} // namespace lambent::content

// Solid and sheet geometry for the generated scenes. Double precision, metres, counter-clockwise from outside.
// Every solid is closed: each edge belongs to two triangles, so nothing that is built of them leaks light.
#pragma once

#include "engine/core/math.h"

#include <array>
#include <vector>

namespace lambent::content {

using glm::dvec2;
using glm::dvec3;

inline constexpr double kTau = 6.283185307179586;

struct Geometry {
  std::vector<dvec3> positions, normals;
  std::vector<dvec2> uvs; // empty, or one per vertex
  std::vector<uint32_t> indices;

  uint32_t addVertex(const dvec3& position, const dvec3& normal);
  /// Two triangles between vertices that are there, counter-clockwise seen from their front.
  void addFace(uint32_t a, uint32_t b, uint32_t c, uint32_t d);
  /// Faces between rows of `columns` vertices each, which were added from `first` on; where they are `round` the last
  /// one of a row goes on at its first one, where the grid is `closed` the last row at the first one.
  void addGrid(uint32_t first, uint32_t rows, uint32_t columns, bool round, bool closed = false);
  /// Flat quad a, b, c, d, counter-clockwise seen from its front.
  void addQuad(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d);
  /// Adds a copy of `part`, moved by `offset`. Both have texture coordinates or neither has.
  void add(const Geometry& part, const dvec3& offset = dvec3(0));
};

/// Turned around the vertical axis, degrees counter-clockwise from above.
dvec3 turned(const dvec3& v, double degrees);
Geometry turned(Geometry geometry, double degrees);

Geometry moved(Geometry geometry, const dvec3& by);

/// Box between two opposite corners.
Geometry box(const dvec3& a, const dvec3& b);

/// Closed block over a quadrilateral `low` and one `high` above it, both counter-clockwise from above.
Geometry hexahedron(const std::array<dvec3, 4>& low, const std::array<dvec3, 4>& high);

/// Wall along X between `lo` and `hi` with one rectangular opening through its whole thickness (Z), given by its lower
/// left and upper right corner in x and y. An opening that reaches down to lo.y is a doorway.
Geometry wallWithOpening(const dvec3& lo, const dvec3& hi, const dvec2& openingLo, const dvec2& openingHi);

/// The same turned by a quarter: x and z swap places (the opening is given in z and y).
Geometry crossWallWithOpening(const dvec3& lo, const dvec3& hi, const dvec2& openingLo, const dvec2& openingHi);

/// A window or door: x from, to; y from, to above the storey's floor.
struct Opening {
  double lo, hi, sill, head;
};
/// A storey of a wall from x = -half to `half`, from z = 0 to `thickness`, from y = `bottom` to `top`: columns beside
/// and between the openings, which go from left to right, and what is above and below these.
Geometry wallWithOpenings(const std::vector<Opening>& openings, double half, double thickness, double bottom,
                          double floor, double top);

/// With texture coordinates from its vertices' horizontal positions: (x, z) / tileMetres.
Geometry mappedFromAbove(Geometry geometry, double tileMetres);

/// With texture coordinates from above, or from the side that each vertex faces most, upright; `tileMetres` a tile.
Geometry mappedFromSides(Geometry geometry, double tileMetres);

/// Piece of a profile that is shaded smoothly along its length, without its first point: it goes on from where the one
/// before ends. x is the radius and y the height.
using ProfilePiece = std::vector<dvec2>;

/// Body of revolution around +Y. The profile goes from the axis at the bottom, `start`, to the axis at the top, which
/// makes the body closed.
Geometry lathe(const dvec2& start, const std::vector<ProfilePiece>& profile, uint32_t segments);

Geometry sphere(double radius, uint32_t segments);

/// Opening of a round arch in a wall: wall from y = 0 (the springing) to `height`, `bay` wide, `thickness` deep,
/// centred on x and z, with a half circle of `radius` around the origin cut out, and a moulding around it on the +Z
/// face.
struct ArchShape {
  double bay = 3.4, height = 1.8, thickness = 0.5, radius = 1.4;
  uint32_t segments = 20;
};
Geometry arch(const ArchShape& shape);

/// Hanging cloth with vertical folds: a single sheet in the plane z = 0, hung along the line y = 0, centred on x.
struct ClothShape {
  double width = 1.6, drop = 2.4;
  double folds = 4.5; // full waves across the width
  double foldDepthTop = 0.02, foldDepthBottom = 0.08;
  double gather = 0; // share of the width that is lost towards the bottom
  uint32_t columns = 40, rows = 10;
};
Geometry cloth(const ClothShape& shape);

/// Round rod along a line of at least two points, with flat ends; no piece is vertical. `taper` is the share of the
/// radius that is lost towards the end.
Geometry rod(const std::vector<dvec3>& line, double radius, uint32_t sides, double taper = 0);

/// Solid along X between x0 and x1 whose cross-section is a convex outline in (z, y), counter-clockwise from +X: with z
/// to the left.
Geometry prism(const std::vector<dvec2>& outline, double x0, double x1);

} // namespace lambent::content

#include "tools/content/shapes.h"

#include "engine/core/error.h"

#include <cmath>

namespace lambent::content {

uint32_t Geometry::addVertex(const dvec3& position, const dvec3& normal) {
  positions.push_back(position);
  normals.push_back(normal);
  return uint32_t(positions.size() - 1);
}

void Geometry::addFace(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  indices.insert(indices.end(), {a, b, c, a, c, d});
}

void Geometry::addGrid(uint32_t first, uint32_t rows, uint32_t columns, bool round, bool closed) {
  for (uint32_t row = 0; row < rows - !closed; ++row)
    for (uint32_t column = 0; column < columns - !round; ++column) {
      const uint32_t here = first + row * columns, next = first + (row + 1) % rows * columns;
      const uint32_t beside = (column + 1) % columns;
      addFace(here + column, here + beside, next + beside, next + column);
    }
}

void Geometry::addQuad(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d) {
  const dvec3 normal = glm::normalize(glm::cross(c - a, d - b));
  const uint32_t first = addVertex(a, normal);
  addVertex(b, normal);
  addVertex(c, normal);
  addVertex(d, normal);
  addFace(first, first + 1, first + 2, first + 3);
}

void Geometry::add(const Geometry& part, const dvec3& offset) {
  if (!positions.empty()) CHECK_EQ(uvs.empty(), part.uvs.empty());
  const uint32_t first = uint32_t(positions.size());
  for (const dvec3& p : part.positions) positions.push_back(p + offset);
  normals.insert(normals.end(), part.normals.begin(), part.normals.end());
  uvs.insert(uvs.end(), part.uvs.begin(), part.uvs.end());
  for (const uint32_t i : part.indices) indices.push_back(first + i);
}

dvec3 turned(const dvec3& v, double degrees) {
  const double angle = glm::radians(degrees), c = std::cos(angle), s = std::sin(angle);
  return {c * v.x + s * v.z, v.y, c * v.z - s * v.x};
}

Geometry turned(Geometry geometry, double degrees) {
  for (auto* vectors : {&geometry.positions, &geometry.normals})
    for (dvec3& v : *vectors) v = turned(v, degrees);
  return geometry;
}

Geometry moved(Geometry geometry, const dvec3& by) {
  for (dvec3& p : geometry.positions) p += by;
  return geometry;
}

Geometry box(const dvec3& a, const dvec3& b) {
  const dvec3 lo = glm::min(a, b), hi = glm::max(a, b);
  Geometry g;
  const auto corner = [&](int x, int y, int z) { return dvec3(x ? hi.x : lo.x, y ? hi.y : lo.y, z ? hi.z : lo.z); };
  g.addQuad(corner(0, 0, 1), corner(1, 0, 1), corner(1, 1, 1), corner(0, 1, 1)); // +Z
  g.addQuad(corner(1, 0, 0), corner(0, 0, 0), corner(0, 1, 0), corner(1, 1, 0)); // -Z
  g.addQuad(corner(1, 0, 1), corner(1, 0, 0), corner(1, 1, 0), corner(1, 1, 1)); // +X
  g.addQuad(corner(0, 0, 0), corner(0, 0, 1), corner(0, 1, 1), corner(0, 1, 0)); // -X
  g.addQuad(corner(0, 1, 1), corner(1, 1, 1), corner(1, 1, 0), corner(0, 1, 0)); // +Y
  g.addQuad(corner(0, 0, 0), corner(1, 0, 0), corner(1, 0, 1), corner(0, 0, 1)); // -Y
  return g;
}

Geometry hexahedron(const std::array<dvec3, 4>& low, const std::array<dvec3, 4>& high) {
  Geometry g;
  g.addQuad(high[0], high[1], high[2], high[3]);
  g.addQuad(low[3], low[2], low[1], low[0]);
  for (size_t i = 0; i < 4; ++i) g.addQuad(low[i], low[(i + 1) % 4], high[(i + 1) % 4], high[i]);
  return g;
}

Geometry wallWithOpening(const dvec3& lo, const dvec3& hi, const dvec2& openingLo, const dvec2& openingHi) {
  CHECK(openingLo.x > lo.x && openingHi.x < hi.x && openingLo.y >= lo.y && openingHi.y < hi.y);
  Geometry g = box(lo, {openingLo.x, hi.y, hi.z});
  g.add(box({openingHi.x, lo.y, lo.z}, hi));
  g.add(box({openingLo.x, openingHi.y, lo.z}, {openingHi.x, hi.y, hi.z}));
  if (openingLo.y > lo.y) g.add(box({openingLo.x, lo.y, lo.z}, {openingHi.x, openingLo.y, hi.z}));
  return g;
}

Geometry crossWallWithOpening(const dvec3& lo, const dvec3& hi, const dvec2& openingLo, const dvec2& openingHi) {
  // A quarter turn takes (x, y, z) to (z, y, -x).
  return turned(wallWithOpening({-hi.z, lo.y, lo.x}, {-lo.z, hi.y, hi.x}, {-openingHi.x, openingLo.y},
                                {-openingLo.x, openingHi.y}),
                90);
}

Geometry wallWithOpenings(const std::vector<Opening>& openings, double half, double thickness, double bottom,
                          double floor, double top) {
  Geometry g;
  double x = -half;
  for (const Opening& o : openings) {
    g.add(box({x, bottom, 0}, {o.lo, top, thickness}));
    g.add(box({o.lo, floor + o.head, 0}, {o.hi, top, thickness}));
    if (o.sill > 0) g.add(box({o.lo, bottom, 0}, {o.hi, floor + o.sill, thickness}));
    x = o.hi;
  }
  g.add(box({x, bottom, 0}, {half, top, thickness}));
  return g;
}

Geometry mappedFromAbove(Geometry geometry, double tileMetres) {
  geometry.uvs.clear();
  for (const dvec3& p : geometry.positions) geometry.uvs.emplace_back(p.x / tileMetres, p.z / tileMetres);
  return geometry;
}

Geometry mappedFromSides(Geometry geometry, double tileMetres) {
  geometry.uvs.clear();
  for (size_t i = 0; i < geometry.positions.size(); ++i) {
    const dvec3 p = geometry.positions[i] / tileMetres, n = glm::abs(geometry.normals[i]);
    if (n.y > std::max(n.x, n.z))
      geometry.uvs.emplace_back(p.x, p.z);
    else
      geometry.uvs.emplace_back(n.x > n.z ? p.z : p.x, -p.y);
  }
  return geometry;
}

Geometry lathe(const dvec2& start, const std::vector<ProfilePiece>& profile, uint32_t segments) {
  Geometry g;
  dvec2 from = start;
  for (ProfilePiece piece : profile) {
    piece.insert(piece.begin(), from);
    from = piece.back();
    const uint32_t first = uint32_t(g.positions.size());
    const uint32_t points = uint32_t(piece.size());
    for (uint32_t i = 0; i < points; ++i) {
      const dvec2 along = piece[std::min(i + 1, points - 1)] - piece[i ? i - 1 : 0];
      const dvec2 outward = glm::normalize(dvec2(along.y, -along.x)); // right of the way up
      for (uint32_t s = 0; s < segments; ++s) {
        const double angle = kTau * s / segments, c = std::cos(angle), sn = std::sin(angle);
        g.addVertex({piece[i].x * c, piece[i].y, -piece[i].x * sn}, {outward.x * c, outward.y, -outward.x * sn});
      }
    }
    for (uint32_t i = 0; i + 1 < points; ++i)
      for (uint32_t s = 0; s < segments; ++s) {
        const uint32_t next = (s + 1) % segments, low = first + i * segments, high = low + segments;
        // On the axis all vertices of a ring coincide: only one of the two triangles has an area.
        if (piece[i].x > 0) g.indices.insert(g.indices.end(), {low + s, low + next, high + next});
        if (piece[i + 1].x > 0) g.indices.insert(g.indices.end(), {low + s, high + next, high + s});
      }
  }
  return g;
}

Geometry sphere(double radius, uint32_t segments) {
  ProfilePiece meridian;
  const uint32_t rings = segments / 2;
  for (uint32_t i = 1; i <= rings; ++i) {
    const double angle = 0.5 * kTau * i / rings;
    meridian.emplace_back(i == rings ? 0.0 : radius * std::sin(angle), -radius * std::cos(angle));
  }
  Geometry g = lathe({0, -radius}, {meridian}, segments);
  for (size_t i = 0; i < g.positions.size(); ++i) g.normals[i] = g.positions[i] / radius;
  return g;
}

namespace {

/// Point `i` of `segments` on a half circle around the origin, from the left springing to the right one.
dvec2 onArch(uint32_t i, uint32_t segments, double radius) {
  const double angle = 0.5 * kTau * (1.0 - double(i) / segments);
  const bool springing = i == 0 || i == segments;
  return {radius * std::cos(angle), springing ? 0.0 : radius * std::sin(angle)};
}

/// Half ring around the origin between two radii and two depths, closed, from the left springing to the right one.
void addHalfRing(Geometry& g, double inner, double outer, double back, double front, uint32_t segments) {
  const auto point = [&](uint32_t i, double radius, double z) { return dvec3(onArch(i, segments, radius), z); };
  for (uint32_t i = 0; i < segments; ++i) {
    const auto ring = [&](uint32_t k) {
      return std::array{point(k, inner, back), point(k, inner, front), point(k, outer, front), point(k, outer, back)};
    };
    const auto a = ring(i), b = ring(i + 1);
    g.addQuad(a[1], b[1], b[2], a[2]); // front
    g.addQuad(b[0], a[0], a[3], b[3]); // back
    g.addQuad(a[3], a[2], b[2], b[3]); // outside
    g.addQuad(a[1], a[0], b[0], b[1]); // inside
    if (i == 0) g.addQuad(a[0], a[1], a[2], a[3]);
    if (i + 1 == segments) g.addQuad(b[3], b[2], b[1], b[0]);
  }
}

} // namespace

Geometry arch(const ArchShape& shape) {
  Geometry g;
  const double half = 0.5 * shape.bay, z = 0.5 * shape.thickness, top = shape.height, r = shape.radius;
  // x and y of the cut from left to right, with the wall's outer ends as first and last column.
  std::vector<dvec2> cut{{-half, 0}};
  for (uint32_t i = 0; i <= shape.segments; ++i) cut.push_back(onArch(i, shape.segments, r));
  cut.emplace_back(half, 0);

  const auto soffitNormal = [](const dvec2& p) { return -glm::normalize(dvec3(p, 0)); };
  for (size_t i = 0; i + 1 < cut.size(); ++i) {
    const dvec2 a = cut[i], b = cut[i + 1];
    g.addQuad({a, z}, {b, z}, {b.x, top, z}, {a.x, top, z});
    g.addQuad({b, -z}, {a, -z}, {a.x, top, -z}, {b.x, top, -z});
    g.addQuad({a.x, top, z}, {b.x, top, z}, {b.x, top, -z}, {a.x, top, -z});
    g.addQuad({a, -z}, {b, -z}, {b, z}, {a, z});
    if (i > 0 && i + 2 < cut.size()) { // the soffit is shaded as a cylinder
      const size_t last = g.normals.size();
      g.normals[last - 4] = g.normals[last - 1] = soffitNormal(a);
      g.normals[last - 3] = g.normals[last - 2] = soffitNormal(b);
    }
  }
  g.addQuad({-half, 0, -z}, {-half, 0, z}, {-half, top, z}, {-half, top, -z});
  g.addQuad({half, 0, z}, {half, 0, -z}, {half, top, -z}, {half, top, z});
  // The moulding is sunk into the wall so that its back is hidden.
  addHalfRing(g, r + 0.02, r + 0.02 + 0.16, z - 0.05, z + 0.05, shape.segments);
  return g;
}

Geometry cloth(const ClothShape& shape) {
  const auto at = [&](double u, double v) {
    const double width = shape.width * (1.0 - shape.gather * v * v);
    const double depth = glm::mix(shape.foldDepthTop, shape.foldDepthBottom, v);
    // A second, slower wave that drifts with the height keeps the folds from being parallel.
    const double wave = std::sin(kTau * shape.folds * u) + 0.45 * std::sin(kTau * (1.3 * u + 0.35 * v));
    const double sag = 0.02 * v * std::cos(kTau * shape.folds * 0.5 * u);
    return dvec3(width * (u - 0.5), -shape.drop * v + sag, depth * wave);
  };
  Geometry g;
  constexpr double kStep = 1e-4; // of the parameter, for the tangents
  for (uint32_t row = 0; row <= shape.rows; ++row)
    for (uint32_t column = 0; column <= shape.columns; ++column) {
      const double u = double(column) / shape.columns, v = double(row) / shape.rows;
      const dvec3 along = at(u + kStep, v) - at(u - kStep, v), down = at(u, v + kStep) - at(u, v - kStep);
      g.addVertex(at(u, v), glm::normalize(glm::cross(down, along)));
    }
  const uint32_t stride = shape.columns + 1;
  for (uint32_t row = 0; row < shape.rows; ++row)
    for (uint32_t column = 0; column < shape.columns; ++column) {
      const uint32_t upper = row * stride + column, lower = upper + stride;
      g.addFace(lower, lower + 1, upper + 1, upper);
    }
  return g;
}

Geometry rod(const std::vector<dvec3>& line, double radius, uint32_t sides, double taper) {
  CHECK_LE(2u, line.size());
  Geometry g;
  const uint32_t points = uint32_t(line.size());
  const auto direction = [&](uint32_t i) {
    return glm::normalize(line[std::min(i + 1, points - 1)] - line[i ? i - 1 : 0]);
  };
  const auto outward = [&](uint32_t i, uint32_t s) {
    const dvec3 side = glm::normalize(glm::cross(direction(i), dvec3(0, 1, 0)));
    const double angle = kTau * (s % sides) / sides;
    return std::cos(angle) * side + std::sin(angle) * glm::cross(direction(i), side);
  };
  const auto thickness = [&](uint32_t i) { return radius * (1 - taper * i / (points - 1)); };
  for (uint32_t i = 0; i < points; ++i)
    for (uint32_t s = 0; s < sides; ++s) g.addVertex(line[i] + thickness(i) * outward(i, s), outward(i, s));
  g.addGrid(0, points, sides, true);
  for (const bool end : {false, true}) {
    const uint32_t i = end ? points - 1 : 0, middle = uint32_t(g.positions.size());
    const dvec3 normal = end ? direction(i) : -direction(i);
    g.addVertex(line[i], normal);
    for (uint32_t s = 0; s < sides; ++s) g.addVertex(line[i] + thickness(i) * outward(i, s), normal);
    for (uint32_t s = 0; s < sides; ++s) {
      const uint32_t a = middle + 1 + s, b = middle + 1 + (s + 1) % sides;
      g.indices.insert(g.indices.end(), {middle, end ? a : b, end ? b : a});
    }
  }
  return g;
}

Geometry prism(const std::vector<dvec2>& outline, double x0, double x1) {
  Geometry g;
  const uint32_t corners = uint32_t(outline.size());
  const auto at = [&](uint32_t i, double x) { return dvec3(x, outline[i % corners].y, outline[i % corners].x); };
  for (uint32_t i = 0; i < corners; ++i) g.addQuad(at(i, x1), at(i, x0), at(i + 1, x0), at(i + 1, x1));
  for (const bool end : {false, true}) {
    const uint32_t first = uint32_t(g.positions.size());
    for (uint32_t i = 0; i < corners; ++i) g.addVertex(at(i, end ? x1 : x0), {end ? 1 : -1, 0, 0});
    for (uint32_t i = 1; i + 1 < corners; ++i)
      g.indices.insert(g.indices.end(), {first, first + (end ? i : i + 1), first + (end ? i + 1 : i)});
  }
  return g;
}

} // namespace lambent::content

// Meshing by surface nets (Gibson 1998): a vertex in every cell that the surface crosses, a quad for every edge of the
// grid that it crosses. Four cells share an edge, so the surface is closed. Vertices are then spread out on the
// surface.
#include "tools/content/forms.h"

#include "engine/core/error.h"

#include <array>
#include <cmath>

namespace lambent::content {

namespace {

double distanceTo(const Limb& limb, const dvec3& p) {
  const dvec3 along = limb.b - limb.a;
  const double length2 = glm::dot(along, along);
  const double t = length2 > 0 ? glm::clamp(glm::dot(p - limb.a, along) / length2, 0.0, 1.0) : 0.0;
  return glm::length(p - limb.a - t * along) - glm::mix(limb.ra, limb.rb, t);
}

dvec3 gradient(const Field& field, const dvec3& p, double step) {
  const auto slope = [&](const dvec3& axis) { return (field(p + step * axis) - field(p - step * axis)) / (2 * step); };
  return {slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1})};
}

/// Samples of a field on a grid, and the vertex that each cell got.
class Net {
 public:
  Net(const Form& form, double cell)
      : form_(form), cell_(cell), lo_(form.lo - 1.5 * cell),
        size_(glm::ceil((form.hi - form.lo) / cell) + 4.0) { // a border of a cell outside on every side
    values_.resize(size_t(size_.x) * size_t(size_.y) * size_t(size_.z));
    forEach(0, 0, [&](const glm::ivec3& i) {
      const double value = form.field(corner(i));
      const bool border = glm::any(glm::equal(i, glm::ivec3(0))) || glm::any(glm::equal(i, size_ - 1));
      CHECK(!border || value > 0); // else the box is too small
      values_[index(i)] = value;
    });
  }

  Geometry surface() {
    cells_.assign(values_.size(), kNone);
    forEach(0, 1, [&](const glm::ivec3& cell) { addVertices(cell); });
    forEach(1, 1, [&](const glm::ivec3& from) {
      for (int axis = 0; axis < 3; ++axis) addQuad(from, axis);
    });
    for (int i = 0; i < 3; ++i) relax();
    addNormals();
    int rounds = 0;
    while (untangle() && rounds < 20) ++rounds;
    sharpen();
    return std::move(g_);
  }

 private:
  size_t index(const glm::ivec3& i) const {
    return (size_t(i.z) * size_t(size_.y) + size_t(i.y)) * size_t(size_.x) + size_t(i.x);
  }
  dvec3 corner(const glm::ivec3& i) const { return lo_ + cell_ * dvec3(i); }
  bool inside(const glm::ivec3& i) const { return values_[index(i)] < 0; }
  /// Samples from `from` on, without the last `left` along each axis.
  template <class Visit> void forEach(int from, int left, const Visit& visit) const {
    for (int z = from; z < size_.z - left; ++z)
      for (int y = from; y < size_.y - left; ++y)
        for (int x = from; x < size_.x - left; ++x) visit(glm::ivec3(x, y, z));
  }

  /// One of a cell's edges: along `axis`, at the far side of the next axis where bit 0 of `side` is set, of the one
  /// after where bit 1 is.
  struct CellEdge {
    int axis, side;
    glm::ivec3 from, to;
    size_t id() const { return size_t(4 * axis + side); }
  };

  static const std::array<CellEdge, 12>& cellEdges() {
    static const std::array<CellEdge, 12> edges = [] {
      std::array<CellEdge, 12> all;
      for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 4; ++side) {
          CellEdge e{axis, side, glm::ivec3(0), glm::ivec3(0)};
          e.from[(axis + 1) % 3] = e.to[(axis + 1) % 3] = side & 1;
          e.from[(axis + 2) % 3] = e.to[(axis + 2) % 3] = side >> 1;
          e.to[axis] = 1;
          all[e.id()] = e;
        }
      return all;
    }();
    return edges;
  }

  /// A vertex for each sheet of surface in a cell. On a face of the cell two crossed edges are of one sheet; where all
  /// four are crossed, those at the same inner corner are, seen from both sides of the face.
  void addVertices(const glm::ivec3& cell) {
    std::array<dvec3, 12> crossing;
    std::array<int, 12> sheet; // -1: not crossed
    std::array<glm::ivec3, 12> inner;
    for (const CellEdge& e : cellEdges()) {
      const glm::ivec3 from = cell + e.from, to = cell + e.to;
      const double a = values_[index(from)], b = values_[index(to)];
      sheet[e.id()] = (a < 0) == (b < 0) ? -1 : int(e.id());
      crossing[e.id()] = glm::mix(corner(from), corner(to), a / (a - b));
      inner[e.id()] = a < 0 ? e.from : e.to;
    }
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) {
        std::vector<size_t> crossed;
        for (const CellEdge& e : cellEdges())
          if (e.axis != axis && e.from[axis] == side && sheet[e.id()] >= 0) crossed.push_back(e.id());
        for (const size_t a : crossed)
          for (const size_t b : crossed)
            if (crossed.size() == 2 || inner[a] == inner[b]) {
              const int gone = sheet[b], kept = sheet[a];
              for (int& s : sheet)
                if (s == gone) s = kept;
            }
      }
    std::array<uint32_t, 12> vertices;
    vertices.fill(kNone);
    const size_t before = g_.positions.size();
    for (int s = 0; s < 12; ++s) {
      dvec3 sum(0);
      int count = 0;
      for (size_t e = 0; e < 12; ++e)
        if (sheet[e] == s) {
          sum += crossing[e];
          ++count;
          vertices[e] = uint32_t(g_.positions.size());
        }
      if (count) g_.addVertex(sum / double(count), dvec3(0));
    }
    if (g_.positions.size() == before) return;
    cells_[index(cell)] = uint32_t(vertices_.size());
    vertices_.push_back(vertices);
  }

  /// Onto the surface, by Newton's method; at most half a cell away, where the grid is too coarse for the field.
  dvec3 onSurface(dvec3 p) const {
    const dvec3 start = p;
    for (int i = 0; i < 3; ++i) {
      const dvec3 slope = gradient(form_.field, p, kStep * cell_);
      p -= form_.field(p) / glm::dot(slope, slope) * slope;
    }
    const double way = glm::distance(p, start);
    return way > 0.5 * cell_ ? start + 0.5 * cell_ / way * (p - start) : p;
  }

  dvec3 area(size_t triangle) const {
    const auto at = [&](size_t k) { return g_.positions[g_.indices[triangle + k]]; };
    return 0.5 * glm::cross(at(1) - at(0), at(2) - at(0));
  }

  /// For every vertex the mean of those that share an edge with it.
  std::vector<dvec3> meanNeighbours() const {
    std::vector<dvec3> mean(g_.positions.size(), dvec3(0));
    std::vector<double> count(mean.size(), 0);
    for (size_t i = 0; i < g_.indices.size(); ++i) {
      const uint32_t from = g_.indices[i], to = g_.indices[i % 3 == 2 ? i - 2 : i + 1];
      mean[from] += g_.positions[to];
      count[from] += 1;
    }
    for (size_t i = 0; i < mean.size(); ++i) mean[i] /= count[i];
    return mean;
  }

  /// Evens out triangles; vertices stay on the surface.
  void relax() {
    const std::vector<dvec3> mean = meanNeighbours();
    for (size_t i = 0; i < mean.size(); ++i) g_.positions[i] = onSurface(mean[i]);
  }

  void addNormals() {
    for (size_t i = 0; i < g_.positions.size(); ++i)
      g_.normals[i] = glm::normalize(gradient(form_.field, g_.positions[i], kStep * cell_));
  }

  /// Where a crease or gap is narrower than a cell, triangles fold over: there the net is drawn taut, off the surface,
  /// and shaded by the mean of the triangles around. False when nothing was left to do.
  bool untangle() {
    std::vector<bool> folded(g_.positions.size(), false);
    std::vector<dvec3> around(g_.positions.size(), dvec3(0));
    bool any = false;
    for (size_t t = 0; t < g_.indices.size(); t += 3)
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t vertex = g_.indices[t + k];
        around[vertex] += area(t);
        if (glm::dot(g_.normals[vertex], glm::normalize(area(t))) > 0.35) continue;
        for (size_t all = 0; all < 3; ++all) folded[g_.indices[t + all]] = true;
        any = true;
      }
    const std::vector<dvec3> mean = meanNeighbours();
    for (size_t i = 0; i < mean.size(); ++i) {
      if (!folded[i]) continue;
      g_.positions[i] = mean[i];
      g_.normals[i] = glm::normalize(around[i]);
    }
    return any;
  }

  /// What is folded still has an edge there: its triangles get corners of their own.
  void sharpen() {
    for (size_t t = 0; t < g_.indices.size(); t += 3)
      for (size_t k = 0; k < 3; ++k) {
        uint32_t& vertex = g_.indices[t + k];
        const dvec3 face = glm::normalize(area(t));
        if (glm::dot(g_.normals[vertex], face) < 0.35) vertex = g_.addVertex(dvec3(g_.positions[vertex]), face);
      }
  }

  void addQuad(const glm::ivec3& from, int axis) {
    glm::ivec3 step(0), u(0), v(0);
    step[axis] = u[(axis + 1) % 3] = v[(axis + 2) % 3] = 1;
    if (inside(from) == inside(from + step)) return;
    const auto vertex = [&](int alongU, int alongV) { // of the cell that has this edge at those sides
      return vertices_[cells_[index(from - alongU * u - alongV * v)]][size_t(4 * axis + alongU + 2 * alongV)];
    };
    std::array<uint32_t, 4> quad{vertex(1, 1), vertex(0, 1), vertex(0, 0), vertex(1, 0)};
    if (!inside(from)) std::swap(quad[1], quad[3]);
    const auto apart = [&](int i, int k) {
      return glm::distance(g_.positions[quad[size_t(i)]], g_.positions[quad[size_t(k)]]);
    };
    const size_t first = apart(0, 2) <= apart(1, 3) ? 0 : 1; // cut along the shorter diagonal
    g_.addFace(quad[first], quad[first + 1], quad[(first + 2) % 4], quad[(first + 3) % 4]);
  }

  static constexpr double kStep = 0.05; // of slopes, in cells
  static constexpr uint32_t kNone = 0xffffffffu;
  const Form& form_;
  double cell_;
  dvec3 lo_;
  glm::ivec3 size_; // samples along each axis
  std::vector<double> values_;
  std::vector<uint32_t> cells_;                    // index into vertices_, by the lowest corner of the cell
  std::vector<std::array<uint32_t, 12>> vertices_; // by the cell's edge
  Geometry g_;
};

} // namespace

double joined(double a, double b, double round) {
  const double h = std::max(round - std::abs(a - b), 0.0) / round;
  return std::min(a, b) - 0.25 * h * h * round;
}

Form limbs(std::vector<Limb> parts) {
  Form form{nullptr, dvec3(1e9), dvec3(-1e9)};
  for (const Limb& l : parts) {
    if (l.carve) continue;
    form.lo = glm::min(form.lo, glm::min(l.a - l.ra, l.b - l.rb) - 0.25 * l.blend);
    form.hi = glm::max(form.hi, glm::max(l.a + l.ra, l.b + l.rb) + 0.25 * l.blend);
  }
  form.field = [parts = std::move(parts)](const dvec3& p) {
    double d = distanceTo(parts[0], p);
    for (size_t i = 1; i < parts.size(); ++i) {
      const double part = distanceTo(parts[i], p);
      d = parts[i].carve ? -joined(-d, part, parts[i].blend) : joined(d, part, parts[i].blend);
    }
    return d;
  };
  return form;
}

Geometry meshed(const Form& form, double cell) { return Net(form, cell).surface(); }

Form recliningFigure() {
  return limbs({
      {{0.22, 0.24, 0.0}, {-0.4, 0.6, 0.0}, 0.2, 0.19, 0.1},         // trunk
      {{-0.46, 0.66, -0.22}, {-0.46, 0.66, 0.22}, 0.11, 0.11, 0.16}, // shoulders
      {{-0.48, 0.72, 0.0}, {-0.52, 0.86, 0.0}, 0.07, 0.06, 0.08},    // neck
      {{-0.54, 0.92, 0.0}, {-0.5, 0.94, 0.0}, 0.1, 0.09, 0.05},      // head
      {{-0.48, 0.64, 0.26}, {-0.74, 0.1, 0.3}, 0.085, 0.07, 0.08},   // the arm it leans on
      {{-0.74, 0.1, 0.3}, {-0.34, 0.05, 0.34}, 0.075, 0.055, 0.06},
      {{-0.46, 0.66, -0.26}, {-0.06, 0.56, -0.34}, 0.085, 0.065, 0.08}, // the other one, on its thigh
      {{-0.06, 0.56, -0.34}, {0.4, 0.52, -0.16}, 0.065, 0.05, 0.06},
      {{0.22, 0.26, -0.1}, {0.66, 0.66, -0.12}, 0.17, 0.12, 0.14}, // raised leg
      {{0.66, 0.66, -0.12}, {0.9, 0.06, -0.12}, 0.115, 0.065, 0.07},
      {{0.88, 0.05, -0.12}, {1.08, 0.04, -0.12}, 0.065, 0.055, 0.06},
      {{0.22, 0.2, 0.12}, {0.78, 0.15, 0.2}, 0.17, 0.12, 0.14}, // lying leg
      {{0.78, 0.15, 0.2}, {1.3, 0.07, 0.14}, 0.115, 0.065, 0.08},
      {{-0.12, 0.36, -0.6}, {-0.12, 0.36, 0.6}, 0.085, 0.085, 0.1, true}, // pierced below the breast
  });
}

Form drapedFigure() {
  Form body = limbs({
      {{0.0, 0.95, 0.0}, {0.03, 1.3, 0.0}, 0.125, 0.13, 0.12},       // trunk
      {{-0.14, 1.38, 0.0}, {0.19, 1.41, 0.02}, 0.07, 0.07, 0.12},    // shoulders
      {{0.03, 1.4, 0.0}, {0.04, 1.55, 0.01}, 0.055, 0.048, 0.06},    // neck
      {{0.045, 1.64, 0.02}, {0.04, 1.7, 0.0}, 0.085, 0.095, 0.03},   // head
      {{0.04, 1.7, -0.07}, {0.04, 1.66, -0.11}, 0.05, 0.05, 0.05},   // knot of hair
      {{-0.16, 1.37, 0.0}, {-0.27, 1.08, 0.02}, 0.065, 0.056, 0.06}, // arm that hangs, hand at the hip
      {{-0.27, 1.08, 0.02}, {-0.15, 0.9, 0.14}, 0.056, 0.05, 0.04},
      {{0.21, 1.39, 0.02}, {0.31, 1.12, 0.1}, 0.065, 0.056, 0.06}, // arm that is bent
      {{0.31, 1.12, 0.1}, {0.12, 1.22, 0.24}, 0.056, 0.05, 0.04},
  });
  // The skirt's folds deepen and spread towards the floor.
  const Field trunk = body.field;
  body.field = [trunk](const dvec3& p) {
    const double down = glm::clamp((0.98 - p.y) / 1.0, 0.0, 1.0);
    const double angle = std::atan2(p.z, p.x);
    const double folds = std::cos(9 * angle + 2.2 * down) + 0.5 * std::cos(5 * angle - 3 * down);
    const double radius = 0.135 + 0.035 * down + 0.1 * down * down * down + 0.02 * down * folds;
    const double side = std::hypot(p.x - 0.02 * down, 1.15 * p.z) - radius;
    const double skirt =
        0.7 * -joined(-side, 0.5 - std::abs(p.y - 0.48), 0.05); // side slopes by more than one per metre
    return joined(trunk(p), skirt, 0.08);
  };
  body.lo = {-0.4, -0.08, -0.36};
  body.hi = {0.42, 1.84, 0.36};
  return body;
}

Form piercedForm() {
  return limbs({
      {{0.0, 0.1, 0.0}, {-0.04, 0.42, 0.0}, 0.12, 0.23, 0.1},
      {{-0.04, 0.42, 0.0}, {0.04, 0.8, 0.0}, 0.25, 0.33, 0.2},
      {{0.12, 0.76, -0.7}, {-0.02, 0.68, 0.7}, 0.13, 0.19, 0.12, true},
      {{-0.42, 0.38, 0.55}, {-0.22, 0.52, 0.22}, 0.2, 0.1, 0.12, true},
  });
}

Form bird() {
  return limbs({
      {{0.0, 0.08, 0.0}, {0.0, 0.1, 0.0}, 0.1, 0.09, 0.05},
      {{0.0, 0.12, 0.0}, {-0.02, 0.38, 0.0}, 0.065, 0.045, 0.08},
      {{-0.02, 0.38, 0.0}, {-0.02, 0.85, 0.0}, 0.05, 0.125, 0.1},
      {{-0.02, 0.85, 0.0}, {0.06, 1.25, 0.0}, 0.125, 0.08, 0.2},
      {{0.06, 1.25, 0.0}, {0.15, 1.5, 0.0}, 0.08, 0.035, 0.2},
  });
}

Form growth() {
  return limbs({
      {{0.05, 0.2, 0.02}, {-0.12, 0.26, 0.1}, 0.22, 0.2, 0.1},
      {{0.18, 0.28, -0.08}, {0.22, 0.44, -0.1}, 0.2, 0.16, 0.12},
      {{-0.08, 0.3, 0.05}, {-0.12, 0.6, -0.02}, 0.2, 0.19, 0.16},
      {{-0.12, 0.6, -0.02}, {-0.26, 0.74, 0.06}, 0.17, 0.13, 0.14},
      {{-0.06, 0.62, -0.04}, {0.08, 0.86, -0.06}, 0.16, 0.13, 0.14},
      {{0.08, 0.86, -0.06}, {0.1, 0.98, -0.02}, 0.12, 0.11, 0.1},
      {{0.3, 0.5, 0.3}, {0.1, 0.56, 0.14}, 0.16, 0.08, 0.1, true},
  });
}

Form gourd() {
  Form form;
  form.field = [](const dvec3& q) {
    const dvec3 p = q - dvec3(0, 0.42, 0);
    const double length = std::max(glm::length(p), 1e-6), up = p.y / length, across2 = 1 - up * up;
    const double ribs = std::cos(9 * std::atan2(p.z, p.x) + 5 * up);
    return 0.6 * (length - 0.4 - 0.05 * up * up - 0.045 * across2 * across2 * ribs + 0.03 * across2 * std::sin(4 * up));
  };
  form.lo = {-0.48, -0.06, -0.48};
  form.hi = {0.48, 0.9, 0.48};
  return form;
}

} // namespace lambent::content

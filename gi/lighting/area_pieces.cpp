#include "gi/lighting/area_pieces.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

namespace lambent {

namespace {

constexpr float kSame = 1e-4f; // of the lengths at hand

int sides(const AreaPiece& p) { return int(p.corners[0].w); }
vec3 corner(const AreaPiece& p, int i) { return vec3(p.corners[i % sides(p)]); }

AreaPiece pieceOfTriangle(const EmitterTriangle& t, bool doubleSided) {
  AreaPiece piece{};
  // The front may be the other side than the corners say, under mirroring transforms.
  const bool turned = glm::dot(glm::cross(t.e1, t.e2), t.normal) < 0;
  piece.corners[0] = vec4(t.p0, 3);
  piece.corners[1] = vec4(t.p0 + (turned ? t.e2 : t.e1), 0);
  piece.corners[2] = vec4(t.p0 + (turned ? t.e1 : t.e2), 0);
  piece.normalArea = vec4(t.normal, t.area);
  piece.radianceSides = vec4(t.radiance, doubleSided ? 1 : 0);
  return piece;
}

AreaPiece withCorners(const AreaPiece& like, std::initializer_list<vec3> corners, float area) {
  AreaPiece piece = like;
  size_t i = 0;
  for (const vec3& c : corners) piece.corners[i++] = vec4(c, 0);
  piece.corners[0].w = float(corners.size());
  piece.normalArea.w = area;
  return piece;
}

/// Pieces that grow together along their common edges.
class Merger {
 public:
  explicit Merger(std::vector<AreaPiece> pieces) : pieces_(std::move(pieces)), into_(pieces_.size()) {
    std::iota(into_.begin(), into_.end(), 0u);
    for (const AreaPiece& p : pieces_)
      for (int i = 0; i < 3; ++i) box_.add(corner(p, i));
    for (uint32_t i = 0; i < pieces_.size(); ++i) enter(i);
  }

  /// Calls join(a, b, e, f, result) for pieces that share a's edge e, which is b's edge f, until none says yes.
  template <class Join> void run(const Join& join) {
    for (uint32_t i = 0; i < pieces_.size(); ++i)
      while (into_[i] == i && grow(i, join)) {
      }
  }

  std::vector<AreaPiece> result(std::vector<uint32_t>& of) const {
    std::vector<AreaPiece> out;
    std::vector<uint32_t> number(pieces_.size(), 0);
    for (uint32_t i = 0; i < pieces_.size(); ++i)
      if (into_[i] == i) number[i] = uint32_t(out.size()), out.push_back(pieces_[i]);
    of.clear();
    for (uint32_t i = 0; i < pieces_.size(); ++i) {
      uint32_t root = i;
      while (into_[root] != root) root = into_[root];
      of.push_back(number[root]);
    }
    return out;
  }

 private:
  using Point = std::array<int, 3>;
  using Edge = std::pair<Point, Point>;

  Point pointOf(const vec3& p) const {
    const vec3 at = glm::round((p - box_.lo) / std::max(maxComponent(box_.size()) * kSame, 1e-30f));
    return {int(at.x), int(at.y), int(at.z)};
  }
  Edge edgeOf(const AreaPiece& p, int i) const {
    const Point a = pointOf(corner(p, i)), b = pointOf(corner(p, i + 1));
    return {std::min(a, b), std::max(a, b)};
  }
  void enter(uint32_t i) {
    for (int e = 0; e < sides(pieces_[i]); ++e) edges_[edgeOf(pieces_[i], e)].push_back(i);
  }
  void leave(uint32_t i) {
    for (int e = 0; e < sides(pieces_[i]); ++e) std::erase(edges_[edgeOf(pieces_[i], e)], i);
  }

  template <class Join> bool grow(uint32_t i, const Join& join) {
    for (int e = 0; e < sides(pieces_[i]); ++e) {
      const Edge edge = edgeOf(pieces_[i], e);
      for (const uint32_t other : edges_[edge]) {
        if (other == i) continue;
        const AreaPiece &a = pieces_[i], &b = pieces_[other];
        if (a.radianceSides != b.radianceSides || glm::dot(vec3(a.normalArea), vec3(b.normalArea)) < 0.99999f) continue;
        for (int f = 0; f < sides(b); ++f) {
          AreaPiece joined;
          if (edgeOf(b, f) != edge || !join(a, b, e, f, joined)) continue;
          leave(i);
          leave(other);
          into_[other] = i;
          pieces_[i] = joined;
          enter(i);
          return true;
        }
      }
    }
    return false;
  }

  std::vector<AreaPiece> pieces_;
  std::vector<uint32_t> into_; // itself, or whom it has become part of
  std::map<Edge, std::vector<uint32_t>> edges_;
  Aabb box_;
};

bool isLongest(const AreaPiece& triangle, int edge) {
  const auto length = [&](int i) { return glm::distance(corner(triangle, i), corner(triangle, i + 1)); };
  return length(edge) >= 0.999f * std::max(length(edge + 1), length(edge + 2));
}

/// Two triangles to a parallelogram.
bool joinTriangles(const AreaPiece& a, const AreaPiece& b, int e, int f, AreaPiece& to) {
  if (sides(a) != 3 || sides(b) != 3) return false;
  const vec3 from = corner(a, e), next = corner(a, e + 1), off = corner(a, e + 2), fourth = corner(b, f + 2);
  const float length = glm::distance(from, next),
              width = 2 * a.normalArea.w / std::max(length, glm::distance(next, off));
  if (glm::distance(from + next - off, fourth) > std::min(kSame * length, 0.01f * width)) return false;
  to = withCorners(a, {off, from, fourth, next}, a.normalArea.w + b.normalArea.w);
  return true;
}

/// Two parallelograms to a longer one.
bool joinParallelograms(const AreaPiece& a, const AreaPiece& b, int e, int f, AreaPiece& to) {
  if (sides(a) != 4 || sides(b) != 4) return false;
  const vec3 inward = corner(a, e + 2) - corner(a, e + 1), onward = corner(b, f + 2) - corner(b, f + 1);
  if (glm::dot(inward, onward) >= 0 ||
      glm::length(glm::cross(inward, onward)) > kSame * glm::length(inward) * glm::length(onward))
    return false;
  to = withCorners(a, {corner(a, e) + onward, corner(a, e + 1) + onward, corner(a, e + 2), corner(a, e + 3)},
                   a.normalArea.w + b.normalArea.w);
  return true;
}

/// A piece, the points on it, and how unevenly these shine.
struct Patch {
  AreaPiece piece;
  std::vector<uint32_t> points;
  double error = 0; // Σ (luminance − mean)² · area
};

void measure(Patch& patch, std::span<const SurfaceLight> points) {
  patch.error = 0;
  if (patch.points.empty()) return; // the radiance of what it was part of
  dvec3 sum(0);
  double area = 0;
  for (uint32_t i : patch.points) {
    sum += dvec3(points[i].radiance) * double(points[i].area);
    area += points[i].area;
  }
  const vec3 mean = vec3(sum / area);
  patch.piece.radianceSides = vec4(mean, patch.piece.radianceSides.w);
  for (uint32_t i : patch.points) {
    const double off = luminance(points[i].radiance) - luminance(mean);
    patch.error += off * off * points[i].area;
  }
}

/// Halves of a piece: of a parallelogram across edge 0 or 1, of a triangle across any.
std::array<Patch, 2> halved(const Patch& patch, int across, std::span<const SurfaceLight> points) {
  const AreaPiece& p = patch.piece;
  const vec3 from = corner(p, across), to = corner(p, across + 1), middle = 0.5f * (from + to);
  std::array<Patch, 2> halves;
  vec3 cut; // along the border of the halves
  if (sides(p) == 3) {
    const vec3 off = corner(p, across + 2);
    cut = off - middle;
    halves[0].piece = withCorners(p, {from, middle, off}, 0.5f * p.normalArea.w);
    halves[1].piece = withCorners(p, {middle, to, off}, 0.5f * p.normalArea.w);
  } else {
    const vec3 next = corner(p, across + 2), last = corner(p, across + 3), opposite = 0.5f * (next + last);
    cut = opposite - middle;
    halves[0].piece = withCorners(p, {from, middle, opposite, last}, 0.5f * p.normalArea.w);
    halves[1].piece = withCorners(p, {middle, to, next, opposite}, 0.5f * p.normalArea.w);
  }
  const vec3 plane = glm::cross(glm::cross(to - from, cut), cut); // normal of the cut, in the piece's plane
  const float first = glm::dot(from - middle, plane);
  for (uint32_t i : patch.points)
    halves[glm::dot(points[i].position - middle, plane) * first > 0 ? 0 : 1].points.push_back(i);
  for (Patch& half : halves) measure(half, points);
  return halves;
}

std::array<Patch, 2> halvedBest(const Patch& patch, std::span<const SurfaceLight> points) {
  std::array<Patch, 2> best;
  double least = kInfinity;
  for (int across = 0; across < sides(patch.piece) - (sides(patch.piece) == 4 ? 2 : 0); ++across) {
    std::array<Patch, 2> halves = halved(patch, across, points);
    // Of two that help alike, the one that leaves the more compact pieces.
    const double length = glm::distance(corner(patch.piece, across), corner(patch.piece, across + 1));
    const double error = (halves[0].error + halves[1].error + 0.1 * patch.error) / length;
    if (error < least) least = error, best = std::move(halves);
  }
  return best;
}

} // namespace

std::vector<AreaPiece> mergedPieces(std::span<const EmitterTriangle> triangles, bool doubleSided,
                                    std::vector<uint32_t>& of) {
  std::vector<AreaPiece> pieces;
  for (const EmitterTriangle& t : triangles) pieces.push_back(pieceOfTriangle(t, doubleSided));
  Merger merger(std::move(pieces));
  // First across diagonals: in a mesh of squares any two neighbours would do, and leave slanting rows.
  merger.run([](const AreaPiece& a, const AreaPiece& b, int e, int f, AreaPiece& to) {
    return sides(a) == 3 && sides(b) == 3 && isLongest(a, e) && isLongest(b, f) && joinTriangles(a, b, e, f, to);
  });
  merger.run(joinTriangles);
  // Then rows, all along one direction, then these to each other.
  vec3 along(0);
  merger.run([&](const AreaPiece& a, const AreaPiece& b, int e, int f, AreaPiece& to) {
    if (!joinParallelograms(a, b, e, f, to)) return false;
    const vec3 way = glm::normalize(corner(a, e + 2) - corner(a, e + 1));
    if (along == vec3(0)) along = way;
    return std::abs(glm::dot(way, along)) > 0.7f;
  });
  merger.run(joinParallelograms);
  return merger.result(of);
}

std::vector<AreaPiece> piecesByRadiance(std::vector<AreaPiece> pieces, std::span<const SurfaceLight> points,
                                        std::span<const uint32_t> pieceOf, size_t most) {
  constexpr double kEven = 1e-4; // of the light's squared mean
  std::vector<Patch> patches;
  for (const AreaPiece& p : pieces) patches.push_back({p, {}, 0});
  double sum = 0, area = 0;
  for (uint32_t i = 0; i < points.size(); ++i) {
    patches[pieceOf[points[i].triangle]].points.push_back(i);
    sum += luminance(points[i].radiance) * points[i].area;
    area += points[i].area;
  }
  for (Patch& patch : patches) measure(patch, points);
  const double even = kEven * sum * sum / std::max(area, 1e-30);
  while (patches.size() < most) {
    const auto worst = std::ranges::max_element(patches, {}, &Patch::error);
    if (worst == patches.end() || !(worst->error > even)) break;
    std::array<Patch, 2> halves = halvedBest(*worst, points);
    *worst = std::move(halves[0]);
    patches.push_back(std::move(halves[1]));
  }
  pieces.clear();
  for (const Patch& patch : patches)
    if (luminance(vec3(patch.piece.radianceSides)) > 0) pieces.push_back(patch.piece);
  return pieces;
}

} // namespace lambent

// No two faces fight for the same pixels: where triangles of different solids lie in one plane, face the same way and
// overlap, at most one of them may be in sight.
#include "tests/content/placed.h"
#include "tests/content/written.h"

namespace lambent::test::coplanar_test {

constexpr double kSamePlane = 1e-3;    // metres
constexpr double kLeastOverlap = 1e-4; // m², a square of 1 cm

using Polygon = std::vector<dvec2>;

double cross(const dvec2& a, const dvec2& b) { return a.x * b.y - a.y * b.x; }

/// The part of `polygon` to the left of the line from a to b.
Polygon clipped(const Polygon& polygon, const dvec2& a, const dvec2& b) {
  Polygon out;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const dvec2 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double dp = cross(b - a, p - a), dq = cross(b - a, q - a);
    if (dp >= 0) out.push_back(p);
    if ((dp > 0 && dq < 0) || (dp < 0 && dq > 0)) out.push_back(p + dp / (dp - dq) * (q - p));
  }
  return out;
}

double area(const Polygon& p) {
  double twice = 0;
  for (size_t i = 0; i + 1 < p.size(); ++i) twice += cross(p[i] - p[0], p[i + 1] - p[0]);
  return 0.5 * twice;
}

/// A triangle in the coordinates of its plane, counter-clockwise, and its extent along the first axis.
struct Flat {
  const PlacedTriangle* source;
  double offset; // of the plane along its normal, metres
  Polygon corners;
  double lo, hi;
};

/// Axes of the plane; the same for all triangles whose rounded normal is `normal`.
std::pair<dvec3, dvec3> axes(const dvec3& normal) {
  const dvec3 helper = std::abs(normal.y) < 0.5 ? dvec3(0, 1, 0) : dvec3(1, 0, 0);
  const dvec3 u = glm::normalize(glm::cross(helper, normal));
  return {u, glm::cross(normal, u)};
}

using Key = std::array<long, 4>; // rounded normal and plane offset

/// Pairs of mesh names whose faces fight, with one place each.
std::map<std::string, dvec3> fights(const PlacedScene& scene) {
  constexpr double kNormalSteps = 250;
  std::map<Key, std::vector<Flat>> planes;
  for (const PlacedTriangle& t : scene.triangles()) {
    // A sheet is seen from both sides.
    for (int side = 0; side < (t.sheet ? 2 : 1); ++side) {
      const dvec3 n = side ? -t.normal : t.normal;
      const dvec3 rounded = glm::round(n * kNormalSteps);
      const auto [u, v] = axes(glm::normalize(rounded));
      Flat flat{&t, glm::dot(n, t.corner[0]), {}, 1e30, -1e30};
      for (const dvec3& c : t.corner) flat.corners.emplace_back(glm::dot(c, u), glm::dot(c, v));
      if (area(flat.corners) < 0) std::swap(flat.corners[1], flat.corners[2]);
      for (const dvec2& c : flat.corners) {
        flat.lo = std::min(flat.lo, c.x);
        flat.hi = std::max(flat.hi, c.x);
      }
      const Key key{std::lround(rounded.x), std::lround(rounded.y), std::lround(rounded.z),
                    std::lround(flat.offset / (4 * kSamePlane))};
      planes[key].push_back(flat);
      // Into the next cell too when it is close to its border, so that no pair is missed.
      for (const long step : {-1L, 1L})
        if (std::lround((flat.offset + double(step) * kSamePlane) / (4 * kSamePlane)) != key[3])
          planes[{key[0], key[1], key[2], key[3] + step}].push_back(flat);
    }
  }

  std::map<std::string, dvec3> found;
  for (auto& [key, flats] : planes) {
    const dvec3 normal = glm::normalize(dvec3(key[0], key[1], key[2]));
    const auto [u, v] = axes(normal);
    std::sort(flats.begin(), flats.end(), [](const Flat& a, const Flat& b) { return a.lo < b.lo; });
    for (size_t i = 0; i < flats.size(); ++i)
      for (size_t j = i + 1; j < flats.size() && flats[j].lo < flats[i].hi; ++j) {
        const Flat &a = flats[i], &b = flats[j];
        if (a.source == b.source || a.source->material == b.source->material) continue;
        if (std::abs(a.offset - b.offset) > kSamePlane) continue;
        Polygon common = a.corners;
        for (size_t k = 0; k < 3 && !common.empty(); ++k)
          common = clipped(common, b.corners[k], b.corners[(k + 1) % 3]);
        if (common.size() < 3 || area(common) < kLeastOverlap) continue;
        std::string pair = scene.meshName(*a.source), other = scene.meshName(*b.source);
        if (pair > other) std::swap(pair, other);
        pair += " / " + other;
        if (found.contains(pair)) continue;
        dvec2 middle(0);
        for (const dvec2& c : common) middle += c / double(common.size());
        const double above = std::max(a.offset, b.offset) + 2 * kSamePlane;
        const dvec3 place = middle.x * u + middle.y * v + above * normal;
        if (!scene.inSolid(place)) found[pair] = place; // else both are walled in
      }
  }
  return found;
}

class Coplanar : public testing::TestWithParam<ContentRecipe> {};

TEST_P(Coplanar, NoTwoMaterialsShareAFace) {
  SKIP_WHERE_TOO_LARGE(GetParam());
  const PlacedScene scene(loadScene(written(GetParam()).scene.file));
  for (const auto& [pair, at] : fights(scene))
    ADD_FAILURE() << pair << " at " << at.x << ", " << at.y << ", " << at.z << " (sink one into the other by 1 cm)";
}

INSTANTIATE_TEST_SUITE_P(Recipes, Coplanar, testing::ValuesIn(testedRecipes()),
                         [](const auto& info) { return testName(info.param.name); });

} // namespace lambent::test::coplanar_test

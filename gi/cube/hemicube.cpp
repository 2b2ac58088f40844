#include "gi/cube/hemicube.h"

#include "shaders/shared/paraboloid.h"

#include <algorithm>
#include <cmath>

namespace lambent {

vec3 Hemicube::direction(int face, vec2 at) const {
  const HemicubeFace& f = kHemicubeFaces[face];
  const float x = 2 * at.x / float(resolution) - 1;
  const float y =
      face == 0 ? 2 * at.y / float(resolution) - 1 : 2 * at.y / float(resolution); // sides: from the horizon
  return glm::normalize(frame * (f.forward + x * f.right + y * f.up));
}

bool Hemicube::find(const vec3& direction, int& face, vec2& at) const {
  const vec3 d = direction * frame; // transposed: to the light's frame
  if (!(d.z > 0)) return false;
  const vec3 a = glm::abs(d);
  face = d.z >= a.x && d.z >= a.y ? 0 : a.x >= a.y ? (d.x > 0 ? 1 : 2) : (d.y > 0 ? 3 : 4);
  const HemicubeFace& f = kHemicubeFaces[face];
  const float z = glm::dot(d, f.forward), half = 0.5f * float(resolution);
  at.x = (glm::dot(d, f.right) / z + 1) * half;
  at.y = face == 0 ? (glm::dot(d, f.up) / z + 1) * half : glm::dot(d, f.up) / z * half;
  return true;
}

Hemicube hemicubeAt(const VirtualLight& light, int resolution, float rayEpsilon) {
  Hemicube h;
  h.resolution = resolution;
  h.origin = light.pose(rayEpsilon).origin();
  h.frame[2] = light.normal;
  basisAround(light.normal, h.frame[0], h.frame[1]);
  h.texels.resize(h.size());
  return h;
}

void castHemicube(Hemicube& hemicube, const RayQuery& rays, RayCounts& counts) {
  std::vector<Ray> asked;
  std::vector<SurfaceHit> hits;
  for (int face = 0; face < 5; ++face)
    for (int y = 0; y < hemicube.rows(face); ++y) {
      asked.clear();
      for (int x = 0; x < hemicube.resolution; ++x)
        asked.push_back({hemicube.origin, hemicube.direction(face, vec2(x, y) + 0.5f)});
      hits.resize(asked.size());
      rays.closest(asked, hits);
      counts.closest += asked.size();
      HemicubeTexel* row = &hemicube.at(face, 0, y);
      for (size_t x = 0; x < hits.size(); ++x)
        row[x] = hits[x].valid() ? HemicubeTexel{hits[x].t, hits[x].geometricNormal} : HemicubeTexel{};
    }
}

namespace {

constexpr float kAround = 0.5f; // texels of the hemicube, of what a texel's surface goes on to
constexpr int kWidest = 64;     // texels of a cube; where a surface is seen edge-on

/// What a texel sees, and how far that may reach.
struct Splat {
  const Hemicube& hemicube;
  int face;
  vec2 texel; // its middle, in texels of the face
  vec3 normal, middle;
  Aabb box;

  Splat(const Hemicube& h, int face_, int x, int y, const HemicubeTexel& t, float widestTexel)
      : hemicube(h), face(face_), texel(vec2(x, y) + 0.5f), normal(t.normal),
        middle(h.origin + t.distance * h.direction(face_, texel)) {
    // Where its corners meet the surface's plane.
    box.add(middle);
    const float height = glm::dot(middle - h.origin, normal), reach = float(kWidest) * widestTexel + t.distance;
    for (const vec2 corner : {vec2(-1, -1), vec2(1, -1), vec2(-1, 1), vec2(1, 1)}) {
      const vec3 d = h.direction(face, texel + corner * (0.5f + kAround));
      const float towards = glm::dot(d, normal);
      box.add(h.origin + d * (towards * reach < height ? std::min(height / towards, reach) : reach));
    }
  }

  bool mayLieIn(const CubeNode& node, int resolution) const {
    const vec3 hi = node.corner + float(resolution) * node.texel;
    return glm::all(glm::lessThanEqual(box.lo, hi)) && glm::all(glm::lessThanEqual(node.corner, box.hi));
  }

  /// The entries of a cube, with numbers from `firstColumn` on.
  void mark(const CubeSurfaces& surfaces, const CubeGrid& grid, size_t firstColumn, std::vector<uint8_t>& seen) const {
    constexpr float kSameSurface = 0.5f; // texels of the cube
    const int axes = axesOf(normal);
    for (int axis = 0; axis < 3; ++axis) {
      if (!(axes >> axis & 1)) continue;
      const auto texels = [&](const vec3& p, int along) {
        return int(
            std::floor(std::clamp((p[along] - grid.corner[along]) / grid.texel, 0.0f, float(grid.resolution - 1))));
      };
      const int a = (axis + 1) % 3, b = (axis + 2) % 3;
      const ivec2 at(texels(middle, a), texels(middle, b));
      const ivec2 lo = glm::max(ivec2(texels(box.lo, a), texels(box.lo, b)), at - kWidest);
      const ivec2 hi = glm::min(ivec2(texels(box.hi, a), texels(box.hi, b)), at + kWidest);
      for (int v = lo.y; v <= hi.y; ++v)
        for (int u = lo.x; u <= hi.x; ++u) {
          const size_t column = firstColumn + grid.column(axis, u, v);
          for (uint32_t e = surfaces.firsts()[column]; e < surfaces.firsts()[column + 1]; ++e) {
            if (seen[e]) continue;
            const CubeEntry& entry = surfaces.entries()[e];
            int f;
            vec2 p;
            if (!matches(entry, middle, normal, kSameSurface * grid.texel) ||
                !hemicube.find(entry.position - hemicube.origin, f, p) || f != face)
              continue;
            const vec2 off = glm::abs(p - texel);
            if (std::max(off.x, off.y) <= 0.5f + kAround) seen[e] = 1;
          }
        }
    }
  }
};

} // namespace

void splat(const Hemicube& hemicube, const CubeSurfaces& surfaces, std::vector<uint8_t>& seen) {
  const std::span<const CubeNode> nodes = surfaces.nodes();
  const int resolution = surfaces.cubes().front().resolution;
  std::vector<uint32_t> open; // nodes of the tree
  for (int face = 0; face < 5; ++face)
    for (int y = 0; y < hemicube.rows(face); ++y)
      for (int x = 0; x < hemicube.resolution; ++x) {
        const HemicubeTexel& t = hemicube.at(face, x, y);
        if (!(t.distance < kInfinity)) continue;
        const Splat splat(hemicube, face, x, y, t, surfaces.texel());
        open.assign(1, 0);
        while (!open.empty()) {
          const CubeNode& node = nodes[open.back()];
          open.pop_back();
          if (node.children == 0) {
            splat.mark(surfaces, surfaces.cubes()[node.firstColumn / surfaces.columns()], node.firstColumn, seen);
            continue;
          }
          for (uint32_t i = node.children; i < node.children + 8; ++i)
            if (splat.mayLieIn(nodes[i], resolution)) open.push_back(i);
        }
      }
}

} // namespace lambent

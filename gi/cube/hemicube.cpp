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

Hemicube hemicubeAt(const VirtualLight& light, int resolution, float grain) {
  Hemicube h;
  h.resolution = resolution;
  h.origin = light.pose(grain).origin();
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

void splat(const Hemicube& hemicube, const CubeSurfaces& surfaces, std::vector<uint8_t>& seen) {
  constexpr float kAround = 0.5f;      // texels of the hemicube, of what a texel's surface goes on to
  constexpr float kSameSurface = 0.5f; // texels of the cube
  constexpr int kWidest = 64;          // texels of the cube; where a surface is seen edge-on
  const float texel = surfaces.texel();
  const int last = surfaces.resolution() - 1;
  for (int face = 0; face < 5; ++face)
    for (int y = 0; y < hemicube.rows(face); ++y)
      for (int x = 0; x < hemicube.resolution; ++x) {
        const HemicubeTexel& t = hemicube.at(face, x, y);
        if (!(t.distance < kInfinity)) continue;
        const vec3 middle = hemicube.origin + t.distance * hemicube.direction(face, vec2(x, y) + 0.5f);
        // Where its corners meet the surface's plane.
        Aabb box;
        box.add(middle);
        const float height = glm::dot(middle - hemicube.origin, t.normal);
        for (const vec2 corner :
             {vec2(-kAround), vec2(1 + kAround, -kAround), vec2(-kAround, 1 + kAround), vec2(1 + kAround)}) {
          const vec3 d = hemicube.direction(face, vec2(x, y) + corner);
          const float towards = glm::dot(d, t.normal);
          const float reach = float(kWidest) * texel + t.distance;
          box.add(hemicube.origin + d * (towards * reach < height ? std::min(height / towards, reach) : reach));
        }
        const int axes = CubeSurfaces::axesOf(t.normal);
        for (int axis = 0; axis < 3; ++axis) {
          if (!(axes >> axis & 1)) continue;
          const auto texels = [&](const vec3& p, int along) {
            return std::clamp(int(std::floor((p[along] - surfaces.corner()[along]) / texel)), 0, last);
          };
          const int a = (axis + 1) % 3, b = (axis + 2) % 3;
          const ivec2 at(texels(middle, a), texels(middle, b));
          const ivec2 lo = glm::max(ivec2(texels(box.lo, a), texels(box.lo, b)), at - kWidest);
          const ivec2 hi = glm::min(ivec2(texels(box.hi, a), texels(box.hi, b)), at + kWidest);
          for (int v = lo.y; v <= hi.y; ++v)
            for (int u = lo.x; u <= hi.x; ++u) {
              const size_t column = surfaces.column(axis, u, v);
              for (uint32_t e = surfaces.firsts()[column]; e < surfaces.firsts()[column + 1]; ++e) {
                if (seen[e]) continue;
                const CubeEntry& entry = surfaces.entries()[e];
                if (!CubeSurfaces::matches(entry, middle, t.normal, kSameSurface * texel)) continue;
                int f;
                vec2 p;
                if (!hemicube.find(entry.position - hemicube.origin, f, p) || f != face) continue;
                const vec2 off = glm::abs(p - (vec2(x, y) + 0.5f));
                if (std::max(off.x, off.y) <= 0.5f + kAround) seen[e] = 1;
              }
            }
        }
      }
}

} // namespace lambent

#include "gi/measure/lamp_truth.h"

#include "engine/core/parallel.h"
#include "engine/core/rng.h"
#include "engine/trace/embree_query.h"
#include "gi/lighting/light_set.h"

#include <algorithm>

namespace lambent {

namespace {

/// Triangles of lamps, and the sums of their power up to each.
struct Lamps {
  struct Triangle {
    EmitterTriangle t;
    bool doubleSided;
  };
  std::vector<Triangle> triangles;
  std::vector<float> upTo;

  explicit Lamps(const LightSet& lights) {
    for (const Emitter& e : lights.emitters)
      for (uint32_t i = 0; i < e.triangleCount; ++i) {
        const EmitterTriangle& t = lights.triangles[e.firstTriangle + i];
        const float power = luminance(t.radiance) * t.area;
        if (!(power > 0)) continue;
        triangles.push_back({t, e.doubleSided});
        upTo.push_back((upTo.empty() ? 0 : upTo.back()) + power);
      }
  }
};

} // namespace

LampTruth traceLamps(const SceneView& view, int rays) {
  const CameraView& camera = view.camera;
  EmbreeQuery query(*view.assets);
  query.update(view, true);
  const LightSet set = collectLights(view);
  const Lamps lamps(set);
  const Image black(camera.width, camera.height);
  LampTruth out{black, black, black, black};
  if (lamps.triangles.empty()) return out;
  const float all = lamps.upTo.back();
  parallelFor(size_t(camera.height), 1, [&](size_t begin, size_t end) {
    std::vector<Ray> segments;
    std::vector<vec3> light;
    std::vector<uint8_t> odd, blocked;
    for (int y = int(begin); y < int(end); ++y)
      for (int x = 0; x < camera.width; ++x) {
        const CameraRay seen =
            cameraRay(camera, (float(x) + 0.5f) / float(camera.width), (float(y) + 0.5f) / float(camera.height));
        const SurfaceHit hit = query.seen(Ray{seen.origin, seen.direction});
        if (!hit.valid() || maxComponent(hit.emission) > 0) continue;
        out.distance.at(x, y) = vec3(glm::dot(hit.position - camera.position(), -vec3(camera.worldFromView[2])));
        out.normal.at(x, y) = hit.normal;
        const vec3 origin = offsetPoint(hit.position, hit.geometricNormal, query.rayEpsilon());
        const vec3 shift = Rng(1, Stream::Reference, uint64_t(y) << 32 | uint64_t(x)).next3();
        segments.clear();
        light.clear();
        odd.clear();
        for (int i = 0; i < rays; ++i) {
          const vec3 u = additiveRecurrence3(uint32_t(i), shift);
          const float power = all * (float(i) + u.x) / float(rays);
          const size_t which = std::min(size_t(std::ranges::lower_bound(lamps.upTo, power) - lamps.upTo.begin()),
                                        lamps.triangles.size() - 1);
          const auto& [t, doubleSided] = lamps.triangles[which];
          const vec2 inside = u.y + u.z > 1 ? vec2(1 - u.y, 1 - u.z) : vec2(u.y, u.z);
          const vec3 at = t.p0 + inside.x * t.e1 + inside.y * t.e2, way = at - hit.position;
          const float r2 = std::max(glm::dot(way, way), 1e-20f), cosine = glm::dot(hit.normal, way);
          const float facing = -glm::dot(t.normal, way), cosineLight = doubleSided ? std::abs(facing) : facing;
          if (!(cosine > 0 && cosineLight > 0)) continue;
          segments.push_back(segment(origin, offsetPoint(at, facing < 0 ? -t.normal : t.normal, query.rayEpsilon())));
          const float density = luminance(t.radiance) / all; // of samples, per m²
          odd.push_back(i % 2);
          light.push_back(t.radiance * (cosine * cosineLight / (r2 * r2 * density * float(rays))));
        }
        blocked.resize(segments.size());
        query.occluded(segments, blocked);
        vec3 halves[2] = {vec3(0), vec3(0)};
        for (size_t i = 0; i < light.size(); ++i)
          if (!blocked[i]) halves[odd[i]] += light[i];
        out.light.at(x, y) = hit.albedo / kPi * (halves[0] + halves[1]);
        out.noise.at(x, y) = hit.albedo / kPi * glm::abs(halves[0] - halves[1]);
      }
  });
  return out;
}

} // namespace lambent

#include "engine/scene/ray_work.h"

#include "engine/core/sampling.h"
#include "engine/scene/placed_triangles.h"
#include "engine/view/surface_point.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

constexpr uint64_t kLookedAt = 1024;   // triangles that places are drawn among
constexpr size_t kMostBoxes = 1 << 15; // that a ray counts: far more than is let pass, and little memory
constexpr int kSteps = 3;              // of a walk

struct Ray {
  vec3 origin{0}, direction{0}; // unit
  float end = kInfinity;        // distance of the first surface that is not cut out
  vec3 normal{0};               // there; its length is of no account
  std::vector<float> boxes;     // distances at which it enters those of triangles
  std::vector<float> cutOut;    // distances of triangles that it passes
  bool full = false;            // has met so much that it looks no further

  void forgetBehindEnd() {
    std::erase_if(boxes, [&](float t) { return t > end; });
    std::erase_if(cutOut, [&](float t) { return t > end; });
  }
  float sum() const { return float(boxes.size()) + RayWork::kCutOut * float(cutOut.size()); }
};

/// Where a ray meets a triangle, and the weights of its second and third corner.
struct Meeting {
  float t;
  vec2 barycentric;
  vec3 normal;
};
std::optional<Meeting> meetingOf(const Ray& ray, const std::array<vec3, 3>& corners) {
  const vec3 edge1 = corners[1] - corners[0], edge2 = corners[2] - corners[0];
  const vec3 p = glm::cross(ray.direction, edge2);
  const float det = glm::dot(edge1, p);
  if (det == 0) return {};
  const vec3 s = ray.origin - corners[0];
  const float u = glm::dot(s, p) / det;
  if (!(u >= 0 && u <= 1)) return {};
  const vec3 q = glm::cross(s, edge1);
  const float v = glm::dot(ray.direction, q) / det;
  if (!(v >= 0 && u + v <= 1)) return {};
  return Meeting{glm::dot(edge2, q) / det, {u, v}, glm::cross(edge1, edge2)};
}

/// Follows rays to their ends. What is nearer than `skipped` is what a ray begins on.
class Tracing {
 public:
  explicit Tracing(const Scene& scene)
      : scene_(scene), placed_(scene), skipped_(1e-6f * worldBounds(scene).diameter()) {}

  void operator()(std::vector<Ray>& rays) {
    std::vector<Ray*> near; // the box that was last asked for
    const auto wanted = [&](const Aabb& box) {
      near.clear();
      for (Ray& ray : rays)
        if (!ray.full && entry(box, ray.origin, ray.direction, 0, ray.end)) near.push_back(&ray);
      return !near.empty();
    };
    placed_.forEachBlock(wanted, [&](const TriangleBlock& block) {
      auto primitive = block.mesh.primitives.begin(); // in the order of their triangles
      for (size_t i = block.begin; i < block.end; ++i) {
        while (i >= size_t(primitive->firstTriangle) + primitive->triangleCount) ++primitive;
        const std::array<vec3, 3> corners = block.corners(i);
        Aabb box;
        for (const vec3& c : corners) box.add(c);
        for (Ray* ray : near)
          if (const std::optional<float> from = entry(box, ray->origin, ray->direction, 0, ray->end)) {
            ray->boxes.push_back(*from);
            meet(*ray, block, *primitive, i, corners);
          }
      }
      for (Ray* ray : near) {
        if (ray->boxes.size() < kMostBoxes) continue;
        ray->forgetBehindEnd();
        ray->full = ray->boxes.size() >= kMostBoxes / 2;
      }
    });
    for (Ray& ray : rays) ray.forgetBehindEnd();
  }

 private:
  void meet(Ray& ray, const TriangleBlock& block, const Primitive& p, size_t triangle,
            const std::array<vec3, 3>& corners) const {
    const std::optional<Meeting> met = meetingOf(ray, corners);
    if (!met || !(met->t > skipped_ && met->t < ray.end)) return;
    const Material& material = scene_.assets.materials[p.material];
    if (material.alphaMode == AlphaMode::Mask) {
      const TrianglePlace place = trianglePlace(block.mesh, p, uint32_t(triangle - p.firstTriangle), met->barycentric);
      if (baseColourAt(scene_.assets, block.mesh, material, place).w < material.alphaCutoff) {
        ray.cutOut.push_back(met->t);
        return;
      }
    }
    ray.end = met->t, ray.normal = met->normal;
  }

  const Scene& scene_;
  PlacedTriangles placed_;
  float skipped_;
};

/// From in front of triangles: nobody looks into closed things.
std::vector<Ray> firstRays(const Scene& scene, Rng& random) {
  uint64_t all = 0;
  forEachPosed(scene, [&](const Mesh& mesh, const DeformedMesh*, const mat4&) { all += mesh.triangles.size(); });
  if (all == 0) return {};
  std::vector<uint64_t> drawn(kLookedAt);
  for (uint64_t& number : drawn) number = drawnBelow(all, random);
  std::ranges::sort(drawn);
  std::vector<std::array<vec3, 3>> triangles; // counter-clockwise, seen from in front
  std::vector<float> areas;
  uint64_t first = 0; // of the instance
  forEachPosed(scene, [&](const Mesh& mesh, const DeformedMesh* deformed, const mat4& worldFromObject) {
    for (; triangles.size() < drawn.size() && drawn[triangles.size()] < first + mesh.triangles.size();) {
      const size_t i = size_t(drawn[triangles.size()] - first);
      auto t = TriangleBlock{mesh, deformed, worldFromObject, i, i + 1, {}}.corners(i);
      if (glm::determinant(mat3(worldFromObject)) < 0) std::swap(t[1], t[2]);
      areas.push_back(float(glm::length(glm::cross(dvec3(t[1] - t[0]), dvec3(t[2] - t[0])))));
      triangles.push_back(t);
    }
    first += mesh.triangles.size();
  });
  const Distribution byArea{std::span<const float>(areas)};
  if (!(byArea.total() > 0)) return {};
  std::vector<Ray> rays(size_t(std::clamp<uint64_t>((uint64_t(1) << 24) / all, 16, 64)));
  for (Ray& ray : rays) {
    const auto& t = triangles[byArea.sample(random.next())];
    const vec2 b = sampleTriangle(random.next2());
    ray.origin = t[0] + b.x * (t[1] - t[0]) + b.y * (t[2] - t[0]);
    ray.direction = sampleCosineHemisphere(unitOr(glm::cross(t[1] - t[0], t[2] - t[0]), vec3(0, 1, 0)), random.next2());
  }
  return rays;
}

/// From where a ray ended, back into the space that it came through.
Ray onward(const Ray& ray, Rng& random) {
  const vec3 n = unitOr(ray.normal, -ray.direction);
  Ray next;
  next.origin = ray.origin + ray.end * ray.direction;
  next.direction = sampleCosineHemisphere(glm::dot(n, ray.direction) > 0 ? -n : n, random.next2());
  return next;
}

} // namespace

RayWork rayWork(const Scene& scene) {
  Rng random(1, Stream::RayWork, 0);
  std::vector<Ray> rays = firstRays(scene, random);
  Tracing trace(scene);
  RayWork work;
  float most = -1;
  size_t counted = 0;
  for (int step = 0; step < kSteps && !rays.empty(); ++step) {
    trace(rays);
    std::vector<Ray> next;
    for (const Ray& ray : rays) {
      const bool ended = ray.end < kInfinity && !ray.full;
      if (ended) next.push_back(onward(ray, random));
      if (step == 0 && ended) continue; // it leads to where light may be; one that leaves the scene, or is full, counts
      ++counted;
      work.boxes += float(ray.boxes.size()), work.cutOut += float(ray.cutOut.size());
      if (ray.sum() > most) most = ray.sum(), work.place = ray.origin;
    }
    rays = std::move(next);
  }
  if (counted > 0) work.boxes /= float(counted), work.cutOut /= float(counted);
  return work;
}

} // namespace lambent

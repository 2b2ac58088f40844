#include "engine/scene/ray_work.h"

#include "engine/core/error.h"
#include "engine/core/rng.h"
#include "engine/core/sampling.h"
#include "engine/scene/placed_triangles.h"
#include "engine/view/surface_point.h"
#include "shaders/shared/coverage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <unordered_map>

namespace lambent {

namespace {

constexpr size_t kMostBoxes = 1 << 15; // that a ray counts: far more than is let pass, and little memory
constexpr size_t kTries = 16;          // to begin where a triangle is not cut out
constexpr int kSteps = 3;              // of a walk
constexpr size_t kSent = 16;           // rays from each place that is seen

/// Where walks begin: in front of surfaces, drawn by their area; at the camera. What is small beside a scene, but is
/// what one looks at, is found by the second. What an eye looks through counts by itself.
enum Walk { kFromSurfaces, kFromCamera, kThroughBacks, kWalks };

struct Ray {
  Walk walk = kFromSurfaces;
  bool leads = false;           // only to where it ends: it keeps no lists, of which there would be too many
  bool looks = false;           // the camera's own: passes backs that are hidden, and keeps a list of them
  vec3 origin{0}, direction{0}; // unit
  float end = kInfinity;        // distance of the first surface that is not cut out
  vec3 normal{0};               // there; its length is of no account
  std::vector<float> boxes;     // distances at which it enters those of triangles
  std::vector<float> passed;    // distances of triangles that it passes
  size_t entered = 0;           // boxes, those behind its end too
  bool full = false;            // has met so much that it looks no further

  void forgetBehindEnd() {
    std::erase_if(boxes, [&](float t) { return t > end; });
    std::erase_if(passed, [&](float t) { return t > end; });
  }
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

const Primitive& primitiveOf(const Mesh& mesh, uint32_t triangle) {
  return *std::ranges::partition_point(mesh.primitives, [&](const Primitive& before) {
    return before.firstTriangle + before.triangleCount <= triangle; // they are in the order of their triangles
  });
}

/// Whether a triangle is masked, and cut out at a place of it, or blended, and not there for that key.
bool isCutOut(const SceneAssets& assets, const Mesh& mesh, uint32_t triangle, const vec2& barycentric, uint32_t key) {
  const Primitive& p = primitiveOf(mesh, triangle);
  const Material& material = assets.materials[p.material];
  if (material.alphaMode == AlphaMode::Opaque) return false;
  const float alpha = alphaAt(assets, mesh, material, trianglePlace(mesh, p, triangle - p.firstTriangle, barycentric));
  return !isThere(material, alpha, key, 0, triangle);
}

/// Follows rays to their ends.
class Tracing {
 public:
  explicit Tracing(const Scene& scene) : assets_(scene.assets), placed_(scene) {}

  void operator()(std::vector<Ray>& rays) {
    std::vector<Ray*> near; // the box that was last asked for
    const auto wanted = [&](const Aabb& box) {
      near.clear();
      for (Ray& ray : rays)
        if (!ray.full && entry(box, ray.origin, ray.direction, 0, ray.end)) near.push_back(&ray);
      return !near.empty();
    };
    placed_.forEachBlock(wanted, [&](const TriangleBlock& block) {
      for (const uint32_t i : block.triangles) {
        const std::array<vec3, 3> corners = block.corners(i);
        Aabb box;
        for (const vec3& c : corners) box.add(c);
        for (Ray* ray : near)
          if (const std::optional<float> from = entry(box, ray->origin, ray->direction, 0, ray->end)) {
            if (!ray->leads) ray->boxes.push_back(*from);
            ++ray->entered;
            meet(*ray, block, i, corners);
          }
      }
      for (Ray* ray : near) {
        if (ray->leads) ray->full = ray->entered >= kMostBoxes;
        if (ray->boxes.size() < kMostBoxes) continue;
        ray->forgetBehindEnd();
        ray->full = ray->boxes.size() >= kMostBoxes / 2;
      }
    });
    for (Ray& ray : rays) ray.forgetBehindEnd();
  }

 private:
  void meet(Ray& ray, const TriangleBlock& block, uint32_t triangle, const std::array<vec3, 3>& corners) const {
    const std::optional<Meeting> met = meetingOf(ray, corners);
    const float longest = std::max(glm::distance(corners[0], corners[1]), glm::distance(corners[0], corners[2]));
    const float skipped = 0x1p-16f * std::max(longest, maxComponent(glm::abs(ray.origin))); // what it begins on
    if (!met || !(met->t > skipped && met->t < ray.end)) return;
    if (ray.looks && isHiddenBack(block, triangle, glm::dot(met->normal, ray.direction))) {
      ray.passed.push_back(met->t);
    } else if (isCutOut(assets_, block.mesh, triangle, met->barycentric, rayKey(met->normal, ray.direction))) {
      if (!ray.leads) ray.passed.push_back(met->t);
    } else {
      ray.end = met->t, ray.normal = met->normal;
    }
  }

  /// `along`: of the ray's direction and the normal of the corners' winding in world space.
  bool isHiddenBack(const TriangleBlock& block, uint32_t triangle, float along) const {
    if (!assets_.materials[primitiveOf(block.mesh, triangle).material].backHidden) return false;
    return (along > 0) != (glm::determinant(mat3(block.worldFromObject)) < 0);
  }

  const SceneAssets& assets_;
  PlacedTriangles placed_;
};

/// From in front of a triangle (its corners in world space), at a place of it.
Ray rayFrom(std::array<vec3, 3> t, vec2 b, const mat4& worldFromObject, Rng& random) {
  if (glm::determinant(mat3(worldFromObject)) < 0) std::swap(t[1], t[2]), std::swap(b.x, b.y);
  const vec3 normal = unitOr(glm::cross(t[1] - t[0], t[2] - t[0]), vec3(0, 1, 0));
  Ray ray;
  ray.origin = t[0] + b.x * (t[1] - t[0]) + b.y * (t[2] - t[0]);
  ray.direction = sampleCosineHemisphere(normal, random.next2());
  return ray;
}

/// Of one triangle, and of all of a mesh; object space.
double areaOf(const Mesh& mesh, const std::vector<vec3>& positions, size_t triangle) {
  const uvec3& t = mesh.triangles[triangle];
  const dvec3 a(positions[t.x]), b(positions[t.y]), c(positions[t.z]);
  return 0.5 * glm::length(glm::cross(b - a, c - a));
}
double areaOf(const Mesh& mesh, const std::vector<vec3>& positions) {
  double area = 0;
  for (size_t i = 0; i < mesh.triangles.size(); ++i) area += areaOf(mesh, positions, i);
  return area;
}

/// By how much areas grow, in the mean over three directions.
double areaScale(const mat4& m) {
  const dvec3 x(m[0]), y(m[1]), z(m[2]);
  return (glm::length(glm::cross(x, y)) + glm::length(glm::cross(y, z)) + glm::length(glm::cross(z, x))) / 3;
}

/// Of each instance in turn, world space.
std::vector<double> areasOfInstances(const Scene& scene) {
  std::vector<double> areas;
  std::unordered_map<const Mesh*, double> ofRigid; // object space
  forEachPosed(scene, [&](const Mesh& mesh, const DeformedMesh* deformed, const mat4& worldFromObject) {
    double area = 0;
    if (deformed) {
      area = areaOf(mesh, deformed->positions);
    } else {
      const auto [known, first] = ofRigid.try_emplace(&mesh, 0);
      if (first) known->second = areaOf(mesh, mesh.positions);
      area = known->second;
    }
    areas.push_back(area * areaScale(worldFromObject));
  });
  return areas;
}

/// From in front of triangles, drawn by their area: nobody looks into closed things. From where they are cut out, none.
std::vector<Ray> surfaceRays(const Scene& scene, const std::vector<double>& areas, size_t wanted, Rng& random) {
  double all = 0;
  for (const double area : areas) all += area;
  std::vector<double> drawn(kTries * wanted);
  for (double& d : drawn) d = all * double(random.next());
  std::ranges::sort(drawn);
  std::vector<Ray> rays;
  auto next = drawn.begin();
  double before = 0; // area of the instances before
  auto area = areas.begin();
  forEachPosed(scene, [&](const Mesh& mesh, const DeformedMesh* deformed, const mat4& worldFromObject) {
    const double own = *area++;
    const std::vector<vec3>& positions = deformed ? deformed->positions : mesh.positions;
    const double scale = areaScale(worldFromObject);
    double passed = before;
    for (uint32_t i = 0; i < mesh.triangles.size() && next != drawn.end() && *next < before + own; ++i) {
      passed += scale * areaOf(mesh, positions, i);
      for (; next != drawn.end() && *next < passed; ++next) {
        const vec2 place = sampleTriangle(random.next2());
        if (isCutOut(scene.assets, mesh, i, place, rayKey(vec3(place, 0), vec3(0)))) continue;
        rays.push_back(
            rayFrom(TriangleBlock{mesh, deformed, worldFromObject, {}, {}}.corners(i), place, worldFromObject, random));
      }
    }
    before += own;
  });
  if (rays.size() <= wanted) return rays;
  std::vector<Ray> some;
  for (size_t i = 0; i < wanted; ++i) some.push_back(rays[i * rays.size() / wanted]);
  return some;
}

/// From where a ray ended, back into the space that it came through. It does not lead.
Ray onward(const Ray& ray, Rng& random) {
  const vec3 n = unitOr(ray.normal, -ray.direction);
  Ray next;
  next.walk = ray.walk;
  next.origin = ray.origin + ray.end * ray.direction;
  next.direction = sampleCosineHemisphere(glm::dot(n, ray.direction) > 0 ? -n : n, random.next2());
  return next;
}

/// Through a camera's picture.
std::vector<Ray> cameraRays(const CameraView& camera, size_t count) {
  std::vector<Ray> rays(count);
  for (size_t i = 0; i < count; ++i) {
    const vec3 at = additiveRecurrence3(uint32_t(i), vec3(0));
    const CameraRay through = cameraRay(camera, at.x, at.y);
    rays[i].walk = kFromCamera, rays[i].leads = rays[i].looks = true;
    rays[i].origin = through.origin, rays[i].direction = through.direction;
  }
  return rays;
}

/// As many as wanted of those from the camera, evenly, and all others.
void keepSome(std::vector<Ray>& rays, size_t wanted) {
  const auto from = std::ranges::stable_partition(rays, [](const Ray& ray) { return ray.walk != kFromCamera; }).begin();
  const auto others = size_t(from - rays.begin()), count = rays.size() - others;
  if (count <= wanted) return;
  for (size_t i = 0; i < wanted; ++i) rays[others + i] = rays[others + i * count / wanted];
  rays.resize(others + wanted);
}

/// Sums over the rays of a walk.
struct Counted {
  RayWork work;
  float most = -1; // of one ray
  size_t rays = 0;

  void add(const Ray& ray) {
    ++rays;
    const auto boxes = float(ray.leads ? ray.entered : ray.boxes.size()), cutOut = float(ray.passed.size());
    work.boxes += boxes, work.cutOut += cutOut;
    if (const float sum = boxes + RayWork::kCutOut * cutOut; sum > most) most = sum, work.place = ray.origin;
  }
  RayWork mean() const {
    RayWork mean = work;
    if (rays > 0) mean.boxes /= float(rays), mean.cutOut /= float(rays);
    return mean;
  }
};

/// From what a camera shows, and from all surfaces too.
RayWork workOf(const Scene& scene, const CameraView& camera, bool surfaces) {
  const std::vector<double> areas = areasOfInstances(scene);
  if (std::ranges::none_of(areas, [](double area) { return area > 0; })) return {}; // nothing for light to fall on
  uint64_t triangles = 0;
  forEachPosed(scene, [&](const Mesh& mesh, const DeformedMesh*, const mat4&) { triangles += mesh.triangles.size(); });
  constexpr uint64_t kFew = 64, kMany = 256; // of other cameras few each, for there are several
  const auto wanted = size_t(std::clamp((uint64_t(1) << 28) / triangles, kFew, surfaces ? kMany : kFew));
  Rng random(1, Stream::RayWork, 0);
  std::vector<Ray> rays;
  if (surfaces) rays = surfaceRays(scene, areas, wanted, random);
  std::ranges::move(cameraRays(camera, wanted), std::back_inserter(rays));
  Tracing trace(scene);
  std::array<Counted, kWalks> walks;
  for (int step = 0; step < kSteps && !rays.empty(); ++step) {
    trace(rays);
    std::vector<Ray> next;
    const auto ends = [](const Ray& ray) { return ray.end < kInfinity && !ray.full; };
    const auto met =
        size_t(std::ranges::count_if(rays, [&](const Ray& ray) { return ray.walk == kFromCamera && ends(ray); }));
    for (const Ray& ray : rays) {
      // A walk's first ray leads to where light may be, unless it leaves the scene or is full. From the camera its
      // second leads to where lights are put, since they shine on what is seen: many are sent, for few may meet
      // anything. What it passes itself counts alone.
      const bool fromCamera = ray.walk == kFromCamera;
      if (ray.full || (fromCamera ? step == 2 : step > 0 || !ends(ray))) walks[ray.walk].add(ray);
      if (ray.looks && !ray.full) {
        Ray passes;
        passes.origin = ray.origin, passes.boxes = ray.passed;
        walks[kThroughBacks].add(passes);
      }
      if (!ends(ray)) continue;
      const size_t sent = !fromCamera ? 1 : step == 0 ? kSent : 1 + 2 * wanted / (1 + met);
      for (size_t i = 0; i < sent; ++i) {
        next.push_back(onward(ray, random));
        next.back().leads = fromCamera && step == 0;
      }
    }
    if (step == 1) keepSome(next, wanted);
    rays = std::move(next);
  }
  return std::ranges::max({walks[kFromSurfaces].mean(), walks[kFromCamera].mean(), walks[kThroughBacks].mean()}, {},
                          &RayWork::sum);
}

/// A first frame casts 30 million rays.
void refuseSlowRays(const Scene& scene, const RayWork& work) {
  constexpr float kMost = 150; // see decisions.md
  if (work.sum() <= kMost) return;
  const dvec3 at = dvec3(work.place) + scene.origin;
  std::ostringstream text;
  text << "every ray looks at " << std::lround(work.sum()) << " triangles in the mean";
  if (work.cutOut >= 1) text << ", " << std::lround(work.cutOut) << " that are cut out or blended counted 7 times";
  text << " (most from " << at.x << ", " << at.y << ", " << at.z
       << "): pictures would take very long; thin them out, or --allow-large";
  throw InputError(scene.file.string(), text.str());
}

void require(Scene& scene, const RayWork& work, FileTrust trust) {
  if (!trust.large) refuseSlowRays(scene, work);
  scene.rayWork = std::max(scene.rayWork, work.sum());
}

} // namespace

RayWork rayWork(const Scene& scene) {
  const std::vector<NamedCamera> cameras = sceneCameras(scene);
  return workOf(scene, cameras.empty() ? defaultView(scene) : cameras.front().view, true);
}

RayWork rayWork(const Scene& scene, const CameraView& camera) { return workOf(scene, camera, false); }

void requireQuickRays(Scene& scene, FileTrust trust) { require(scene, rayWork(scene), trust); }
void requireQuickRays(Scene& scene, const CameraView& camera, FileTrust trust) {
  require(scene, rayWork(scene, camera), trust);
}

} // namespace lambent

#include "game/rules/goal.h"

#include "engine/core/rng.h"
#include "engine/view/surface_point.h"
#include "gi/reference/path_tracer.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>

namespace lambent {

namespace {

constexpr uint32_t kPlaces = 64, kSamples = 32; // of a pass
constexpr int kBounces = 5;
constexpr uint32_t kEnough = 8; // passes, to be sure of anything
constexpr double kCertain = 3;  // standard errors
constexpr uint32_t kMost = 512; // then it is known well enough
constexpr std::string_view kMark = ", goal ";

std::vector<vec3> figuresOf(std::span<const LightView> suns) {
  std::vector<vec3> all;
  for (const LightView& sun : suns) all.insert(all.end(), {sun.direction, sun.intensity});
  return all;
}

} // namespace

std::unique_ptr<Goal> Goal::find(const Scene& scene) {
  std::unique_ptr<Goal> goal;
  scene.registry.each<Name>([&](Entity e, const Name& name) {
    const size_t mark = name.value.find(kMark);
    if (goal || mark == std::string::npos || !scene.registry.has<MeshInstance>(e)) return;
    float wanted = 0;
    std::from_chars(name.value.data() + mark + kMark.size(), name.value.data() + name.value.size(), wanted);
    if (!(wanted > 0) || !std::isfinite(wanted)) return;
    goal.reset(new Goal(scene, e, name.value.substr(0, mark), wanted));
  });
  if (goal && goal->places_.empty()) goal.reset();
  return goal;
}

Goal::Goal(const Scene& scene, Entity entity, std::string what, float wanted)
    : entity_(entity), what_(std::move(what)), wanted_(wanted), solids_(scene) {
  const SceneView& view = solids_.view();
  const auto found = std::ranges::find(view.instances, entity.id(), &InstanceView::id);
  if (found == view.instances.end()) return;
  const Mesh& mesh = scene.assets.meshes[found->mesh];
  const mat3 m(found->worldFromObject);
  std::vector<float> areas;
  std::vector<Place> triangles;
  for (uint32_t p = 0; p < mesh.primitives.size(); ++p)
    for (uint32_t t = 0; t < mesh.primitives[p].triangleCount; ++t) {
      const uvec3 v = mesh.triangles[mesh.primitives[p].firstTriangle + t];
      const vec3 a = mesh.positions[v.x], b = mesh.positions[v.y], c = mesh.positions[v.z];
      areas.push_back(0.5f * glm::length(glm::cross(m * (b - a), m * (c - a))));
      triangles.push_back({p, t, {}});
    }
  const Distribution byArea(areas);
  if (byArea.empty()) return;
  for (uint32_t i = 0; i < kPlaces; ++i) {
    const vec3 u = additiveRecurrence3(i, vec3(0));
    Place place = triangles[byArea.sample((float(i) + 0.5f) / kPlaces)];
    place.barycentric = sampleTriangle({u.x, u.y});
    places_.push_back(place);
  }
}

std::vector<SurfaceHit> Goal::surfaces() const {
  const SceneView& view = solids_.view();
  const auto found = std::ranges::find(view.instances, entity_.id(), &InstanceView::id);
  std::vector<SurfaceHit> hits;
  if (found == view.instances.end()) return hits;
  const uint32_t instance = uint32_t(found - view.instances.begin());
  for (const Place& place : places_) {
    const SurfacePoint p = surfacePoint(view, instance, place.primitive, place.triangle, place.barycentric);
    SurfaceHit hit;
    hit.t = 0;
    hit.position = p.position;
    hit.normal = p.normal;
    hit.geometricNormal = p.geometricNormal;
    hits.push_back(hit);
  }
  return hits;
}

void Goal::update() {
  solids_.update();
  SceneView view = solids_.view();
  std::vector<LightView> suns(view.lights.begin(), view.lights.end());
  std::erase_if(suns, [](const LightView& l) { return l.type != LightType::Directional; });
  const SceneChanges& c = view.changes;
  const std::vector<vec3> figures = figuresOf(suns); // what a lamp or a flashlight does is nothing to it
  if (c.geometry || c.instances || figures != suns_ || !(view.sky == sky_)) {
    passes_ = 0;
    sum_ = squares_ = 0;
  }
  suns_ = figures;
  sky_ = view.sky;
  if (passes_ == kMost) return;
  const std::vector<SurfaceHit> hits = surfaces();
  if (hits.empty()) return;
  view.lights = suns;
  const LightSet lights = collectLights(view);
  RayCounts counts;
  double pass = 0;
  for (const PixelSums& p : sampleSurfaces(
           hits,
           {.rays = solids_.rays(), .lights = lights, .camera = view.camera, .bounces = kBounces, .seed = ++frame_},
           kSamples, counts))
    pass += double(luminance(vec3(p.direct + p.indirect)));
  pass *= double(kPi) / (kSamples * double(hits.size()));
  ++passes_;
  sum_ += pass;
  squares_ += pass * pass;
  const double mean = sum_ / passes_;
  shown_ += (mean - shown_) * (frame_ == 1 ? 1 : std::clamp(double(passes_) / kEnough, 0.25, 1.0));
  // Asked again and again, two errors would be passed by chance: asked at 8, 16, 32 … passes.
  reached_ |= passes_ >= kEnough && std::has_single_bit(passes_) && mean - kCertain * double(error()) > double(wanted_);
}

float Goal::error() const {
  if (passes_ < 2) return kInfinity;
  const double n = passes_;
  return float(std::sqrt(std::max(0.0, squares_ - sum_ * sum_ / n) / (n - 1) / n));
}

void Goal::reset() {
  frame_ = passes_ = 0;
  sum_ = squares_ = shown_ = 0;
  reached_ = false;
}

} // namespace lambent

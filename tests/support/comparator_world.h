// A small world of analytic shapes with a set of virtual lights that one of the techniques places.
#pragma once

#include "engine/trace/analytic_query.h"
#include "gi/vpl/sources.h"
#include "tests/support/hand_scene.h"
#include "tests/support/spread_lights.h"

namespace lambent::test {

inline CameraView cameraAlong(const vec3& eye, const vec3& forward, float fovY = 0.8f) {
  CameraView c;
  const vec3 z = -glm::normalize(forward), x = glm::normalize(glm::cross(vec3(0, 1, 0), z)), y = glm::cross(z, x);
  c.worldFromView = mat4(vec4(x, 0), vec4(y, 0), vec4(z, 0), vec4(eye, 1));
  c.fovY = fovY;
  return c;
}

inline LightView lampAt(const vec3& position, float intensity) {
  LightView l;
  l.position = position;
  l.intensity = vec3(intensity);
  return l;
}

inline Vpl vplAt(const vec3& position, const vec3& normal, uint64_t id = 1, float albedo = 0.5f) {
  Vpl v;
  v.position = position;
  v.normal = v.geometricNormal = normal;
  v.albedo = vec3(albedo);
  v.id = id;
  return v;
}

inline vec3 radianceOf(const Vpl& v, const RayQuery& rays, const LightSet& lights, int bounces, int paths = 16,
                       uint32_t seed = 1) {
  std::vector<Vpl> one{v};
  relight(one, rays, lights, paths, bounces, seed);
  return one[0].radiance;
}

/// Whether two sets hold the same lights, bit by bit.
inline void expectSame(std::span<const Vpl> a, std::span<const Vpl> b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].id, b[i].id) << i;
    ASSERT_EQ(a[i].alive, b[i].alive) << i;
    ASSERT_EQ(a[i].position, b[i].position) << i;
    ASSERT_EQ(a[i].radiance, b[i].radiance) << i;
    ASSERT_EQ(a[i].area, b[i].area) << i;
  }
}

/// Light that leaves it, W/sr.
inline double powerOf(std::span<const Vpl> vpls) {
  double sum = 0;
  for (const Vpl& v : vpls)
    if (v.alive) sum += double(v.radiance.x) * v.area;
  return sum;
}

/// A world of analytic shapes and a set to fill. Starts as a closed room of 6×3×6 m with a block, lit by a lamp.
struct ComparatorWorld {
  AnalyticQuery rays;
  LightSet lights;
  std::vector<InstanceView> instances{4};
  SceneView view;
  SmcSettings settings;
  VplSettings vpl;
  VplSet set;

  explicit ComparatorWorld(VplSource source) {
    rays.addBox({-3, 0, -3}, {3, 3, 3}, {vec3(0.7f, 0.6f, 0.5f)});
    rays.addBox({-2.2f, 0, -1}, {-1.2f, 1.5f, 0}, {vec3(0.4f)});
    lights.punctual = {lampAt({1.5f, 2, 1}, 5)};
    for (uint32_t i = 0; i < instances.size(); ++i) instances[i].id = 10 + i; // ids are not indices
    view.instances = instances;
    view.camera = cameraAlong({0, 1.5f, 2.5f}, {0, -0.7f, -1});
    view.boundsWorld = {vec3(-3, 0, -3), vec3(3, 3, 3)};
    settings.vpls = 256;
    settings.points = 512;
    settings.warmup = 5;
    vpl.source = source;
    vpl.mirCandidates = 64;
  }
  ComparatorWorld(const ComparatorWorld&) = delete;
  VplChanges update(uint32_t seed = 1) {
    VplUpdateLog log;
    return placeVpls(vpl.source, set, {view, rays, lights, settings, seed, vpl}, log);
  }
  double power() const { return powerOf(set.slots); }
};

} // namespace lambent::test

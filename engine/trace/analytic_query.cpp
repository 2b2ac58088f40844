#include "engine/trace/analytic_query.h"

#include "engine/core/error.h"

#include <cmath>

namespace lambent {

uint32_t AnalyticQuery::add(const Shape& shape) {
  shapes_.push_back(shape);
  return uint32_t(shapes_.size() - 1);
}

AnalyticQuery::Meeting AnalyticQuery::meet(const Shape& shape, const Ray& ray) {
  Meeting m;
  const auto inside = [&](float t) { return t > 0 && t < ray.tMax; };
  switch (shape.kind) {
  case Kind::Box: {
    float tNear = -kInfinity, tFar = kInfinity;
    int faceNear = 0, faceFar = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float inv = 1 / ray.direction[axis];
      float t0 = (shape.a[axis] - ray.origin[axis]) * inv, t1 = (shape.b[axis] - ray.origin[axis]) * inv;
      if (std::isnan(t0) || std::isnan(t1)) continue; // parallel and exactly on the slab's border
      const bool swapped = t0 > t1;
      if (swapped) std::swap(t0, t1);
      if (t0 > tNear) tNear = t0, faceNear = 2 * axis + swapped;
      if (t1 < tFar) tFar = t1, faceFar = 2 * axis + !swapped;
    }
    if (tNear > tFar) return m;
    const bool first = inside(tNear);
    if (!first && !inside(tFar)) return m;
    m.t = first ? tNear : tFar;
    m.face = uint32_t(first ? faceNear : faceFar);
    m.outward[int(m.face) / 2] = m.face % 2 ? 1.0f : -1.0f;
    return m;
  }
  case Kind::Sphere: {
    // Closest approach first: the textbook discriminant cancels badly for far spheres.
    const float radius = shape.b.x, dd = glm::dot(ray.direction, ray.direction);
    const vec3 toCentre = shape.a - ray.origin;
    const float tMid = glm::dot(toCentre, ray.direction) / dd;
    const vec3 offset = toCentre - ray.direction * tMid;
    const float h2 = radius * radius - glm::dot(offset, offset);
    if (h2 < 0) return m;
    const float half = std::sqrt(h2 / dd);
    const float t = inside(tMid - half) ? tMid - half : tMid + half;
    if (!inside(t)) return m;
    m.t = t;
    m.outward = glm::normalize(ray.origin + ray.direction * t - shape.a);
    return m;
  }
  case Kind::Plane: {
    const float cosine = glm::dot(shape.b, ray.direction);
    const float t = glm::dot(shape.b, shape.a - ray.origin) / cosine;
    if (cosine == 0 || !inside(t)) return m;
    m.t = t;
    m.outward = shape.b;
    return m;
  }
  }
  return m;
}

void AnalyticQuery::closest(std::span<const Ray> rays, std::span<SurfaceHit> hits) const {
  CHECK_EQ(rays.size(), hits.size());
  for (size_t i = 0; i < rays.size(); ++i) {
    Meeting best;
    uint32_t index = 0;
    for (uint32_t s = 0; s < shapes_.size(); ++s)
      if (const Meeting m = meet(shapes_[s], rays[i]); m.t < best.t) best = m, index = s;
    SurfaceHit& hit = hits[i] = {};
    if (!(best.t < kInfinity)) continue;
    const Look& look = shapes_[index].look;
    const bool fromOutside = glm::dot(best.outward, rays[i].direction) < 0;
    hit.t = best.t;
    hit.position = rays[i].origin + rays[i].direction * best.t;
    hit.normal = hit.geometricNormal = fromOutside ? best.outward : -best.outward;
    hit.albedo = look.albedo;
    if (fromOutside != look.inward) hit.emission = look.emission;
    hit.instance = index;
    hit.triangle = best.face;
  }
}

void AnalyticQuery::distances(std::span<const Ray> rays, std::span<float> t) const {
  CHECK_EQ(rays.size(), t.size());
  for (size_t i = 0; i < rays.size(); ++i) {
    t[i] = kInfinity;
    for (const Shape& s : shapes_) t[i] = glm::min(t[i], meet(s, rays[i]).t);
  }
}

void AnalyticQuery::occluded(std::span<const Ray> rays, std::span<uint8_t> blocked) const {
  CHECK_EQ(rays.size(), blocked.size());
  for (size_t i = 0; i < rays.size(); ++i) {
    blocked[i] = 0;
    for (const Shape& s : shapes_)
      if (meet(s, rays[i]).t < kInfinity) blocked[i] = 1;
  }
}

} // namespace lambent

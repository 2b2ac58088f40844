#include "gi/vpl/area_lights.h"

#include <algorithm>
#include <span>

namespace lambent {

namespace {

constexpr uint32_t kPerDisk = 4;

AreaPiece pieceOf(const EmitterTriangle& t, bool doubleSided) {
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

/// A triangle and the one that completes it to a parallelogram.
bool merge(AreaPiece& a, const AreaPiece& b) {
  if (a.corners[0].w != 3 || glm::dot(vec3(a.normalArea), vec3(b.normalArea)) < 0.99999f) return false;
  for (int i = 0; i < 3; ++i) { // its corner off the diagonal
    const vec3 off(a.corners[i]), next(a.corners[(i + 1) % 3]), last(a.corners[(i + 2) % 3]);
    const vec3 fourth = next + last - off;
    const float within = 1e-4f * glm::distance(next, last);
    const auto among = [&](const vec3& p) {
      return std::any_of(b.corners, b.corners + 3, [&](const vec4& c) { return glm::distance(vec3(c), p) <= within; });
    };
    if (!among(next) || !among(last) || !among(fourth)) continue;
    a.corners[0] = vec4(off, 4);
    a.corners[1] = vec4(next, 0);
    a.corners[2] = vec4(fourth, 0);
    a.corners[3] = vec4(last, 0);
    a.normalArea.w *= 2;
    return true;
  }
  return false;
}

/// Number of the cell that a place in [0,1]³ lies in along a curve that fills the cube (Morton).
uint32_t alongCurve(const vec3& place) {
  const uvec3 cell = uvec3(glm::clamp(place, 0.0f, 0.999f) * 1024.0f);
  uint32_t number = 0;
  for (int bit = 9; bit >= 0; --bit)
    for (int axis = 0; axis < 3; ++axis) number = number << 1 | (cell[axis] >> bit & 1);
  return number;
}

bool textured(const LightSet& lights, const Emitter& emitter) {
  if (!lights.view) return false;
  const InstanceView& instance = lights.view->instances[emitter.instance];
  const Primitive& primitive = lights.view->assets->meshes[instance.mesh].primitives[emitter.primitive];
  return lights.view->assets->materials[primitive.material].emissiveTexture.image != kNone;
}

/// Points spread evenly over an emitter in proportion to the power of its triangles. Those of a textured one are each
/// the middle of sixteen, whose mean radiance they have.
void addSamples(const LightSet& lights, const Emitter& emitter, AreaLights& to) {
  const uint32_t group = textured(lights, emitter) ? 4 : 1, count = AreaLights::kSamples * group;
  std::vector<AreaSample> points;
  Aabb box;
  for (uint32_t i = 0; i < count; ++i) {
    const vec3 spread = additiveRecurrence3(i, vec3(0.5f));
    const EmitterPoint p = sampleEmitter(lights, emitter, {(float(i) + 0.5f) / float(count), spread.x, spread.y});
    points.push_back({p.position, p.normal, p.radiance});
    box.add(p.position);
  }
  const vec3 size = glm::max(box.size(), vec3(maxComponent(box.size()) * 1e-3f + 1e-30f));
  std::stable_sort(points.begin(), points.end(), [&](const AreaSample& a, const AreaSample& b) {
    return alongCurve((a.position - box.lo) / size) < alongCurve((b.position - box.lo) / size);
  });
  for (uint32_t i = 0; i < count; i += group) {
    AreaSample& sample = to.samples.emplace_back(points[i + group / 2]);
    sample.radiance = vec3(0);
    for (uint32_t k = 0; k < group; ++k) sample.radiance += points[i + k].radiance / float(group);
  }
}

/// Samples as disks: one for every kPerDisk that follow each other, with their share of the surface and their mean
/// radiance.
void addDisks(const LightSet& lights, const Emitter& emitter, const AreaLight& light, AreaLights& to) {
  float area = 0;
  for (uint32_t t = 0; t < emitter.triangleCount; ++t) area += lights.triangles[emitter.firstTriangle + t].area;
  for (uint32_t i = 0; i < light.samples; i += kPerDisk) {
    const std::span of = std::span(to.samples).subspan(light.firstSample + i, kPerDisk);
    vec3 radiance(0);
    for (const AreaSample& s : of) radiance += s.radiance / float(kPerDisk);
    AreaPiece& piece = to.pieces.emplace_back();
    piece.corners[0] = vec4(of[kPerDisk / 2].position, 0);
    piece.normalArea = vec4(of[kPerDisk / 2].normal, area * float(kPerDisk) / float(light.samples));
    piece.radianceSides = vec4(radiance, emitter.doubleSided ? 1 : 0);
  }
}

} // namespace

AreaLights areaLights(const LightSet& lights) {
  AreaLights out;
  for (const Emitter& emitter : lights.emitters) {
    if (!(emitter.power > 0)) continue;
    AreaLight light{.firstPiece = uint32_t(out.pieces.size()),
                    .firstSample = uint32_t(out.samples.size()),
                    .samples = AreaLights::kSamples,
                    .doubleSided = emitter.doubleSided};
    addSamples(lights, emitter, out);
    for (uint32_t t = 0; t < emitter.triangleCount && emitter.triangleCount <= 2 * AreaLights::kMostPolygons; ++t) {
      const EmitterTriangle& triangle = lights.triangles[emitter.firstTriangle + t];
      if (!(triangle.area > 0)) continue;
      const AreaPiece piece = pieceOf(triangle, emitter.doubleSided);
      if (out.pieces.size() > light.firstPiece && merge(out.pieces.back(), piece)) continue;
      out.pieces.push_back(piece);
    }
    light.pieces = uint32_t(out.pieces.size()) - light.firstPiece;
    if (light.pieces == 0 || light.pieces > AreaLights::kMostPolygons || textured(lights, emitter)) {
      out.pieces.resize(light.firstPiece);
      addDisks(lights, emitter, light, out);
      light.pieces = uint32_t(out.pieces.size()) - light.firstPiece;
    }
    out.lights.push_back(light);
  }
  return out;
}

vec3 unshadowed(const AreaLights& all, const AreaLight& light, const vec3& position, const vec3& normal) {
  vec3 sum(0);
  for (uint32_t i = 0; i < light.pieces; ++i) {
    const AreaPiece& piece = all.pieces[light.firstPiece + i];
    sum += vec3(piece.radianceSides) * areaFormFactor(piece, position, normal);
  }
  return sum;
}

} // namespace lambent

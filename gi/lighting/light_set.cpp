#include "gi/lighting/light_set.h"

#include "engine/view/surface_point.h"
#include "shaders/shared/paraboloid.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace lambent {

namespace {

/// Mean over pixels and rays, which meet what is masked or blended in a share of its places.
vec3 emissionAt(const LightSet& lights, const Emitter& e, uint32_t meshTriangle, vec2 bary) {
  const SceneView& view = *lights.view;
  const Mesh& mesh = view.assets->meshes[view.instances[e.instance].mesh];
  const Primitive& primitive = mesh.primitives[e.primitive];
  const Material& material = view.assets->materials[primitive.material];
  vec3 emission = material.emission;
  const bool byAlpha = lights.alpha && material.alphaMode != AlphaMode::Opaque;
  if (material.emissiveTexture.image == kNone && !byAlpha) return emission;
  const TrianglePlace place = trianglePlace(mesh, primitive, meshTriangle, bary);
  if (material.emissiveTexture.image != kNone)
    emission *=
        vec3(sampleTexture(*view.assets, material.emissiveTexture, uvAt(mesh, place, material.emissiveTexture)));
  if (byAlpha) emission *= shareThere(material, alphaAt(*view.assets, mesh, material, place));
  return emission;
}

/// The same of a whole triangle, by the means of its textures.
vec3 meanEmission(const SceneAssets& assets, const Mesh& mesh, const Primitive& primitive, uint32_t triangle,
                  bool byAlpha) {
  constexpr float kLeast = 1e-3f; // keeps every triangle reachable: the mean of a texture is not its own
  const Material& material = assets.materials[primitive.material];
  vec3 mean = material.emission;
  if (const uint32_t image = material.emissiveTexture.image; image != kNone)
    mean *= glm::max(vec3(assets.images[image].averageLinear), vec3(kLeast));
  if (material.alphaMode == AlphaMode::Opaque || !byAlpha) return mean;
  const uint32_t image = material.baseColorTexture.image;
  const TrianglePlace middle = trianglePlace(mesh, primitive, triangle, vec2(1.0f / 3));
  const float alpha =
      baseColourAt(assets, mesh, material, middle, image != kNone ? &assets.images[image].averageLinear : nullptr).w;
  // Of a mask's texels about as many are there as their mean says.
  const float share = image != kNone ? std::clamp(alpha, 0.0f, 1.0f) : shareThere(material, alpha);
  return mean * (image != kNone || !mesh.colors.empty() ? std::max(share, kLeast) : share);
}

/// Emitters one after another along a curve through their places.
std::vector<uint32_t> orderOf(std::span<const Emitter> emitters) {
  Aabb box;
  for (const Emitter& e : emitters) box.add(e.bounds.centre);
  const vec3 scale = vec3(1023) / glm::max(box.size(), vec3(1e-30f));
  std::vector<std::pair<uint32_t, uint32_t>> order;
  for (uint32_t i = 0; i < emitters.size(); ++i)
    order.emplace_back(alongCurve(uvec3((emitters[i].bounds.centre - box.lo) * scale)), i);
  std::ranges::sort(order);
  std::vector<uint32_t> indices;
  for (const auto& [place, i] : order) indices.push_back(i);
  return indices;
}

} // namespace

EmitterTriangle makeEmitterTriangle(const vec3& p0, const vec3& p1, const vec3& p2, const vec3& radiance) {
  EmitterTriangle t{p0, p1 - p0, p2 - p0, vec3(0), radiance};
  const vec3 c = glm::cross(t.e1, t.e2);
  const float length = glm::length(c);
  t.area = 0.5f * length;
  t.normal = length > 0 ? c / length : vec3(0);
  return t;
}

void addEmitter(LightSet& lights, uint32_t instance, uint32_t primitive, std::vector<EmitterTriangle> triangles,
                bool doubleSided) {
  Emitter e;
  e.instance = instance;
  e.primitive = primitive;
  e.firstTriangle = uint32_t(lights.triangles.size());
  e.triangleCount = uint32_t(triangles.size());
  e.doubleSided = doubleSided;
  Aabb box;
  std::vector<float> powers;
  vec3 normals(0);
  for (const EmitterTriangle& t : triangles) {
    normals += t.normal * t.area;
    box.add(t.p0), box.add(t.p0 + t.e1), box.add(t.p0 + t.e2);
    powers.push_back(luminance(t.radiance) * t.area);
    e.power += powers.back();
  }
  if (!(e.power > 0)) return;
  e.bounds = {.centre = box.centre(),
              .half = 0.5f * box.size(),
              .power = e.power,
              .range = kInfinity,
              .bothSides = doubleSided};
  if (const float length = glm::length(normals); length > 0) {
    e.bounds.axis = normals / length;
    e.bounds.cosAxes = 1;
    for (const EmitterTriangle& t : triangles)
      if (t.area > 0) e.bounds.cosAxes = std::min(e.bounds.cosAxes, glm::dot(t.normal, e.bounds.axis));
  }
  e.byPower = Distribution(powers);
  lights.triangles.insert(lights.triangles.end(), triangles.begin(), triangles.end());
  lights.emitters.push_back(std::move(e));
}

LightSet collectLights(const SceneView& view, bool alpha) {
  LightSet lights;
  lights.alpha = alpha;
  lights.view = &view;
  lights.sky = view.sky;
  for (const LightView& l : view.lights)
    if (luminance(l.intensity) > 0) lights.punctual.push_back(l);
  for (uint32_t i = 0; i < view.instances.size(); ++i) {
    const InstanceView& instance = view.instances[i];
    const Mesh& mesh = view.assets->meshes[instance.mesh];
    const std::vector<vec3>& positions = instance.deformed ? instance.deformed->positions : mesh.positions;
    for (uint32_t p = 0; p < mesh.primitives.size(); ++p) {
      const Primitive& primitive = mesh.primitives[p];
      const Material& material = view.assets->materials[primitive.material];
      if (!material.emits()) continue;
      // Front side = outside of the mesh also under mirroring transforms (glTF flips the winding there).
      const bool mirrored = glm::determinant(mat3(instance.worldFromObject)) < 0;
      std::vector<EmitterTriangle> triangles;
      for (uint32_t t = 0; t < primitive.triangleCount; ++t) {
        const uvec3 v = mesh.triangles[primitive.firstTriangle + t];
        const auto world = [&](uint32_t k) { return vec3(instance.worldFromObject * vec4(positions[k], 1)); };
        EmitterTriangle e = makeEmitterTriangle(world(v.x), world(v.y), world(v.z),
                                                meanEmission(*view.assets, mesh, primitive, t, alpha));
        if (mirrored) e.normal = -e.normal;
        e.meshTriangle = t;
        triangles.push_back(e);
      }
      addEmitter(lights, i, p, std::move(triangles), material.doubleSided);
    }
  }
  lights.tree = LightTree(lights);
  return lights;
}

uint32_t LightSet::emitterOf(const SurfaceHit& hit) const {
  // Sorted by (instance, primitive) because collectLights visits them in that order.
  const auto key = [](const Emitter& e) { return uint64_t(e.instance) << 32 | e.primitive; };
  const uint64_t wanted = uint64_t(hit.instance) << 32 | hit.primitive;
  const auto it = std::lower_bound(emitters.begin(), emitters.end(), wanted,
                                   [&](const Emitter& e, uint64_t w) { return key(e) < w; });
  return it != emitters.end() && key(*it) == wanted ? uint32_t(it - emitters.begin()) : kNone;
}

LightView pointOfDisk(const LightView& light, vec2 u) {
  LightView point = light;
  if (!hasDisk(light)) return point;
  vec3 tangent, bitangent;
  basisAround(light.direction, tangent, bitangent);
  const float r = std::tan(light.angularRadius) * std::sqrt(u.x), phi = 2 * kPi * u.y;
  point.direction = glm::normalize(light.direction + (tangent * std::cos(phi) + bitangent * std::sin(phi)) * r);
  return point;
}

bool isInDisk(const LightView& light, const vec3& towards) {
  const float cosine = -glm::dot(light.direction, towards), r = std::tan(light.angularRadius);
  const vec3 across = glm::cross(light.direction, towards); // digits that a cosine near 1 has lost
  return cosine > 0 && glm::dot(across, across) <= r * r * cosine * cosine;
}

float pdfOfDisk(const LightView& light, const vec3& towards) {
  const float cosine = -glm::dot(light.direction, towards), r = std::tan(light.angularRadius);
  return 1 / (kPi * r * r * cosine * cosine * cosine);
}

PunctualSample punctualIrradiance(const LightView& light, const vec3& x, const vec3& n) {
  PunctualSample s;
  if (light.type == LightType::Directional) {
    s.towards = -light.direction;
    s.distance = kInfinity;
    s.irradiance = light.intensity * glm::max(0.0f, glm::dot(n, s.towards));
    return s;
  }
  const vec3 d = light.position - x;
  const float r2 = glm::dot(d, d);
  if (!(r2 > 0)) return s;
  s.distance = std::sqrt(r2);
  s.towards = d / s.distance;
  float falloff = 1 / r2;
  if (light.range < kInfinity) {
    const float q = r2 / (light.range * light.range);
    falloff *= glm::clamp(1 - q * q, 0.0f, 1.0f);
  }
  if (light.type == LightType::Spot) {
    const float scale = 1 / glm::max(0.001f, light.innerConeCos - light.outerConeCos);
    const float a = glm::clamp((glm::dot(light.direction, -s.towards) - light.outerConeCos) * scale, 0.0f, 1.0f);
    falloff *= a * a;
  }
  s.irradiance = light.intensity * (falloff * glm::max(0.0f, glm::dot(n, s.towards)));
  return s;
}

EmitterPoint sampleEmitter(const LightSet& lights, const Emitter& emitter, const vec3& u) {
  const uint32_t k = emitter.byPower.sample(u.x);
  const EmitterTriangle& t = lights.triangles[emitter.firstTriangle + k];
  const vec2 bary = sampleTriangle({u.y, u.z});
  EmitterPoint s;
  s.position = t.p0 + t.e1 * bary.x + t.e2 * bary.y;
  s.normal = t.normal;
  s.radiance = lights.view ? emissionAt(lights, emitter, t.meshTriangle, bary) : t.radiance;
  s.pdfArea = emitter.byPower.probability(k) / t.area;
  return s;
}

float pdfEmitterArea(const LightSet& lights, const Emitter& emitter, uint32_t meshTriangle) {
  if (meshTriangle >= emitter.triangleCount) return 0;
  const EmitterTriangle& t = lights.triangles[emitter.firstTriangle + meshTriangle];
  return t.area > 0 ? emitter.byPower.probability(meshTriangle) / t.area : 0;
}

std::vector<EmitterPatch> emitterPatches(const LightSet& lights, int count) {
  std::vector<EmitterPatch> patches;
  const auto add = [&](const Emitter& e, float place, uint32_t i, float power) {
    const vec3 spread = additiveRecurrence3(i, vec3(0.5f));
    const EmitterPoint p = sampleEmitter(lights, e, {place, spread.x, spread.y});
    const EmitterTriangle& t = lights.triangles[e.firstTriangle + e.byPower.sample(place)];
    // Radiance of the triangle rather than of the point: a texel that happens to be black must not darken the patch.
    const float area = power / luminance(t.radiance);
    patches.push_back({p.position, p.normal, t.radiance, area});
    if (e.doubleSided) patches.push_back({p.position, -p.normal, t.radiance, area});
  };
  float total = 0;
  for (const Emitter& e : lights.emitters) total += e.power;
  if (lights.emitters.size() > kMostEmitterPatches) {
    const std::vector<uint32_t> order = orderOf(lights.emitters);
    std::vector<float> powers;
    for (const uint32_t e : order) powers.push_back(lights.emitters[e].power);
    const Distribution byPower(powers);
    for (uint32_t i = 0; i < kMostEmitterPatches; ++i) {
      const auto [at, place] = byPower.choose((float(i) + 0.5f) / float(kMostEmitterPatches));
      add(lights.emitters[order[at]], place, i, total / float(kMostEmitterPatches));
    }
    return patches;
  }
  for (const Emitter& e : lights.emitters) {
    const int share = std::max(1, int(std::lround(float(count) * e.power / total)));
    for (int i = 0; i < share; ++i) add(e, (float(i) + 0.5f) / float(share), uint32_t(i), e.power / float(share));
  }
  return patches;
}

} // namespace lambent

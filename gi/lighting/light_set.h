// All light of a scene in the form that light paths sample: punctual lights, emissive triangles grouped by surface,
// sky.
#pragma once

#include "engine/core/sampling.h"
#include "engine/trace/ray_query.h"
#include "gi/contract/virtual_lights.h"
#include "gi/lighting/light_tree.h"

namespace lambent {

/// One emissive triangle, world space. `radiance` is the mean over the triangle; where a texture modulates it,
/// `radianceAt` gives the exact value.
struct EmitterTriangle {
  vec3 p0, e1, e2; // corner and edges
  vec3 normal;     // unit, front side
  vec3 radiance;
  float area = 0;            // m²
  uint32_t meshTriangle = 0; // within the primitive
};

/// The emissive triangles of one (instance, primitive).
struct Emitter {
  uint32_t instance = 0, primitive = 0;
  uint32_t firstTriangle = 0, triangleCount = 0; // run of LightSet::triangles
  bool doubleSided = false;
  LightBounds bounds;
  float power = 0;      // Σ luminance(radiance) · area, W/sr
  Distribution byPower; // over its triangles
};

struct LightSet {
  std::vector<LightView> punctual;
  std::vector<Emitter> emitters;
  std::vector<EmitterTriangle> triangles;
  Sky sky;
  LightTree tree;       // over the lights above, rebuilt when any of them changes; few need none (LightChoice)
  bool emission = true; // false: what glows is not a light, and has no emitters
  bool alpha = true;    // false: rays meet masked and blended surfaces as if they were solid
  const SceneView* view = nullptr; // for textured emission; null: emission is `EmitterTriangle::radiance`

  bool empty() const { return punctual.empty() && emitters.empty() && sky.black(); }
  size_t lightCount() const { return punctual.size() + emitters.size(); } // the sky is sampled by itself
  /// Emitter that a hit lies on, or kNone.
  uint32_t emitterOf(const SurfaceHit& hit) const;
};

/// Collects the lights of a view. Emissive materials whose texture is black on average are kept (their texels may not
/// be). `view` must outlive the result. `alpha`: as LightSet.
LightSet collectLights(const SceneView& view, bool alpha = true);

/// Adds an emitter by hand (tests, generated lights): each triangle with its own radiance.
void addEmitter(LightSet& lights, uint32_t instance, uint32_t primitive, std::vector<EmitterTriangle> triangles,
                bool doubleSided);
EmitterTriangle makeEmitterTriangle(const vec3& p0, const vec3& p1, const vec3& p2, const vec3& radiance);

/// Irradiance per channel that an unblocked punctual light brings to (x, n), and the segment's other end.
/// Zero behind the surface, outside cone or range. glTF KHR_lights_punctual falloffs.
struct PunctualSample {
  vec3 irradiance{0};
  vec3 towards{0};    // unit direction from x to the light
  float distance = 0; // metres; kInfinity for a directional light
};
PunctualSample punctualIrradiance(const LightView& light, const vec3& x, const vec3& n);
/// Says whether a punctual light has a size, and so no sharp shadows.
inline bool hasDisk(const LightView& light) { return light.type == LightType::Directional && light.angularRadius > 0; }

/// Says whether a direction meets the disk of a light that has one.
bool isInDisk(const LightView& light, const vec3& towards);
/// Density per steradian with which pointOfDisk finds the direction towards a point of a light's disk. Times the
/// light's intensity it is the disk's radiance.
float pdfOfDisk(const LightView& light, const vec3& towards);

/// The light as a point of its disk brings it; numbers in [0, 1). Lights without a size are returned as they are.
LightView pointOfDisk(const LightView& light, vec2 u);

/// A point on an emitter with its density.
struct EmitterPoint {
  vec3 position, normal; // front-side normal, unit
  vec3 radiance;
  float pdfArea = 0; // per m²
};
EmitterPoint sampleEmitter(const LightSet& lights, const Emitter& emitter, const vec3& u);
/// Density per m² with which sampleEmitter finds a point on `hit`'s triangle.
float pdfEmitterArea(const LightSet& lights, const Emitter& emitter, uint32_t meshTriangle);

/// A patch of an emissive surface that stands for a share of its power in direct light: one shadowed sample.
struct EmitterPatch {
  vec3 position, normal; // unit, the side that emits
  vec3 radiance;
  float area = 0; // m²
};
/// About `count` patches over all emitters (at least one each), in proportion to power, evenly spread over each
/// emitter's surface, the same every time. Double-sided emitters give one patch per side. The patches of an emitter add
/// up to its power exactly.
///
/// More than kMostEmitterPatches emitters share so many patches: along a Morton curve through their places each patch
/// stands where an equal part of all power has its middle, in the colour of the emitter there.
std::vector<EmitterPatch> emitterPatches(const LightSet& lights, int count);
inline constexpr size_t kMostEmitterPatches = 1024; // of each side
inline VirtualLight lightOf(const EmitterPatch& p) {
  return {p.position, p.normal, p.normal, p.radiance, p.area, true};
}

} // namespace lambent

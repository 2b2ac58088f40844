// The persistent set of virtual point lights. A slot keeps its index for life (interleaving subsets and shadow-map
// layers stay put); the light in it may be replaced.
#pragma once

#include "engine/core/math.h"
#include "gi/contract/virtual_lights.h"
#include "gi/plan/settings.h"
#include "gi/vpl/kept_paths.h"
#include "gi/vpl/settling.h"

#include <array>
#include <cstdint>
#include <vector>

namespace lambent {

/// Where on an object something stands, whatever the object does.
struct SurfacePlace {
  vec3 position{0}, normal{0, 1, 0}, geometricNormal{0, 1, 0}; // object space; for shapes without a mesh
  // As in SurfaceHit. Exact whatever size the object had when this place was found, and on its surface in any shape.
  uint32_t mesh = 0; // index into SceneAssets::meshes: with another mesh the place is gone
  uint32_t primitive = 0, triangle = 0;
  vec2 barycentric{0};
  bool back = false; // on the back of the triangle
};

/// A small diffuse patch that stands for all light reflected around it, with all that the sampler knows of it. World
/// space.
struct Vpl {
  vec3 position{0};     // on the surface
  vec3 normal{0, 1, 0}; // shading normal, towards the lit side
  vec3 geometricNormal{0, 1, 0};
  vec3 albedo{0};
  vec3 radiance{0};        // reflected L = B/π, W/(m² sr); no emission of its own
  vec3 samplerRadiance{0}; // the same by other paths, for the sampler's choices only (see estimateRadiance)
  float area = 0;          // m² that it stands for: π r_k² / k (paper 1, eq. 7, see gi/vpl/density.cpp)
  float candidateArea = 0; // the same with k = 1, used by the sampler only
  uint64_t id = 0;         // seeds its light paths; never reused
  uint32_t bornFrame = 0;
  uint32_t instance = 0; // InstanceView::id of the object that carries it
  SurfacePlace place;    // on that object: VPLs ride on it
  float share = 1;       // as SurfaceHit
  vec3 mailbox{0};       // a point seen by both the camera and this VPL, already off its surface
  bool alive = false;    // false: empty slot, brings no light
  bool valid = false;    // indirectly visible in this frame as far as known

  /// Intensity I = L/p up to the factor N (paper 1, eq. 6): radiance × area, W/sr as a luminance.
  float intensity() const { return luminance(radiance) * area; }
};

/// A place that light paths may start from, to find what it reflects (estimateRadiance); in no set, of no area.
inline Vpl patchOf(const SurfaceHit& h, uint64_t id) {
  Vpl v;
  v.position = h.position;
  v.normal = h.normal;
  v.geometricNormal = h.geometricNormal;
  v.albedo = h.albedo;
  v.share = h.share;
  v.id = id;
  return v;
}

/// What rendering needs of it.
inline VirtualLight lightOf(const Vpl& v) {
  return {v.position, v.normal, v.geometricNormal, v.radiance, v.alive ? v.area : 0, v.alive};
}

/// A point of the surface drawn around one VPL; it lies in the cell of that one or of another. World space.
struct SurfaceSample {
  static constexpr size_t kNear = 8;
  vec3 position, normal, geometricNormal, albedo;
  std::array<uint32_t, kNear> near; // slots of the VPLs nearest to it, nearest first; kNone beyond the last
  float reach2 = 0;                 // squared distance to the last of them, m²; infinite where they are fewer
  float density = 0;      // samples per m² that all of them draw here; 0: the one that drew it is not among them
  uint32_t owner = kNone; // the nearest that is connected to it
  float owner2 = 0;       // squared distance to that, m²
  uint32_t weighed = 0;   // VplCell::drawing of the owner that `seen` is for
  float seen = 0;         // how well it is seen, by the place of its owner
  uint8_t chord = 0;      // number of the one that met it
};

/// A share of a cell.
struct CellPoint {
  vec3 position, normal, geometricNormal, albedo;
  float area = 0; // m² of surface that it stands for
};

/// The surface that a VPL stands for: all that is nearer to it than to any other (see gi/vpl/cells.cpp).
struct VplCell {
  std::vector<CellPoint> points;      // from the middle outwards
  std::vector<SurfaceSample> samples; // drawn around this VPL, whoever has them
  std::vector<vec3> viewers;          // points that the camera sees and that look this way
  float seenVpl = 1;                  // how many of them see the VPL
  vec3 centre{0};                     // where the samples were drawn
  float radius = 0;                   // m, scale that they were drawn with; 0 = none drawn
  float reach = 0;                    // m: VPLs farther away concern none of the samples
  uint32_t drawing = 0;               // number of the drawing, of all cells
};

struct VplSet {
  std::vector<Vpl> slots;
  std::vector<VplCell> cells;                      // by slot; empty with densities by nearest neighbours
  uint32_t drawings = 0;                           // of cells, so far
  float cellLimit = 0;                             // m: the limit on radii that their densities are for
  uint32_t direct = ~0u;                           // VirtualLights::direct
  float mostFlux = kInfinity;                      // W as a luminance: no VPL reflects more, see lightsOf
  std::vector<KeptPaths> samplerPaths, lightPaths; // by slot: of samplerRadiance and radiance; empty without path cache
  std::vector<Vpl> pool;                           // candidates that may yet be wanted, oldest first
  std::vector<KeptPaths> poolPaths;                // of their samplerRadiance
  VplSource source = VplSource::Smc;               // who filled the slots
  uint64_t nextId = 1;
  uint32_t frame = 0;               // iterations so far
  float visibleArea = 0;            // m², running estimate of the indirectly visible surface
  int litPaths = 0, litBounces = 0; // settings that the present radiances were estimated with
  Settling settling;
  bool sampledLate = false; // something changed while the sampler was left out
};

/// By slot. An estimate of radiance that met a spot much smaller than the area it stands for is right on average, by
/// one VPL in thousands that would light the whole image: none reflects more than could arrive. The error is that of
/// the set that had it; elsewhere nothing is taken.
inline std::vector<VirtualLight> lightsOf(const VplSet& set) {
  std::vector<VirtualLight> lights;
  lights.reserve(set.slots.size());
  for (const Vpl& v : set.slots) {
    VirtualLight& light = lights.emplace_back(lightOf(v));
    const float flux = kPi * luminance(light.radiance) * light.area;
    if (flux > set.mostFlux) light.radiance *= set.mostFlux / flux;
  }
  return lights;
}

/// What one update did: which slots need a new shadow map, and figures for the frame log.
struct VplChanges {
  std::vector<uint32_t> movedSlots;  // that hold another VPL or one that stands elsewhere, ascending
  std::vector<uint32_t> placedSlots; // of these, the ones with another VPL
  uint32_t kept = 0, invalid = 0, candidates = 0, strong = 0, alive = 0;
  bool burst = false; // camera cut: the M_max bound was lifted
};

} // namespace lambent

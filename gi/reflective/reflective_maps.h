// Light from reflective shadow maps (papers 2 and 3): what punctual lights see is where they are reflected once. Lights
// that glow and the sky have no such map and bring nothing here.
//   ReflectiveMapPass    maps of all lights side by side, and their pyramid              reflective_maps.cpp, rsm.frag
//   ReflectiveLightPass  VPLs of them: on a regular grid (rsm), one per smooth patch (isr)     reflective_lights.cpp
//   drawTreeGather       clusters of all sizes, chosen by every fragment (hisr)           tree_gather.cpp
#pragma once

#include "gi/contract/virtual_lights.h"
#include "gi/surfaces/surfaces.h"

namespace lambent {

/// One map: a light, a face of a point light, or all that a sun meets.
struct ReflectiveMap {
  CameraView view;       // from the light, resolution × resolution
  mat4 clipFromWorld{1}; // what the map shows
  LightView light;
  bool parallel = false;
  float patchArea = 0; // what a texel stands for: m² (parallel), or steradians on average
  float power = 0;     // luminance of the light that goes into the map, W
};

/// All maps in one sheet of cells, `columns` wide, in the order of `maps`. Mip level i of the textures holds clusters
/// of 2^i × 2^i texels, up to `coarsest` per side of a map: their sum of flux and area, means of the rest weighted by
/// flux.
struct ReflectiveMaps {
  std::span<const ReflectiveMap> maps;
  const gl::Texture* position = nullptr; // RGBA32F: world; a: bound of the area, m²: that of the largest texel times
                                         // their number; 0 where the map meets nothing
  const gl::Texture* normal = nullptr;   // RGBA32F: on the lit side; unit at level 0, at others as long as the mean
  const gl::Texture* flux = nullptr;     // RGBA32F: reflected flux, W; a: area facing the light, m²
  const gl::Texture* depth = nullptr;    // reversed, level 0 only
  int resolution = 0, columns = 1, levels = 1;
  PatchPyramid patches; // if needed: level λ is mip level λ − 1, as everywhere
  bool changed = true;  // anything since the last run

  glm::ivec2 origin(size_t map) const { return resolution * glm::ivec2(int(map) % columns, int(map) / columns); }
  int levelOf(int patchesPerSide) const; // mip level with about so many clusters per side of a map
};

/// What is made from the maps.
struct ReflectiveNeeds {
  bool clusters = false; // the coarser mip levels
  bool patches = false;  // which clusters are smooth; only with clusters
  bool operator==(const ReflectiveNeeds&) const = default;
};

struct ReflectiveMapInputs {
  const GpuScene& scene;
  std::span<const LightView> lights;
  Aabb bounds; // of the scene
  bool allChanged = false;
  std::span<const Aabb> moved; // where geometry changed: maps that show none of it stay
  const RsmSettings& rsm;
  ReflectiveNeeds needs;
};

class ReflectiveMapPass {
 public:
  explicit ReflectiveMapPass(PassContext context) : context_(context) {}
  ReflectiveMaps run(const ReflectiveMapInputs& in);
  uint32_t mapsDrawn() const { return mapsDrawn_; } // in the last run

 private:
  void allocate(int resolution, int columns, int rows, int levels);
  void drawSurfaces(const ReflectiveMapInputs& in, size_t map);
  void drawFlux(const ReflectiveMapInputs& in, size_t map);
  void drawPyramid();

  PassContext context_;
  PatchPass patchPass_{context_, StageId::LightPatches};
  std::vector<ReflectiveMap> maps_;
  RsmSettings settings_;
  ReflectiveNeeds needs_;
  PatchPyramid patches_;
  int resolution_ = 0, columns_ = 1;
  uint32_t mapsDrawn_ = 0;
  gl::Texture depth_, albedo_, position_, normal_, flux_;
  gl::Framebuffer surfaces_, fluxes_;
  std::vector<gl::Framebuffer> levels_;
  gl::Ring cameras_{"reflective maps/cameras"};
};

/// Bytes that the sheet's textures may take; the resolution is halved until they fit.
inline constexpr uint64_t kReflectiveMapBudget = uint64_t(512) << 20;

/// A regular grid over each of `maps` maps: `columns` × `rows` cells, one row more in the first ones.
struct LightGrid {
  int columns = 0, rows = 0, mapsWithOneMore = 0, maps = 0;
  int count() const { return columns * (rows * maps + mapsWithOneMore); }
};
/// Divides the maps into nearly square cells, `vpls` of them or hardly fewer, at least one per map: 252 on the six maps
/// of a point light for 256.
LightGrid lightGrid(int vpls, int maps);

class ReflectiveLightPass {
 public:
  explicit ReflectiveLightPass(PassContext context) : context_(context) {}
  // VPLs of the maps, as the gather reads them.
  PackedLights runGrid(const ReflectiveMaps& maps, const RsmSettings& rsm); // on a regular grid
  /// Makes one light per patch without discontinuity that reflects light. Needs the maps' patches. Waits for the GPU to
  /// know how many these are.
  PackedLights runClusters(const ReflectiveMaps& maps, const RsmSettings& rsm);
  /// Reads the VPLs of the last run back, by slot; empty ones have no area.
  std::vector<VplLight> read() const;

 private:
  void reserve(uint32_t slots);

  PassContext context_;
  bool grid_ = false; // what `lights_` holds
  gl::Buffer lights_, compact_;
  gl::Texture compactView_;
  gl::Ring lenses_{"reflective lights/lenses"};
  uint32_t count_ = 0;
};

/// What drawGather draws in place of VPLs: irradiance from the trees of all maps. Each fragment descends from the
/// coarsest clusters and stops where what a cluster may bring stays below τ (paper 3, eq. 7 and 8): P A/(π r² + A),
/// with P the light of its map as a share of the brightest map's, A the bound of its area, r the distance of its mean
/// place.
struct LightTrees {
  const ReflectiveMaps& maps;
  const RsmSettings& rsm;
  /// Clusters that a fragment looks at in one draw: watchdogs stop a GPU that works on one for seconds, and software
  /// Mesa leaves a loop after 65 536 turns.
  int mostTurns = 4096;
};

} // namespace lambent

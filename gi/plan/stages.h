// Every stage of a frame that is timed, on the CPU or the GPU: a row of the panel, a column of frames.csv.
#pragma once

#include "engine/core/profile.h"

#include <iterator>

namespace lambent {

enum class StageId : uint16_t {
  Scene,
  // virtual lights on the CPU (gi/vpl)
  Validate,
  Points,
  Candidates,
  Resample,
  Radiosity,
  Replace,
  Density,
  Photons, // ir
  Chains,  // tcas
  // virtual lights on the GPU (gi/reflective, gi/sources)
  ReflectiveMaps,
  LightPatches, // of reflective maps
  ReflectiveLights,
  Vpls, // upload
  // surfaces
  Surfaces,
  Patches,
  // direct light
  LightMaps,
  Emitters, // upload
  EmitterMaps,
  Direct,
  ShadowRays, // where maps are in doubt
  AreaRays,   // between emissive surfaces and patches
  AreaLight,
  // who sees whom
  VplMaps,
  MapComparison,
  // indirect light
  Gather,
  MapChecks,
  NearLight,
  GatherByRays,
  IrradianceUpload,
  Stencil,
  Refine,
  Splat,
  SplatPerVpl,
  VolumeVisibility, // which cells of a volume see one another
  Inject,
  Propagate,
  Cube,      // lights put into it and taken out
  Hemicubes, // of these, drawn
  Upsample,
  History,
  Filter,
  // image
  Composite,
  Display,
  AntiAliasing,
  Present,
};

inline constexpr const char* kStageNames[] = {"scene",
                                              "validate",
                                              "points",
                                              "candidates",
                                              "resample",
                                              "radiosity",
                                              "replace",
                                              "density",
                                              "photons",
                                              "chains",
                                              "reflective maps",
                                              "light patches",
                                              "reflective lights",
                                              "vpls",
                                              "g-buffer",
                                              "patches",
                                              "light maps",
                                              "emitters",
                                              "emitter maps",
                                              "direct",
                                              "shadow rays",
                                              "area rays",
                                              "area light",
                                              "vpl maps",
                                              "map comparison",
                                              "gather",
                                              "map checks",
                                              "near light",
                                              "gather by rays",
                                              "irradiance upload",
                                              "stencil",
                                              "refine",
                                              "splat",
                                              "splat per VPL",
                                              "volume sights",
                                              "inject",
                                              "propagate",
                                              "cube",
                                              "hemicubes",
                                              "upsample",
                                              "history",
                                              "filter",
                                              "composite",
                                              "display",
                                              "antialiasing",
                                              "present"};
inline constexpr size_t kStages = std::size(kStageNames);
static_assert(kStages == size_t(StageId::Present) + 1);

constexpr StageKey key(StageId id) { return {uint16_t(id), kStageNames[size_t(id)]}; }

} // namespace lambent

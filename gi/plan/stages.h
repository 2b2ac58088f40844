// Every stage of a frame that is timed, on the CPU or the GPU: a row of the panel, a column of frames.csv.
#pragma once

#include "engine/core/profile.h"

#include <iterator>

namespace lambent {

/// STAGE(id, name) for each.
#define LAMBENT_STAGES(STAGE)                                                                                          \
  STAGE(Scene, "scene")                                                                                                \
  /* virtual lights on the CPU (gi/vpl) */                                                                             \
  STAGE(Validate, "validate")                                                                                          \
  STAGE(Points, "points")                                                                                              \
  STAGE(Candidates, "candidates")                                                                                      \
  STAGE(Resample, "resample")                                                                                          \
  STAGE(Radiosity, "radiosity")                                                                                        \
  STAGE(Replace, "replace")                                                                                            \
  STAGE(Density, "density")                                                                                            \
  STAGE(Photons, "photons") /* ir */                                                                                   \
  STAGE(Chains, "chains")   /* tcas */                                                                                 \
  /* virtual lights on the GPU (gi/reflective, gi/sources) */                                                          \
  STAGE(ReflectiveMaps, "reflective maps")                                                                             \
  STAGE(LightPatches, "light patches") /* of reflective maps */                                                        \
  STAGE(ReflectiveLights, "reflective lights")                                                                         \
  STAGE(Vpls, "vpls") /* upload */                                                                                     \
  /* surfaces */                                                                                                       \
  STAGE(Surfaces, "g-buffer")                                                                                          \
  STAGE(Patches, "patches")                                                                                            \
  /* direct light */                                                                                                   \
  STAGE(LightMaps, "light maps")                                                                                       \
  STAGE(Emitters, "emitters") /* upload */                                                                             \
  STAGE(EmitterMaps, "emitter maps")                                                                                   \
  STAGE(Direct, "direct")                                                                                              \
  STAGE(ShadowRays, "shadow rays") /* where maps are in doubt */                                                       \
  STAGE(AreaRays, "area rays")     /* between emissive surfaces and patches */                                         \
  STAGE(SoftRays, "soft rays")     /* from pixels to what has a size */                                                \
  STAGE(SoftLight, "soft light")   /* their light, averaged over frames and denoised */                                \
  STAGE(AreaLight, "area light")                                                                                       \
  /* who sees whom */                                                                                                  \
  STAGE(VplMaps, "vpl maps")                                                                                           \
  STAGE(MapComparison, "map comparison")                                                                               \
  /* indirect light */                                                                                                 \
  STAGE(Lists, "light lists")                                                                                          \
  STAGE(Gather, "gather")                                                                                              \
  STAGE(MapChecks, "map checks")                                                                                       \
  STAGE(NearLight, "near light")                                                                                       \
  STAGE(MirrorRays, "mirror rays") /* by lobes of smooth surfaces */                                                   \
  STAGE(Mirrors, "mirrors")        /* their light, averaged over frames and denoised */                                \
  STAGE(GatherByRays, "gather by rays")                                                                                \
  STAGE(IrradianceUpload, "irradiance upload")                                                                         \
  STAGE(Stencil, "stencil")                                                                                            \
  STAGE(Refine, "refine")                                                                                              \
  STAGE(Splat, "splat")                                                                                                \
  STAGE(SplatPerVpl, "splat per VPL")                                                                                  \
  STAGE(VolumeVisibility, "volume sights") /* which cells of a volume see one another */                               \
  STAGE(Inject, "inject")                                                                                              \
  STAGE(Propagate, "propagate")                                                                                        \
  STAGE(Cube, "cube")           /* lights put into it and taken out */                                                 \
  STAGE(Hemicubes, "hemicubes") /* of these, drawn */                                                                  \
  STAGE(Upsample, "upsample")                                                                                          \
  STAGE(History, "history")                                                                                            \
  STAGE(Filter, "filter")                                                                                              \
  /* image */                                                                                                          \
  STAGE(Composite, "composite")                                                                                        \
  STAGE(Display, "display")                                                                                            \
  STAGE(AntiAliasing, "antialiasing")                                                                                  \
  STAGE(Present, "present")

enum class StageId : uint16_t {
#define STAGE(id, name) id,
  LAMBENT_STAGES(STAGE)
#undef STAGE
};

inline constexpr const char* kStageNames[] = {
#define STAGE(id, name) name,
    LAMBENT_STAGES(STAGE)
#undef STAGE
};
inline constexpr size_t kStages = std::size(kStageNames);

constexpr StageKey key(StageId id) { return {uint16_t(id), kStageNames[size_t(id)]}; }

} // namespace lambent

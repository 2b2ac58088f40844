// All that a GiFrame keeps, for the source files of its frame: gi_frame.cpp (the frame as a whole), gi_frame_light.cpp
// (VPLs and what the GPU needs of them), gi_frame_draw.cpp (the passes).
#pragma once

#include "engine/trace/embree_query.h"
#include "gi/frame/gi_frame.h"
#include "gi/visibility/map_schedule.h"
#include "gi/contract/passes.h"
#include "gi/lights/reflective_maps.h"
#include "gi/vpl/sources.h"

#include <chrono>
#include <future>

namespace lambent {

/// A view with spans of its own: the scene's live only until its next extraction.
struct WorldCopy {
  SceneView view;
  std::vector<InstanceView> instances;
  std::vector<LightView> lights;
  std::vector<Aabb> addedOrRemoved;

  /// With `frozen` the instances stay what and where they were.
  void take(const SceneView& now, bool frozen) {
    lights.assign(now.lights.begin(), now.lights.end());
    const Aabb bounds = view.boundsWorld;
    view = now;
    if (frozen) {
      for (InstanceView& i : instances) {
        i.moved = i.reshaped = false;
        i.worldFromObjectBefore = i.worldFromObject;
        i.boundsWorldBefore = i.boundsWorld;
      }
      addedOrRemoved.clear();
      view.changes.geometry = view.changes.instances = false;
      view.boundsWorld = bounds;
    } else {
      instances.assign(now.instances.begin(), now.instances.end());
      addedOrRemoved.assign(now.addedOrRemoved.begin(), now.addedOrRemoved.end());
    }
    view.instances = instances;
    view.lights = lights;
    view.addedOrRemoved = addedOrRemoved;
  }
};

/// What an update of the VPLs depends on besides the world.
struct UpdateTask {
  SmcSettings smc;
  VplSettings vpl;
  VplEffects effects;
  bool settingsChanged;
  bool pretended; // done on a copy that is thrown away, because nothing calls for it
};

struct GiFrame::State {
  Settings settings, settingsBefore;
  uint32_t seed;

  gl::ProgramCache programs;
  gl::GpuProfiler profiler;
  PassContext context{programs, profiler};
  GBufferPass gbufferPass{context};
  LightShadowPass lightShadowPass{context};
  ParaboloidMapPass emitterMapPass{context, StageId::EmitterMaps};
  VplLightBuffer emitterBuffer{context, StageId::Emitters};
  DirectPass directPass{context};
  ParaboloidMapPass vplMapPass{context, StageId::VplMaps};
  VplLightBuffer vplBuffer{context, StageId::Vpls};
  GatherPass gatherPass{context};
  MultiresPass multiresPass{context};
  ReflectiveMapPass reflectiveMapPass{context};
  ReflectiveLightPass reflectiveLightPass{context};
  FilterPass filterPass{context};
  IndirectUpload indirectUpload{context};
  CompositePass compositePass{context};
  mutable DisplayPass displayPass{context};

  const SceneAssets* assets = nullptr;
  std::unique_ptr<GpuScene> gpuScene;
  std::unique_ptr<EmbreeQuery> rays;
  WorldCopy world;
  Disturbance disturbance; // where this frame's world moved
  LightSet lights;
  EffectPlan plan;
  bool settingsChanged = true, shadersChanged = false;
  bool missed = false; // something changed that VPLs or shadow maps were not told of
  bool frozen = false; // objects stand where they stood

  VplSet vpls;
  VplChanges changes;
  VplUpdateLog log;
  bool lightArrived = false; // an update ended that no picture shows yet

  std::vector<VplLight> vplLights;
  std::vector<Vpl> vplsShown; // only for a gather by rays
  std::vector<MapPose> poses, emitterPoses;
  std::vector<MapJob> mapJobs;
  MapSchedule mapSchedule;
  bool vplMapsOld = false;        // VPLs were shown without maps
  bool reflectiveMapsOld = false; // frames passed without them
  float farDistance = 0;
  Aabb receivers;           // see visibleBounds
  uint64_t testedDraws = 0; // GpuScene's count at the end of the last frame
  bool calibrated = false;
  float exposure = 0;

  FrameResults results;
  FrameStats stats;
  std::future<void> updating; // last: its task uses the others

  State(const Settings& s, uint32_t seed_) : settings(s), seed(seed_) {}

  void begin(const SceneView& given);
  void planFrame(const SceneView& given);
  void placeWorld();
  void updateLight(const std::function<void(int, int)>& progress);
  UpdateTask updateTask(bool pretended) const;
  void update(const UpdateTask& task, const std::function<void(int, int)>& progress);
  void finishUpdate();
  void showUpdate();
  float mapReach();
  void prepareVplMaps(bool beside, const std::vector<uint32_t>& carried);
  void draw();
  std::vector<MapJob> emitterMapJobs(std::span<const MapPose> emitters, int resolution);
  DirectLight drawDirect(const GBuffer& gbuffer);
  IndirectLight drawIndirect(const GBuffer& gbuffer);
  VplLights reflectiveLights(const ReflectiveMaps& sheet);
  void countWork();

  uint64_t& work(EffectId id) { return stats.work[size_t(id)]; }
};

} // namespace lambent

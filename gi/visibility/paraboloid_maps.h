// Distance maps of virtual lights and of emissive samples: kept, and drawn by one of two makers.
#pragma once

#include "gi/contract/maker_choice.h"
#include "gi/contract/pass_context.h"
#include "gi/contract/virtual_lights.h"
#include "gi/plan/settings.h"
#include "gi/surfaces/gpu_scene.h"

#include <string>
#include <vector>

namespace lambent {

class RayQuery;

struct ParaboloidMapInputs {
  const GpuScene& scene;
  const RayQuery* rays = nullptr;    // null: raster only
  std::span<const MapPose> poses;    // all slots
  std::span<const MapJob> jobs = {}; // what to redraw; the rest keeps its texels. By slot, one each
  float farDistance = 1;             // scene diameter, metres
  int resolution = 128;              // no map is kept when it, farDistance or their number changes
  ShadowMaker maker = ShadowMaker::Auto;
  bool checkered = false;  // blended surfaces are in every other texel, so that none agree on them. By rays only
  bool jobsAreAll = false; // where none is kept too, since slots without a job have no light; else all are drawn then
};

/// Both makers' maps of one slot, distances in metres, row 0 at v = 0, kInfinity where nothing is met.
struct MakerComparison {
  int resolution = 0;
  std::vector<float> raster, rays;
};

class ParaboloidMapPass {
 public:
  /// `stage` names its times and its memory.
  ParaboloidMapPass(PassContext context, StageId stage) : context_(context), stage_(stage), name_(key(stage).name) {}

  ParaboloidMaps run(const ParaboloidMapInputs& in);
  /// Says whether a run would keep no map, whatever its jobs.
  bool redrawsAll(const ParaboloidMapInputs& in) const;

  uint32_t mapsDrawn() const { return mapsDrawn_; } // in the last run, in part or whole
  /// Says which maker draws and how it was chosen. Empty before the first map.
  const MakerChoice& maker() const { return maker_; }
  /// Reads the stored map of a slot, as distances in metres (kInfinity where nothing is met).
  std::vector<float> readLayer(uint32_t slot) const;
  /// Draws one pose with both makers into scratch maps, for the measure of their agreement. Requires in.rays.
  MakerComparison compareMakers(const ParaboloidMapInputs& in, const MapPose& pose);

 private:
  void allocate(const ParaboloidMapInputs& in);
  MakerTimes timesOf(const ParaboloidMapInputs& in, std::span<const MapJob> jobs);
  void draw(const ParaboloidMapInputs& in, std::span<const MapJob> jobs, bool partsByRays);
  void drawRaster(const ParaboloidMapInputs& in, std::span<const MapJob> jobs);
  void drawRays(const ParaboloidMapInputs& in, std::span<const MapJob> jobs);
  void rasterInto(const ParaboloidMapInputs& in, const MapPose& pose, const gl::Texture& array, int layer);

  PassContext context_;
  StageId stage_;
  std::string name_;
  MakerChoice maker_{context_, "rays", "raster"};
  std::vector<gl::Texture> arrays_;
  gl::Texture faces_;
  gl::Framebuffer facesFramebuffer_, layerFramebuffer_;
  int resolution_ = 0;
  size_t slots_ = 0;
  float farDistance_ = 0;
  bool checkered_ = false;
  uint32_t mapsDrawn_ = 0;
};

} // namespace lambent

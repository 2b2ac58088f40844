// GPU passes of one frame, in data-flow order. Every stage is `Outputs run(Inputs)`; outputs name the textures that the
// next stages read, valid until the stage's next run. Textures have GL's row order (row 0 at the bottom); images on the
// CPU have row 0 at the top, and the functions here turn them over.
//
//   GpuScene → GBufferPass ─────────────┬──────────────────────────────┐
//   LightShadowPass → DirectPass ───────┤                              │
//   VplLightBuffer, ParaboloidMapPass → GatherPass → FilterPass ───────┤  (or uploadIndirect)
//                                                      CompositePass → DisplayPass
#pragma once

#include "engine/core/image.h"
#include "engine/gl/objects.h"
#include "engine/gl/profiler.h"
#include "engine/gl/program.h"
#include "engine/gl/ring.h"
#include "engine/scene/scene_view.h"
#include "engine/trace/ray_query.h"
#include "gi/contract/map_job.h"
#include "gi/plan/settings.h"
#include "gi/plan/stages.h"
#include "gi/surfaces/gpu_scene.h"
#include "gi/vpl/light_set.h"
#include "gi/vpl/vpl_set.h"
#include "shaders/shared/camera_block.h"
#include "shaders/shared/vpl_light.h"

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lambent {

enum class Buffer : int; // gi/frame/gi_frame.h

/// What every pass works with. Must outlive the passes.
struct PassContext {
  gl::ProgramCache& programs;
  gl::GpuProfiler& profiler;

  /// What all GL commands of a stage run inside.
  gl::PassScope scope(StageId stage) const { return {profiler, key(stage)}; }
};

// 1. G-buffer ---------------------------------------------------------------------------------------------------------

/// Surfaces seen by the camera. World position follows from `depth` and `camera` (shaders/lib/gbuffer.glsl).
struct GBuffer {
  const gl::Texture* depth = nullptr;      // DEPTH32F, reversed: 0 where nothing is seen
  const gl::Texture* normal = nullptr;     // RGBA16F world shading normal, turned to the viewer
  const gl::Texture* albedo = nullptr;     // RGBA16F
  const gl::Texture* emission = nullptr;   // RGBA16F radiance emitted towards the viewer, W/(m² sr)
  const gl::Texture* finish = nullptr;     // RG16 roughness (at least kLeastRoughness), metalness; null: all is Lambert
  const gl::BufferSlice* camera = nullptr; // uniform block CameraBlock (shaders/shared/camera_block.h)
  CameraBlock block;                       // what `camera` holds
  int width = 0, height = 0;
};

struct GBufferInputs {
  const GpuScene& scene;
  const CameraView& camera;
  bool glossy = false; // with `finish`: the passes that follow then add glossy reflection
};

/// The block of a camera; `orthoFar` is the far plane of an orthographic one, metres.
CameraBlock cameraBlock(const CameraView& camera, float orthoFar);

class GBufferPass {
 public:
  explicit GBufferPass(PassContext context) : context_(context) {}
  GBuffer run(const GBufferInputs& in);

 private:
  PassContext context_;
  gl::Texture depth_, normal_, albedo_, emission_, finish_;
  gl::Framebuffer framebuffer_;
  gl::Ring cameras_{"g-buffer/camera"};
  gl::BufferSlice camera_; // of the last run
};

// 2. Shadow maps of VPLs and of emissive samples ---------------------------------------------------------------------

/// Poses of all slots of a set (empty slots too).
std::vector<MapPose> mapPoses(const VplSet& set);

/// Distance maps of one set of lights: DEPTH16 texture arrays of up to 2048 layers, layer = slot mod 2048 of array
/// slot / 2048; texels hold distance / farDistance along the ray, 1 where nothing is met.
struct ParaboloidMaps {
  std::span<const gl::Texture> arrays;
  int resolution = 0;
  float farDistance = 1; // metres
};

struct ParaboloidMapInputs {
  const GpuScene& scene;
  const RayQuery* rays = nullptr; // null: raster only
  std::span<const MapPose> poses; // all slots
  std::span<const MapJob> jobs;   // what to draw anew; the rest keeps its texels. By slot, one each
  float farDistance = 1;          // scene diameter, metres
  int resolution = 128;           // every slot is drawn anew when it, farDistance or the number of slots changes
  ShadowMaker maker = ShadowMaker::Auto;
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
  /// Whether a run would draw every map, whatever its jobs.
  bool drawsAllAnew(const ParaboloidMapInputs& in) const;

  uint32_t mapsDrawn() const { return mapsDrawn_; } // in the last run, in part or whole
  /// Who draws, and how it was chosen: "rays (2.1 ms a map, raster 14.0 ms)". Empty before the first map.
  const std::string& makerReport() const { return makerReport_; }
  /// The stored map of a slot, as distances in metres (kInfinity where nothing is met).
  std::vector<float> readLayer(uint32_t slot) const;
  /// Draws one pose with both makers into scratch maps, for the measure of their agreement. Requires in.rays.
  MakerComparison compareMakers(const ParaboloidMapInputs& in, const MapPose& pose);

 private:
  void allocate(const ParaboloidMapInputs& in);
  void measureMakers(const ParaboloidMapInputs& in, std::span<const MapJob> jobs);
  void drawRaster(const ParaboloidMapInputs& in, std::span<const MapJob> jobs);
  void drawRays(const ParaboloidMapInputs& in, std::span<const MapJob> jobs);
  void rasterInto(const ParaboloidMapInputs& in, const MapPose& pose, const gl::Texture& array, int layer);

  PassContext context_;
  StageId stage_;
  std::string name_, makerReport_;
  std::vector<gl::Texture> arrays_;
  gl::Texture faces_;
  gl::Framebuffer facesFramebuffer_, layerFramebuffer_;
  int resolution_ = 0;
  size_t slots_ = 0;
  float farDistance_ = 0;
  std::optional<ShadowMaker> measuredMaker_;
  uint32_t mapsDrawn_ = 0;
};

// 3. VPLs as the gather reads them ------------------------------------------------------------------------------------

/// Place of a slot in VplLights::buffer.
uint32_t lightOrder(uint32_t slot);

/// The light of a slot; empty (a = 0) when it is not alive or brings nothing.
VplLight vplLight(const Vpl& vpl);
/// What of a VPL its light tells: all that rendering needs.
Vpl vplOf(const VplLight& light);

/// Lights in chunks of 2048, as many as a map array has layers. Within chunk k, class c (slot mod 16) is contiguous:
/// light k·2048 + c·128 + (slot mod 2048)/16, so that 8 classes are one uniform block of 64 KiB.
struct VplLights {
  const gl::Buffer* buffer = nullptr;
  uint32_t count = 0; // slots
};

class VplLightBuffer {
 public:
  VplLightBuffer(PassContext context, StageId stage)
      : context_(context), stage_(stage), changes_(std::string(key(stage).name) + "/changed lights") {}
  /// Uploads the slots whose light differs from what the buffer holds.
  VplLights run(std::span<const VplLight> slots);
  uint32_t uploaded() const { return uploaded_; } // lights that differed in the last run

 private:
  PassContext context_;
  StageId stage_;
  gl::Buffer buffer_;
  gl::Ring changes_;
  std::vector<VplLight> mirror_; // in buffer order
  uint32_t count_ = 0, uploaded_ = 0;
};

// 4. Direct light -----------------------------------------------------------------------------------------------------

/// Shadow maps of all punctual lights and of the sky's directions, for one box of receivers.
struct LightShadows;

struct LightShadowInputs {
  const GpuScene& scene;
  std::span<const LightView> lights;
  bool sky = false; // draw the sky's maps
  vec3 skyRadiance{0};
  Aabb receivers;              // everything the camera sees; sun and sky maps are fitted to it
  Aabb casters;                // box of the whole scene
  bool allChanged = false;     // draw every map
  std::span<const Aabb> moved; // where geometry changed: maps that show none of it stay
  const ShadowSettings& shadow;
};

struct LightShadowState;
class LightShadowPass {
 public:
  explicit LightShadowPass(PassContext context);
  ~LightShadowPass();
  /// Draws only maps whose light, fit or casters changed, and of cubes only the faces.
  const LightShadows& run(const LightShadowInputs& in);
  uint32_t mapsDrawn() const;    // in the last run
  uint32_t skyMapsDrawn() const; // of these

 private:
  std::unique_ptr<LightShadowState> state_;
};

struct DirectInputs {
  const GBuffer& gbuffer;
  const LightShadows& shadows;
  // Emissive surfaces; leave out when there are none. Use emitterLight() for the lights, their poses for the maps.
  const VplLights* emitters = nullptr;
  const ParaboloidMaps* emitterMaps = nullptr; // null: unshadowed
  const ShadowSettings& shadow;
};
VplLight emitterLight(const EmitterPatch& patch);
MapPose emitterPose(const EmitterPatch& patch);

/// Direct irradiance at the visible surfaces, W/m², albedo not included.
struct DirectLight {
  const gl::Texture* irradiance = nullptr; // RGBA32F
  const gl::Texture* glossy = nullptr;     // RGBA32F reflected by the receivers' lobes, W/(m² sr) over glossyTint
};

class DirectPass {
 public:
  explicit DirectPass(PassContext context);
  DirectLight run(const DirectInputs& in);

 private:
  PassContext context_;
  gl::Sampler compareSampler_; // bilinear depth comparison for the emitters' maps
  gl::Texture irradiance_, glossy_;
  gl::Framebuffer framebuffer_;
};

// 5. Indirect light ---------------------------------------------------------------------------------------------------

/// Irradiance as gathered. De-interleaved: 16 sub-images in a 4×4 grid of tiles of ⌈W/4⌉×⌈H/4⌉; tile (x mod 4, y mod 4)
/// holds pixel (x, y) at (x/4, y/4), lit by the lights of class (x mod 4) + 4·(y mod 4), times 16.
struct RawIndirect {
  const gl::Texture* irradiance = nullptr; // RGBA32F
  bool deinterleaved = false;
  const gl::Texture* glossy =
      nullptr; // as DirectLight::glossy, in the same places; null unless gbuffer.finish is there
};

struct LightTrees; // gi/lights/reflective_maps.h

struct GatherInputs {
  const GBuffer& gbuffer;
  const VplLights& lights;
  const ParaboloidMaps* maps = nullptr; // null: no visibility
  float bias = 1;                       // ShadowSettings::bias, texels
  const GatherSettings& gather;
  const LightTrees* trees = nullptr; // gathered in place of `lights`, without visibility
};

class GatherPass {
 public:
  explicit GatherPass(PassContext context) : context_(context) {}
  RawIndirect run(const GatherInputs& in);

 private:
  PassContext context_;
  gl::Texture irradiance_, glossy_;
  gl::Framebuffer framebuffer_;
};

/// Indirect irradiance at the visible surfaces, W/m². Null texture: none.
struct IndirectLight {
  const gl::Texture* irradiance = nullptr; // RGBA32F
  const gl::Texture* glossy = nullptr;     // as DirectLight::glossy
};

struct FilterInputs {
  const GBuffer& gbuffer;
  const RawIndirect& raw;
  const FilterSettings& filter;
};

/// Cross-bilateral 7×7; with the filter off only puts the pixels back in their places. A full gather passes through.
class FilterPass {
 public:
  explicit FilterPass(PassContext context) : context_(context) {}
  IndirectLight run(const FilterInputs& in);

 private:
  PassContext context_;
  gl::Texture irradiance_, rows_, glossy_, glossyRows_;
  gl::Framebuffer framebuffer_, rowsFramebuffer_;
};

/// Irradiance, and glossy light if there is any, computed on the CPU (vpl.visibility = rays), in place of gather and
/// filter.
class IndirectUpload {
 public:
  explicit IndirectUpload(PassContext context) : context_(context) {}
  IndirectLight run(const Image& irradiance, const Image* glossy = nullptr);

 private:
  PassContext context_;
  gl::Texture irradiance_, glossy_;
};

// 6. Picture ----------------------------------------------------------------------------------------------------------

/// Radiance towards the camera, W/(m² sr).
struct Picture {
  const gl::Texture* radiance = nullptr; // RGBA32F; a = 1 on surfaces, 0 on background
};

struct CompositeInputs {
  const GBuffer& gbuffer;
  const DirectLight& direct;
  const IndirectLight& indirect;
  vec3 skyRadiance{0};
};

class CompositePass {
 public:
  explicit CompositePass(PassContext context) : context_(context) {}
  /// emission + albedo/π · (E_direct + E_indirect) + glossy light; the sky where nothing is seen.
  Picture run(const CompositeInputs& in);

 private:
  PassContext context_;
  gl::Texture radiance_, black_;
  gl::Framebuffer framebuffer_;
};

/// Factor that brings the log-average luminance of the picture's surfaces (black ones left out) to 0.18; 1 when there
/// is no light. Reads the picture back: meant to run once.
float measureExposure(const Picture& picture);

// 7. Looking at it ----------------------------------------------------------------------------------------------------

/// Everything a frame made, for read-back and views. Null where a stage did not run.
struct FrameResults {
  GBuffer gbuffer;
  DirectLight direct;
  RawIndirect raw;
  IndirectLight indirect;
  Picture picture;
  ParaboloidMaps vplMaps;
  const gl::Texture* patches = nullptr; // PatchPyramid::normalLo of the picture
  int patchLevels = 0;
  const VplSet* vpls = nullptr;
  vec3 skyRadiance{0};
  float sceneDiameter = 1; // metres; scales the depth view
};

class DisplayPass {
 public:
  explicit DisplayPass(PassContext context) : context_(context) {}

  /// Draws `buffer` as a display shows it into a texture (RGBA8, sRGB-encoded) of the picture's size.
  /// `markNan`: paint NaN magenta and infinity cyan in every radiometric view.
  const gl::Texture& run(Buffer buffer, const FrameResults& frame, float exposure, bool markNan);
  /// Draws the texture of the last run into framebuffer `framebuffer`, scaled to width × height.
  void present(uint32_t framebuffer, int width, int height);
  /// The texture of the last run.
  Image8 read() const;

 private:
  void drawVpls(const FrameResults& frame);

  PassContext context_;
  gl::Texture display_, black_;
  gl::Framebuffer framebuffer_;
  gl::Ring sprites_{"display/vpls"};
  gl::VertexArray spriteArray_;
};

/// Linear values of a buffer: radiance for beauty, direct (emission and background included: beauty − indirect),
/// indirect, emission; irradiance (indirect, filtered) and unfiltered; albedo; world normal; depth in metres along the
/// view direction, 0 on background. The other views give beauty. Stages that did not run read as black.
Image readBuffer(Buffer buffer, const FrameResults& frame);

} // namespace lambent

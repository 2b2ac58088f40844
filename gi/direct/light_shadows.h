// Shadow maps of punctual lights and sky directions, as the direct pass reads them.
#pragma once

#include "engine/gl/ring.h"
#include "gi/contract/light_views.h"
#include "gi/contract/pass_context.h"
#include "gi/plan/settings.h"
#include "gi/surfaces/gpu_scene.h"
#include "shaders/shared/light_record.h"

#include <memory>
#include <span>

namespace lambent {

/// How the map of a direct light is made: a cube of depths, one perspective (spots, and lamps far from what is seen),
/// parallel rays (suns, and directions of the sky), distances over a hemisphere (samples of emissive surfaces).
enum class MapKind { Cube, Spot, Sun, Sky, Emitter };

/// Up to kLightsPerBlock lights of one kind, with their maps in one texture array.
struct LightBlock {
  MapKind kind = MapKind::Sun;
  const gl::Texture* maps = nullptr;  // DEPTH32F reversed; of emitters as ParaboloidMaps
  const gl::Buffer* lights = nullptr; // LightRecords
  std::span<const LightRecord> held;  // what `lights` holds
  uint32_t first = 0;                 // of its lights, among all of the frame
};

/// Light records on the GPU: those that differ from what it has are uploaded.
class LightRecords {
 public:
  /// Takes at most kLightsPerBlock lights.
  void hold(std::vector<LightRecord> lights, gl::Ring& uploads);
  const gl::Buffer& buffer() const { return buffer_; }
  std::span<const LightRecord> held() const { return held_; }

 private:
  gl::Buffer buffer_;
  std::vector<LightRecord> held_;
};

/// Orthographic view along a light's direction, in its own frame: xy across, z towards the light.
struct SunFit {
  vec3 direction{0};
  vec2 lo{0}, hi{0};
  float zLo = 0, zHi = 0;

  mat4 clipFromWorld() const; // reversed depth: 1 at the light's end
  vec2 size() const { return hi - lo; }
};
/// Covers `receivers` across and `casters` along the light. Keeps `previous` while it still covers them and is not more
/// than twice as large as needed, so that a slow camera redraws nothing; a new fit has a tenth to spare on each side.
SunFit fitSun(const vec3& direction, const Aabb& receivers, const Aabb& casters, const SunFit& previous);

/// Leaves out places, at most a thirtieth, that make their box much larger than the rest needs.
std::vector<vec3> withoutOutliers(std::vector<vec3> places);

/// `count` directions that stand for the sky, each with the irradiance that it brings to a surface facing it. Of a
/// constant sky they are spread evenly, else in proportion to luminance; what a plane without obstacles gets from above
/// and from below is exact where any of them come from there.
struct SkyDirection {
  vec3 direction; // unit, the way the light travels
  vec3 irradiance;
};
std::vector<SkyDirection> skyDirections(const Sky& sky, int count);

struct LightShadowInputs {
  const GpuScene& scene;
  std::span<const LightView> lights;
  bool drawSky = false;
  Sky sky;
  Aabb receivers, sunReceivers; // what maps of the sky, and of suns and far lamps, are fitted to
  Aabb casters;                 // box of the whole scene
  bool allChanged = false;      // draw every map
  std::span<const Aabb> moved;  // where geometry changed: maps that show none of it stay
  const ShadowSettings& shadow;
};

struct LightShadowState;
class LightShadowPass {
 public:
  explicit LightShadowPass(PassContext context);
  ~LightShadowPass();
  /// Draws only maps whose light, fit or casters changed, and of cubes only the changed faces.
  std::vector<LightBlock> run(const LightShadowInputs& in);
  uint32_t mapsDrawn() const;    // in the last run
  uint32_t skyMapsDrawn() const; // of these

 private:
  std::unique_ptr<LightShadowState> state_;
};

} // namespace lambent

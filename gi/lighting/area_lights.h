// Emissive surfaces as area lights: pieces whose unshadowed light is known in closed form, and points that rays are
// sent to. Paper 4, section 3.1.
#pragma once

#include "gi/lighting/light_set.h"
#include "shaders/shared/area_piece.h"

namespace lambent {

/// A point where rays end, drawn in proportion to brightness. World space.
struct AreaSample {
  vec3 position, normal; // on the surface; unit, to the front
  vec3 radiance;         // there, times the area that it stands for over the mean sample's: all are equally bright
};

/// One emitter, or one of its parts that do not touch.
struct AreaLight {
  uint32_t firstPiece = 0, pieces = 0;   // run of AreaLights::pieces
  uint32_t firstSample = 0, samples = 0; // run of AreaLights::samples, in an order in which neighbours lie side by side
  bool doubleSided = false;
  float brought = 1; // to the image where nothing is between, relative to other lights of the group (AreaGroups)
};

struct AreaLights {
  std::vector<AreaLight> lights;
  std::vector<AreaPiece> pieces;
  std::vector<AreaSample> samples;

  static constexpr uint32_t kMostPieces = 64;       // of a light; polygons, or where these are more, disks
  static constexpr uint32_t kAllPieces = 2048;      // of all lights, but for one of each
  static constexpr uint32_t kSamples = 256;         // of a light, at most
  static constexpr uint32_t kAllSamples = 1u << 18; // of all lights, but for kLeastSamples of each
  static constexpr uint32_t kLeastSamples = 16;
};
/// Collects all emitters that bring light.
AreaLights areaLights(const LightSet& lights);

/// Irradiance from a light where nothing is between.
vec3 unshadowed(const AreaLights& all, const AreaLight& light, const vec3& position, const vec3& normal);

} // namespace lambent

// Virtual lights as sources give them, and as gathers see them.
#pragma once

#include "gi/contract/map_job.h"
#include "shaders/shared/vpl_light.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lambent {

namespace gl {
class Buffer;
class Texture;
} // namespace gl
struct LightTrees; // gi/reflective/reflective_maps.h

/// A small diffuse patch that stands for light reflected, or emitted, around it: all that rendering needs. World space.
struct VirtualLight {
  vec3 position{0};     // on the surface
  vec3 normal{0, 1, 0}; // shading normal, towards the lit side
  vec3 geometricNormal{0, 1, 0};
  vec3 radiance{0}; // W/(m² sr)
  float area = 0;   // m² that it stands for
  bool alive = false;

  /// Radiance × area, W/sr as a luminance.
  float intensity() const { return luminance(radiance) * area; }
  MapPose pose(float rayEpsilon) const {
    return {position, normal, geometricNormal, rayEpsilon};
  } // RayQuery::rayEpsilon
};

/// Lights on the GPU, in chunks of 2048, as many as a map array has layers. Within chunk k, class c (slot mod 16) is
/// contiguous: light k·2048 + c·128 + (slot mod 2048)/16, so that 8 classes are one uniform block of 64 KiB.
struct PackedLights {
  const gl::Buffer* buffer = nullptr;
  uint32_t count = 0; // slots
};

/// This frame's lights of a source. A slot keeps its number while its light stays.
struct VirtualLights {
  PackedLights packed = {};                 // what gathers read; empty where visibility or a tree does without
  std::span<const VirtualLight> slots = {}; // the same on the CPU, where visibility needs them there
  std::vector<uint32_t> moved = {};         // slots whose light is another than when last seen, ascending
  std::vector<uint32_t> carried = {}; // slots whose light is the same and stands elsewhere, on an object that moved
  bool mayWait = false;               // maps of lights that stay may follow moving objects some frames late
  const LightTrees* trees = nullptr;  // in place of a list
  uint32_t direct = ~0u;              // slots below it reflect direct light, others later bounces
  uint32_t alive = 0;                 // that bring light, as far as known
};

inline constexpr int kLayersPerArray = 2048; // what every OpenGL 4.5 offers
inline constexpr uint32_t kLightsPerChunk = kLightClasses * kLightsPerClass;
static_assert(kLightsPerChunk == kLayersPerArray);

/// Distance maps of one set of lights: DEPTH16 texture arrays of up to so many layers, layer = slot mod 2048 of array
/// slot / 2048; texels hold paraboloidValue(distance / farDistance) along the ray, 1 where nothing is met.
struct ParaboloidMaps {
  std::span<const gl::Texture> arrays;
  int resolution = 0;
  float farDistance = 1; // metres
};

/// Lights, and the maps of who sees them.
struct ShadowedLights {
  const VirtualLights& list;
  const ParaboloidMaps* maps = nullptr; // null: everywhere
};

} // namespace lambent

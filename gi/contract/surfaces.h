// Surfaces seen by a camera: drawn by gi/surfaces, or taken over from a host that has drawn them.
#pragma once

#include "shaders/shared/camera_block.h"

#include <cstdint>

namespace lambent {

namespace gl {
class Texture;
struct BufferSlice;
} // namespace gl

/// What a camera sees. World positions follow from `depth` and `camera` (shaders/lib/gbuffer.glsl).
struct GBuffer {
  const gl::Texture* depth = nullptr;    // DEPTH32F, reversed: 0 where nothing is seen
  const gl::Texture* normal = nullptr;   // RGBA16F world shading normal, turned to the viewer
  const gl::Texture* albedo = nullptr;   // RGBA16F
  const gl::Texture* emission = nullptr; // RGBA16F radiance emitted towards the viewer, W/(m² sr)
  const gl::Texture* roughnessMetalness =
      nullptr;                             // RG16 roughness (at least kLeastRoughness), metalness; null: all is Lambert
  const gl::BufferSlice* camera = nullptr; // uniform block CameraBlock (shaders/shared/camera_block.h)
  CameraBlock block;                       // what `camera` holds
  int width = 0, height = 0;
};

/// A host's own G-buffer of the view's camera and size, as names of textures in the current context. They hold what
/// GBuffer says, in any format of floats that samplers read; rows from the bottom, depth as
/// clipFromView(camera, far) of the view's camera gives it.
struct HostSurfaces {
  uint32_t depth = 0, normal = 0, albedo = 0;
  uint32_t emission = 0;           // 0: nothing glows
  uint32_t roughnessMetalness = 0; // 0: all is Lambert
};

} // namespace lambent

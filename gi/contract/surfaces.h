// Surfaces seen by a camera: drawn by gi/surfaces, or taken over from a host that has drawn them.
#pragma once

#include "engine/core/math.h"
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
  const gl::Texture* albedo = nullptr;   // RGBA16F; null: a host's that has not told it
  const gl::Texture* emission = nullptr; // RGBA16F radiance emitted towards the viewer, W/(m² sr)
  /// RGBA16 as shaders/shared/ggx.h takes it, a host's any with roughness and metalness; null: all is Lambert.
  const gl::Texture* finish = nullptr;
  /// RGBA16F as `normal`, by normal maps: of light, never of places; null: the same.
  const gl::Texture* mappedNormal = nullptr;
  /// RG16: the share that blended surfaces let through, and 1 where what is behind them is shown, 0 where one of them
  /// is; null: there are none.
  const gl::Texture* blended = nullptr;
  const gl::BufferSlice* camera = nullptr; // uniform block CameraBlock (shaders/shared/camera_block.h)
  CameraBlock block;                       // what `camera` holds
  int width = 0, height = 0;
};

enum class HostDepth : int { Reversed, Forward, Linear }; // Linear: metres along the view direction, in red
enum class HostNormals : int { Xyz, Unorm, Octahedral, OctahedralUnorm };

/// How a host's textures are to be read, where they are not as ours.
struct HostConventions {
  HostDepth depth = HostDepth::Reversed;
  bool depthMinusOne = false; // depth is stored as -1..1
  float near = 0;             // planes of the host's projection, metres; near 0: depth is as clipFromView gives it
  float far = kInfinity;
  HostNormals normals = HostNormals::Xyz; // octahedral: shaders/shared/octahedral.h
  bool viewSpace = false;                 // normals are of view space
  bool originTop = false;                 // rows from the top
  int x = 0, y = 0;                       // where the view's rectangle begins, in rows and columns as stored

  /// Says whether textures can be read without being converted.
  bool ours() const { return *this == HostConventions{}; }
  bool operator==(const HostConventions&) const = default;
};

/// A host's own G-buffer of the view's camera, as names of textures in the current context, in any format that samplers
/// read as floats. By default they have the view's size, hold what GBuffer says, rows from the bottom, and depth as
/// clipFromView(camera, far) of the view's camera gives it.
struct HostSurfaces {
  uint32_t depth = 0, normal = 0;
  uint32_t albedo = 0;   // 0: who composes the image knows it; light does without
  uint32_t emission = 0; // 0: nothing glows
  uint32_t finish = 0;   // 0: all is Lambert; of hosts with our conventions only; RG: blue 0, alpha 1
  HostConventions conventions = {};
};

} // namespace lambent

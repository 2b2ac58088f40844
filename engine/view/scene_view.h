// The scene of one frame as plain spans, extracted from the ECS: what the GI module reads. World space.
#pragma once

#include "engine/core/math.h"
#include "engine/view/assets.h"
#include "engine/view/sky.h"

#include <memory>
#include <span>

namespace lambent {

/// Vertices of an instance whose mesh is skinned or morphed, as posed now: next to those of its Mesh, in the same
/// object space, with unit normals. Triangles, texture coordinates and colours stay the mesh's.
struct DeformedMesh {
  std::vector<vec3> positions, normals;
  std::vector<vec4> tangents;              // as the mesh's; empty: those of the mesh
  std::vector<Aabb> primitiveBoundsObject; // parallel to Mesh::primitives
  Aabb boundsObject;
  /// Different for every shape that this process has made: who keeps a copy knows by it whether the copy still holds.
  /// Says nothing else, and so may not enter a result.
  uint64_t revision = 0;
};
/// An empty shape with a revision of its own.
std::shared_ptr<DeformedMesh> newShape();

/// One placed mesh. `id` is stable while the entity lives; instances keep their order between frames.
struct InstanceView {
  uint32_t id = 0;
  uint32_t mesh = 0; // index into SceneAssets::meshes
  mat4 worldFromObject{1};
  mat4 worldFromObjectBefore{1}; // of the previous extraction; equal when it did not move
  bool moved = false;            // placed or shaped otherwise than in the previous extraction
  bool reshaped = false;         // its vertices, in object space, are not those of the previous extraction
  std::shared_ptr<const DeformedMesh> deformed; // null: rigid, the mesh's own vertices; never written again
  Aabb boundsWorld;
  Aabb boundsWorldBefore; // of the previous extraction; equal when it did not move
};

enum class LightType : uint8_t { Point, Spot, Directional };

/// A punctual light. Intensity is W/sr per channel for point and spot, irradiance W/m² (facing the light) for
/// directional: glTF's candela and lux taken as they are. Spot falloff is glTF's own.
struct LightView {
  uint32_t id = 0;
  LightType type = LightType::Point;
  vec3 position{0};
  vec3 direction{0, -1, 0}; // unit, the way the light travels
  vec3 intensity{1};
  float range = kInfinity; // metres; glTF's smooth window, infinite when absent
  float innerConeCos = 1, outerConeCos = 0.70710678f;
  float angularRadius = 0; // of a directional light's disk, radians; 0: sharp shadows
  bool changed = false;    // anything of it differs from the previous extraction
};

/// Places farther than this from the scene's origin (metres, along an axis) are left out, so that squares and cubes of
/// distances stay finite.
inline constexpr float kFarthest = 1e12f;
inline bool isNear(const vec3& place) { return maxComponent(glm::abs(place)) <= kFarthest && isFinite(place); }
inline bool isNear(const Aabb& box) { return box.empty() || (isNear(box.lo) && isNear(box.hi)); }

struct CameraView {
  mat4 worldFromView{1}; // camera looks along -Z of view space, rigid (no scale)
  float fovY = 1.0f;     // radians; ignored when orthoHalfHeight > 0
  float orthoHalfHeight = 0;
  float near = 0.05f; // metres; the far plane is at infinity
  int width = 320, height = 180;
  bool throughBlended = false; // the image lacks blended surfaces, as a host's G-buffer does

  vec3 position() const { return vec3(worldFromView[3]); }
  float aspect() const { return float(width) / float(height); }
  /// Returns the camera of an image `side` times as wide and as high, in whole pixels, at least one.
  CameraView scaled(float side) const;
  bool operator==(const CameraView&) const = default;
};

struct SceneChanges {
  bool first = true;     // nothing was extracted before
  bool camera = true;    // pose, lens or size
  bool lights = true;    // any light added, removed, moved or changed; sky
  bool geometry = true;  // any instance moved or was reshaped
  bool instances = true; // instances were added or removed

  bool any() const { return first || camera || lights || geometry || instances; }
};

struct SceneView {
  const SceneAssets* assets = nullptr;
  std::span<const InstanceView> instances;
  std::span<const LightView> lights;
  std::span<const Aabb> addedOrRemoved; // world bounds of instances that came or went since the previous extraction
  Sky sky;
  CameraView camera;
  Aabb boundsWorld; // of all instances
  SceneChanges changes;
  double time = 0;   // seconds
  float rayWork = 0; // what a ray has to look at, in the mean (RayWork::sum, engine/scene/ray_work.h); 0: not known
};

/// World direction through the point (u, v) of the image, u to the right and v down in [0,1], and its origin.
struct CameraRay {
  vec3 origin, direction; // direction is unit
};
CameraRay cameraRay(const CameraView& camera, float u, float v);

/// Where in the image the centre of a pixel is, as cameraRay takes it; pixels row by row from the top.
inline vec2 pixelCentre(const CameraView& camera, size_t pixel) {
  return (vec2(pixel % size_t(camera.width), pixel / size_t(camera.width)) + 0.5f) / vec2(camera.width, camera.height);
}

/// Reversed-Z projection with infinite far plane (perspective: depth = near / distance along -Z; 0 at infinity), for
/// glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE). For an orthographic camera depth falls linearly from 1 to 0 over
/// [near, orthoFar].
mat4 clipFromView(const CameraView& camera, float orthoFar = 1000.0f);

/// Camera at `eye` looking at `target`, +Y up (another up where the view is vertical).
CameraView lookAt(const vec3& eye, const vec3& target, float fovY);

/// Rotation that turns -Z to `direction` and keeps +Y upwards as far as possible: for lights and cameras. Identity when
/// the direction has no length.
quat rotationTowards(const vec3& direction);

} // namespace lambent

// Meshes that the game itself adds to a scene. To be added before anything is built from the scene's assets.
#pragma once

#include "engine/scene/scene.h"

#include <span>
#include <string>

namespace lambent {

/// A part of a mesh: an upright box.
struct BoxPart {
  vec3 lo, hi;
};

/// A mesh of closed boxes, of one colour. Returns its index.
uint32_t addBoxesMesh(SceneAssets& assets, const std::string& name, std::span<const BoxPart> parts, const vec3& albedo);
/// One box around the origin.
uint32_t addBoxMesh(SceneAssets& assets, const std::string& name, const vec3& halfSize, const vec3& albedo);

/// An entity that shows the mesh, with its world transform in place (it has no parent yet).
Entity addInstance(Scene& scene, const std::string& name, uint32_t mesh, const Transform& place);

} // namespace lambent

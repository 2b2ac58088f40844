// Whether something on disk was made from this scene.
#pragma once

#include "engine/core/hash.h"
#include "engine/view/scene_view.h"

namespace lambent {

/// Meshes, materials, textures, and where the instances are. What only glossy receivers depend on, or those with normal
/// maps, stays out of the others' hashes.
void addGeometry(Hash& hash, const SceneView& view, bool glossy, bool normalMaps);

} // namespace lambent

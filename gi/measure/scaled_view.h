// Views changed to measure what something costs: with more of one thing and the same light on the picture, or never at
// rest.
#pragma once

#include "engine/view/scene_view.h"

#include <functional>
#include <vector>

namespace lambent {

/// Triangles cut in n² each, along their edges: the same surface, without gaps. Texture coordinates, colours and
/// normals are those between the corners. Meshes that may be deformed stay as they are.
SceneAssets tessellated(const SceneAssets& assets, uint32_t n);

/// Meshes cut in up to `parts` each.
struct Pieces {
  SceneAssets assets;
  std::vector<std::vector<uint32_t>> of; // the pieces of each mesh, as indices into assets.meshes
};
/// Each with as many triangles of each primitive, ordered along the mesh's longest side. The same triangles as before
/// in all. Meshes that may be deformed stay whole.
Pieces inPieces(const SceneAssets& assets, uint32_t parts);

/// Placed triangles.
size_t trianglesOf(const SceneView& view);

/// The view with every punctual light a ten-thousandth of the scene aside in every other frame, so that no map is kept
/// and every stage that follows them runs in every frame. `lights` holds them.
SceneView unsteady(SceneView view, int frame, std::vector<LightView>& lights);

/// A view changed in one way. What it gives points into the function and into the view given, until the next call.
using ScaledView = std::function<SceneView(SceneView)>;

/// Each punctual light as `count` lights at its place, which share its intensity.
ScaledView splitLights(uint32_t count);
/// Each instance as instances of the pieces of its mesh. `assets` are those of all views to come.
ScaledView splitInstances(const SceneAssets& assets, uint32_t parts);
/// The same surface of n² times as many triangles. `assets` are those of all views to come.
ScaledView splitTriangles(const SceneAssets& assets, uint32_t n);
/// A picture `side` times as wide and as high, of the same shape as nearly as whole pixels allow.
ScaledView resizedImage(float side);

} // namespace lambent

// The steps from a parsed document to a Scene, in data-flow order: nodes ask for meshes, meshes for materials,
// materials for images; what nothing asks for is never read. Images are decoded last, all at once.
#pragma once

#include "engine/scene/gltf_document.h"
#include "engine/scene/scene.h"

#include <map>
#include <utility>

namespace lambent::gltf {

/// What import has made so far: where a thing of the file went in SceneAssets (kNone: nothing to show).
struct Import {
  Document doc;
  Scene scene;
  std::map<std::pair<int, int>, uint32_t> meshes; // by (mesh, the node that skins it or -1)
  std::map<int, uint32_t> materials, images;      // material -1: the default one
  std::vector<mat4> worldFromNode;                // of every node that the scene reaches, at rest
  std::vector<Entity> entities;                   // by node; invalid where the scene does not reach it

  bool reached(int node) const { return entities[size_t(node)] != Entity(); }

  // Told once each, with their counts, when the import is done.
  std::map<std::string, size_t> counted; // text → how often
};

/// Entities for one scene of the file, with cameras, lights and mesh instances.
void importNodes(Import& import, const std::string& sceneName);

/// A glTF mesh as a slot of SceneAssets::meshes, kNone when it holds no triangles. With a skinned node (else -1): in
/// the rest pose of the node's skin, in the node's own space.
uint32_t importMesh(Import& import, int mesh, int skinnedNode);

/// Matrices that take each joint's vertices from the bind pose to the space of `node` with the joints at rest; empty
/// when the skin cannot be applied there.
std::vector<mat4> restSkinMatrices(Import& import, int node);

uint32_t importMaterial(Import& import, int material);

/// Fills SceneAssets::images from what the materials asked for.
void decodeImages(Import& import);

void importAnimations(Import& import);

} // namespace lambent::gltf

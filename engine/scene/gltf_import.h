// The steps from a parsed document to a Scene, in data-flow order: nodes ask for meshes, meshes for materials,
// materials for images; what nothing asks for is never read. Images are decoded last, all at once.
#pragma once

#include "engine/scene/gltf_document.h"
#include "engine/scene/scene.h"

#include <map>
#include <utility>

namespace lambent::gltf {

/// Where a mesh refers to the highest of its joints; place empty when it has none.
struct HighestJoint {
  uint32_t joint = 0;
  std::string place;
};

/// What import has made so far: where a thing of the file went in SceneAssets (kNone: nothing to show).
struct Import {
  Document doc;
  Scene scene;
  std::map<std::pair<int, bool>, uint32_t> meshes; // by (mesh, whether its joints were read)
  std::map<uint32_t, HighestJoint> highestJoints;  // by slot of SceneAssets::meshes
  std::map<int, uint32_t> materials;               // -1: the default one
  std::map<std::pair<int, bool>, uint32_t> images; // by (image, whether its colours are sRGB)
  std::map<std::pair<int, std::string>, int> firstOfSource; // image of a buffer view or file: each is decoded once
  std::vector<Entity> entities;                    // by node; invalid where the scene does not reach it
  LoadStep step;                                   // empty: nobody listens

  bool reached(int node) const { return entities[size_t(node)] != Entity(); }

  // Shares of the time that loading takes: of Sponza, with 69 images, 4 %, 6 % and 90 %.
  static constexpr float kRead = 0.04f, kMeshes = 0.1f;
  void tell(const char* at, float from, float to, size_t done, size_t of) const {
    if (step) step(at, from + (to - from) * float(done) / float(std::max<size_t>(of, 1)));
  }

  // Reported once each, with their counts, when the import is done.
  std::map<std::string, size_t> counted; // text → how often
};

/// Which of the file's scenes has that name or number, its default where the name is empty; -1: it has none. Throws
/// InputError.
int sceneOf(const Document& doc, const std::string& name);

/// Entities for a scene of the file (sceneOf), with cameras, lights and mesh instances.
void importNodes(Import& import, int scene);

/// The scene's sky, where its extras tell one; `outside`: as FileTrust.
void importSky(Import& import, int scene, bool outside);

/// A glTF mesh as a slot of SceneAssets::meshes, kNone when it holds no triangles. `skinned`: with its vertices'
/// joints.
uint32_t importMesh(Import& import, int mesh, bool skinned);

/// Skin and morph weights for the node's entity, whose mesh is in `slot`.
void importDeformation(Import& import, int node, uint32_t slot);

uint32_t importMaterial(Import& import, int material);

/// Fills SceneAssets::images from what the materials asked for.
void decodeImages(Import& import);

void importAnimations(Import& import);

} // namespace lambent::gltf

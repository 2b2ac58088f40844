// What a lambent_world holds, and the telling of it to a scene.
#pragma once

#include "engine/scene/scene.h"
#include "gi/lambent_world.h"
#include "gi/library/descriptors.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <set>
#include <tuple>

namespace lambent::library {

/// What one scene has of a world; true after each call of lambent.h, so that a call that fails can be made again.
struct Synced {
  struct Placed {
    lambent_instance instance = 0; // 0: it was refused
    uint32_t mesh = kNone;
    mat4 place{0};
    uint64_t shape = 0; // DeformedMesh::revision
    bool operator==(const Placed&) const = default;
  };
  struct Lit {
    lambent_light light = 0; // 0: it was refused
    std::optional<lambent_light_desc> as;
  };
  SceneExtractor extractor;
  // By number, as far as a call got; 0: refused, or a mesh without triangles.
  std::map<std::tuple<uint32_t, Wrap, Wrap, bool>, lambent_texture> textures;
  std::vector<lambent_material> materials;
  std::vector<lambent_mesh> meshes;
  std::map<uint32_t, Placed> instances; // by entity
  std::map<uint32_t, Lit> lights;
  std::optional<Sky> sky;
};

/// Brings a scene to what the world is. Throws Refusal where the library fails; what it does not take is left out, with
/// a warning of the world's.
void sync(lambent_world& world, lambent_device* device, lambent_scene scene);

lambent_mesh_desc describe(const Mesh& mesh); // without submeshes; points into the mesh
lambent_light_desc describe(const LightView& light);

} // namespace lambent::library

struct lambent_world {
  lambent::Scene scene;
  lambent_sky_desc sky; // as given
  std::map<std::pair<lambent_device*, lambent_scene>, lambent::library::Synced> synced;
  std::string message;
  bool dead = false; // after a fault in this code
  std::atomic<bool> busy = false;

  void warn(const std::string& line) {
    if (std::ranges::find(scene.warnings, line) == scene.warnings.end()) scene.warnings.push_back(line);
  }
};

// A scene as a host tells it, call by call: what it is made of, what stands where, what shines. Checks what it is told,
// and keeps it as a SceneView needs it. No OpenGL.
#pragma once

#include "engine/view/view_changes.h"

#include <map>
#include <optional>
#include <span>
#include <string>

namespace lambent {

/// A mesh as it is given: as lambent_mesh_desc. Spans are copied.
struct HostMesh {
  std::string name = {};
  std::span<const vec3> positions = {}, normals = {}; // normals: empty or one a vertex, of any length
  std::span<const vec2> uvs = {}, uvs1 = {};          // empty or one a vertex
  std::span<const vec4> colors = {};                  // likewise
  std::span<const uvec3> triangles = {};
  struct Part {
    uint32_t firstTriangle, triangleCount, material;
  };
  std::span<const Part> parts = {}; // empty: all of `material`
  uint32_t material = 0;
};

/// Numbers of textures, materials, meshes, instances and lights count from 0 and are not given again.
/// Every call throws InputError, with nothing changed, where what it is told cannot be. Calls for textures, materials and
/// meshes wait for an update of lights that still reads them (frame.overlap).
class HostScene {
 public:
  HostScene();

  uint32_t addTexture(TextureImage image);
  void removeTexture(uint32_t texture);           // that no material uses
  uint32_t addMaterial(const Material& material); // its textures by number
  void setMaterial(uint32_t material, const Material& as);
  void removeMaterial(uint32_t material); // that no mesh has
  uint32_t addMesh(const HostMesh& mesh);
  void removeMesh(uint32_t mesh); // that no instance shows

  uint32_t addInstance(uint32_t mesh, const mat4& worldFromObject);
  void moveInstance(uint32_t instance, const mat4& worldFromObject);
  /// Object space, one a vertex; no normals: made from the triangles; no positions: the mesh's own.
  void deformInstance(uint32_t instance, std::span<const vec3> positions, std::span<const vec3> normals);
  void removeInstance(uint32_t instance);

  uint32_t addLight(const LightView& light); // `id` and `changed` are set here
  void setLight(uint32_t light, const LightView& as);
  void removeLight(uint32_t light);

  void setSky(const Sky& sky) { sky_ = sky; }

  /// The scene now, for the frames that `changes` follows. Valid until its next call, and while nothing is added.
  SceneView view(ViewChanges& changes, const CameraView& camera, double time) const;

  uint64_t bytes() const; // of meshes, textures and shapes
  /// Another number after each change of a material, and where textures, materials or meshes went; never 0.
  uint64_t assetsVersion() const { return version_; }
  bool hasMesh(uint32_t mesh) const { return is(meshes_, mesh); }
  bool hasMaterial(uint32_t material) const { return is(materials_, material); }
  bool hasTexture(uint32_t texture) const { return is(textures_, texture); }
  bool hasInstance(uint32_t instance) const { return instances_.contains(instance); }
  bool hasLight(uint32_t light) const { return lights_.contains(light); }

 private:
  InstanceView& at(uint32_t instance);
  void require(const Material& material) const;
  void meshesCameOrWent() { ++assets_.revision, ++assets_.meshRevision; }
  void assetsChanged() { assets_.identity = Identity(), ++version_; }
  static bool is(const std::vector<bool>& there, uint32_t number) { return number < there.size() && there[number]; }

  SceneAssets assets_;
  uint64_t version_ = 1;
  std::vector<bool> textures_, materials_, meshes_; // by number: whether it is there; what is not keeps its number
  std::map<uint32_t, InstanceView> instances_;
  std::map<uint32_t, LightView> lights_;
  Sky sky_;
  uint32_t nextInstance_ = 0, nextLight_ = 0;
};

} // namespace lambent

// The scene's assets in GPU memory and the drawing of its instances. Nothing is ever culled by facing: both sides of a
// surface reflect, and the ray tracer sees both.
#pragma once

#include "engine/gl/objects.h"
#include "engine/gl/program.h"
#include "engine/scene/scene_view.h"
#include "shaders/shared/material_block.h"

#include <map>
#include <span>
#include <vector>

namespace lambent {

/// Half spaces dot(plane, (p, 1)) ≥ 0 that bound what a matrix shows.
struct Frustum {
  std::vector<vec4> planes;

  /// Of a clip-from-world matrix for z in [0, w].
  static Frustum ofClip(const mat4& clipFromWorld);
  /// False only when the box is certainly outside.
  bool mayShow(const Aabb& box) const;
};

/// What a draw writes: everything, or depth alone.
enum class DrawKind { GBuffer, Depth };

class GpuScene {
 public:
  /// Uploads meshes, materials and textures (mipmapped). `assets` is read only here.
  GpuScene(gl::ProgramCache& programs, const SceneAssets& assets);

  /// Takes over this frame's instances; uploads transforms when any moved.
  void place(std::span<const InstanceView> instances);

  /// Draws all instances that `clipFromWorld` may show, sorted by material, into the bound framebuffer. Sets programs,
  /// vertex array and textures; the caller sets the pipeline state and, for DrawKind::GBuffer, binds the camera block
  /// and gives the eye. Returns the number of draws.
  uint32_t draw(DrawKind kind, const mat4& clipFromWorld, const vec3& eye = vec3(0)) const;

  uint32_t triangleCount() const { return triangleCount_; } // of all placed instances
  const Aabb& bounds() const { return bounds_; }            // world space

 private:
  static constexpr GLuint kInstanceBinding = 4;

  struct PrimitiveRange {
    uint32_t firstIndex, indexCount, baseVertex, material;
    Aabb boundsObject;
  };
  struct MaterialDraw {
    GLuint baseTexture, emissiveTexture; // 0 = none
    GLuint baseSampler, emissiveSampler;
    bool masked;
  };
  struct Item {
    uint32_t instance;
    PrimitiveRange range;
    Aabb boundsWorld;
  };

  void uploadMeshes(const SceneAssets& assets);
  void uploadMaterials(const SceneAssets& assets);
  uint32_t samplerFor(const TextureRef& ref);
  void bindMaterial(uint32_t index) const;
  const gl::Program& programFor(DrawKind kind, const MaterialDraw& material) const;

  gl::ProgramCache& programs_;
  gl::Buffer positions_, normals_, uvs_, colors_, indices_, instanceRows_, materials_;
  gl::VertexArray vertexArray_;
  std::vector<gl::Texture> textures_;
  std::map<uint32_t, gl::Sampler> samplers_; // by packed wrap and filter modes
  std::vector<std::vector<PrimitiveRange>> meshes_;
  std::vector<MaterialDraw> materialDraws_;
  size_t materialStride_ = 256;
  std::vector<InstanceView> instances_;
  std::vector<Item> items_; // sorted by material
  Aabb bounds_;
  uint32_t triangleCount_ = 0;
};

} // namespace lambent

// The scene's assets in GPU memory and the drawing of its instances. Light meets both sides of every surface, so what
// is drawn for it is not culled by facing.
#pragma once

#include "engine/gl/objects.h"
#include "engine/gl/ring.h"
#include "engine/view/scene_view.h"
#include "gi/contract/pass_context.h"
#include "shaders/shared/material_block.h"

#include <map>
#include <span>
#include <utility>
#include <vector>

namespace lambent {

/// Half spaces dot(plane, (p, 1)) ≥ 0 that bound what a matrix shows.
struct Frustum {
  std::vector<vec4> planes;

  /// Makes the frustum of a clip-from-world matrix for z in [0, w].
  static Frustum ofClip(const mat4& clipFromWorld);
  /// Returns false only when the box is certainly outside.
  bool mayShow(const Aabb& box) const;
};

/// What a draw writes: the G-buffer, the same with roughness and metalness, with mapped normals, or both; distance
/// (metres) and geometric normal of what the eye sees; depth alone; depth for maps that ask rays where their texels
/// differ, with blended surfaces in every other texel; depth of what is solid, blended surfaces left out; or what those
/// let through, and nothing else.
enum class DrawKind {
  GBuffer,
  GlossyGBuffer,
  MappedGBuffer,
  GlossyMappedGBuffer,
  DistanceNormal,
  Depth,
  CheckeredDepth,
  SolidDepth,
  Blended
};
inline DrawKind gBufferWith(bool glossy, bool mapped) { return DrawKind(int(glossy) + 2 * int(mapped)); }

/// Which instances are drawn: those that have not moved for a while, those that have, or both.
enum class Instances { All, Still, Moving };

class GpuScene {
 public:
  /// Uploads meshes, materials and textures (mipmapped). `assets` is read only here.
  GpuScene(const PassContext& context, const SceneAssets& assets);

  /// Takes over what came to the assets, and gives up what went. To be followed by place().
  void takeAssets(const SceneAssets& assets);
  /// Takes over this frame's instances; uploads transforms when any moved, and the vertices of what was reshaped.
  void place(std::span<const InstanceView> instances);

  /// Draws all instances that `clipFromWorld` may show, sorted by material, into the bound framebuffer: one call per
  /// material and vertex array, and without a G-buffer one for all materials without alpha test. Sets programs, vertex
  /// array and textures; the caller sets the pipeline state, gives the eye but for depth, for a G-buffer binds the
  /// camera block, and for distances gives the directions of pixels: of window coordinates (x, y, 1), world axes.
  /// Returns the number of calls.
  uint32_t draw(DrawKind kind, const mat4& clipFromWorld, const vec3& eye = vec3(0), Instances which = Instances::All,
                const mat3& wayFromPixel = mat3(1)) const {
    return draw(kind, clipFromWorld, eye, which, wayFromPixel, false);
  }
  /// Draws what an eye sees: without the backs of materials that hide theirs, as RayQuery::seen.
  uint32_t drawSeen(DrawKind kind, const mat4& clipFromWorld, const vec3& eye) const {
    return draw(kind, clipFromWorld, eye, Instances::All, mat3(1), true);
  }

  /// Sets which alpha test draws use; AlphaTest::Needed at the start.
  void setAlphaTest(AlphaTest test) {
    if (std::exchange(alphaTest_, test) != test) stillVersion_ = nextVersion();
  }
  /// Returns a number that stays the same as long as what Instances::Still draws does, and that no other scene of this
  /// process has.
  uint64_t stillVersion() const { return stillVersion_; }

  /// Says whether there are blended materials.
  bool blends() const { return blends_ && alphaTest_ != AlphaTest::None; }
  uint64_t testedDraws() const { return testedDraws_; }     // so far, of materials whose alpha is tested
  uint32_t triangleCount() const { return triangleCount_; } // of all placed instances
  const Aabb& bounds() const { return bounds_; }            // world space

 private:
  static constexpr GLuint kInstanceBinding = 4, kIndexBinding = 8;
  static constexpr uint64_t kMostCommandBytes = uint64_t(4) << 20;
  static constexpr uint8_t kRested = 30; // placements without a move after which an instance stands still

  struct PrimitiveRange {
    uint32_t primitive; // of its mesh
    uint32_t firstIndex, indexCount, baseVertex, material;
    Aabb boundsObject;
  };
  struct MaterialDraw {
    GLuint baseTexture, emissiveTexture, roughnessMetalnessTexture, normalTexture; // 0 = none
    GLuint baseSampler, emissiveSampler, finishSampler, normalSampler;
    AlphaMode alphaMode;
    bool backHidden;
  };
  struct MeshRange {
    uint32_t baseVertex, vertexCount;
    std::vector<PrimitiveRange> primitives; // without empty ones
  };
  struct Item {
    uint32_t instance;
    PrimitiveRange range;
    Aabb boundsWorld;
    bool deformed, mirrored;
  };
  /// What place() was last given; revision 0: rigid.
  struct Placed {
    uint32_t mesh;
    mat4 worldFromObject;
    uint64_t revision;
    bool operator==(const Placed&) const = default;
  };
  /// Vertices of the deformed instances, one after the other; attributes that do not deform are copies of the mesh's.
  struct DeformedVertices {
    gl::Buffer positions, normals, uvs, colors, tangents;
    gl::VertexArray array;
    std::vector<uint32_t> baseVertex; // by instance; kNone: rigid
  };

  uint32_t draw(DrawKind kind, const mat4& clipFromWorld, const vec3& eye, Instances which, const mat3& wayFromPixel,
                bool seen) const;
  static uint64_t nextVersion();
  void uploadMeshes(const SceneAssets& assets);
  gl::VertexArray vertexArrayOf(const char* label, const gl::Buffer& positions, const gl::Buffer& normals,
                                const gl::Buffer& uvs, const gl::Buffer& colors, const gl::Buffer& tangents) const;
  void noteMoves(const std::vector<Placed>& placed);
  void layOutDeformed(std::span<const InstanceView> instances);
  void uploadDeformed(std::span<const InstanceView> instances);
  void uploadMaterials(const SceneAssets& assets);
  uint32_t samplerFor(const TextureRef& ref);
  void bindMaterial(uint32_t index) const;
  bool tested(const MaterialDraw& material) const {
    return alphaTest_ == AlphaTest::All || (alphaTest_ == AlphaTest::Needed && material.alphaMode != AlphaMode::Opaque);
  }
  const gl::Program& programFor(DrawKind kind, const MaterialDraw& material) const;

  PassContext context_;
  gl::Buffer positions_, normals_, uvs_, colors_, tangents_, indices_, instanceRows_, instanceIndices_, materials_;
  gl::Ring changes_{"scene/changes"}; // of instances and deformed vertices
  mutable gl::Ring commands_{"scene/draws"};
  gl::VertexArray vertexArray_;
  std::vector<gl::Texture> textures_;
  std::map<uint32_t, gl::Sampler> samplers_; // by packed wrap and filter modes
  std::vector<MeshRange> meshes_;
  uint64_t meshRevision_; // of the assets
  DeformedVertices deformed_;
  std::vector<MaterialDraw> materialDraws_;
  size_t materialStride_ = 256;
  std::vector<Placed> placed_;
  std::vector<uint8_t> rest_; // by instance: placements since it moved, at most kRested
  uint64_t stillVersion_ = nextVersion();
  std::vector<Item> items_; // sorted by material
  Aabb bounds_;
  uint32_t triangleCount_ = 0;
  bool blends_ = false;
  AlphaTest alphaTest_ = AlphaTest::Needed;
  mutable uint64_t testedDraws_ = 0;
};

} // namespace lambent

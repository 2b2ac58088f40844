// The scene in two levels, instances above meshes, as arrays for ray tracers other than Embree.
#pragma once

#include "engine/trace/bvh.h"
#include "engine/view/scene_view.h"

namespace lambent {

class FlatScene {
 public:
  /// Builds the hierarchy of every mesh. `assets` must outlive the scene.
  explicit FlatScene(const SceneAssets& assets);

  /// What the last update changed.
  struct Changed {
    bool top = false;    // instances, and the hierarchy above them
    bool shapes = false; // nodes and triangles from staticNodes() and staticTriangles() on: of deformed instances
  };
  /// Takes over instances and transforms. The hierarchy above them is refitted, and rebuilt where instances come,
  /// go, or have strayed (see kStrayed); those of reshaped instances are refitted.
  Changed update(const SceneView& view);

  std::span<const BvhNode> nodes() const { return nodes_; }
  std::span<const RayTriangle> triangles() const { return triangles_; }
  size_t staticNodes() const { return staticNodes_; } // what lies before never changes
  size_t staticTriangles() const { return staticTriangles_; }
  std::span<const BvhNode> top() const { return top_.nodes; }
  std::span<const RayInstance> instances() const { return instances_; }
  std::span<const RayMask> masks() const { return masks_; }
  std::span<const uint32_t> texels() const { return texels_; }

  static constexpr float kStrayed = 2; // times the area of its boxes when built

 private:
  /// The hierarchy over one mesh's triangles and where it lies in the arrays.
  struct Shape {
    Bvh bvh;
    uint32_t firstNode = 0, firstTriangle = 0;
  };

  void addTexels(uint32_t image);
  uint32_t maskOf(const Mesh& mesh, const Primitive& primitive, uint32_t triangle);
  void place(Shape& shape, uint32_t mesh, std::span<const vec3> positions);
  void reshape(const SceneView& view, Changed& changed);

  const SceneAssets& assets_;
  BvhBuilder builder_;
  std::vector<Shape> meshes_, deformed_;             // deformed_: by instance, only of those that are
  std::vector<std::vector<uint32_t>> masksOfMeshes_; // by mesh and triangle; empty: all solid
  std::vector<BvhNode> nodes_;
  std::vector<RayTriangle> triangles_;
  size_t staticNodes_ = 0, staticTriangles_ = 0;
  std::vector<RayMask> masks_;
  std::vector<uint32_t> firstTexels_; // by image of the assets; kNone: no mask reads it
  std::vector<uint32_t> texels_;
  Bvh top_;
  double topArea_ = 0; // of its nodes, when built
  std::vector<RayInstance> instances_;
  std::vector<uint32_t> meshOf_;    // by instance, as last taken over
  std::vector<uint64_t> revisions_; // of shapes; 0: rigid
};

} // namespace lambent

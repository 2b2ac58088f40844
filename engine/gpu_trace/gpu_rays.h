// RayQuery on the GPU: for shaders that trace rays themselves (shaders/lib/rays.glsl), and by lists, which wait for it.
#pragma once

#include "engine/gl/program.h"
#include "engine/gl/ring.h"
#include "engine/trace/flat_scene.h"
#include "engine/trace/ray_query.h"

namespace lambent {

/// Needs the context that it was made in: unlike other queries it is for that thread alone.
class GpuRays final : public RayQuery {
 public:
  /// Uploads the hierarchies of all meshes. `assets` must outlive it.
  GpuRays(gl::ProgramCache& programs, const SceneAssets& assets);

  /// Takes over instances and transforms, and uploads what they changed.
  void update(const SceneView& view);
  /// Sets the alpha test of rays; Masked at the start. All gives the same results as Masked.
  void setAlphaTest(AlphaTest test) { alphaTest_ = test; }

  /// Binds the hierarchies for the program in use, which includes lib/rays.glsl.
  void bind(const gl::Program& program) const;

  void closest(std::span<const Ray> rays, std::span<SurfaceHit> hits) const override;
  void seen(std::span<const Ray> rays, std::span<SurfaceHit> hits) const override;
  void distances(std::span<const Ray> rays, std::span<float> t) const override;
  void occluded(std::span<const Ray> rays, std::span<uint8_t> blocked) const override;
  bool ownThread() const override { return true; }
  using RayQuery::closest;
  using RayQuery::occluded;

 private:
  struct Hit; // as rays.comp writes it
  template <class T> std::vector<T> trace(std::span<const Ray> rays, bool any) const;
  void upload(gl::Buffer& buffer, const char* label, uint64_t offset, uint64_t bytes, const void* all);

  gl::ProgramCache& programs_;
  const SceneAssets& assets_;
  FlatScene scene_;
  gl::Buffer top_, instances_, nodes_, triangles_, masks_, texels_;
  gl::Ring changes_{"rays/changes"};
  std::vector<InstanceView> placed_;
  AlphaTest alphaTest_ = AlphaTest::Needed;
};

} // namespace lambent

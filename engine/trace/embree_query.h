// RayQuery over a scene with Embree (3 or 4): one bottom-level scene per mesh, and one per deformed instance, instanced
// by a top-level scene.
#pragma once

#include "engine/trace/ray_query.h"

namespace lambent {

class EmbreeQuery final : public RayQuery {
 public:
  /// Builds the bottom level of every mesh. `assets` must outlive the query.
  explicit EmbreeQuery(const SceneAssets& assets);
  ~EmbreeQuery() override;

  /// Builds the bottom level of meshes that came to the assets, and gives up those of meshes that went. To be followed
  /// by an update before any ray.
  void takeAssets();
  /// Takes over instances and transforms; rebuilds the top level only if something moved, came or went, and refits the
  /// bottom level of what was reshaped. With `all` every instance is placed again. Returns how many were.
  uint32_t update(const SceneView& view, bool all = false);

  /// Sets the alpha test of rays; Masked at the start.
  void setAlphaTest(AlphaTest test);
  /// Sets whether a hit's albedo has the texel's colour, as at the start, or the texture's mean.
  void setTextures(bool on);

  /// Work of all threads since the last call.
  struct Work {
    uint64_t alphaTests = 0, textureLookups = 0;
  };
  Work takeWork() const;

  void closest(std::span<const Ray> rays, std::span<SurfaceHit> hits) const override;
  void seen(std::span<const Ray> rays, std::span<SurfaceHit> hits) const override;
  void distances(std::span<const Ray> rays, std::span<float> t) const override;
  void occluded(std::span<const Ray> rays, std::span<uint8_t> blocked) const override;
  void transmittance(std::span<const Ray> rays, std::span<float> passes) const override;
  using RayQuery::closest;
  using RayQuery::occluded;
  using RayQuery::seen;

  /// Version of the library in use, e.g. "3.13.5".
  static std::string version();

 private:
  void trace(std::span<const Ray> rays, std::span<SurfaceHit> hits, bool eye) const;

  struct State;
  std::unique_ptr<State> state_;
};

} // namespace lambent

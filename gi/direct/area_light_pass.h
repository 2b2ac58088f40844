// Direct light of emissive surfaces by patches of the image (paper 4): what they bring where nothing is between, in
// closed form at every pixel, times the share of it that rays from patches find open.
#pragma once

#include "engine/gpu_trace/gpu_rays.h"
#include "gi/contract/figures.h"
#include "gi/contract/maker_choice.h"
#include "gi/contract/pass_context.h"
#include "gi/contract/patches.h"
#include "gi/contract/surface_lighting.h"
#include "gi/contract/world.h"
#include "gi/direct/area_fragments.h"
#include "gi/direct/area_groups.h"
#include "gi/gather/patch_atlas.h"

#include <memory>

namespace lambent {

class AreaLightPass {
 public:
  explicit AreaLightPass(PassContext context) : context_(context) {}

  /// Adds the light to the target, which is as large as the image.
  void add(const World& world, const GBuffer& surfaces, SurfaceReader& reader, Patches& patches,
           const Settings& settings, const LightTarget& target, FrameStats& stats);
  /// R8: 1 + level of the smallest fragment at each pixel of the last image, over all lights; 0: none.
  const gl::Texture* fragments() const { return fragments_ ? &fragments_ : nullptr; }
  /// Drops the collected lights. Call it when the pass is not run for a while: changes of lights are then not reported.
  void forget() {
    lights_ = {};
    gpuRays_.reset();
    groups_.forget();
    fragments_ = {};
  }

 private:
  const RayQuery& tracerFor(const World& world, const FrameSurfaces& surfaces, const AreaSettings& settings);
  const RayQuery& gpuRays(const World& world);
  std::optional<MakerTimes> timesOf(const World& world, const FrameSurfaces& surfaces);
  void noteFragments(const glm::ivec2& size, std::vector<uint8_t>& smallest) const;
  void readLevels(const FrameSurfaces& seen, const PatchPyramid& pyramid);
  const gl::Texture& upsample(const GBuffer& surfaces, const Settings& settings);
  void collect(const World& world);
  void shade(const GBuffer& surfaces, std::vector<AreaPiece> pieces, const gl::Texture& share,
             const LightTarget& target);
  void shadePieces(const GBuffer& surfaces, std::span<const AreaPiece> pieces, bool disks);

  PassContext context_;
  AreaLights lights_;
  AreaGroups groups_;
  std::vector<EmitterTriangle> triangles_; // that they are of
  std::unique_ptr<GpuRays> gpuRays_;       // where the GPU traces
  uint64_t traced_ = 0;                    // meshRevision of the assets that they know
  MakerChoice tracer_{context_, "cpu", "gpu"};
  std::vector<FragmentLevel> levels_;
  PatchAtlas atlas_{context_};
  gl::Texture share_, stencil_, lobes_, fragments_;
  gl::Framebuffer framebuffer_; // of both
  gl::Ring blocks_{"area lights/pieces"};
};

} // namespace lambent

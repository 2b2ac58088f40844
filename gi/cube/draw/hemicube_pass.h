// Hemicubes of virtual lights (gi/cube/hemicube.h), drawn by the GPU or cast on the CPU.
#pragma once

#include "gi/contract/figures.h"
#include "gi/contract/maker_choice.h"
#include "gi/contract/pass_context.h"
#include "gi/contract/world.h"
#include "gi/cube/hemicube.h"
#include "gi/plan/settings.h"

namespace lambent {

class HemicubePass : public HemicubeMaker {
 public:
  explicit HemicubePass(PassContext context) : context_(context) {}

  /// Sets the world that the next hemicubes show and the maker that draws them.
  void prepare(const World& world, CubeMaker maker);
  void make(std::span<Hemicube> hemicubes) override;
  /// Adds to the figures the rays since the last call and the maker.
  void tell(FrameStats& stats);

 private:
  MakerTimes timesOf(std::span<const Hemicube> hemicubes);
  void cast(std::span<Hemicube> hemicubes);
  void draw(std::span<Hemicube> hemicubes);
  void allocate(int resolution, int layers);
  void drawInto(int layer, const Hemicube& hemicube);

  PassContext context_;
  const GpuScene* scene_ = nullptr;
  const RayQuery* rays_ = nullptr;
  float near_ = 0; // metres
  CubeMaker asked_ = CubeMaker::Auto;
  MakerChoice maker_{context_, "rays", "raster"};
  RayCounts counts_;
  gl::Texture texels_; // a layer is a hemicube, as in Hemicube::texels
  gl::Texture depth_;
  gl::Framebuffer framebuffer_;
};

} // namespace lambent

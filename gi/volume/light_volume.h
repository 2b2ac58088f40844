// A light propagation volume (Kaplanyan and Dachsbacher 2010; paper 4, 3.2): lights deposit what they reflect in the
// cells of a grid, it goes from cell to cell, and what passes each cell is kept. World space.
#pragma once

#include "engine/gl/ring.h"
#include "gi/contract/figures.h"
#include "gi/contract/pass_context.h"
#include "gi/contract/virtual_lights.h"
#include "gi/volume/volume_visibility.h"

#include <memory>

namespace lambent {

class Gather; // gi/contract/gather.h

struct VolumeInputs {
  const World& world;
  std::span<const VirtualLight> lights;
  const VolumeSettings& settings;
};

/// Deposits flux on the CPU, where the lights and the rays are, and propagates it on the GPU. What did not change is
/// kept.
class LightVolume {
 public:
  explicit LightVolume(PassContext context) : context_(context) {}

  void update(const VolumeInputs& in, FrameStats& stats);
  /// Binds storage blocks and sets uniforms of volume_gather.frag.
  void bind(const gl::Program& program) const;

  const VolumeVisibility& sights() const { return sights_; }
  /// Returns the flux that is on its way after the last step, W. Reads back, so it is for tests.
  vec3 fluxOnItsWay() const;
  /// Returns the flux that was deposited, W.
  vec3 fluxDeposited() const;

 private:
  /// Where a light stands, and the cells around it that receive its flux.
  struct Injection {
    vec3 position{kInfinity}, normal{0};
    ivec3 base{0};
    float weights[8] = {}; // sum 1, or 0 where nothing is open to it
  };

  template <class T> void upload(gl::Buffer& buffer, const char* label, std::span<const T> data);
  void findCells(const VolumeInputs& in, RayCounts& counts);
  bool deposit(const VolumeInputs& in, RayCounts& counts);
  void propagate();

  PassContext context_;
  VolumeVisibility sights_;
  gl::Buffer open_, seen_, deposits_, light_[2], passed_;
  gl::Ring changes_{"volume/changes"};
  std::vector<Injection> injections_; // by slot
  std::vector<vec4> deposited_;
  int steps_ = -1;
  VolumeLobes lobes_ = VolumeLobes::Way;
};

} // namespace lambent

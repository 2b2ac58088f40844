// Virtual lights as the gather reads them: uniform-block chunks ordered by interleaving class.
#pragma once

#include "engine/gl/ring.h"
#include "gi/contract/pass_context.h"
#include "gi/contract/virtual_lights.h"

namespace lambent {

/// Returns the place of a slot in PackedLights::buffer.
uint32_t lightOrder(uint32_t slot);

/// Packs the light of a slot; empty (a = 0) when it is not alive or brings nothing.
VplLight pack(const VirtualLight& light);
/// Returns the virtual light that a packed one describes. Its geometric normal is lost: the shading normal replaces it.
VirtualLight unpack(const VplLight& light);

class PackedLightBuffer {
 public:
  PackedLightBuffer(PassContext context, StageId stage)
      : context_(context), stage_(stage), changes_(std::string(key(stage).name) + "/changed lights") {}
  /// Uploads the slots whose light differs from what the buffer holds.
  PackedLights run(std::span<const VirtualLight> slots);
  uint32_t uploaded() const { return uploaded_; } // lights that differed in the last run

 private:
  PassContext context_;
  StageId stage_;
  gl::Buffer buffer_;
  gl::Ring changes_;
  std::vector<VplLight> mirror_; // in buffer order
  uint32_t count_ = 0, uploaded_ = 0;
};

} // namespace lambent

// Pairs of a pixel and a direct light about which the light's shadow map is in doubt, and what rays say of them.
#pragma once

#include "engine/gl/ring.h"
#include "engine/trace/ray_query.h"
#include "shaders/shared/shadow_doubt.h"

#include <algorithm>
#include <functional>

namespace lambent {

class ShadowRayPass {
 public:
  static constexpr uint32_t kMost = 524287; // 16 MiB: what every OpenGL lets shaders write into
  /// `most`: doubts that the list may grow to hold.
  explicit ShadowRayPass(uint32_t most = kMost) : most_(most), room_(std::min(most, 1u << 14)) {}
  /// Empties the list and binds it for shaders (shaders/lib/shadow_doubt.glsl).
  void begin();
  /// Takes the list over from the GPU. Returns false where there were more doubts than it has room for. The list has
  /// then grown as far as it may, and doubts must be noted again in parts.
  bool collect();
  /// Traces the rays that `towards` gives for each doubt. Afterwards `lit` holds the pairs that see one another, by
  /// light and pixel.
  void trace(const RayQuery& rays, const std::function<Ray(const ShadowDoubt&)>& towards, RayCounts& counts);

  /// Pairs of a pixel (as ShadowDoubt's) and a light that see one another: its index in the lower 24 bits, and in the
  /// upper 8 what part of its light passes blended surfaces.
  std::span<const uvec2> lit() const { return lit_; }
  static uint32_t lightOf(const uvec2& pair) { return pair.y & 0xffffffu; }
  void bindLit(int unit);

 private:
  struct Header {
    uint32_t count = 0, room = 0, pad[2] = {0, 0};
  };

  gl::Buffer list_, litBuffer_;
  gl::Texture litView_;
  gl::Ring uploads_{"direct/shadow rays"};
  uint32_t most_, room_; // of list_
  std::vector<ShadowDoubt> doubts_;
  std::vector<uvec2> lit_;
};

} // namespace lambent

// Light brought into textures of a host.
#pragma once

#include "gi/contract/pass_context.h"
#include "gi/contract/surfaces.h"

namespace lambent {

/// Where light goes: the rectangle of a host's texture from (x, y) on, in its own rows and columns, of the light's
/// size.
struct DeliveryTarget {
  uint32_t texture = 0; // 0: one of ours
  int x = 0, y = 0;
  bool originTop = false; // the texture's rows are from the top
};

class Delivery {
 public:
  explicit Delivery(PassContext context) : context_(context) {}
  /// Throws InputError where the host's texture cannot take light of this size.
  static void check(int width, int height, const DeliveryTarget& to);
  /// Draws `light` (a name, RGBA32F, width × height, rows from the bottom; 0: none, which is black) to where it goes.
  /// Returns the name of what holds it. The target has been checked.
  uint32_t run(uint32_t light, int width, int height, const DeliveryTarget& to, int index);

 private:
  PassContext context_;
  gl::Texture ours_[2]; // by index
};

} // namespace lambent

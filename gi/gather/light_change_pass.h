// Follows lights and objects from frame to frame, and says by how much the light of tiles changed.
#pragma once

#include "engine/gl/objects.h"
#include "gi/contract/light_change_map.h"
#include "gi/contract/virtual_lights.h"
#include "gi/lists/choose_lights.h"
#include "gi/lists/light_change.h"

namespace lambent {

class LightChangePass {
 public:
  /// What lights and objects did since the last frame; call it in each.
  struct Events {
    const VirtualLights& lights;
    std::span<const Aabb> moved; // bounds of what moved, before and after; world space, m
    bool mapsWait = false;       // for what moved before
    bool unknown = false;        // anything else may have changed
  };
  void observe(const Events& in);
  /// The change of the tiles of lists that were chosen in this frame.
  LightChangeMap run(const ListTable& table, float disk);
  void forget() { *this = {}; }

 private:
  std::vector<vec3> before_, now_; // radiance by slots, as LightChangeInputs::before
  std::span<const VirtualLight> lights_;
  // What moved in the frames of this span and of the one before; a span ends when no map waits.
  std::vector<Aabb> moved_, movedBefore_;
  int frames_ = 0;         // of the span
  std::vector<vec2> kept_; // as the texture
  bool ran_ = false;       // in the last frame
  gl::Texture texture_;
};

} // namespace lambent

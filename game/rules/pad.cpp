#include "game/rules/pad.h"

#include <algorithm>

namespace lambent {

namespace {
constexpr float kDead = 0.18f;          // of the tilt
constexpr float kTurnsPerSecond = 2.6f; // radians, at full tilt
} // namespace

vec2 stick(const vec2& tilt) {
  const float length = glm::length(tilt);
  if (!(length > kDead)) return vec2(0);
  const float share = std::min((length - kDead) / (1 - kDead), 1.0f);
  return tilt / length * (share * share);
}

void addPad(MoveInput& move, const PadState& pad, const PadButtons& down, float seconds) {
  const vec2 walk = stick(pad.left), look = stick(pad.right);
  move.direction += vec3(walk.x, pad.rightTrigger - pad.leftTrigger, walk.y);
  move.direction = glm::clamp(move.direction, vec3(-1), vec3(1));
  move.look += kTurnsPerSecond * seconds * vec2(look.x, -look.y);
  move.fast |= down[size_t(PadButton::Run)];
  move.jump |= down[size_t(PadButton::Jump)];
}

} // namespace lambent

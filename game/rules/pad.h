// A gamepad's sticks and buttons, by meaning: what GLFW calls an Xbox-like layout.
#pragma once

#include "game/rules/player.h"

#include <array>

namespace lambent {

struct PadState {
  vec2 left{0}, right{0};                  // sticks, -1 to 1: right and down
  float leftTrigger = 0, rightTrigger = 0; // 0 to 1
};

enum class PadButton { Jump, Gait, Use, Torch, Run, Hurl, Home, Menu, Lamp, Box };
inline constexpr size_t kPadButtons = size_t(PadButton::Box) + 1;
using PadButtons = std::array<bool, kPadButtons>;

/// Shapes a stick's tilt: zero near the middle, where sticks never rest quite at zero; finer near it, and 1 at the rim.
vec2 stick(const vec2& tilt);

/// Adds what the pad asks for to the keys' wishes.
void addPad(MoveInput& move, const PadState& pad, const PadButtons& down, float seconds);

} // namespace lambent

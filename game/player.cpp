#include "game/player.h"

#include "engine/scene/scene.h"

namespace lambent {

namespace {
constexpr float kSpeedPerDiameter = 0.05f; // a hall of 30 m is walked at 1.5 m/s
constexpr float kFast = 4;
constexpr float kSteepest = 1.55f; // radians, just short of straight up
} // namespace

Player::Player(const CameraView& view, float sceneDiameter)
    : speed_(glm::max(kSpeedPerDiameter * sceneDiameter, 1e-3f)) {
  place(view);
}

void Player::place(const CameraView& view) {
  lens_ = view;
  position_ = view.position();
  const vec3 forward = -vec3(view.worldFromView[2]);
  yaw_ = std::atan2(forward.x, -forward.z);
  pitch_ = glm::clamp(std::asin(glm::clamp(forward.y, -1.0f, 1.0f)), -kSteepest, kSteepest);
}

vec3 Player::forward() const {
  return {std::sin(yaw_) * std::cos(pitch_), std::sin(pitch_), -std::cos(yaw_) * std::cos(pitch_)};
}

void Player::move(const MoveInput& input, float seconds) {
  yaw_ = std::remainder(yaw_ + input.look.x, 2 * kPi);
  pitch_ = glm::clamp(pitch_ + input.look.y, -kSteepest, kSteepest);
  const vec3 right(std::cos(yaw_), 0, std::sin(yaw_));
  const vec3 step = input.direction.x * right + input.direction.y * vec3(0, 1, 0) - input.direction.z * forward();
  if (step == vec3(0)) return;
  position_ += glm::normalize(step) * (speed_ * (input.fast ? kFast : 1.0f) * seconds);
}

CameraView Player::view(int width, int height) const {
  CameraView view = lookAt(position_, position_ + forward(), lens_.fovY);
  view.orthoHalfHeight = lens_.orthoHalfHeight;
  view.near = lens_.near;
  view.width = width;
  view.height = height;
  return view;
}

} // namespace lambent

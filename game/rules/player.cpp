#include "game/rules/player.h"

#include "engine/scene/scene.h"

#include <cmath>

namespace lambent {

namespace {

constexpr float kWalkPerHeight = 1.2f;   // heights per second: 2.1 m/s
constexpr float kFlyPerDiameter = 0.05f; // a hall of 30 m is crossed in 20 s
constexpr float kRun = 2, kRush = 4;     // times as fast
constexpr float kSteepest = 1.55f;       // radians, just short of straight up
constexpr float kShareOfScene = 0.25f;   // of its diameter that a body may be high
constexpr float kLost = 3;               // heights below the scene at which nobody falls any further

} // namespace

BodySize bodySizeFor(const Aabb& scene) {
  BodySize size;
  if (scene.diameter() > 0) size.height = std::min(size.height, kShareOfScene * scene.diameter());
  return size;
}

Player::Player(const CameraView& start, const Aabb& bounds)
    : start_(start), lowest_(bounds.empty() ? -kInfinity : bounds.lo.y),
      flight_(glm::max(kFlyPerDiameter * bounds.diameter(), 1e-3f)), body_(bodySizeFor(bounds)) {
  place(start);
}

void Player::place(const CameraView& view) {
  lens_ = view;
  body_.place(view.position());
  const vec3 forward = -vec3(view.worldFromView[2]);
  yaw_ = std::atan2(forward.x, -forward.z);
  pitch_ = glm::clamp(std::asin(glm::clamp(forward.y, -1.0f, 1.0f)), -kSteepest, kSteepest);
}

void Player::home(const RayQuery& rays) {
  place(start_);
  takeOver(rays);
}

void Player::takeOver(const RayQuery& rays) {
  const vec3 eye = position();
  const bool stands = body_.stand(rays, eye);
  if (!stands) body_.place(eye);
  body_.setGait(stands ? Gait::Walk : Gait::Fly);
}

vec3 Player::forward() const {
  return {std::sin(yaw_) * std::cos(pitch_), std::sin(pitch_), -std::cos(yaw_) * std::cos(pitch_)};
}

float Player::speed() const { return pace * (gait() == Gait::Walk ? kWalkPerHeight * body_.size().height : flight_); }

bool Player::move(const RayQuery& rays, const SceneView& view, const MoveInput& input, float seconds) {
  body_.ride(view);
  yaw_ = std::remainder(yaw_ + input.look.x - body_.turn(), 2 * kPi);
  pitch_ = glm::clamp(pitch_ + input.look.y, -kSteepest, kSteepest);

  const bool walks = gait() == Gait::Walk;
  const vec3 right(std::cos(yaw_), 0, std::sin(yaw_));
  const vec3 ahead = walks ? vec3(std::sin(yaw_), 0, -std::cos(yaw_)) : forward();
  vec3 way = input.direction.x * right - input.direction.z * ahead;
  if (!walks) way.y += input.direction.y;
  if (const float length = glm::length(way); length > 1) way /= length; // a stick may be tilted less
  const float times = !input.fast ? 1 : walks ? kRun : kRush;
  body_.move(rays, view, {way * speed() * times, input.jump}, seconds);

  if (!walks || body_.feet().y > lowest_ - kLost * body_.size().height) return false;
  home(rays);
  return true;
}

CameraView Player::view(int width, int height) const {
  CameraView view = lookAt(position(), position() + forward(), lens_.fovY);
  view.orthoHalfHeight = lens_.orthoHalfHeight;
  view.near = lens_.near;
  view.width = width;
  view.height = height;
  return view;
}

} // namespace lambent

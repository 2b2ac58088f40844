// Where the person stands and looks: a free camera without collision.
#pragma once

#include "engine/scene/scene_view.h"

namespace lambent {

/// What the keys and the mouse asked for in one frame.
struct MoveInput {
  vec3 direction{0}; // in view space: x right, y up, z backwards; length up to √3
  vec2 look{0};      // turn to the right and up, radians
  bool fast = false; // four times the speed

  bool any() const { return direction != vec3(0) || look != vec2(0); }
};

class Player {
 public:
  /// Starts at `view`, with a walking speed that suits a scene of `sceneDiameter` metres.
  Player(const CameraView& view, float sceneDiameter);

  /// Stands and looks as `view` does.
  void place(const CameraView& view);
  void move(const MoveInput& input, float seconds);

  vec3 position() const { return position_; }
  vec3 forward() const;
  float fovY() const { return lens_.fovY; }
  float speed() const { return speed_; } // m/s
  void setSpeed(float metresPerSecond) { speed_ = metresPerSecond; }

  CameraView view(int width, int height) const;

 private:
  CameraView lens_; // field of view, near plane; the pose is not used
  vec3 position_{0};
  float yaw_ = 0, pitch_ = 0; // radians; 0, 0 looks along -Z; yaw turns to the right
  float speed_ = 1;
};

} // namespace lambent

// The person in the scene: a body, where its eyes look, and the way home.
#pragma once

#include "game/rules/body.h"

namespace lambent {

/// What keys, mouse and gamepad asked for in one frame.
struct MoveInput {
  vec3 direction{0}; // in view space: x right, y up, z backwards; length up to √3
  vec2 look{0};      // turn to the right and up, radians
  bool fast = false, jump = false;

  bool any() const { return direction != vec3(0) || look != vec2(0) || jump; }
};

/// A person's body, in a doll's house a doll's.
BodySize bodySizeFor(const Aabb& scene);

class Player {
 public:
  /// Begins at `start`, with a body that suits a scene in `bounds`: a person's, or a doll's.
  Player(const CameraView& start, const Aabb& bounds);

  /// Back to the start: on its feet where there is a floor, else flying.
  void home(const RayQuery& rays);
  /// Stands and looks as `view` does, without regard to what is there.
  void place(const CameraView& view);

  /// Where it is now: on its feet where there is a floor, else flying.
  void takeOver(const RayQuery& rays);

  /// Goes along with what it stands on, then moves for so many seconds. Who falls out of the scene comes home; says
  /// whether that happened.
  bool move(const RayQuery& rays, const SceneView& view, const MoveInput& input, float seconds);

  void setGait(Gait gait) { body_.setGait(gait); }
  Gait gait() const { return body_.gait(); }
  const Body& body() const { return body_; }
  vec3 position() const { return body_.eye(); }
  vec3 forward() const;
  float yaw() const { return -yaw_; } // radians to the left of -Z
  float fovY() const { return lens_.fovY; }
  float speed() const; // m/s, of the present gait

  CameraView view(int width, int height) const;

  float pace = 1; // times the usual speed

 private:
  CameraView start_, lens_; // of the lens: field of view, near plane
  float lowest_;            // of the scene, world
  float flight_;            // m/s
  Body body_;
  float yaw_ = 0, pitch_ = 0; // radians; 0, 0 looks along -Z; yaw turns to the right
};

} // namespace lambent

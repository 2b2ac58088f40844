// A person's body among what rays meet: it walks, climbs stairs, jumps, falls, is carried by what it stands on and
// pushed by what moves against it, and flies. Knows neither window nor scene; all sizes follow from its height.
//
// The body is an upright cylinder, felt out with rays: a grid of them ahead of every move, a ring around it for what
// came too near, and a bundle downwards for the floor. What is lower than a step is walked onto.
#pragma once

#include "engine/trace/ray_query.h"

#include <vector>

namespace lambent {

struct BodySize {
  float height = 1.75f; // metres

  float radius() const { return 0.14f * height; }
  float eye() const { return 0.92f * height; }
  float step() const { return 0.2f * height; } // what is climbed without a jump
  float gravity() const { return 5.6f * height; }
  float jump() const { return 0.32f * height; } // height of one
};

/// How the world resists: a walker falls and is stopped, a flyer is stopped, a ghost is not.
enum class Gait { Walk, Fly, Ghost };

/// What the body is to do for a while, world space.
struct BodyWish {
  vec3 velocity{0}; // metres per second; of a walker the part along Y is ignored
  bool jump = false;
};

class Body {
 public:
  explicit Body(const BodySize& size = {}) : size_(size) {}

  /// Puts the eye there, at rest. A walker then falls to the floor.
  void place(const vec3& eye);
  /// Puts the body there on its feet; returns false where there is no floor near, or no room to stand.
  bool stand(const RayQuery& rays, const vec3& eye);

  /// Goes along with what it stands on, as that moved since the last extraction.
  void ride(const SceneView& view);
  /// Moves for so many seconds. Frames of any length give the same path, in steps of at most kStepSeconds.
  void move(const RayQuery& rays, const SceneView& view, const BodyWish& wish, float seconds);

  Gait gait() const { return gait_; }
  void setGait(Gait gait);

  vec3 eye() const { return feet_ + vec3(0, size_.eye() + eyeLag_, 0); }
  const vec3& feet() const { return feet_; }
  const BodySize& size() const { return size_; }
  /// Says whether something is where the body is: it stands in the way of what moves.
  bool cramped(const RayQuery& rays) const;
  bool grounded() const { return grounded_; }
  uint32_t ground() const { return ground_; } // id of the instance that it stands on; kNone in the air
  float turn() const { return turn_; }        // radians by which the last ride turned it to the left

  static constexpr float kStepSeconds = 1.0f / 60;

 private:
  struct Floor {
    bool met = false, steep = false;
    float height = 0; // world
    uint32_t instance = kNone;
  };

  void walk(const RayQuery& rays, const SceneView& view, const BodyWish& wish, float seconds);
  void separate(const RayQuery& rays);
  void slide(const RayQuery& rays, vec3 way);
  float clearWay(const RayQuery& rays, const vec3& direction, float length, vec3& normal) const;
  Floor floorBelow(const RayQuery& rays, float reach) const;
  float headroom(const RayQuery& rays, float reach) const;

  BodySize size_;
  Gait gait_ = Gait::Walk;
  vec3 feet_{0};
  float rise_ = 0;   // m/s upwards
  float eyeLag_ = 0; // metres by which the eye is behind the feet after a step
  float turn_ = 0;
  bool grounded_ = false;
  uint32_t ground_ = kNone;
};

} // namespace lambent

// The components a scene's entities are made of. Plain data; the functions that work on them are in scene.h.
#pragma once

#include "engine/ecs/registry.h"
#include "engine/view/scene_view.h"

#include <optional>
#include <string>
#include <vector>

namespace lambent {

struct Name {
  std::string value;
};

/// Placement in the parent's space. `matrix`, when set, is used instead of the rest: only for nodes that a file gives
/// as a matrix with shear, which translation, rotation and scale cannot express.
struct Transform {
  dvec3 translation{0}; // in double precision, for places far from the origin
  quat rotation{1, 0, 0, 0};
  vec3 scale{1};
  std::optional<dmat4> matrix;

  /// parentFromNode.
  dmat4 local() const {
    if (matrix) return *matrix;
    dmat4 m(glm::mat4_cast(rotation));
    m[0] *= scale.x;
    m[1] *= scale.y;
    m[2] *= scale.z;
    m[3] = glm::dvec4(translation, 1);
    return m;
  }
};

/// The entity whose space this one's Transform is in; roots have none. Both need a Transform.
struct Parent {
  Entity entity;
};

/// Written by updateWorldTransforms. In coordinates of the file: see Scene::origin.
struct WorldTransform {
  dmat4 worldFromNode{1};
};

struct MeshInstance {
  uint32_t mesh = 0; // index into SceneAssets::meshes
};

/// The mesh of the entity follows joints: entities with a WorldTransform, and for each the matrix from the mesh's bind
/// pose to the joint's own space. The joints alone place the surface in the world; the entity's own transform does not
/// (glTF 2.0, 3.7.3.1).
struct Skin {
  std::vector<Entity> joints;
  std::vector<mat4> jointFromBind; // parallel to `joints`
};

/// How much of each morph target of the entity's mesh is added; missing ones count as zero.
struct MorphWeights {
  std::vector<float> weights;
};

/// The most of a light in any channel: what an image sums up must stay finite.
inline constexpr float kMostLight = 1e30f;

/// Stands at the entity's origin and shines along its -Z. Units as in LightView.
struct PunctualLight {
  LightType type = LightType::Point;
  vec3 intensity{1};
  float range = kInfinity; // metres, not scaled by the node
  float innerConeCos = 1, outerConeCos = 0.70710678f;
  float angularRadius = 0; // radians; as LightView
};

/// Looks along the entity's -Z with +Y up.
struct CameraLens {
  float fovY = 1.0f;         // radians; ignored when orthoHalfHeight > 0
  float orthoHalfHeight = 0; // metres; 0: perspective
  float near = 0.05f;        // metres
};

/// The pose that animation starts from: animate() puts the entity back to it before it applies channels and motion.
struct Animated {
  Transform rest;
};

/// The same for morph weights.
struct AnimatedWeights {
  std::vector<float> rest;
};

/// Scripted motion for scenes whose file has no animation. The two parts add up; either may be idle.
struct Motion {
  vec3 spinAxis{0, 1, 0}; // unit, parent's space, through the node's own origin
  float spinSpeed = 0;    // radians per second
  vec3 swing{0};          // amplitude in the parent's space, metres
  float swingPeriod = 1;  // seconds
  float swingPhase = 0;   // radians
};

enum class ChannelPath : uint8_t { Translation, Rotation, Scale };
enum class Interpolation : uint8_t { Step, Linear, CubicSpline };

/// Key frames of one property of one entity. `values` holds xyz for translation and scale, xyzw for rotation; one per
/// time, or three (in-tangent, value, out-tangent) for CubicSpline.
struct AnimationChannel {
  Entity target;
  ChannelPath path = ChannelPath::Translation;
  Interpolation interpolation = Interpolation::Linear;
  std::vector<float> times; // seconds, never decreasing, not empty
  std::vector<vec4> values;
};

/// Key frames of the morph weights of one entity, `count` to a value; otherwise as AnimationChannel.
struct WeightsChannel {
  Entity target;
  Interpolation interpolation = Interpolation::Linear;
  size_t count = 0;
  std::vector<float> times;
  std::vector<float> values; // count per time, or three times count
};

struct AnimationClip {
  std::string name;
  double duration = 0; // seconds: the last key of all channels
  std::vector<AnimationChannel> channels;
  std::vector<WeightsChannel> weightsChannels;
};

/// Value of a channel at `time`, held before the first and after the last key. Rotations are unit quaternions (xyzw),
/// interpolated along the shorter arc.
vec4 sampleChannel(const AnimationChannel& channel, float time);
/// The same for morph weights; `weights` gets channel.count values.
void sampleChannel(const WeightsChannel& channel, float time, std::vector<float>& weights);

} // namespace lambent

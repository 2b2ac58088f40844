// Key frame animation as glTF 2.0 defines it (appendix C of its specification), and scripted motion.

#include "engine/scene/scene.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

/// wxyz order is glm's constructor, xyzw glTF's storage.
quat quatFromXyzw(const vec4& v) { return {v.w, v.x, v.y, v.z}; }

vec4 slerpShorter(const vec4& a, vec4 b, float u) {
  if (glm::dot(a, b) < 0) b = -b;
  const quat q = glm::slerp(quatFromXyzw(a), quatFromXyzw(b), u);
  return {q.x, q.y, q.z, q.w};
}

vec4 unitOrIdentity(const vec4& q) {
  const float length = glm::length(q);
  return length > 1e-12f ? q / length : vec4(0, 0, 0, 1);
}

void applyChannel(Transform& t, const AnimationChannel& channel, float time) {
  const vec4 v = sampleChannel(channel, time);
  switch (channel.path) {
  case ChannelPath::Translation:
    t.translation = vec3(v);
    break;
  case ChannelPath::Rotation:
    t.rotation = quatFromXyzw(v);
    break;
  case ChannelPath::Scale:
    t.scale = vec3(v);
    break;
  }
}

void applyMotion(Transform& t, const Motion& motion, double time) {
  const double period = motion.swingPeriod > 0 ? motion.swingPeriod : 1;
  const double turns = time / period;
  const vec3 offset = motion.swing * float(std::sin(2 * double(kPi) * (turns - std::floor(turns)) + motion.swingPhase));
  const auto angle = float(std::fmod(double(motion.spinSpeed) * time, 2 * double(kPi)));
  const quat spin = glm::angleAxis(angle, motion.spinAxis);
  if (t.matrix) {
    const vec3 origin = vec3((*t.matrix)[3]);
    *t.matrix = glm::mat4_cast(spin) * *t.matrix;
    (*t.matrix)[3] = vec4(origin + offset, 1);
  } else {
    t.translation += offset;
    t.rotation = spin * t.rotation;
  }
}

/// Time within the clip; clips loop, also backwards from zero.
float clipTime(const AnimationClip& clip, double time) {
  if (!(clip.duration > 0)) return 0;
  return float(time - std::floor(time / clip.duration) * clip.duration);
}

} // namespace

vec4 sampleChannel(const AnimationChannel& channel, float time) {
  CHECK(!channel.times.empty());
  const bool cubic = channel.interpolation == Interpolation::CubicSpline;
  const bool rotation = channel.path == ChannelPath::Rotation;
  const auto value = [&](size_t key) { return channel.values[cubic ? 3 * key + 1 : key]; };
  const auto finish = [&](const vec4& v) { return rotation ? unitOrIdentity(v) : v; };

  const size_t after =
      size_t(std::upper_bound(channel.times.begin(), channel.times.end(), time) - channel.times.begin());
  if (after == 0) return finish(value(0));
  const size_t key = after - 1;
  if (after == channel.times.size() || channel.interpolation == Interpolation::Step) return finish(value(key));

  const float span = channel.times[after] - channel.times[key]; // > 0: upper_bound skips equal times
  const float u = (time - channel.times[key]) / span;
  if (!cubic)
    return rotation ? finish(slerpShorter(value(key), value(after), u)) : glm::mix(value(key), value(after), u);

  // Hermite spline; tangents are per second, hence the span.
  const vec4 leaving = span * channel.values[3 * key + 2], arriving = span * channel.values[3 * after];
  const float u2 = u * u, u3 = u2 * u;
  return finish((2 * u3 - 3 * u2 + 1) * value(key) + (u3 - 2 * u2 + u) * leaving + (3 * u2 - 2 * u3) * value(after) +
                (u3 - u2) * arriving);
}

void animate(Scene& scene, double time) {
  Registry& registry = scene.registry;
  std::vector<Entity> unrested; // scripted after loading: their rest pose is where they are now
  registry.each<Motion, Transform>([&](Entity e, const Motion&, const Transform&) {
    if (!registry.has<Animated>(e)) unrested.push_back(e);
  });
  for (const Entity e : unrested) registry.emplace<Animated>(e, registry.get<Transform>(e));

  registry.each<Animated, Transform>([](Entity, const Animated& a, Transform& t) { t = a.rest; });
  for (const AnimationClip& clip : scene.animations)
    for (const AnimationChannel& channel : clip.channels)
      if (auto* t = registry.tryGet<Transform>(channel.target)) applyChannel(*t, channel, clipTime(clip, time));
  registry.each<Motion, Transform>([&](Entity, const Motion& m, Transform& t) { applyMotion(t, m, time); });
  updateWorldTransforms(scene);
}

} // namespace lambent

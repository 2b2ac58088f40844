// Key frame animation as glTF 2.0 defines it (appendix C of its specification), and scripted motion.

#include "engine/scene/scene.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

/// Linear, and to the bit what both share: what stands still between two keys must not seem to move.
template <class Value> Value between(const Value& from, const Value& to, float u) { return from + (to - from) * u; }

/// wxyz order is glm's constructor, xyzw glTF's storage.
quat quatFromXyzw(const vec4& v) { return {v.w, v.x, v.y, v.z}; }

vec4 slerpShorter(const vec4& a, vec4 b, float u) {
  if (glm::dot(a, b) < 0) b = -b;
  if (a == b) return a; // slerp would round
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
    t.translation = dvec3(v);
    break;
  case ChannelPath::Rotation:
    t.rotation = quatFromXyzw(v);
    break;
  case ChannelPath::Scale:
    t.scale = vec3(v);
    break;
  }
}

/// The keys around a time, and where between them: equal keys where a value is held.
struct Between {
  size_t key = 0, after = 0;
  float u = 0, span = 0; // share of the way, seconds between the two
};

Between findKeys(const std::vector<float>& times, Interpolation interpolation, float time) {
  CHECK(!times.empty());
  const size_t after = size_t(std::upper_bound(times.begin(), times.end(), time) - times.begin());
  if (after == 0) return {};
  const size_t key = after - 1;
  if (after == times.size() || interpolation == Interpolation::Step) return {key, key};
  const float span = times[after] - times[key]; // > 0: upper_bound skips equal times
  return {key, after, (time - times[key]) / span, span};
}

/// Hermite spline; tangents are per second, hence the span.
template <class V> V hermite(const Between& at, const V& from, const V& leaving, const V& arriving, const V& to) {
  const float u = at.u, u2 = u * u, u3 = u2 * u;
  return between(from, to, 3 * u2 - 2 * u3) + (u3 - 2 * u2 + u) * (at.span * leaving) +
         (u3 - u2) * (at.span * arriving);
}

/// `row(i)` counts keys, or in-tangents, values and out-tangents of keys; `mix` is linear interpolation.
template <class Channel, class Row, class Mix>
auto sampleKeys(const Channel& channel, const Between& at, Row&& row, Mix&& mix) {
  const bool cubic = channel.interpolation == Interpolation::CubicSpline;
  const auto value = [&](size_t key) { return row(cubic ? 3 * key + 1 : key); };
  if (at.after == at.key) return value(at.key);
  if (!cubic) return mix(value(at.key), value(at.after), at.u);
  return hermite(at, value(at.key), row(3 * at.key + 2), row(3 * at.after), value(at.after));
}

void applyMotion(Transform& t, const Motion& motion, double time) {
  const double period = motion.swingPeriod > 0 ? motion.swingPeriod : 1;
  const double turns = time / period;
  const vec3 offset = motion.swing * float(std::sin(2 * double(kPi) * (turns - std::floor(turns)) + motion.swingPhase));
  const auto angle = float(std::fmod(double(motion.spinSpeed) * time, 2 * double(kPi)));
  const quat spin = glm::angleAxis(angle, motion.spinAxis);
  if (t.matrix) {
    const dvec3 origin((*t.matrix)[3]);
    *t.matrix = dmat4(glm::mat4_cast(spin)) * *t.matrix;
    (*t.matrix)[3] = glm::dvec4(origin + dvec3(offset), 1);
  } else {
    t.translation += dvec3(offset);
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
  const bool rotation = channel.path == ChannelPath::Rotation;
  const vec4 v = sampleKeys(
      channel, findKeys(channel.times, channel.interpolation, time), [&](size_t row) { return channel.values[row]; },
      [&](const vec4& a, const vec4& b, float u) { return rotation ? slerpShorter(a, b, u) : between(a, b, u); });
  return rotation ? unitOrIdentity(v) : v;
}

void sampleChannel(const WeightsChannel& channel, float time, std::vector<float>& weights) {
  const Between at = findKeys(channel.times, channel.interpolation, time);
  weights.resize(channel.count);
  for (size_t i = 0; i < channel.count; ++i)
    weights[i] = sampleKeys(
        channel, at, [&](size_t row) { return channel.values[row * channel.count + i]; },
        [](float a, float b, float u) { return between(a, b, u); });
}

void animate(Scene& scene, double time) {
  Registry& registry = scene.registry;
  std::vector<Entity> unrested; // scripted after loading: their rest pose is where they are now
  registry.each<Motion, Transform>([&](Entity e, const Motion&, const Transform&) {
    if (!registry.has<Animated>(e)) unrested.push_back(e);
  });
  for (const Entity e : unrested) registry.emplace<Animated>(e, registry.get<Transform>(e));

  registry.each<Animated, Transform>([](Entity, const Animated& a, Transform& t) { t = a.rest; });
  registry.each<AnimatedWeights, MorphWeights>(
      [](Entity, const AnimatedWeights& a, MorphWeights& m) { m.weights = a.rest; });
  for (const AnimationClip& clip : scene.animations) {
    for (const AnimationChannel& channel : clip.channels)
      if (auto* t = registry.tryGet<Transform>(channel.target)) applyChannel(*t, channel, clipTime(clip, time));
    for (const WeightsChannel& channel : clip.weightsChannels)
      if (auto* m = registry.tryGet<MorphWeights>(channel.target))
        sampleChannel(channel, clipTime(clip, time), m->weights);
  }
  registry.each<Motion, Transform>([&](Entity, const Motion& m, Transform& t) { applyMotion(t, m, time); });
  updateWorldTransforms(scene);
}

} // namespace lambent

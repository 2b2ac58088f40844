// A shot at time t: its camera, and its nodes in a scene.

#include "engine/core/text.h"
#include "engine/scene/shot.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <unordered_map>

namespace lambent {

namespace {

/// Linear, and to the bit what both share: what stands still between two keys must not seem to move.
template <class Value, class Share> Value between(const Value& from, const Value& to, Share u) {
  return from + (to - from) * u;
}

/// The first of the keys that lies after t.
template <class Key> auto firstAfter(const std::vector<Key>& keys, double t) {
  return std::upper_bound(keys.begin(), keys.end(), t, [](double a, const Key& k) { return a < k.t; });
}

/// Catmull-Rom through keys at uneven times: cubic Hermite whose tangents are the slopes between the neighbours,
/// one-sided at the ends, where it also holds.
template <class Value> dvec3 spline(const std::vector<CameraKey>& keys, double t, Value&& value) {
  const auto after = firstAfter(keys, t);
  if (after == keys.begin()) return value(keys.front());
  if (after == keys.end()) return value(keys.back());
  const size_t i = size_t(after - keys.begin()) - 1;
  const auto slope = [&](size_t k) {
    const size_t a = k > 0 ? k - 1 : k, b = std::min(k + 1, keys.size() - 1);
    return (value(keys[b]) - value(keys[a])) / (keys[b].t - keys[a].t);
  };
  const double span = keys[i + 1].t - keys[i].t, u = (t - keys[i].t) / span, u2 = u * u, u3 = u2 * u;
  return between(value(keys[i]), value(keys[i + 1]), 3 * u2 - 2 * u3) + (u3 - 2 * u2 + u) * span * slope(i) +
         (u3 - u2) * span * slope(i + 1);
}

float linearFov(const std::vector<CameraKey>& keys, double t) {
  const auto after = firstAfter(keys, t);
  if (after == keys.begin()) return keys.front().fovY;
  if (after == keys.end()) return keys.back().fovY;
  const auto before = after - 1;
  return between(before->fovY, after->fovY, float((t - before->t) / (after->t - before->t)));
}

template <class V> struct Neighbours {
  V from, to;
  float u;
};

/// The keys around t that set `field`; nothing where no key does.
template <class V>
std::optional<Neighbours<V>> around(const std::vector<NodeKey>& keys, std::optional<V> NodeKey::*field, double t) {
  const NodeKey *before = nullptr, *after = nullptr;
  for (const NodeKey& k : keys) {
    if (!(k.*field)) continue;
    if (k.t <= t) before = &k;
    if (k.t > t && !after) after = &k;
  }
  if (!before && !after) return {};
  if (!before) return Neighbours<V>{*(after->*field), *(after->*field), 0};
  if (!after) return Neighbours<V>{*(before->*field), *(before->*field), 0};
  return Neighbours<V>{*(before->*field), *(after->*field), float((t - before->t) / (after->t - before->t))};
}

template <class V>
std::optional<V> linear(const std::vector<NodeKey>& keys, std::optional<V> NodeKey::*field, double t) {
  const auto b = around(keys, field, t);
  return b ? std::optional(between(b->from, b->to, typename V::value_type(b->u))) : std::nullopt;
}

/// Angles are mixed, not orientations, so that a turn of 360 degrees between two keys is one.
quat rotationFromDegrees(const vec3& degrees) {
  const vec3 r = glm::radians(degrees);
  return glm::angleAxis(r.y, vec3(0, 1, 0)) * glm::angleAxis(r.x, vec3(1, 0, 0)) * glm::angleAxis(r.z, vec3(0, 0, 1));
}

void place(Transform& t, std::optional<dvec3> position, std::optional<quat> rotation) {
  if (!t.matrix) {
    if (position) t.translation = *position;
    if (rotation) t.rotation = *rotation;
    return;
  }
  if (rotation) { // of a sheared matrix only the lengths of its axes can be kept
    const mat3 r = glm::mat3_cast(*rotation);
    for (int c = 0; c < 3; ++c) (*t.matrix)[c] = glm::dvec4(dvec3(r[c]) * glm::length(dvec3((*t.matrix)[c])), 0);
  }
  if (position) (*t.matrix)[3] = glm::dvec4(*position, 1);
}

/// The nodes of a scene that have a T, by name; of several with one name the first.
template <class T> class NamedNodes {
 public:
  NamedNodes(const Scene& scene, const Shot& shot, const char* what) : shot_(shot), what_(what) {
    scene.registry.each<Name, T>([&](Entity e, const Name& n, const T&) { nodes_.emplace(n.value, e); });
  }
  /// The one called `name`, or an error that names the nearest.
  Entity find(const std::string& name) const {
    if (const auto found = nodes_.find(name); found != nodes_.end()) return found->second;
    std::vector<std::string> names;
    for (const auto& [known, node] : nodes_) names.emplace_back(known);
    std::ranges::sort(names);
    const std::string nearest = nearestName(name, names);
    throw InputError(shot_.file.string(), "the scene has no " + std::string(what_) + " called '" + name + "'" +
                                              (nearest.empty() ? "" : " (did you mean '" + nearest + "'?)"));
  }

 private:
  const Shot& shot_;
  const char* what_;
  std::unordered_map<std::string_view, Entity> nodes_;
};

void poseNode(Scene& scene, Entity e, const std::vector<NodeKey>& keys, double t) {
  const auto degrees = linear(keys, &NodeKey::rotation, t);
  place(scene.registry.get<Transform>(e), linear(keys, &NodeKey::position, t),
        degrees ? std::optional(rotationFromDegrees(*degrees)) : std::nullopt);
}

/// Turns a light to a direction in world space, whatever its parents do: needs their world transforms.
void aimLight(Scene& scene, Entity e, const vec3& direction) {
  Registry& registry = scene.registry;
  vec3 inParent = direction;
  if (const Parent* p = registry.tryGet<Parent>(e)) {
    const mat3 worldFromParent(registry.get<WorldTransform>(p->entity).worldFromNode);
    if (std::abs(glm::determinant(worldFromParent)) > 0) inParent = glm::inverse(worldFromParent) * direction;
  }
  place(registry.get<Transform>(e), std::nullopt, rotationTowards(inParent));
}

/// Mixed along the great circle where the two differ by less than half a turn.
vec3 mixDirections(const Neighbours<vec3>& b) {
  const vec3 from = glm::normalize(b.from), to = glm::normalize(b.to);
  const float angle = std::acos(glm::clamp(glm::dot(from, to), -1.0f, 1.0f));
  if (angle < 1e-3f || angle > kPi - 1e-3f) return b.u < 0.5f ? from : to;
  return (std::sin((1 - b.u) * angle) * from + std::sin(b.u * angle) * to) / std::sin(angle);
}

} // namespace

int Shot::frameCount() const { return std::max(1, int(std::lround(fps * seconds))); }

CameraKey keyOf(const CameraView& camera, const dvec3& origin, double t) {
  const dvec3 eye = origin + dvec3(camera.position());
  return {t, eye, eye - dvec3(camera.worldFromView[2]), camera.fovY};
}

CameraView shotCamera(const Shot& shot, double t, const dvec3& origin) {
  CHECK(!shot.camera.empty());
  const dvec3 eye = spline(shot.camera, t, [](const CameraKey& k) { return k.eye; });
  const dvec3 target = spline(shot.camera, t, [](const CameraKey& k) { return k.target; });
  return lookAt(vec3(eye - origin), vec3(target - origin), linearFov(shot.camera, t));
}

PlayedMoment playedAt(const Shot& shot, double t) {
  CHECK(!shot.played.empty());
  const auto after = firstAfter(shot.played, t);
  if (after == shot.played.begin()) return shot.played.front();
  PlayedMoment now = *(after - 1);
  if (after == shot.played.end()) return now;
  const double u = (t - now.t) / (after->t - now.t);
  for (auto& [name, at] : now.movers)
    if (const auto next = after->movers.find(name); next != after->movers.end()) at = between(at, next->second, u);
  for (PlayedMoment::Thing& thing : now.things)
    for (const PlayedMoment::Thing& next : after->things) {
      if (next.number != thing.number) continue;
      thing.centre = between(thing.centre, next.centre, float(u));
      thing.yaw += float(u) * std::remainder(next.yaw - thing.yaw, 2 * kPi);
    }
  if (now.torch && after->torch) {
    now.torch->position = between(now.torch->position, after->torch->position, float(u));
    const vec3 mixed = between(now.torch->direction, after->torch->direction, float(u));
    if (u > 0 && glm::length(mixed) > 0) // else to the bit what was recorded; opposite ones have no middle
      now.torch->direction = glm::normalize(mixed);
  }
  if (now.hour && after->hour && *after->hour > *now.hour) now.hour = between(*now.hour, *after->hour, u);
  return now;
}

void poseShot(Scene& scene, const Shot& shot, double t) {
  animate(scene, t);
  std::vector<std::pair<Entity, vec3>> aims;
  if (!shot.objects.empty()) {
    const NamedNodes<Transform> nodes(scene, shot, "node");
    for (const auto& [name, keys] : shot.objects) poseNode(scene, nodes.find(name), keys, t);
  }
  std::optional<NamedNodes<PunctualLight>> lights;
  if (!shot.lights.empty()) lights.emplace(scene, shot, "light");
  for (const auto& [name, keys] : shot.lights) {
    const Entity e = lights->find(name);
    poseNode(scene, e, keys, t);
    if (const auto intensity = linear(keys, &NodeKey::intensity, t))
      scene.registry.get<PunctualLight>(e).intensity = *intensity;
    if (const auto direction = around(keys, &NodeKey::direction, t)) aims.emplace_back(e, mixDirections(*direction));
  }
  updateWorldTransforms(scene);
  if (aims.empty()) return;
  for (const auto& [e, direction] : aims) aimLight(scene, e, direction);
  updateWorldTransforms(scene);
}

} // namespace lambent

#include "game/rules/things.h"

#include "engine/core/error.h"
#include "game/rules/shapes.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

struct Look {
  const char* name;
  vec3 halfSize; // of a person's height
  vec3 albedo;
};
constexpr std::array<Look, kThingKinds> kLooks = {{
    {"white board", {0.34f, 0.4f, 0.015f}, {0.82f, 0.82f, 0.8f}},
    {"white box", {0.14f, 0.14f, 0.14f}, {0.82f, 0.82f, 0.8f}},
    {"red box", {0.14f, 0.14f, 0.14f}, {0.72f, 0.08f, 0.06f}},
    {"green box", {0.14f, 0.14f, 0.14f}, {0.1f, 0.55f, 0.12f}},
    {"blue box", {0.14f, 0.14f, 0.14f}, {0.08f, 0.14f, 0.65f}},
    {"lamp", {0.06f, 0.1f, 0.06f}, {0.3f, 0.3f, 0.32f}},
}};

constexpr float kReach = 0.62f;      // of a person's height, from the eye to what is carried
constexpr float kNear = 0.05f;       // the least
constexpr float kBelow = 0.16f;      // below the eye
constexpr float kHurl = 3.4f;        // heights per second
constexpr float kGravity = 5.6f;     // heights per second²
constexpr float kBounce = 0.25f;     // speed that is left across a surface
constexpr float kGrip = 0.6f;        // and along it
constexpr float kRest = 0.25f;       // heights per second, below which something on a floor stays
constexpr float kSkin = 0.004f;      // heights that stay free before a surface
constexpr float kLampAbove = 0.035f; // heights of the light above its stand
constexpr float kLost = 40;          // heights per second downwards: it fell out of the scene
constexpr float kStepSeconds = 1.0f / 60;

/// The first thing that the ray meets but for the instance itself.
SurfaceHit closestButSelf(const Solids& solids, Ray ray, uint32_t self) {
  float behind = 0;
  for (int tries = 0; tries < 4; ++tries) {
    SurfaceHit hit = solids.rays().closest(ray);
    if (!hit.valid() || solids.view().instances[hit.instance].id != self) {
      if (hit.valid()) hit.t += behind;
      return hit;
    }
    const float past = hit.t * 1.0001f + 1e-6f;
    behind += past;
    ray.origin += past * ray.direction;
    ray.tMax -= past;
    if (!(ray.tMax > 0)) break;
  }
  return {};
}

} // namespace

const char* thingName(ThingKind kind) { return kLooks[size_t(kind)].name; }

Things::Things(Scene& scene, float personHeight) : scene_(scene), size_(personHeight) {
  for (size_t i = 0; i + 1 < kThingKinds; ++i)
    meshes_[i] = addBoxMesh(scene.assets, kLooks[i].name, size_ * kLooks[i].halfSize, kLooks[i].albedo);
  const Look& lamp = kLooks[size_t(ThingKind::Lamp)];
  const vec3 h = size_ * lamp.halfSize;
  const BoxPart stand[] = {{-h, {h.x, -0.8f * h.y, h.z}},
                           {{-0.15f * h.x, -h.y, -0.15f * h.z}, {0.15f * h.x, h.y, 0.15f * h.z}}};
  meshes_[size_t(ThingKind::Lamp)] = addBoxesMesh(scene.assets, lamp.name, stand, lamp.albedo);
}

vec3 Things::halfSize(ThingKind kind) const { return size_ * kLooks[size_t(kind)].halfSize; }

bool Things::take(ThingKind kind, const Player& player) {
  putDown();
  if (things_.size() >= kMost) return false;
  show(make(kind, made_, player.position() + kReach * size_ * player.forward()));
  hand_ = things_.size() - 1;
  return true;
}

Things::Thing& Things::make(ThingKind kind, uint32_t number, const vec3& centre) {
  Thing thing{kind, number, addInstance(scene_, thingName(kind), meshes_[size_t(kind)], {}), {}, centre};
  if (kind == ThingKind::Lamp) {
    LightView light;
    light.intensity = lampIntensity;
    thing.light = addLight(scene_, light, "lamp");
  }
  things_.push_back(thing);
  made_ = std::max(made_, number + 1);
  return things_.back();
}

std::vector<PlayedMoment::Thing> Things::list() const {
  std::vector<PlayedMoment::Thing> list;
  for (const Thing& t : things_) list.push_back({t.number, thingName(t.kind), t.centre, t.yaw});
  return list;
}

void Things::check(const std::vector<PlayedMoment::Thing>& list, const std::string& file) {
  if (list.size() > kMost) throw InputError(file, "played.things has more than " + std::to_string(kMost) + " at once");
  for (const PlayedMoment::Thing& thing : list) {
    if (std::ranges::find(kLooks, thing.kind, &Look::name) == kLooks.end())
      throw InputError(file, "played.things has no kind '" + thing.kind + "' (white board, red box, lamp, ...)");
    if (std::ranges::count(list, thing.number, &PlayedMoment::Thing::number) > 1)
      throw InputError(file, "played.things has two of number " + std::to_string(thing.number) + " at once");
  }
}

void Things::show(const std::vector<PlayedMoment::Thing>& list, const std::string& file) {
  check(list, file);
  hand_.reset();
  for (size_t i = things_.size(); i-- > 0;)
    if (std::ranges::find(list, things_[i].number, &PlayedMoment::Thing::number) == list.end()) destroy(i);
  for (const PlayedMoment::Thing& wanted : list) {
    auto found = std::ranges::find(things_, wanted.number, &Thing::number);
    if (found == things_.end()) {
      const auto look = std::ranges::find(kLooks, wanted.kind, &Look::name);
      make(ThingKind(look - kLooks.begin()), wanted.number, wanted.centre);
      found = things_.end() - 1;
    }
    found->centre = wanted.centre;
    found->yaw = wanted.yaw;
    found->velocity = vec3(0);
    found->resting = false;
    show(*found);
  }
}

bool Things::pick(uint32_t instance, const Player& player) {
  const auto found = std::ranges::find_if(things_, [&](const Thing& t) { return t.entity.id() == instance; });
  if (found == things_.end()) return false;
  putDown();
  hand_ = size_t(found - things_.begin());
  found->yaw = player.yaw();
  return true;
}

std::optional<ThingKind> Things::carried() const { return hand_ ? std::optional(things_[*hand_].kind) : std::nullopt; }

std::optional<ThingKind> Things::kindOf(uint32_t instance) const {
  for (const Thing& t : things_)
    if (t.entity.id() == instance) return t.kind;
  return {};
}

void Things::exchangeCarried(const Player& player) {
  if (!hand_) return;
  const int next = int(things_[*hand_].kind) + 1;
  removeCarried();
  if (next < int(ThingKind::Lamp)) take(ThingKind(next), player);
}

void Things::putDown() {
  if (!hand_) return;
  Thing& thing = things_[*hand_];
  thing.velocity = vec3(0);
  thing.resting = false;
  hand_.reset();
}

void Things::hurl(const Player& player) {
  if (!hand_) return;
  Thing& thing = things_[*hand_];
  putDown();
  thing.velocity = kHurl * size_ * glm::normalize(player.forward() + vec3(0, 0.15f, 0));
}

void Things::destroy(size_t index) {
  const Thing& thing = things_[index];
  scene_.registry.destroy(thing.entity);
  if (thing.kind == ThingKind::Lamp) scene_.registry.destroy(thing.light);
  things_.erase(things_.begin() + std::ptrdiff_t(index));
  if (hand_ && *hand_ == index)
    hand_.reset();
  else if (hand_ && *hand_ > index)
    --*hand_;
}

void Things::removeCarried() {
  if (hand_) destroy(*hand_);
}

void Things::clear() {
  while (!things_.empty()) destroy(things_.size() - 1);
}

void Things::update(Solids& solids, const Player& player, float seconds) {
  solids.hide(hand_ ? std::optional(things_[*hand_].entity.id()) : std::nullopt);
  for (size_t i = things_.size(); i-- > 0;) {
    Thing& thing = things_[i];
    if (hand_ == i) {
      hold(solids, thing, player);
    } else {
      if (thing.resting) ride(solids, thing);
      fly(solids, thing, seconds);
    }
    if (thing.velocity.y < -kLost * size_)
      destroy(i);
    else
      show(thing);
  }
}

/// Places of the thing that feel what is around it: corners, edges, faces and its middle, world.
std::vector<vec3> Things::lattice(const Thing& thing) const {
  const vec3 half = halfSize(thing.kind);
  const quat turn = glm::angleAxis(thing.yaw, vec3(0, 1, 0));
  std::vector<vec3> places;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) places.push_back(thing.centre + turn * (0.98f * half * vec3(x, y, z)));
  return places;
}

/// Before the eyes, as far off as walls allow.
void Things::hold(const Solids& solids, Thing& thing, const Player& player) {
  const vec3 eye = player.position();
  thing.yaw = player.yaw();
  const float far = kReach * size_ + halfSize(thing.kind).z;
  for (float reach = far;; reach -= 0.05f * size_) {
    thing.centre = eye + std::max(reach, kNear * size_) * player.forward() - vec3(0, kBelow * size_, 0);
    if (reach <= kNear * size_) return;
    const auto places = lattice(thing);
    if (std::ranges::none_of(places, [&](const vec3& p) { return solids.rays().occluded(Ray{eye, p - eye, 1}); }))
      return;
  }
}

/// With what it stands on; and awake when that is gone.
void Things::ride(const Solids& solids, Thing& thing) {
  if (const std::optional<mat4> way = motionOf(solids.view(), thing.ground)) {
    thing.centre = vec3(*way * vec4(thing.centre, 1));
    const vec3 ahead = vec3(*way * vec4(0, 0, -1, 0));
    thing.yaw += std::atan2(-ahead.x, -ahead.z);
  }
  const vec3 half = halfSize(thing.kind);
  bool held = false;
  for (const vec3& p : lattice(thing)) {
    if (p.y > thing.centre.y - 0.5f * half.y) continue;
    held |= closestButSelf(solids, {p, {0, -1, 0}, 4 * kSkin * size_ + 0.02f * half.y}, thing.entity.id()).valid();
  }
  thing.resting = held;
}

/// Falls, and bounces off what it meets, losing speed.
void Things::fly(const Solids& solids, Thing& thing, float seconds) {
  const int steps = std::max(1, int(std::ceil(seconds / kStepSeconds - 1e-3f)));
  const float each = seconds / float(steps), skin = kSkin * size_;
  for (int i = 0; i < steps && !thing.resting; ++i) {
    thing.velocity.y -= kGravity * size_ * each;
    const vec3 way = thing.velocity * each;
    const float length = glm::length(way);
    if (!(length > 0)) continue;
    SurfaceHit first;
    for (const vec3& p : lattice(thing)) {
      const SurfaceHit hit = closestButSelf(solids, {p, way / length, length + skin}, thing.entity.id());
      if (hit.t < first.t) first = hit;
    }
    thing.centre += way / length * std::clamp(first.t - skin, 0.0f, length);
    if (!first.valid() || first.t > length + skin) continue;
    const vec3 n = first.geometricNormal;
    const float into = glm::dot(thing.velocity, n);
    if (into >= 0) continue;
    thing.velocity = kGrip * (thing.velocity - into * n) - kBounce * into * n;
    if (n.y > 0.7f && glm::length(thing.velocity) < kRest * size_) {
      thing.velocity = vec3(0);
      thing.resting = true;
      thing.ground = solids.view().instances[first.instance].id;
    }
  }
}

/// Puts the entities where the thing is, world transforms included.
void Things::show(const Thing& thing) {
  Registry& registry = scene_.registry;
  const auto put = [&](Entity e, const vec3& at) {
    Transform& place = registry.get<Transform>(e);
    place.translation = scene_.origin + dvec3(at);
    place.rotation = glm::angleAxis(thing.yaw, vec3(0, 1, 0));
    registry.get<WorldTransform>(e).worldFromNode = place.local();
  };
  put(thing.entity, thing.centre);
  if (thing.kind != ThingKind::Lamp) return;
  put(thing.light, thing.centre + vec3(0, halfSize(thing.kind).y + kLampAbove * size_, 0));
  registry.get<PunctualLight>(thing.light).intensity = lampIntensity;
}

} // namespace lambent

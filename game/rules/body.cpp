#include "game/rules/body.h"

#include "game/rules/solids.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lambent {

namespace {

constexpr int kAround = 24;    // directions of the ring that feels what is too near
constexpr int kRows = 9;       // of rays ahead, from the step's height to the head
constexpr int kColumns = 11;   // of rays ahead, across the body
constexpr int kSlides = 4;     // surfaces that one step follows
constexpr float kSkin = 0.02f; // share of the radius that stays free in front of a surface
constexpr float kSteep = 0.6f; // least upward part of a floor's normal that is walked up: 53 degrees
constexpr float kEyeRate = 12; // per second: how fast the eye follows a step
constexpr float kUnder = 0.7f; // share of the radius that must be above nothing to fall
constexpr int kPushes = 4;     // walls that push at once

vec3 level(const vec3& v) { return {v.x, 0, v.z}; }

/// Unit, or zero where there is no direction.
vec3 unit(const vec3& v) {
  const float length = glm::length(v);
  return length > 0 ? v / length : vec3(0);
}

std::array<vec3, kAround> around() {
  std::array<vec3, kAround> directions;
  for (int i = 0; i < kAround; ++i) {
    const float angle = 2 * kPi * float(i) / kAround;
    directions[size_t(i)] = {std::cos(angle), 0, std::sin(angle)};
  }
  return directions;
}

/// Rays for floor and ceiling: from the middle and from a ring of this radius around it.
std::array<Ray, kAround / 2 + 1> bundle(const vec3& middle, float radius, const vec3& direction, float reach) {
  std::array<Ray, kAround / 2 + 1> rays;
  const auto ring = around();
  for (size_t i = 0; i < rays.size(); ++i)
    rays[i] = {middle + (i > 0 ? radius * ring[2 * (i - 1)] : vec3(0)), direction, reach};
  return rays;
}

} // namespace

void Body::place(const vec3& eye) {
  feet_ = eye - vec3(0, size_.eye(), 0);
  rise_ = eyeLag_ = 0;
  grounded_ = false;
  ground_ = kNone;
}

bool Body::stand(const RayQuery& rays, const vec3& eye) {
  place(eye);
  const float reach = 2 * size_.height;
  const SurfaceHit floor = rays.closest(Ray{eye, {0, -1, 0}, reach});
  const SurfaceHit ceiling = rays.closest(Ray{eye, {0, 1, 0}, reach});
  if (!floor.valid() || floor.t + std::min(ceiling.t, reach) < size_.height) return false;
  feet_.y = std::max(feet_.y, floor.position.y);
  return true;
}

void Body::setGait(Gait gait) {
  gait_ = gait;
  rise_ = eyeLag_ = 0;
  grounded_ = false;
  ground_ = kNone;
}

void Body::ride(const SceneView& view) {
  turn_ = 0;
  if (ground_ == kNone || gait_ != Gait::Walk) return;
  const std::optional<mat4> way = motionOf(view, ground_);
  if (!way) return;
  feet_ = vec3(*way * vec4(feet_, 1));
  const vec3 ahead = vec3(*way * vec4(0, 0, -1, 0));
  turn_ = std::atan2(-ahead.x, -ahead.z);
}

void Body::move(const RayQuery& rays, const SceneView& view, const BodyWish& wish, float seconds) {
  if (!(seconds > 0)) return;
  if (gait_ == Gait::Ghost) {
    feet_ += wish.velocity * seconds;
    return;
  }
  const int steps = std::max(1, int(std::ceil(seconds / kStepSeconds - 1e-3f)));
  const float each = seconds / float(steps);
  for (int i = 0; i < steps; ++i) {
    if (gait_ == Gait::Walk) {
      walk(rays, view, {wish.velocity, wish.jump && i == 0}, each);
    } else {
      separate(rays);
      slide(rays, wish.velocity * each);
    }
  }
}

void Body::walk(const RayQuery& rays, const SceneView& view, const BodyWish& wish, float seconds) {
  separate(rays);
  const vec3 before = feet_;
  const float roomBefore = headroom(rays, 0);
  slide(rays, level(wish.velocity) * seconds);

  if (wish.jump && grounded_) {
    rise_ = std::sqrt(2 * size_.gravity() * size_.jump());
    grounded_ = false;
    ground_ = kNone;
  }
  float drop = size_.step(); // stairs are walked down, not fallen down
  if (!grounded_) {          // along a parabola, until a floor or a ceiling is met
    drop = 0.5f * size_.gravity() * seconds * seconds - rise_ * seconds;
    rise_ -= size_.gravity() * seconds;
  }
  if (drop < 0) {
    const float room = std::max(headroom(rays, -drop), 0.0f);
    if (room < -drop) rise_ = 0;
    feet_.y += room;
    return;
  }

  const float skin = kSkin * size_.radius();
  const auto lift = [&](const Floor& floor) { return floor.met ? std::max(floor.height - feet_.y, 0.0f) : 0.0f; };
  Floor floor = floorBelow(rays, drop + skin);
  const bool tooSteep = grounded_ && floor.steep && lift(floor) > skin;
  if (tooSteep || headroom(rays, lift(floor)) < (roomBefore < 0 ? roomBefore : lift(floor))) {
    feet_ = before;
    floor = floorBelow(rays, drop + skin);
  }
  if (floor.met) {
    if (grounded_) eyeLag_ += feet_.y - floor.height;
    feet_.y = floor.height;
    rise_ = 0;
  } else if (!grounded_) {
    feet_.y -= drop;
  }
  grounded_ = floor.met;
  ground_ = floor.met && floor.instance < view.instances.size() ? view.instances[floor.instance].id : kNone;
  eyeLag_ = glm::clamp(eyeLag_ * std::exp(-kEyeRate * seconds), -2 * size_.step(), 2 * size_.step());
}

bool Body::cramped(const RayQuery& rays) const {
  if (gait_ != Gait::Walk) return false;
  if (headroom(rays, 0) < -2 * kSkin * size_.radius()) return true;
  for (const vec3& d : around())
    for (const float share : {0.3f, 0.6f, 0.9f})
      if (rays.occluded(Ray{feet_ + vec3(0, share * size_.height, 0), d, 0.7f * size_.radius()})) return true;
  return false;
}

/// Away from what came nearer than the radius: a door, or a lift's wall. What stands on the other side stops it.
void Body::separate(const RayQuery& rays) {
  static const auto ring = around();
  const float radius = size_.radius();
  const bool flies = gait_ == Gait::Fly;
  for (int push = 0; push < kPushes; ++push) {
    vec3 away(0);
    float most = 0;
    std::vector<Ray> feelers;
    if (flies) {
      for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
          for (int z = -1; z <= 1; ++z)
            if (x || y || z) feelers.push_back({eye(), glm::normalize(vec3(x, y, z)), radius});
    } else {
      for (int row = 0; row < kRows; row += 2)
        for (const vec3& d : ring) {
          const float height = glm::mix(size_.step(), size_.height, float(row) / (kRows - 1));
          feelers.push_back({feet_ + vec3(0, height, 0), d, radius});
        }
    }
    std::vector<SurfaceHit> hits(feelers.size());
    rays.closest(feelers, hits);
    for (size_t i = 0; i < hits.size(); ++i) {
      if (!hits[i].valid()) continue;
      // So far along the normal that the place met is a radius off.
      const vec3 normal = unit(flies ? hits[i].geometricNormal : level(hits[i].geometricNormal));
      const float t = hits[i].t, ahead = -t * glm::dot(feelers[i].direction, normal);
      const float inside = std::sqrt(std::max(ahead * ahead + radius * radius - t * t, 0.0f)) - ahead;
      if (inside > most) most = inside, away = normal;
    }
    if (!(most > kSkin * radius)) return;
    vec3 other;
    feet_ += away * std::min(most, std::max(clearWay(rays, away, most, other), 0.0f));
  }
}

/// Along the way, and along the surfaces that it meets.
void Body::slide(const RayQuery& rays, vec3 way) {
  const vec3 wanted = way;
  for (int i = 0; i < kSlides; ++i) {
    const float length = glm::length(way);
    if (!(length > 1e-5f * size_.radius())) return;
    const vec3 direction = way / length;
    vec3 normal;
    const float clear = clearWay(rays, direction, length, normal);
    feet_ += direction * glm::clamp(clear, 0.0f, length);
    if (clear >= length) return;
    const vec3 wall = unit(gait_ == Gait::Walk ? level(normal) : normal);
    way = direction * (length - std::max(clear, 0.0f));
    way -= wall * std::min(glm::dot(way, wall), 0.0f);
    if (glm::dot(way, wanted) <= 0) return; // into a corner
  }
}

/// How far the body can go in that direction, up to `length`; and the normal of what stops it.
float Body::clearWay(const RayQuery& rays, const vec3& direction, float length, vec3& normal) const {
  const float radius = size_.radius(), skin = kSkin * radius;
  std::vector<Ray> ahead;
  std::vector<float> nose; // from where a ray starts to the body's surface, along the direction
  const auto add = [&](const vec3& from, float aside) {
    nose.push_back(std::sqrt(std::max(radius * radius - aside * aside, 0.0f)));
    ahead.push_back({from, direction, nose.back() + skin + length});
  };
  if (gait_ == Gait::Walk) {
    const vec3 across(-direction.z, 0, direction.x);
    for (int row = 0; row < kRows; ++row)
      for (int column = 0; column < kColumns; ++column) {
        const float aside = 0.95f * radius * (2 * float(column) / (kColumns - 1) - 1);
        const float height = glm::mix(size_.step(), size_.height, float(row) / (kRows - 1));
        add(feet_ + vec3(0, height, 0) + aside * across, aside);
      }
  } else { // a ball around the eye
    const vec3 helper = std::abs(direction.y) < 0.9f ? vec3(0, 1, 0) : vec3(1, 0, 0);
    const vec3 s = glm::normalize(glm::cross(direction, helper)), t = glm::cross(s, direction);
    add(eye(), 0);
    for (const float share : {0.5f, 0.95f})
      for (const vec3& d : around()) add(eye() + share * radius * (d.x * s + d.z * t), share * radius);
  }
  std::vector<SurfaceHit> hits(ahead.size());
  rays.closest(ahead, hits);
  float clear = length;
  normal = -direction;
  for (size_t i = 0; i < hits.size(); ++i) {
    if (!hits[i].valid() || hits[i].t - nose[i] - skin >= clear) continue;
    clear = hits[i].t - nose[i] - skin;
    normal = hits[i].geometricNormal;
  }
  return clear;
}

/// The highest floor between a step above the feet and `reach` below them.
Body::Floor Body::floorBelow(const RayQuery& rays, float reach) const {
  const vec3 above(0, 1.02f * size_.step(), 0); // what is higher stands in the way of rays ahead
  const auto down = bundle(feet_ + above, kUnder * size_.radius(), {0, -1, 0}, above.y + reach);
  std::array<SurfaceHit, down.size()> hits;
  rays.closest(down, hits);
  Floor floor;
  for (const SurfaceHit& hit : hits) {
    if (!hit.valid() || (floor.met && hit.position.y <= floor.height)) continue;
    floor = {true, hit.geometricNormal.y < kSteep, hit.position.y, hit.instance};
  }
  return floor;
}

/// How far the head can rise, up to `reach`; below zero where it is too low to stand.
float Body::headroom(const RayQuery& rays, float reach) const {
  const float body = size_.height - size_.step();
  const auto up = bundle(feet_ + vec3(0, size_.step(), 0), kUnder * size_.radius(), {0, 1, 0}, body + reach);
  std::array<float, up.size()> met;
  rays.distances(up, met);
  return std::min(reach, *std::ranges::min_element(met) - body);
}

} // namespace lambent

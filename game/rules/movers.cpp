#include "game/rules/movers.h"

#include "engine/core/error.h"
#include "game/rules/shapes.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lambent {

namespace {
constexpr double kStepSeconds = 1.0 / 120;
constexpr double kStartSeconds = 0.4; // to the top speed
constexpr double kThere = 2e-3;       // stops
} // namespace

/// A door turns around its node's +Y, a lift goes to heights of its node.
struct Movers::Kind {
  const char* node;
  const char* noun;
  double turn = 0;               // radians from stop 0 to stop 1
  std::vector<double> heights{}; // of the stops, in the parent's space, metres
  double topSpeed = 1;           // stops per second
  struct ButtonPlace {
    dvec3 place; // world; of the mover's own buttons in its space
    bool own;
    int stop;
  };
  std::vector<ButtonPlace> buttons{};

  int stops() const { return heights.empty() ? 2 : int(heights.size()); }
};

const std::vector<Movers::Kind>& Movers::kinds() {
  // Places are those of content/door and content/lift (tools/content).
  static const std::vector<Kind> table = {
      {.node = "door leaf",
       .noun = "door",
       .turn = kPi / 2,
       .topSpeed = 0.9,
       .buttons = {{{-0.75, 1.2, 0.02}, false, kNext}, {{-0.75, 1.2, -0.22}, false, kNext}}},
      {.node = "cabin",
       .noun = "lift",
       .heights = {0.12, 3.12, 6.12},
       .topSpeed = 0.45,
       .buttons = {{{0.73, 1.2, 0.4}, true, kNext},
                   {{-2.48, 1.2, 1.3}, false, 0},
                   {{-2.82, 1.2, 1.0}, false, 0},
                   {{-2.82, 4.2, 1.0}, false, 1},
                   {{-2.82, 7.2, 1.0}, false, 2}}},
  };
  return table;
}

Movers::Movers(Scene& scene) : scene_(scene) {
  for (const Kind& kind : kinds()) {
    const std::optional<Entity> node = findByName(scene, kind.node);
    if (!node || !scene.registry.has<Transform>(*node) || scene.registry.get<Transform>(*node).matrix) continue;
    movers_.push_back({&kind, *node, scene.registry.get<Transform>(*node)});
    addButtons(movers_.size() - 1);
  }
  updateWorldTransforms(scene);
}

void Movers::addButtons(size_t index) {
  const Kind& kind = *movers_[index].kind;
  const uint32_t mesh = addBoxMesh(scene_.assets, "button", {0.03f, 0.06f, 0.04f}, {0.75f, 0.12f, 0.06f});
  for (const Kind::ButtonPlace& place : kind.buttons) {
    Transform at;
    at.translation = place.place;
    // Doors lie in walls across Z, the lift's buttons on walls across X.
    if (kind.heights.empty()) at.rotation = glm::angleAxis(kPi / 2, vec3(0, 1, 0));
    const Entity e = addInstance(scene_, "button", mesh, at);
    if (place.own) scene_.registry.emplace<Parent>(e, movers_[index].entity);
    buttons_.push_back({e, index, place.stop});
  }
}

std::pair<const Movers::Mover*, const Movers::Button*> Movers::found(uint32_t instance) const {
  for (const Button& button : buttons_)
    if (button.entity.id() == instance) return {&movers_[button.mover], &button};
  for (const Mover& mover : movers_)
    if (mover.entity.id() == instance) return {&mover, nullptr};
  return {};
}

std::string Movers::offer(uint32_t instance) const {
  const auto [mover, button] = found(instance);
  if (!mover) return {};
  const std::string the = std::string("the ") + mover->kind->noun;
  if (mover->kind->heights.empty()) return (mover->target == 0 ? "open " : "shut ") + the;
  return button && button->stop != kNext ? "call " + the : "send " + the + " to the next storey";
}

bool Movers::use(uint32_t instance) {
  const auto [at, button] = found(instance);
  if (!at) return false;
  Mover& mover = movers_[size_t(at - movers_.data())];
  const int stop = button ? button->stop : kNext;
  mover.used = true;
  mover.from = mover.target;
  mover.target = stop == kNext ? (mover.target + 1) % mover.kind->stops() : stop;
  return true;
}

bool Movers::update(double seconds) {
  bool moves = false;
  for (Mover& mover : movers_) {
    if (!mover.used) continue;
    const int steps = std::max(1, int(std::ceil(seconds / kStepSeconds)));
    for (int i = 0; i < steps; ++i) step(mover, seconds / steps);
    moves |= mover.speed != 0;
    apply(mover);
  }
  if (!movers_.empty()) updateWorldTransforms(scene_);
  return moves;
}

/// Starts gently, and slows down in time to stop at its target.
void Movers::step(Mover& mover, double seconds) {
  const double push = mover.kind->topSpeed / kStartSeconds, left = mover.target - mover.at;
  const double wanted = std::copysign(std::min(mover.kind->topSpeed, std::sqrt(2 * push * std::abs(left))), left);
  mover.speed += std::clamp(wanted - mover.speed, -push * seconds, push * seconds);
  mover.at += mover.speed * seconds;
  if (std::abs(mover.target - mover.at) > kThere || std::abs(mover.speed) > 2 * push * seconds + kThere) return;
  mover.at = mover.target;
  mover.speed = 0;
}

void Movers::apply(const Mover& mover) {
  const Kind& kind = *mover.kind;
  const double at = std::clamp(mover.at, 0.0, kind.stops() - 1.0);
  Transform& place = scene_.registry.get<Transform>(mover.entity);
  place = mover.rest;
  if (kind.heights.empty()) {
    place.rotation = mover.rest.rotation * glm::angleAxis(float(at * kind.turn), vec3(0, 1, 0));
    return;
  }
  const int below = std::clamp(int(at), 0, kind.stops() - 2);
  place.translation.y = glm::mix(kind.heights[size_t(below)], kind.heights[size_t(below) + 1], at - below);
}

void Movers::turnBack() {
  for (Mover& mover : movers_)
    if (mover.at != mover.target) std::swap(mover.from, mover.target);
}

void Movers::reset() {
  for (Mover& mover : movers_) reset(mover);
}

void Movers::reset(Mover& mover) {
  mover.at = mover.speed = 0;
  mover.target = mover.from = 0;
  if (std::exchange(mover.used, false)) scene_.registry.get<Transform>(mover.entity) = mover.rest;
}

std::map<std::string, double> Movers::used() const {
  std::map<std::string, double> places;
  for (const Mover& mover : movers_)
    if (mover.used) places[mover.kind->node] = mover.at;
  return places;
}

void Movers::check(const std::map<std::string, double>& places, const std::string& file) const {
  for (const auto& [name, at] : places)
    if (std::ranges::none_of(movers_, [&](const Mover& m) { return name == m.kind->node; }))
      throw InputError(file, "played.movers: the scene has no door or lift called '" + name + "'");
}

void Movers::show(const std::map<std::string, double>& places, const std::string& file) {
  check(places, file);
  for (Mover& mover : movers_) {
    const auto found = places.find(mover.kind->node);
    if (found == places.end()) {
      reset(mover);
      continue;
    }
    mover.used = true;
    mover.at = found->second;
    mover.speed = 0;
    mover.target = mover.from = std::clamp(int(std::lround(mover.at)), 0, mover.kind->stops() - 1);
    apply(mover);
  }
  if (!movers_.empty()) updateWorldTransforms(scene_);
}

double Movers::place(const std::string& node) const {
  for (const Mover& mover : movers_)
    if (node == mover.kind->node) return mover.at;
  return -1;
}

} // namespace lambent

#include "gi/gather/light_change_pass.h"

#include <algorithm>

namespace lambent {

namespace {

constexpr int kSpan = 5;         // frames in which what moved may still show: means follow it
constexpr size_t kMostBoxes = 6; // that are told apart; the nearest ones become one

/// Adds a box to those that stand apart.
void addTo(std::vector<Aabb>& boxes, Aabb box) {
  const auto grown = [](Aabb a, const Aabb& b) {
    a.add(b);
    return a;
  };
  const auto touches = [&](const Aabb& b) {
    return glm::all(glm::lessThanEqual(b.lo, box.hi)) && glm::all(glm::greaterThanEqual(b.hi, box.lo));
  };
  for (auto it = std::ranges::find_if(boxes, touches); it != boxes.end(); it = std::ranges::find_if(boxes, touches)) {
    box.add(*it);
    boxes.erase(it);
  }
  if (boxes.size() >= kMostBoxes) {
    const auto near = std::ranges::min_element(boxes, {}, [&](const Aabb& b) { return grown(b, box).diameter(); });
    box.add(*near);
    boxes.erase(near);
  }
  boxes.push_back(box);
}

} // namespace

void LightChangePass::observe(const Events& in) {
  if (!ran_) kept_.clear();
  ran_ = false;
  lights_ = in.lights.slots;
  std::swap(before_, now_);
  now_.clear();
  for (const VirtualLight& l : lights_) now_.push_back(l.alive ? l.radiance : vec3(kOtherLight));
  for (const uint32_t slot : in.lights.moved)
    if (slot < before_.size()) before_[slot] = vec3(kOtherLight);
  if (in.unknown) before_.clear();
  if (++frames_ > kSpan && !in.mapsWait) {
    movedBefore_ = std::move(moved_);
    moved_.clear();
    frames_ = 0;
  }
  for (const Aabb& box : in.moved) addTo(moved_, box);
}

LightChangeMap LightChangePass::run(const ListTable& table, float disk) {
  ran_ = true;
  std::vector<MovedSphere> spheres;
  for (const std::vector<Aabb>* boxes : {&movedBefore_, &moved_})
    for (const Aabb& b : *boxes) spheres.push_back({b.centre(), b.diameter() / 2});
  const std::vector<LightChange> changes = lightChanges({.lights = lights_,
                                                         .before = before_,
                                                         .moved = spheres,
                                                         .places = table.places,
                                                         .perTile = kListPlaces,
                                                         .disk = disk});
  const auto [width, height] = std::pair(table.tiles.x, table.tiles.y);
  if (!texture_ || texture_.width() != width || texture_.height() != height) {
    texture_ = gl::Texture("light change", {.format = GL_RG32F, .width = width, .height = height, .linear = true});
    kept_.clear();
  }
  // A change is followed by half in each frame, so half of it is left to the next.
  kept_.resize(changes.size(), vec2(0));
  for (size_t t = 0; t < kept_.size(); ++t) kept_[t] = {std::max(kept_[t].x / 2, changes[t].share), changes[t].gained};
  glTextureSubImage2D(texture_.name(), 0, 0, 0, width, height, GL_RG, GL_FLOAT, kept_.data());
  return {&texture_, table.tile};
}

} // namespace lambent

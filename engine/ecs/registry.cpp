#include "engine/ecs/registry.h"

#include <atomic>

namespace lambent {

namespace ecs_detail {

uint32_t nextTypeIndex() {
  static std::atomic<uint32_t> next{0};
  return next++;
}

uint32_t PoolBase::append(Entity e) {
  if (e.index() >= sparse_.size()) sparse_.resize(e.index() + 1, kAbsent);
  sparse_[e.index()] = uint32_t(dense_.size());
  dense_.push_back(e);
  return sparse_[e.index()];
}

uint32_t PoolBase::take(Entity e) {
  const uint32_t place = sparse_[e.index()];
  dense_.erase(dense_.begin() + place);
  sparse_[e.index()] = kAbsent;
  for (uint32_t i = place; i < dense_.size(); ++i) sparse_[dense_[i].index()] = i;
  return place;
}

} // namespace ecs_detail

Entity Registry::create() {
  uint32_t slot;
  if (free_.empty()) {
    slot = uint32_t(generations_.size());
    CHECK_LT(slot, Entity::kMaxIndex);
    generations_.push_back(0);
    alive_.push_back(false);
  } else {
    slot = free_.back();
    free_.pop_back();
  }
  alive_[slot] = true;
  ++living_;
  return {slot, generations_[slot]};
}

void Registry::destroy(Entity e) {
  CHECK(valid(e));
  for (auto& pool : pools_)
    if (pool) pool->erase(e);
  alive_[e.index()] = false;
  --living_;
  // A slot whose generations are used up is retired, so that no two entities ever share an id.
  if (++generations_[e.index()] < Entity::kMaxGeneration) free_.push_back(e.index());
}

bool Registry::valid(Entity e) const {
  return e.index() < generations_.size() && alive_[e.index()] && generations_[e.index()] == e.generation();
}

} // namespace lambent

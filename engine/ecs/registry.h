// A sparse-set entity-component registry: entities are numbers, components are plain structs in one packed array per
// type. Small on purpose: no groups, signals, or scheduling.
//
// Order is part of the contract. `each<A, B>` visits entities in the order in which they were given their A, whatever
// was removed meanwhile, so the same sequence of calls gives the same sequence of visits on every machine. The price is
// that removing a component costs time linear in the components after it.
#pragma once

#include "engine/core/error.h"

#include <cstdint>
#include <memory>
#include <ostream>
#include <type_traits>
#include <utility>
#include <vector>

namespace lambent {

/// A handle: slot index and the slot's generation, so that a handle kept after destroy() is known to be dead.
class Entity {
 public:
  static constexpr uint32_t kIndexBits = 22; // 4 million entities at a time, 1023 uses of each slot
  static constexpr uint32_t kMaxIndex = (1u << kIndexBits) - 1;
  static constexpr uint32_t kMaxGeneration = (1u << (32 - kIndexBits)) - 1;

  constexpr Entity() = default; // no entity
  constexpr Entity(uint32_t index, uint32_t generation) : value_(generation << kIndexBits | index) {}

  constexpr uint32_t index() const { return value_ & kMaxIndex; }
  constexpr uint32_t generation() const { return value_ >> kIndexBits; }
  /// Index and generation in one number: unique over the life of the registry.
  constexpr uint32_t id() const { return value_; }
  friend constexpr bool operator==(Entity, Entity) = default;

 private:
  uint32_t value_ = 0xffffffffu;
};

inline std::ostream& operator<<(std::ostream& out, Entity e) { return out << e.index(); }

namespace ecs_detail {

/// What the registry can do with a component array without knowing the type.
class PoolBase {
 public:
  virtual ~PoolBase() = default;
  virtual void erase(Entity e) = 0;

  bool has(Entity e) const { return e.index() < sparse_.size() && sparse_[e.index()] != kAbsent; }
  const std::vector<Entity>& entities() const { return dense_; }

  /// Above zero while each() walks this array; adding or removing then would invalidate the walk.
  mutable int walkers = 0;

 protected:
  static constexpr uint32_t kAbsent = 0xffffffffu;

  uint32_t append(Entity e);
  /// Takes `e` out, keeps the order of the rest; returns its former place.
  uint32_t take(Entity e);

  std::vector<uint32_t> sparse_; // entity index → place in dense_
  std::vector<Entity> dense_;
};

template <class T> class Pool final : public PoolBase {
 public:
  static_assert(!std::is_same_v<T, bool> && !std::is_reference_v<T> && !std::is_const_v<T>);

  template <class... Args> T& emplace(Entity e, Args&&... args) {
    if (has(e)) return values_[sparse_[e.index()]] = T{std::forward<Args>(args)...};
    CHECK_EQ(walkers, 0);
    values_.push_back(T{std::forward<Args>(args)...});
    append(e);
    return values_.back();
  }
  void erase(Entity e) override {
    if (!has(e)) return;
    CHECK_EQ(walkers, 0);
    values_.erase(values_.begin() + take(e));
  }
  T* find(Entity e) { return has(e) ? &values_[sparse_[e.index()]] : nullptr; }
  T& at(uint32_t place) { return values_[place]; }

 private:
  std::vector<T> values_; // parallel to dense_
};

uint32_t nextTypeIndex();
template <class T> uint32_t typeIndex() {
  static const uint32_t index = nextTypeIndex();
  return index;
}

} // namespace ecs_detail

/// Owns all entities and their components. Not thread-safe for writing; concurrent const use is.
class Registry {
 public:
  Entity create();
  /// Removes the entity and all its components. The entity must be valid.
  void destroy(Entity e);
  bool valid(Entity e) const;
  /// Number of living entities.
  size_t size() const { return living_; }

  /// Gives `e` a T made from `args`, or replaces the one it has. References to other Ts become invalid.
  template <class T, class... Args> T& emplace(Entity e, Args&&... args) {
    CHECK(valid(e));
    return pool<T>().emplace(e, std::forward<Args>(args)...);
  }
  /// Takes the T away; nothing happens when there is none.
  template <class T> void remove(Entity e) {
    CHECK(valid(e));
    if (auto* p = findPool<T>()) p->erase(e);
  }

  template <class T> bool has(Entity e) const { return tryGet<T>(e) != nullptr; }
  /// Null when `e` has no T or is dead.
  template <class T> T* tryGet(Entity e) { return const_cast<T*>(std::as_const(*this).template tryGet<T>(e)); }
  template <class T> const T* tryGet(Entity e) const {
    auto* p = findPool<T>();
    return p && valid(e) ? p->find(e) : nullptr;
  }
  template <class T> T& get(Entity e) { return const_cast<T&>(std::as_const(*this).template get<T>(e)); }
  template <class T> const T& get(Entity e) const {
    const T* component = tryGet<T>(e);
    CHECK(component != nullptr);
    return *component;
  }

  /// Number of entities that have a T.
  template <class T> size_t count() const {
    auto* p = findPool<T>();
    return p ? p->entities().size() : 0;
  }

  /// Calls fn(entity, a, b, ...) for every entity that has all of A, B, ..., in the order in which they were given
  /// their A. Cost: the number of As, so name the rarest first. `fn` may change components but not add, remove or
  /// destroy the types named.
  template <class A, class... Rest, class Fn> void each(Fn&& fn) { walk<A, Rest...>(*this, fn); }
  template <class A, class... Rest, class Fn> void each(Fn&& fn) const { walk<const A, const Rest...>(*this, fn); }

 private:
  template <class T> using Pool = ecs_detail::Pool<T>;

  template <class T> Pool<T>* findPool() const {
    const uint32_t i = ecs_detail::typeIndex<T>();
    return i < pools_.size() ? static_cast<Pool<T>*>(pools_[i].get()) : nullptr;
  }
  template <class T> Pool<T>& pool() {
    const uint32_t i = ecs_detail::typeIndex<T>();
    if (i >= pools_.size()) pools_.resize(i + 1);
    if (!pools_[i]) pools_[i] = std::make_unique<Pool<T>>();
    return static_cast<Pool<T>&>(*pools_[i]);
  }

  struct Walk { // exception-safe count of walkers
    explicit Walk(const ecs_detail::PoolBase& p) : pool(p) { ++pool.walkers; }
    ~Walk() { --pool.walkers; }
    Walk(const Walk&) = delete;
    const ecs_detail::PoolBase& pool;
  };

  template <class A, class... Rest, class Self, class Fn> static void walk(Self& self, Fn& fn) {
    auto* first = self.template findPool<std::remove_const_t<A>>();
    const bool present = first && (self.template findPool<std::remove_const_t<Rest>>() && ... && true);
    if (!present) return;
    walkPools<A, Rest...>(fn, *first, *self.template findPool<std::remove_const_t<Rest>>()...);
  }
  template <class A, class... Rest, class Fn, class First, class... Pools>
  static void walkPools(Fn& fn, First& first, Pools&... rest) {
    const Walk guards[] = {Walk(first), Walk(rest)...};
    for (uint32_t i = 0; i < first.entities().size(); ++i) {
      const Entity e = first.entities()[i];
      if ((rest.has(e) && ... && true)) fn(e, static_cast<A&>(first.at(i)), static_cast<Rest&>(*rest.find(e))...);
    }
  }

  std::vector<uint32_t> generations_; // by slot: of the living entity, or of the next one
  std::vector<uint32_t> free_;        // slots to use again, last freed first
  std::vector<bool> alive_;
  size_t living_ = 0;
  std::vector<std::unique_ptr<ecs_detail::PoolBase>> pools_; // by type index; null where the type was never used
};

} // namespace lambent

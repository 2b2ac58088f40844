#include "engine/ecs/registry.h"

#include "tests/support/test.h"

namespace lambent::test::registry_test {

struct Position {
  float x = 0;
};
struct Label {
  std::string text;
};

std::vector<uint32_t> indicesWithPosition(const Registry& registry) {
  std::vector<uint32_t> order;
  registry.each<Position>([&](Entity e, const Position&) { order.push_back(e.index()); });
  return order;
}

TEST(Registry, HandlesOfDestroyedEntitiesAreInvalid) {
  Registry registry;
  EXPECT_FALSE(registry.valid(Entity()));
  const Entity a = registry.create();
  EXPECT_TRUE(registry.valid(a));
  registry.destroy(a);
  EXPECT_FALSE(registry.valid(a));
  const Entity b = registry.create(); // takes the same slot
  EXPECT_EQ(b.index(), a.index());
  EXPECT_NE(b, a);
  EXPECT_NE(b.id(), a.id());
  EXPECT_FALSE(registry.valid(a));
  EXPECT_EQ(registry.size(), 1u);
}

TEST(Registry, NoIdIsEverUsedTwice) {
  Registry registry;
  std::set<uint32_t> ids;
  for (int i = 0; i < 3000; ++i) { // more than one slot's generations
    const Entity e = registry.create();
    EXPECT_TRUE(ids.insert(e.id()).second);
    registry.destroy(e);
  }
}

TEST(Registry, ComponentsAreAddedReplacedFoundAndRemoved) {
  Registry registry;
  const Entity e = registry.create();
  EXPECT_EQ(registry.tryGet<Position>(e), nullptr);
  registry.emplace<Position>(e, 3.0f);
  registry.emplace<Label>(e, "three");
  EXPECT_EQ(registry.get<Position>(e).x, 3.0f);
  registry.emplace<Position>(e, 4.0f);
  EXPECT_EQ(registry.get<Position>(e).x, 4.0f);
  EXPECT_EQ(registry.count<Position>(), 1u);
  registry.remove<Position>(e);
  registry.remove<Position>(e); // already gone: nothing happens
  EXPECT_FALSE(registry.has<Position>(e));
  EXPECT_EQ(registry.get<Label>(e).text, "three");
  registry.destroy(e);
  EXPECT_EQ(registry.tryGet<Label>(e), nullptr);
  EXPECT_EQ(registry.count<Label>(), 0u);
}

TEST(Registry, EachVisitsInTheOrderOfGivingAlsoAfterRemovals) {
  Registry registry;
  std::vector<Entity> e;
  for (int i = 0; i < 6; ++i) e.push_back(registry.create());
  for (const int i : {3, 0, 5, 1, 4}) registry.emplace<Position>(e[i], float(i));
  registry.remove<Position>(e[0]);
  registry.destroy(e[1]);
  EXPECT_EQ(indicesWithPosition(registry), (std::vector<uint32_t>{3, 5, 4}));
  registry.emplace<Position>(e[0], 0.0f); // given anew: last
  EXPECT_EQ(indicesWithPosition(registry), (std::vector<uint32_t>{3, 5, 4, 0}));
}

TEST(Registry, EachOfSeveralVisitsOnlyEntitiesThatHaveAll) {
  Registry registry;
  const Entity a = registry.create(), b = registry.create(), c = registry.create();
  for (const Entity e : {a, b, c}) registry.emplace<Position>(e, 1.0f);
  registry.emplace<Label>(c, "c");
  registry.emplace<Label>(a, "a");
  std::string seen;
  registry.each<Position, Label>([&](Entity, Position& p, const Label& l) {
    seen += l.text;
    p.x = 2;
  });
  EXPECT_EQ(seen, "ac"); // the order of Position, not of Label
  EXPECT_EQ(registry.get<Position>(a).x, 2);
  EXPECT_EQ(registry.get<Position>(b).x, 1);
  const Registry& constant = registry;
  constant.each<Label, Position>([&](Entity, const Label& l, const Position&) { seen += l.text; });
  EXPECT_EQ(seen, "acca");
}

TEST(Registry, MisuseIsCaught) {
  Registry registry;
  const Entity e = registry.create();
  registry.emplace<Position>(e);
  EXPECT_THROW(registry.each<Position>([&](Entity x, Position&) { registry.remove<Position>(x); }), CheckFailure);
  registry.destroy(e);
  EXPECT_THROW(registry.emplace<Position>(e), CheckFailure);
  EXPECT_THROW(registry.get<Position>(e), CheckFailure);
}

} // namespace lambent::test::registry_test

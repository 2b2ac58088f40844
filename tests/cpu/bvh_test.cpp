#include "engine/core/rng.h"
#include "engine/trace/flat_scene.h"
#include "tests/support/random_world.h"

namespace lambent::test::bvh_test {

std::vector<Aabb> randomBoxes(uint32_t count, uint32_t seed) {
  std::vector<Aabb> boxes(count);
  for (uint32_t i = 0; i < count; ++i) {
    Rng rng(seed, Stream::Test, i);
    boxes[i].add(10.0f * rng.next3());
    boxes[i].add(boxes[i].lo + rng.next3());
  }
  return boxes;
}

bool holds(const BvhNode& node, const Aabb& box) {
  return glm::all(glm::lessThanEqual(node.lo, box.lo)) && glm::all(glm::greaterThanEqual(node.hi, box.hi));
}

/// Walks as a shader does, with a test that all boxes pass or fail, and says what it comes by.
void check(const Bvh& bvh, std::span<const Aabb> boxes, size_t held) {
  std::vector<uint32_t> seen = bvh.order;
  std::sort(seen.begin(), seen.end());
  EXPECT_EQ(seen.size(), held);
  EXPECT_TRUE(std::adjacent_find(seen.begin(), seen.end()) == seen.end()) << "a box is held twice";
  uint32_t next = 0;
  for (uint32_t i = 0; i < bvh.nodes.size(); ++i) {
    const BvhNode& node = bvh.nodes[i];
    ASSERT_GT(node.skip, i);
    ASSERT_LE(node.skip, bvh.nodes.size());
    if (node.leaf == 0) {
      ASSERT_GT(node.skip, i + 1) << "an inner node without children";
      continue;
    }
    EXPECT_EQ(node.skip, i + 1);
    EXPECT_EQ(node.leaf / 8, next) << "leaves lie in the order of the nodes";
    next += node.leaf % 8;
    for (uint32_t k = 0; k < node.leaf % 8; ++k) {
      const Aabb& box = boxes[bvh.order[node.leaf / 8 + k]];
      for (uint32_t above = 0; above <= i; ++above) {
        if (bvh.nodes[above].skip <= i) continue;
        EXPECT_TRUE(holds(bvh.nodes[above], box)) << above << " does not hold leaf " << i;
      }
    }
  }
  EXPECT_EQ(next, held);
}

TEST(Bvh, HoldsEveryBoxOnceBuiltAndRefitted) {
  const BvhBuilder builder;
  for (const uint32_t count : {1u, 2u, 5u, 300u}) {
    std::vector<Aabb> boxes = randomBoxes(count, 1);
    Bvh bvh = builder.build(boxes, 4);
    check(bvh, boxes, count);
    boxes = randomBoxes(count, 2);
    refit(bvh, boxes);
    check(bvh, boxes, count);
  }
}

TEST(Bvh, LeavesOutWhatHasNoBox) {
  const BvhBuilder builder;
  EXPECT_TRUE(builder.build({}, 4).nodes.empty());
  std::vector<Aabb> boxes = randomBoxes(20, 3);
  boxes[3] = {};
  boxes[7].hi.x = kInfinity;
  boxes[9].lo.y = std::numeric_limits<float>::quiet_NaN();
  boxes[11].hi = boxes[11].lo; // a point is one
  check(builder.build(boxes, 4), boxes, 17);
}

TEST(Bvh, ManyBoxesAtOnePlaceEnd) {
  const BvhBuilder builder;
  const std::vector<Aabb> boxes(1000, Aabb{vec3(0), vec3(1)});
  check(builder.build(boxes, 4), boxes, 1000);
}

TEST(FlatScene, SaysWhatChanged) {
  RandomWorld world(0.01f);
  FlatScene scene(world.assets());
  EXPECT_TRUE(scene.update(world.step(40)).top);
  for (int i = 0; i < 20; ++i) {
    const SceneView& view = world.step(i % 3);
    const FlatScene::Changed changed = scene.update(view);
    EXPECT_EQ(changed.top, view.changes.geometry || view.changes.instances) << i;
    FlatScene again(world.assets());
    SceneView first = view;
    first.changes = {};
    again.update(first);
    ASSERT_EQ(scene.instances().size(), again.instances().size());
    EXPECT_EQ(scene.triangles().size(), again.triangles().size());
  }
}

} // namespace lambent::test::bvh_test

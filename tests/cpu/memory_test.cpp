// Who holds memory, and what an error says of it.
#include "engine/core/memory.h"

#include "gi/vpl/asked_memory.h"
#include "gi/vpl/kept_paths.h"

#include <gtest/gtest.h>

namespace lambent::test::memory_test {

uint64_t heldBy(const MemoryAccount& account, const std::string& owner) {
  for (const MemoryAccount::Row& row : account.rows())
    if (row.owner == owner && !row.gpu) return row.bytes;
  return 0;
}

TEST(Memory, AnOwnerGivesBackWhatItHeld) {
  MemoryAccount account;
  {
    const MemoryAccount::Scope scope(account);
    HeldMemory one("cube"), other("cube");
    one.now(300);
    other.now(50);
    EXPECT_EQ(heldBy(account, "cube"), 350u);
    one.now(100);
    EXPECT_EQ(heldBy(account, "cube"), 150u);
    MemoryAccount elsewhere;
    const MemoryAccount::Scope another(elsewhere);
    one.now(200); // stays in the account that it began in
    EXPECT_EQ(heldBy(account, "cube"), 250u);
    EXPECT_TRUE(elsewhere.rows().empty());
  }
  EXPECT_TRUE(account.rows().empty());
}

TEST(Memory, AnErrorNamesTheLargestOwners) {
  MemoryAccount account;
  const MemoryAccount::Scope scope(account);
  HeldMemory rays("rays"), scene("scene"), small("small");
  rays.now(1'250'000'000);
  scene.now(2'000'000'000);
  small.now(99'000'000);
  EXPECT_EQ(moreThanIsLeft(4.2e9, "lower it"),
            "5 GB of memory, more than is left (lower it; held: scene 2.0 GB, rays 1.2 GB)");
}

TEST(Memory, ASetHoldsItsPaths) {
  VplSet set;
  const uint64_t none = bytesHeld(set);
  set.slots.resize(10);
  set.lightPaths.resize(10);
  for (KeptPaths& k : set.lightPaths) k.vertices.resize(32);
  EXPECT_GE(bytesHeld(set) - none, 10 * (sizeof(Vpl) + 32 * sizeof(KeptVertex)));
}

} // namespace lambent::test::memory_test

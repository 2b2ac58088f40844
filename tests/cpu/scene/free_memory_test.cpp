#include "engine/core/free_memory.h"

#include "engine/core/files.h"

#include "tests/support/files.h"

namespace lambent::test::free_memory_test {

class FreeMemory : public ::testing::Test {
 protected:
  void put(const char* name, const char* text) const { writeBytes(folder_ / name, text); }
  TemporaryFolder folder_;
};

TEST_F(FreeMemory, OfAGroupWithoutLimitIsNotBounded) {
  EXPECT_EQ(freeOfGroup(folder_.path()), std::numeric_limits<size_t>::max());
  put("memory.max", "max\n");
  put("memory.current", "1000\n");
  EXPECT_EQ(freeOfGroup(folder_.path()), std::numeric_limits<size_t>::max());
}

TEST_F(FreeMemory, FilesThatTheSystemKeepsAreFree) {
  put("memory.max", "10000\n");
  put("memory.current", "9000\n");
  EXPECT_EQ(freeOfGroup(folder_.path()), 1000u);
  put("memory.stat", "anon 3000\nfile 6000\nactive_file 1000\ninactive_file 5000\nslab 12\n");
  EXPECT_EQ(freeOfGroup(folder_.path()), 6000u);
  put("memory.current", "20000\n"); // of what it may not have
  EXPECT_EQ(freeOfGroup(folder_.path()), 0u);
}

TEST_F(FreeMemory, OfTheFirstVersionToo) {
  put("memory/memory.limit_in_bytes", "500\n");
  put("memory/memory.usage_in_bytes", "400\n");
  put("memory/memory.stat", "inactive_file 1\ntotal_inactive_file 50\n");
  EXPECT_EQ(freeOfGroup(folder_.path()), 150u);
}

TEST(Leftovers, AreThoseOfThatFileAlone) {
  const TemporaryFolder folder;
  for (const char* name : {"a.png", ".a.lambent-123.png", ".a.lambent-1x.png", ".b.lambent-123.png",
                           ".a.lambent-123.exr", ".a.lambent-.png", ".a.123.png"})
    writeBytes(folder / name, "x");
  removeLeftovers(folder / "a.png");
  EXPECT_FALSE(fs::exists(folder / ".a.lambent-123.png"));
  for (const char* name :
       {"a.png", ".a.lambent-1x.png", ".b.lambent-123.png", ".a.lambent-123.exr", ".a.lambent-.png", ".a.123.png"})
    EXPECT_TRUE(fs::exists(folder / name)) << name;
}

TEST(Leftovers, GoWithTheFirstFileWrittenBesideThem) {
  const TemporaryFolder folder;
  writeBytes(folder / ".a.lambent-123.png", "x");
  writeBytes(folder / ".b.lambent-123.png", "x");
  writeAtomically(folder / "a.png", "whole");
  EXPECT_FALSE(fs::exists(folder / ".a.lambent-123.png"));
  writeAtomically(folder / "b.png", "whole");
  EXPECT_FALSE(fs::exists(folder / ".b.lambent-123.png"));
}

/// What a program that lives is about to finish is not taken from it.
TEST(Leftovers, AreNotWhatSomebodyWrites) {
  const TemporaryFolder folder;
  writeAtomically(folder / "a.png", [&](const fs::path& temporary) {
    writeBytes(temporary, "whole");
    removeLeftovers(folder / "a.png");
    EXPECT_TRUE(fs::exists(temporary));
  });
  EXPECT_EQ(readBytes(folder / "a.png"), "whole");
}

/// As long as a name may be, in front of the dot or behind it.
TEST(Leftovers, OfLongNamesFitInTheFolder) {
  const TemporaryFolder folder;
  for (const std::string& name : {std::string(251, 'a') + ".png", "a." + std::string(253, 'b')}) {
    fs::path half;
    EXPECT_THROW(
        writeAtomically(folder / name, [&](const fs::path& t) { writeBytes(half = t, "x"), throw RunError(""); }),
        RunError);
    writeBytes(half, "killed");
    writeAtomically(folder / name, "whole");
    removeLeftovers(folder / name);
    EXPECT_FALSE(fs::exists(half));
    EXPECT_EQ(readBytes(folder / name), "whole");
  }
}

/// They lie where a link leads.
TEST(Leftovers, OfALinkLieBesideWhatItLeadsTo) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "there");
  fs::create_symlink("there/b.png", folder / "a.png");
  writeBytes(folder / "there/.b.lambent-123.png", "x");
  removeLeftovers(folder / "a.png");
  EXPECT_FALSE(fs::exists(folder / "there/.b.lambent-123.png"));
}

} // namespace lambent::test::free_memory_test

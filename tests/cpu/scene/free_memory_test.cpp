#include "engine/core/free_memory.h"

#include "engine/core/image.h"

#include "tests/support/test.h"

#include <fstream>
#include <random>

namespace lambent::test::free_memory_test {

class FreeMemory : public ::testing::Test {
 protected:
  FreeMemory() { std::filesystem::create_directories(folder_ / "memory"); }
  ~FreeMemory() override { std::filesystem::remove_all(folder_); }
  void put(const char* name, const char* text) const { std::ofstream(folder_ / name) << text; }
  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("free-memory-" + std::to_string(std::random_device{}()));
};

TEST_F(FreeMemory, OfAGroupWithoutLimitIsNotBounded) {
  EXPECT_EQ(freeOfGroup(folder_), std::numeric_limits<size_t>::max());
  put("memory.max", "max\n");
  put("memory.current", "1000\n");
  EXPECT_EQ(freeOfGroup(folder_), std::numeric_limits<size_t>::max());
}

TEST_F(FreeMemory, FilesThatTheSystemKeepsAreFree) {
  put("memory.max", "10000\n");
  put("memory.current", "9000\n");
  EXPECT_EQ(freeOfGroup(folder_), 1000u);
  put("memory.stat", "anon 3000\nfile 6000\nactive_file 1000\ninactive_file 5000\nslab 12\n");
  EXPECT_EQ(freeOfGroup(folder_), 6000u);
  put("memory.current", "20000\n"); // of what it may not have
  EXPECT_EQ(freeOfGroup(folder_), 0u);
}

TEST_F(FreeMemory, OfTheFirstVersionToo) {
  put("memory/memory.limit_in_bytes", "500\n");
  put("memory/memory.usage_in_bytes", "400\n");
  put("memory/memory.stat", "inactive_file 1\ntotal_inactive_file 50\n");
  EXPECT_EQ(freeOfGroup(folder_), 150u);
}

TEST(Leftovers, AreThoseOfThatFileAlone) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("leftovers-" + std::to_string(std::random_device{}()));
  std::filesystem::create_directories(folder);
  for (const char* name : {"a.png", ".a.123.png", ".a.1x.png", ".b.123.png", ".a.123.exr", ".a..png"})
    std::ofstream(folder / name) << "x";
  removeLeftovers(folder / "a.png");
  EXPECT_FALSE(std::filesystem::exists(folder / ".a.123.png"));
  for (const char* name : {"a.png", ".a.1x.png", ".b.123.png", ".a.123.exr", ".a..png"})
    EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
  std::filesystem::remove_all(folder);
}

} // namespace lambent::test::free_memory_test

// The file that keeps a layered depth cube.
#include "engine/core/files.h"
#include "gi/cube/cube_file.h"
#include "tests/support/checked.h"
#include "tests/support/cube_world.h"
#include "tests/support/files.h"

#include <cmath>
#include <cstddef>
#include <cstring>

#include <sys/stat.h>

namespace lambent::test::cube_file_test {

class CubeFileTest : public ::testing::Test {
 protected:
  void SetUp() override {

    w.lights = {lightAt({0, -0.99f, 0}, {0, 1, 0}, vec3(1)), lightAt({0.5f, -0.99f, 0}, {0, 1, 0}, vec3(1))};
    w.room();
    key_ = cubeKey(w.view);
  }

  CubeWorld w;
  CubeSettings settings = smallCube(CubeVisibility::Rays, 16);
  TemporaryFolder folder_;
  const fs::path file_ = folder_ / "room.cube";
  uint64_t key_ = 0;
};

TEST_F(CubeFileTest, GivesBackWhatWasSavedAndGoesOn) {
  w.gather.disk = 2.5f; // kept in the file: with other settings a cube begins anew
  LayeredCube half;
  half.update(w.inputs(settings), 1);
  ASSERT_EQ(half.pending(), 1u);
  saveCube(file_, half, key_);
  LayeredCube on = loadCube(file_, key_), whole;
  EXPECT_EQ(on.update(w.inputs(settings)).lightsIn, 1u);
  whole.update(w.inputs(settings));
  for (size_t e = 0; e < whole.surfaces().entries().size(); ++e) ASSERT_EQ(on.irradiance(e), whole.irradiance(e));
}

TEST_F(CubeFileTest, KnowsOfColumnsThatWereCut) {
  settings.resolution = 8;
  for (int i = 0; i < 260; ++i)
    w.scene.quad({0, -0.9f + 0.005f * float(i), 0}, {0, 0, 0.3f}, {0.3f, 0, 0}, w.scene.material(vec3(0.5f)));
  w.place();
  LayeredCube cube;
  cube.update(w.inputs(settings));
  ASSERT_GT(cube.surfaces().columnsCut(), 0u);
  saveCube(file_, cube, key_);
  EXPECT_EQ(loadCube(file_, key_).surfaces().columnsCut(), cube.surfaces().columnsCut());
}

/// What memory holds between members does not reach the file. (After those of lights: tests/cli/busy.)
TEST_F(CubeFileTest, TheSameCubeHasTheSameBytes) {
  const auto bytesWith = [&](int between) {
    constexpr size_t kBegin = offsetof(GatherSettings, glossy) + 1;
    std::memset(reinterpret_cast<char*>(&w.gather) + kBegin, between, offsetof(GatherSettings, spread) - kBegin);
    LayeredCube cube;
    cube.update(w.inputs(settings));
    saveCube(file_, cube, key_);
    return readBytes(file_);
  };
  EXPECT_EQ(bytesWith(0x55), bytesWith(0xaa));
}

TEST_F(CubeFileTest, SaysWhatIsWrongWithAFile) {
  LayeredCube cube;
  cube.update(w.inputs(settings));
  saveCube(file_, cube, key_);
  EXPECT_THROW(loadCube(file_, key_ + 1), InputError);
  const std::string good = readBytes(file_);
  EXPECT_NO_THROW(loadCube(file_, key_));
  for (size_t at = 0; at < good.size(); at += 997) {
    std::string bad = good;
    bad[at] = char(bad[at] ^ 0x55);
    writeBytes(file_, bad);
    EXPECT_THROW(loadCube(file_, key_), InputError) << at;
  }
  writeBytes(file_, good.substr(0, 10));
  EXPECT_NE(inputErrorOf([&] { loadCube(file_, key_); }).find("damaged"), std::string::npos) << "it begins as one";
  for (const size_t size : {size_t(0), size_t(10), size_t(24), size_t(100), good.size() / 2, good.size() - 1}) {
    writeBytes(file_, good.substr(0, size));
    EXPECT_THROW(loadCube(file_, key_), InputError) << size;
  }
  writeBytes(file_, good + '\0');
  EXPECT_THROW(loadCube(file_, key_), InputError);
  fs::remove(file_);
  ASSERT_EQ(mkfifo(file_.c_str(), 0600), 0);
  EXPECT_THROW(loadCube(file_, key_), InputError) << "a pipe that nobody writes";
}

/// A file larger than memory says that, and not that it is damaged: it may be right elsewhere.
TEST_F(CubeFileTest, SaysThatMemoryIsShort) {
  LayeredCube cube;
  cube.update(w.inputs(settings));
  saveCube(file_, cube, key_);
  constexpr size_t kNodes = 24 + 32 + sizeof(CubeSettings) + sizeof(GatherSettings);
  std::string large = readBytes(file_).substr(0, kNodes + sizeof(uint64_t));
  std::error_code refused = std::make_error_code(std::errc::file_too_large);
  for (int bits = 43; refused && bits > 38; --bits) fs::resize_file(file_, uint64_t(1) << bits, refused); // with a hole
  if (refused) GTEST_SKIP() << "this disk has no files with holes as large";
  const uint64_t fits = fs::file_size(file_) / sizeof(CubeNode) / 2;
  std::memcpy(&large[kNodes], &fits, sizeof fits);
  std::fstream(file_, std::ios::in | std::ios::out | std::ios::binary)
      .write(large.data(), std::streamsize(large.size()));
  EXPECT_NE(messageOf<RunError>([&] { loadCube(file_, key_); }).find("GB of memory, more than is left"),
            std::string::npos);
}

/// Values that no build writes, behind a checksum that is right.
TEST_F(CubeFileTest, BelievesNoValueThatCannotBe) {
  settings.levels = 1;
  settings.split = 0; // all of it is in eight cubes
  LayeredCube cube;
  cube.update(w.inputs(settings));
  saveCube(file_, cube, key_);
  const std::string good = readBytes(file_);
  const size_t nodes = cube.surfaces().nodes().size(), cubes = cube.surfaces().cubes().size();
  const size_t entries = cube.surfaces().entries().size(), firsts = cubes * cube.surfaces().columns() + 1;
  ASSERT_EQ(nodes, 9u);
  // Where values lie: engine/core/checked_file.h and CubeFile::each.
  constexpr size_t kSurfaces = 24, kSettings = kSurfaces + 32, kGather = kSettings + sizeof(CubeSettings);
  constexpr size_t kNodes = kGather + sizeof(GatherSettings) + 8;
  const size_t kCubes = kNodes + nodes * sizeof(CubeNode) + 8, kFirsts = kCubes + cubes * sizeof(CubeGrid) + 8;
  const size_t kEntries = kFirsts + firsts * 4 + 8, kLights = kEntries + entries * sizeof(CubeEntry) + 8;
  const size_t kSeen = kLights + w.lights.size() * sizeof(VirtualLight) + 8, kSums = kSeen + entries * 8 + 8;
  ASSERT_EQ(kSums + entries * sizeof(dvec3) + 8, good.size());
  const auto refused = [&](const char* what, size_t at, auto value) {
    std::string bad = good;
    std::memcpy(&bad[at], &value, sizeof value);
    writeBytes(file_, mended(bad));
    EXPECT_NE(inputErrorOf([&] { loadCube(file_, key_); }).find("damaged"), std::string::npos) << what;
  };
  const auto numberAt = [&]<class T>(size_t at, T value) {
    std::memcpy(&value, &good[at], sizeof value);
    return value;
  };
  writeBytes(file_, mended(good));
  EXPECT_NO_THROW(loadCube(file_, key_));
  const float nan = std::nanf("");
  refused("corner", kSurfaces, nan);
  refused("edge", kSurfaces + 12, -1.0f);
  refused("edge, infinite", kSurfaces + 12, kInfinity);
  refused("texels", kSurfaces + 16, 1 << 30);
  refused("texels, not those of the settings", kSurfaces + 16, 24);
  refused("levels", kSurfaces + 20, 0x7fffffff);
  refused("split", kSurfaces + 24, -1.0f);
  refused("a bool", kGather + offsetof(GatherSettings, glossy), uint8_t(2));
  refused("number of nodes", kNodes - 8, uint64_t(1) << 60);
  refused("corner of a node", kNodes + sizeof(CubeNode), 0.5f);
  refused("children of a child", kNodes + sizeof(CubeNode) + offsetof(CubeNode, children), 1u);
  refused("column of a leaf", kNodes + sizeof(CubeNode) + offsetof(CubeNode, firstColumn), 7u);
  refused("texel of a cube", kCubes + offsetof(CubeGrid, texel), 9.0f);
  refused("entries of a column", kFirsts + 4, ~0u);
  const size_t entry = kEntries + 10 * sizeof(CubeEntry);
  refused("place of an entry", entry, nan);
  refused("place beside the texel", entry, vec3(0.9f));
  refused("normal", entry + offsetof(CubeEntry, normal), vec3(2, 0, 0));
  refused("shading normal", entry + offsetof(CubeEntry, shading), vec3(nan));
  refused("light", kLights + offsetof(VirtualLight, radiance), vec3(nan));
  refused("another light", kLights + offsetof(VirtualLight, radiance), vec3(7));
  refused("area", kLights + offsetof(VirtualLight, area), -1.0f);
  refused("a light's bool", kLights + offsetof(VirtualLight, alive), uint8_t(0x80));
  refused("a light that is seen and is none", kSeen, ~uint64_t(0));
  for (const double sum : {std::nan(""), 3e38, -1.0, 2 * numberAt(kSums, 0.0) + 1e-3}) refused("sum", kSums, sum);
}

TEST_F(CubeFileTest, LinksStayLinks) {
  LayeredCube cube;
  cube.update(w.inputs(settings));
  fs::create_symlink("there.cube", file_); // nothing is there yet
  saveCube(file_, cube, key_);
  EXPECT_TRUE(fs::is_symlink(file_));
  EXPECT_NO_THROW(loadCube(folder_ / "there.cube", key_));
  fs::remove(file_);
  fs::create_symlink("room.cube", file_); // to itself
  EXPECT_THROW(saveCube(file_, cube, key_), RunError);
  EXPECT_THROW(checkWritable(file_), RunError);
  EXPECT_TRUE(fs::is_symlink(file_));
}

TEST_F(CubeFileTest, BelongsToTheGeometryNotToTheLights) {
  HandScene other;
  other.box(vec3(-1), vec3(1.01f), other.material(vec3(0.5f)), true);
  EXPECT_NE(cubeKey(other.view()), key_);
  w.scene.lights.push_back({.type = LightType::Point, .intensity = vec3(1)});
  EXPECT_EQ(cubeKey(w.scene.view()), key_);
}
} // namespace lambent::test::cube_file_test

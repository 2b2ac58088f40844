// What settings ask of memory, before it is taken.
#include "gi/vpl/asked_memory.h"

#include "gi/vpl/kept_paths.h"
#include "tests/support/files.h"

namespace lambent::test::asked_memory_test {

constexpr size_t kGiB = size_t(1) << 30;

std::string refusal(const SmcSettings& smc, const VplSettings& vpl, size_t free) {
  return inputErrorOf([&] { refuseBeyondMemory(smc, vpl, free); });
}

TEST(AskedMemory, DefaultsFitASmallMachine) {
  EXPECT_LT(bytesOfVpls({}, {}), 0.1 * double(kGiB));
  EXPECT_NO_THROW(refuseBeyondMemory({}, {}, kGiB / 4));
  EXPECT_THROW(refuseBeyondMemory({}, {}, 1000), InputError);
}

TEST(AskedMemory, KeptPathsAreCountedWithTheirBounces) {
  SmcSettings smc{.vpls = 65536, .paths = 4096, .bounces = 32};
  const double kept = 2.0 * 65536 * 4096 * 32 * sizeof(KeptVertex);
  EXPECT_GE(bytesOfVpls(smc, {}), kept);
  EXPECT_LT(bytesOfVpls(smc, {}), 1.01 * kept);
  EXPECT_NE(refusal(smc, {}, 64 * kGiB).find("smc.vpls, smc.paths and smc.bounces ask for"), std::string::npos);
  EXPECT_NE(refusal(smc, {}, 64 * kGiB).find("smc.cache=off"), std::string::npos);
  smc.cache = false;
  EXPECT_NO_THROW(refuseBeyondMemory(smc, {}, 2 * kGiB)) << "one light's at a time";
}

TEST(AskedMemory, CandidatesAreCountedWhereATechniqueDrawsThem) {
  const SmcSettings smc{.vpls = 65536};
  VplSettings vpl{.source = VplSource::Mir, .mirCandidates = 1024};
  EXPECT_GT(bytesOfVpls(smc, vpl), 15.0 * double(kGiB));
  EXPECT_NE(refusal(smc, vpl, 8 * kGiB).find("vpl.mirCandidates"), std::string::npos);
  vpl.source = VplSource::Ir; // draws none
  EXPECT_NO_THROW(refuseBeyondMemory(smc, vpl, 2 * kGiB));
}

} // namespace lambent::test::asked_memory_test

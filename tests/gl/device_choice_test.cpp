// Which EGL device is tried first, and when software is refused: a choice over descriptions, no device needed.
#include "engine/platform/device_choice.h"

#include "engine/gl/context.h"
#include "tests/support/files.h"

namespace lambent::test::device_choice_test {

using Attempts = std::vector<DeviceAttempt>;
constexpr int kSurfaceless = DeviceAttempt::kSurfaceless;
const DeviceDescription kGpu{"/dev/dri/card0", false}, kOtherGpu{"/dev/dri/card1", false}, kSoftware{"software", true};

Attempts attempts(const std::vector<DeviceDescription>& devices, const DeviceWish& wish = {}) {
  return deviceAttempts(devices, wish);
}

TEST(DeviceChoice, GpusComeFirstAndSoftwareNeverStandsInForThem) {
  EXPECT_EQ(attempts({kSoftware, kGpu, kOtherGpu}),
            (Attempts{{1, Drawn::ByGpu}, {2, Drawn::ByGpu}, {kSurfaceless, Drawn::ByGpu}}));
}

TEST(DeviceChoice, SoftwareIsTakenWhereItIsAllThereIs) {
  EXPECT_EQ(attempts({kSoftware}), (Attempts{{kSurfaceless, Drawn::ByAny}, {0, Drawn::ByAny}}));
  EXPECT_EQ(attempts({}), (Attempts{{kSurfaceless, Drawn::ByAny}}));
}

TEST(DeviceChoice, SoftwareIsTakenWhereItIsAskedFor) {
  EXPECT_EQ(attempts({kGpu, kSoftware}, {.software = true}),
            (Attempts{{1, Drawn::ByCpu}, {kSurfaceless, Drawn::ByCpu}}));
  EXPECT_EQ(attempts({kGpu, kSoftware}, {.softwareMesa = true}),
            (Attempts{{kSurfaceless, Drawn::ByCpu}, {1, Drawn::ByCpu}}));
}

TEST(DeviceChoice, ANumberMeansThatDeviceAndNoOther) {
  EXPECT_EQ(attempts({kGpu, kSoftware, kOtherGpu}, {.device = 2}), (Attempts{{2, Drawn::ByAny}}));
  EXPECT_EQ(attempts({kGpu, kSoftware}, {.device = 1}), (Attempts{{1, Drawn::ByAny}}));
  const std::string error = inputErrorOf([] { attempts({kGpu, kSoftware}, {.device = 2}); });
  EXPECT_NE(error.find("0 = /dev/dri/card0, 1 = software"), std::string::npos) << error;
}

TEST(DeviceChoice, ReadsTheEnvironment) {
  EXPECT_FALSE(deviceWish(nullptr, nullptr).software);
  EXPECT_FALSE(deviceWish("", "0").softwareMesa);
  EXPECT_TRUE(deviceWish(nullptr, "1").softwareMesa);
  EXPECT_TRUE(deviceWish(nullptr, "true").softwareMesa);
  EXPECT_TRUE(deviceWish("software", nullptr).software);
  EXPECT_EQ(deviceWish("3", nullptr).device, 3);
  for (const char* wrong : {"gpu", "-1", "1x", " 1"}) EXPECT_THROW(deviceWish(wrong, nullptr), InputError) << wrong;
}

TEST(DeviceChoice, KnowsDriversThatDrawOnTheCpu) {
  EXPECT_TRUE(gl::drawnByCpu("llvmpipe (LLVM 15.0.6, 256 bits)"));
  EXPECT_TRUE(gl::drawnByCpu("zink (llvmpipe (LLVM 15.0.6, 256 bits))"));
  EXPECT_TRUE(gl::drawnByCpu("softpipe"));
  EXPECT_FALSE(gl::drawnByCpu("NVIDIA H100 80GB HBM3/PCIe/SSE2"));
  EXPECT_FALSE(gl::drawnByCpu("AMD Radeon RX 6600 (navi23, LLVM 15.0.6, DRM 3.49)"));
  EXPECT_FALSE(gl::drawnByCpu("zink (NVIDIA GeForce RTX 3070)"));
}

TEST(DeviceChoice, TellsTheCureInOneLine) {
  const std::vector<std::string> reasons{"EGL device 0: no OpenGL 4.5 core context",
                                         "EGL surfaceless: only software: llvmpipe"};
  const std::vector<DeviceDescription> devices{kGpu, kSoftware};
  std::string text = noContextMessage(devices, {}, reasons);
  EXPECT_NE(text.find("LAMBENT_DEVICE=software"), std::string::npos) << text;
  EXPECT_NE(text.find(reasons[0]), std::string::npos) << text;
  EXPECT_EQ(text.find('\n'), std::string::npos);
  text = noContextMessage(std::vector{kSoftware}, {}, reasons);
  EXPECT_NE(text.find("libgl1-mesa-dri"), std::string::npos) << text;
  text = noContextMessage(devices, {.device = 0}, reasons);
  EXPECT_NE(text.find("1 = software"), std::string::npos) << text;
}

} // namespace lambent::test::device_choice_test

// GPUs that interpolate between corners of triangles rounded to 1/256 of a pixel, as NVIDIA's do and Mesa on the CPU
// does not: depths then lie off their surfaces by more than rays start from them. Light must be that of exact corners.
#include "shader_copy.h"
#include "still_room.h"

namespace lambent::test::rounded_corners_test {

class RoundedCornersTest : public StillRoomTest {
 protected:
  RoundedCornersTest() { room.scene.size(64, 48); }
  ~RoundedCornersTest() override { gl::setShaderFolder(folder); }

  Image drawn(bool rounded, Buffer buffer, int pictures) {
    gl::setShaderFolder(rounded ? rounding.path : folder);
    Viewer gi(settings);
    stand(gi, pictures);
    return gi.read(buffer);
  }
  void expectAlike(Buffer buffer, int pictures, double difference) {
    const Image exact = drawn(false, buffer, pictures), rounded = drawn(true, buffer, pictures);
    EXPECT_NE(exact.pixels, rounded.pixels) << "corners are rounded";
    EXPECT_NEAR(meanLuminance(rounded) / meanLuminance(exact), 1, 0.005);
    EXPECT_LT(relativeRmse(rounded, exact), difference);
  }

  const fs::path folder = gl::shaderFolder();
  const RoundedCorners rounding;
};

/// Rays that check maps start at the image's depths. They took a third of the light.
TEST_F(RoundedCornersTest, LeaveTheLightOfAStandingView) { expectAlike(Buffer::Irradiance, 16, 0.05); }

/// So do those of patches to lamps.
TEST_F(RoundedCornersTest, LeaveTheLightOfLamps) {
  room.scene.lights.clear();
  room.scene.quad({-0.1f, 0.8f, -0.1f}, {0.2f, 0, 0}, {0, 0, 0.2f}, room.scene.material(vec3(0), vec3(20)));
  settings.shadow.emitters = EmitterShadows::Patches;
  expectAlike(Buffer::Direct, 1, 0.06);
}

/// And those of pairs about which the map of a punctual light is in doubt.
TEST_F(RoundedCornersTest, LeaveShadowsOfPunctualLights) { expectAlike(Buffer::Direct, 1, 0.06); }

} // namespace lambent::test::rounded_corners_test

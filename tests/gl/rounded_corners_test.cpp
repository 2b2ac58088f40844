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
TEST_F(RoundedCornersTest, LeaveTheLightOfAStandingView) { expectAlike(Buffer::Irradiance, 16, 0.02); }

/// So do those of patches to lamps.
TEST_F(RoundedCornersTest, LeaveTheLightOfLamps) {
  room.scene.lights.clear();
  room.scene.quad({-0.1f, 0.8f, -0.1f}, {0.2f, 0, 0}, {0, 0, 0.2f}, room.scene.material(vec3(0), vec3(20)));
  settings.shadow.emitters = EmitterShadows::Patches;
  expectAlike(Buffer::Direct, 1, 0.003);
}

/// And those of pairs about which the map of a punctual light is in doubt, worst where the view grazes the floor.
TEST_F(RoundedCornersTest, LeaveShadowsOfPunctualLights) {
  const uint32_t white = room.scene.material(vec3(0.7f));
  constexpr int kTiles = 24; // whose corners are all in view
  for (int z = 0; z < kTiles; ++z)
    for (int x = 0; x < kTiles; ++x)
      room.scene.quad({-1 + 2.0f * float(x) / kTiles, -0.99f, -1 + 1.5f * float(z + 1) / kTiles}, {2.0f / kTiles, 0, 0},
                      {0, 0, -1.5f / kTiles}, white);
  room.scene.camera = cameraAt(vec3(0.1f, -0.9f, 0.95f), vec3(0, -0.95f, -1), 1);
  settings.shadow.pointResolution = 16; // more doubt
  expectAlike(Buffer::Direct, 1, 0.003);
}

/// Lights of reflective maps, and their maps, stand at the depths that the light sees, far off where it grazes a wall.
TEST_F(RoundedCornersTest, LeaveLightsOfReflectiveMaps) {
  HandScene& scene = room.scene;
  const uint32_t white = scene.material(vec3(0.7f));
  constexpr int kTiles = 16; // whose corners are all in the light's view
  for (int z = 0; z < kTiles; ++z)
    for (int x = 0; x < kTiles; ++x)
      scene.quad({-0.9f + 1.8f * float(x) / kTiles, -0.99f, -0.9f + 1.8f * float(z + 1) / kTiles},
                 {1.8f / kTiles, 0, 0}, {0, 0, -1.8f / kTiles}, white);
  scene.lights[0].position = {0, -0.9f, 0};
  applyTechnique(settings, "rsm");
  settings.vpl.visibility = VplVisibility::Rays;
  settings.rsm.resolution = 32;
  expectAlike(Buffer::Irradiance, 1, 0.004);
}

} // namespace lambent::test::rounded_corners_test

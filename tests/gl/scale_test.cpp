// No length is absolute: a world scaled by a power of two, with its lights to match, gives the same bytes.
#include "gl_fixture.h"

namespace lambent::test {

class ScaleTest : public GlTest {
 protected:
  /// A room of `unit` times 4×3×5 m with a block, a ball of faces, a lamp that glows, a point light and a way out to a
  /// sky and a sun. Frames of it standing still and with the block moving.
  static std::vector<Image> pictures(float unit, const std::string& technique,
                                     const Sky& sky = vec3(0.1f, 0.2f, 0.3f)) {
    HandScene scene;
    const uint32_t white = scene.material(vec3(0.7f)), red = scene.material(vec3(0.6f, 0.1f, 0.1f)),
                   lamp = scene.material(vec3(0.2f), vec3(9, 8, 7), true);
    const auto at = [unit](float x, float y, float z) { return unit * vec3(x, y, z); };
    scene.quad(at(-2, 0, 2.5f), at(4, 0, 0), at(0, 0, -5), white);
    scene.quad(at(-2, 3, -2.5f), at(4, 0, 0), at(0, 0, 4), white); // a gap at its front
    scene.quad(at(-2, 0, 2.5f), at(0, 0, -5), at(0, 3, 0), red);
    scene.quad(at(2, 0, -2.5f), at(0, 0, 5), at(0, 3, 0), white);
    scene.quad(at(-2, 0, -2.5f), at(4, 0, 0), at(0, 3, 0), white);
    scene.quad(at(0.5f, 2.5f, -1), at(0.6f, 0, 0), at(0, 0, 0.5f), lamp);
    scene.box(at(-1, 0, -1), at(-0.2f, 1.1f, -0.3f), white, false);
    LightView point;
    point.position = at(-1.2f, 2, 0.7f);
    point.intensity = unit * unit * vec3(2, 3, 4);
    LightView sun;
    sun.type = LightType::Directional;
    sun.direction = glm::normalize(vec3(0.3f, -1, -0.4f));
    sun.intensity = vec3(2);
    scene.lights = {point, sun};
    scene.sky = sky;
    scene.camera = cameraAt(at(0.3f, 1.6f, 2.2f), at(-0.2f, 1, -1), 1.1f, 64, 36);
    scene.camera.near = 0.01f * unit;

    Settings settings;
    settings.smc.vpls = 256;
    settings.smc.points = 256;
    settings.smc.warmup = 8;
    settings.shadow.resolution = 64;
    settings.shadow.maker = ShadowMaker::Rays;
    settings.image.exposure = 1;
    applyTechnique(settings, technique);
    Viewer gi(settings);
    std::vector<Image> images;
    SceneView view = scene.view();
    view.changes = {true, true, true, true, true};
    for (int frame = 0; frame < 3; ++frame) {
      gi.run(view);
      images.push_back(gi.read(Buffer::Direct));
      images.push_back(gi.read(Buffer::Indirect));
      view.changes = {false, false, false, true, false};
      for (size_t i = 6; i < scene.instances.size(); ++i) { // the block
        InstanceView& moved = scene.instances[i];
        moved.moved = true;
        moved.worldFromObjectBefore = moved.worldFromObject;
        moved.boundsWorldBefore = moved.boundsWorld;
        moved.worldFromObject[3] += vec4(at(0.05f, 0, 0.1f), 0);
        moved.boundsWorld = transformed(scene.assets.meshes[moved.mesh].boundsObject, moved.worldFromObject);
      }
    }
    return images;
  }
};

TEST_F(ScaleTest, PowersOfTwoGiveTheSameBytesByDay) {
  const Sky sky = Sky::daylight(glm::normalize(vec3(-0.3f, 1, 0.4f)), 3);
  for (const char* technique : {"smc", "ir"}) {
    const std::vector<Image> usual = pictures(1, technique, sky), scaled = pictures(0x1p-13f, technique, sky);
    for (size_t i = 0; i < usual.size(); ++i)
      for (size_t p = 0; p < usual[i].pixels.size(); ++p)
        ASSERT_EQ(usual[i].pixels[p], scaled[i].pixels[p]) << technique << ", picture " << i;
  }
}

TEST_F(ScaleTest, PowersOfTwoGiveTheSameBytes) {
  for (const char* technique : {"smc", "ir", "mir", "tcas", "rsm", "isr", "hisr", "multires-splat"}) {
    const std::vector<Image> usual = pictures(1, technique);
    double light = 0;
    for (const vec3& p : usual[1].pixels) light += double(p.y);
    EXPECT_GT(light / double(usual[1].pixels.size()), 0.01) << technique;
    for (const int k : {-13, 12}) { // what has a length of its own shows the more the farther from it
      const std::vector<Image> scaled = pictures(std::ldexp(1.0f, k), technique);
      for (size_t i = 0; i < usual.size(); ++i) {
        size_t different = 0;
        for (size_t p = 0; p < usual[i].pixels.size(); ++p) different += usual[i].pixels[p] != scaled[i].pixels[p];
        EXPECT_EQ(different, 0u) << technique << ", 2^" << k << ", " << (i % 2 ? "indirect" : "direct") << ", frame "
                                 << i / 2;
      }
    }
  }
}

} // namespace lambent::test

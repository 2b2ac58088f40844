// Whole frames, and direct light, read back.
#pragma once

#include "gi/direct/direct_light.h"
#include "gi/plan/effects.h"
#include "gl_fixture.h"

namespace lambent::test {

inline Image nextFrame(Viewer& viewer, const SceneView& view, Buffer buffer = Buffer::Irradiance) {
  viewer.run(view);
  return viewer.read(buffer);
}
inline Image firstFrame(const Settings& settings, const SceneView& view, Buffer buffer = Buffer::Irradiance) {
  Viewer viewer(settings);
  return nextFrame(viewer, view, buffer);
}

/// Irradiance by direct light, or radiance where surfaces are glossy; row 0 at the top. `levels`: of the fragments that
/// asked lamps, by pixel, or −1.
inline Image directOf(PassContext passes, const HandScene& scene, const LightSet& lights, const Settings& settings,
                      FrameStats& stats, uint32_t mostDoubts = ShadowRayPass::kMost,
                      std::vector<int>* levels = nullptr) {
  PlacedScene placed(passes, scene);
  const World world = placed.world(lights);
  const bool glossy = settings.gather.glossy &&
                      std::ranges::any_of(scene.assets.materials, [](const Material& m) { return m.glossy(); });
  SurfacePass surfacePass(passes);
  PatchPass patchPass(passes, StageId::Patches);
  DirectLight direct(passes, mostDoubts);
  stats = {};
  FrameResults results;
  results.surfaces = surfacePass.run({world.gpu, world.view.camera, glossy, scene.normalMapped()});
  Patches patches([&] { return patchPass.run(results.surfaces, settings.multires); });
  // Without gloss as if it were indirect, which reads as irradiance, without albedo.
  SurfaceLighting& light = glossy ? results.direct : results.indirect;
  light = lightOf(direct, world, results.surfaces, patches, settings, stats);
  if (levels && light.fragments) {
    const int width = light.fragments->width(), height = light.fragments->height();
    std::vector<uint8_t> texels(size_t(width) * size_t(height));
    light.fragments->read(std::span(texels), GL_RED, GL_UNSIGNED_BYTE);
    levels->clear();
    for (int y = height - 1; y >= 0; --y)
      for (int x = 0; x < width; ++x) levels->push_back(int(texels[size_t(y * width + x)]) - 1);
  }
  return readBuffer(glossy ? Buffer::Direct : Buffer::Irradiance, results);
}

/// Two rooms, a lamp in one of them, with a wall without thickness between, wherever it stands in cells and however it
/// is turned: the other has less than `most` of the first one's light.
inline void expectDarkBesideLit(const Settings& settings, double most) {
  for (const float turn : {0.0f, 0.3f, 0.785f}) {
    HandScene scene;
    const uint32_t white = scene.material(vec3(0.7f));
    scene.box(vec3(-2, -1, -2), vec3(2, 1, 2), white, true);
    const vec3 along(std::sin(turn), 0, std::cos(turn)); // of the wall, through a point beside the middle
    scene.quad(vec3(0.07f, -1, 0) - 3.0f * along, vec3(0, 2, 0), 6.0f * along, white);
    scene.lamp({-1.2f, 0.2f, 0}, vec3(5));
    const auto meanOf = [&](float side) {
      scene.camera = cameraAt(vec3(side * 0.9f, 0, -side * 0.8f), vec3(side * 1.5f, -0.2f, side * 2), 1.7f);
      return meanLuminance(firstFrame(settings, scene.view()));
    };
    const double lit = meanOf(-1), dark = meanOf(1);
    std::printf("wall turned by %.2f: lit room %.2g W/m2, dark room %.2g W/m2\n", double(turn), lit, dark);
    EXPECT_GT(lit, 0.1);
    EXPECT_LT(dark, most * lit) << turn;
  }
}

} // namespace lambent::test

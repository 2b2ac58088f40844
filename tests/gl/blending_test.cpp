// Alpha blending: of surfaces behind one another each takes its share, for the eye and for light.
#include "engine/gpu_trace/gpu_rays.h"
#include "frames.h"
#include "gi/reference/traced_image.h"
#include "gi/vpl/smc.h"
#include "shaders/shared/coverage.h"
#include "tests/support/images.h"
#include "tests/support/reference.h"

namespace lambent::test::blending_test {

class BlendingTest : public GlTest {
 protected:
  static uint32_t blended(HandScene& scene, float alpha, const vec3& albedo = vec3(0)) {
    const uint32_t index = scene.material(albedo);
    scene.assets.materials[index].alphaMode = AlphaMode::Blend;
    scene.assets.materials[index].alpha = alpha;
    return index;
  }
  /// A wall that glows before black panes, of which all with one alpha are of one mesh; the camera sees nothing else.
  static void panes(HandScene& scene, std::span<const float> alphas) {
    scene.quad({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}, scene.material(vec3(0), vec3(1)));
    std::map<float, uint32_t> instances;
    float z = 0.05f;
    for (const float alpha : alphas) {
      const auto same = instances.find(alpha);
      if (same == instances.end())
        instances[alpha] = scene.quad({-4, -4, z}, {8, 0, 0}, {0, 8, 0}, blended(scene, alpha));
      else
        scene.instance(scene.instances[same->second].mesh, glm::translate(mat4(1), vec3(0, 0, z - 0.05f)));
      z += 0.05f;
    }
    scene.camera = cameraAt({0, 0, 3}, vec3(0), 1.0f, 96, 64);
  }
};

TEST_F(BlendingTest, EachPaneTakesItsShareOfWhatIsLeft) {
  const std::vector<std::vector<float>> rows{
      {0.25f}, {0.5f, 0.5f}, {0.5f, 0.5f, 0.5f},           {0.1f, 0.7f}, {0.1f}, {0.9f}, {1 / 255.0f}, {254 / 255.0f},
      {0.02f}, {0.0f, 0.3f}, std::vector<float>(40, 0.02f)};
  for (const std::vector<float>& alphas : rows) {
    HandScene scene;
    panes(scene, alphas);
    double left = 1;
    for (const float alpha : alphas) left *= 1 - double(shareCovered(alpha));
    Settings settings;
    settings.image.exposure = 1;
    Viewer viewer(settings);
    const Image image = nextFrame(viewer, scene.view(), Buffer::Beauty), depth = viewer.read(Buffer::Depth);
    std::vector<double> values;
    for (const vec3& p : image.pixels) values.push_back(double(p.x));
    const double mean = meanOf(values).mean;
    EXPECT_NEAR(mean, left, 0.01) << alphas.size() << " panes, the first of " << alphas[0];
    const auto scatter = [&](const Image& of) {
      double sum = 0;
      for (const vec3& p : of.pixels) sum += std::pow(double(p.x) - mean, 2) / double(of.pixels.size());
      return std::sqrt(sum);
    };
    EXPECT_LT(scatter(image), 5e-3) << "the pattern shows";

    // The reference has the same surface at each pixel of one sample, and others in the next.
    EmbreeQuery rays(scene.assets);
    const SceneView view = scene.view();
    rays.update(view);
    const LightSet lights = collectLights(view);
    const ReferenceInputs in{
        .rays = rays, .lights = lights, .camera = view.camera, .bounces = 0, .blended = &view, .mixes = true};
    constexpr uint32_t kSamples = 16;
    const Image truth = trace(in, kSamples, ReferenceBuffer::Beauty).mean;
    const double varies = std::sqrt(left * (1 - left));
    EXPECT_NEAR(meanLuminance(truth), left, 1e-4 + 4 * varies / std::sqrt(double(kSamples * truth.pixels.size())));
    EXPECT_NEAR(scatter(truth), varies / std::sqrt(double(kSamples)),
                1e-4 + 0.1 * varies / std::sqrt(double(kSamples)));
    std::vector<vec2> centres;
    for (size_t i = 0; i < truth.pixels.size(); ++i) centres.push_back(pixelCentre(view.camera, i));
    const std::vector<SurfaceHit> hits = surfacesAt(rays, view.camera, centres);
    int differing = 0;
    for (size_t i = 0; i < hits.size(); ++i)
      differing += std::abs(view.camera.position().z - hits[i].position.z - depth.pixels[i].x) > 1e-3f;
    EXPECT_LE(differing, int(hits.size() / 100)) << "but on the line where two triangles meet";
  }
}

/// What is beside a pane, or before it, stays as sharp as it was.
TEST_F(BlendingTest, MixesOnlyWherePanesAre) {
  HandScene scene;
  scene.quad({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}, scene.material(vec3(0), vec3(1)));
  scene.quad({-4, -4, 0.2f}, {4, 0, 0}, {0, 8, 0}, blended(scene, 0.5f));             // the left half
  scene.quad({-4, -4, 0.4f}, {8, 0, 0}, {0, 4, 0}, scene.material(vec3(0), vec3(5))); // the lower one, before it
  scene.camera = cameraAt({0, 0, 3}, vec3(0), 1.0f, 96, 64);
  Settings settings;
  settings.image.exposure = 1;
  const Image image = firstFrame(settings, scene.view(), Buffer::Beauty);
  double last = 0; // of the pane's last column
  for (int y = 0; y <= 28; ++y) last += double(image.at(47, y).x) / 29;
  EXPECT_NEAR(last, 0.5, 1e-3);
  for (const auto [x, y] : Pixels(image)) {
    const float is = image.at(x, y).x;
    if (y >= 33) {
      EXPECT_NEAR(is, 5, 1e-3f) << x << ' ' << y;
    } else if (y <= 30 && x >= 49) {
      EXPECT_NEAR(is, 1, 1e-3f) << x << ' ' << y;
    } else if (x <= 45) {
      EXPECT_NEAR(is, is > 2 ? 5 : 0.5f, 1e-3f) << x << ' ' << y;
    }
  }
}

/// Panes that glow before one another: what is behind them is there by its share, whichever of them a pixel shows.
TEST_F(BlendingTest, MixesByWhatAllPanesLetThrough) {
  HandScene scene;
  scene.quad({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}, scene.material(vec3(0), {0, 0, 1}));
  for (const auto& [z, glow] : {std::pair(0.2f, vec3(0, 1, 0)), std::pair(0.4f, vec3(1, 0, 0))}) {
    const uint32_t material = blended(scene, 0.5f);
    scene.assets.materials[material].emission = glow;
    scene.quad({-4, -4, z}, {8, 0, 0}, {0, 8, 0}, material);
  }
  scene.camera = cameraAt({0, 0, 3}, vec3(0), 1.0f, 96, 64);
  Settings settings;
  settings.image.exposure = 1;
  const Image image = firstFrame(settings, scene.view(), Buffer::Beauty);
  double squares = 0;
  vec3 mean(0);
  for (const vec3& p : image.pixels) {
    EXPECT_NEAR(p.z, 0.25f, 2e-3f);
    EXPECT_NEAR(p.x + p.y, 0.75f, 2e-3f);
    squares += std::pow(double(p.x) - 0.5, 2) / double(image.pixels.size());
    mean += p / float(image.pixels.size());
  }
  EXPECT_NEAR(mean.x, 0.5f, 0.01f);
  EXPECT_LT(std::sqrt(squares), 0.15) << "of two panes, each pixel shows one";
}

/// Panes in a room that is seen through its walls' hidden backs, before a sheet that is seen from behind: the one are
/// mixed, and what is before the other is as it was.
TEST_F(BlendingTest, HiddenBacksHideNoPanes) {
  for (const bool sheetFirst : {true, false}) {
    HandScene scene;
    uint32_t wall = 0, sheet = 0;
    const auto addWall = [&] { wall = scene.material(vec3(0)), scene.assets.materials[wall].backHidden = true; };
    if (!sheetFirst) addWall();
    sheet = scene.material(vec3(0));
    if (sheetFirst) addWall();
    scene.quad({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}, scene.material(vec3(0), vec3(1)));
    scene.quad({-4, -4, 0.2f}, {8, 0, 0}, {0, 8, 0}, blended(scene, 0.5f));
    scene.quad({-4, -4, 0.4f}, {0, 8, 0}, {8, 0, 0}, wall);  // its back to the camera
    scene.quad({-4, -4, 0.5f}, {0, 8, 0}, {4, 0, 0}, sheet); // so is that of the sheet, on the left
    scene.camera = cameraAt({0.01f, 0, 3}, {0.01f, 0, 0}, 1.0f, 64, 48);
    Settings settings;
    settings.image.exposure = 1;
    const Image image = firstFrame(settings, scene.view(), Buffer::Beauty);
    for (const auto [x, y] : Pixels(image))
      if (x < 30 || x > 33) {
        EXPECT_NEAR(image.at(x, y).x, x < 30 ? 0 : 0.5f, 1e-3f) << sheetFirst << ' ' << x << ' ' << y;
      }
  }
}

/// A pane that lies in its floor's own plane: whichever is drawn first, the pattern does not show.
TEST_F(BlendingTest, APaneInThePlaneOfAWallIsMixed) {
  HandScene scene;
  const uint32_t pane = blended(scene, 0.5f), wall = scene.material(vec3(0), vec3(1));
  for (const uint32_t material : {pane, wall}) scene.quad({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}, material);
  scene.camera = cameraAt({0, 0, 3}, vec3(0), 1.0f, 64, 48);
  Settings settings;
  settings.image.exposure = 1;
  for (const vec3& p : firstFrame(settings, scene.view(), Buffer::Beauty).pixels) EXPECT_NEAR(p.x, 0.5f, 1e-3f);
}

/// Faint panes before a bright sky: the image and its reference are exposed alike.
TEST_F(BlendingTest, ExposureTakesPanesForSurfacesAsTheReferenceDoes) {
  HandScene scene;
  scene.quad({-4, -4, 0}, {4, 0, 0}, {0, 8, 0}, scene.material(vec3(0), vec3(0.1f)));
  scene.quad({0, -4, 0}, {4, 0, 0}, {0, 8, 0}, blended(scene, 0.1f));
  scene.sky = Sky(vec3(10));
  scene.camera = cameraAt({0.01f, 0, 3}, {0.01f, 0, 0}, 1.0f, 64, 48);
  const Settings settings;
  Viewer viewer(settings);
  viewer.run(scene.view());
  const float truth = traceImage(scene.view(), settings, {.buffer = ReferenceBuffer::Beauty, .samples = 64}).exposure;
  EXPECT_NEAR(viewer.exposure() / truth, 1, 0.02);
}

/// A picture behind a pane keeps its edges.
TEST_F(BlendingTest, WhatIsBehindAPaneStaysSharp) {
  HandScene scene;
  scene.quad({-4, -4, 0}, {4, 0, 0}, {0, 8, 0}, scene.material(vec3(0), vec3(1)));
  scene.quad({0, -4, 0}, {4, 0, 0}, {0, 8, 0}, scene.material(vec3(0), vec3(0)));
  scene.quad({-4, -4, 0.2f}, {8, 0, 0}, {0, 8, 0}, blended(scene, 0.3f));
  scene.camera = cameraAt({0, 0, 3}, vec3(0), 1.0f, 96, 64);
  Settings settings;
  settings.image.exposure = 1;
  const Image image = firstFrame(settings, scene.view(), Buffer::Beauty);
  double before = 0, after = 0;
  for (int y = 0; y < 64; ++y) before += double(image.at(47, y).x) / 64, after += double(image.at(48, y).x) / 64;
  std::printf("beside the edge: %.3f and %.3f of 0.7 and 0\n", before, after);
  EXPECT_GT(before - after, 0.6 * 0.7);
}

TEST_F(BlendingTest, LightPassesPanesByTheirShare) {
  const auto lit = [](std::optional<float> alpha, bool sun, bool reference) {
    HandScene scene;
    scene.quad({-4, 0, -4}, {0, 0, 8}, {8, 0, 0}, scene.material(vec3(0.5f)));
    if (alpha) scene.quad({-4, 1, -4}, {0, 0, 8}, {8, 0, 0}, blended(scene, *alpha));
    if (sun)
      scene.lights.push_back({.type = LightType::Directional, .direction = {0, -1, 0}, .intensity = vec3(3)});
    else
      scene.lamp({0, 2, 0}, vec3(10));
    scene.camera = cameraAt({0, 0.9f, 2}, {0, 0, 0}, 0.9f, 96, 64); // below the pane
    const SceneView view = scene.view();
    if (!reference) {
      Settings settings;
      settings.image.exposure = 1;
      return firstFrame(settings, view, Buffer::Direct);
    }
    EmbreeQuery rays(scene.assets);
    rays.update(view);
    const LightSet lights = collectLights(view);
    const ReferenceInputs in{
        .rays = rays, .lights = lights, .camera = view.camera, .bounces = 0, .blended = alpha ? &view : nullptr};
    return trace(in, 64, ReferenceBuffer::Direct).mean;
  };
  for (const bool sun : {true, false})
    for (const bool reference : {true, false}) {
      const Image open = lit({}, sun, reference);
      for (const float alpha : {0.3f, 0.75f}) {
        const Image shaded = lit(alpha, sun, reference);
        const std::string what = std::string(sun ? "sun" : "lamp") + (reference ? ", reference" : ", direct light");
        EXPECT_NEAR(meanLuminance(shaded) / meanLuminance(open), 1 - alpha, 0.02) << what;
        int off = 0; // each sample has a chance of its own, and direct light all of what passes
        const float most = reference ? 0.3f : 0.01f;
        for (size_t i = 0; i < open.pixels.size(); ++i)
          off += std::abs(shaded.pixels[i].x - (1 - alpha) * open.pixels[i].x) > most * open.pixels[i].x;
        EXPECT_LE(off, int(open.pixels.size() / 100)) << what;
      }
    }
}

/// Light on a floor that is added to a scene.
double floorLight(HandScene& scene, const Settings& settings, Buffer buffer) {
  scene.quad({-4, 0, -4}, {0, 0, 8}, {8, 0, 0}, scene.material(vec3(0.5f)));
  scene.camera = cameraAt({0, 0.9f, 2}, {0, 0, 0}, 0.9f, 48, 32); // below the panes
  return meanLuminance(firstFrame(settings, scene.view(), buffer));
}

TEST_F(BlendingTest, LampsThatGlowShineThroughPanesAndAsPanes) {
  enum class Lamp { BehindAPane, Pane, Masked };
  const auto lit = [&](std::optional<Lamp> what, SoftLightBy by, float alpha) {
    HandScene scene;
    const uint32_t glow = scene.material(vec3(0), vec3(4));
    Material& m = scene.assets.materials[glow];
    m.doubleSided = true;
    if (what == Lamp::Pane) m.alphaMode = AlphaMode::Blend, m.alpha = alpha;
    if (what == Lamp::Masked) { // bars, of which the texture has as many as are cut out
      m.alphaMode = AlphaMode::Mask;
      std::vector<u8vec4> texels;
      for (int i = 0; i < 16 * 16; ++i) texels.push_back({255, 255, 255, i % 8 == 3 || i % 8 == 4 ? 255 : 0});
      m.baseColorTexture = scene.texture(16, texels);
      m.baseColorTexture.nearest = true;
    }
    scene.quad({-1, 2, -1}, {0, 0, 2}, {2, 0, 0}, glow);
    if (what == Lamp::BehindAPane) scene.quad({-4, 1, -4}, {0, 0, 8}, {8, 0, 0}, blended(scene, alpha));
    Settings settings;
    settings.direct.soft = by;
    settings.direct.samples = 16;
    return floorLight(scene, settings, Buffer::Direct);
  };
  for (const SoftLightBy by : {SoftLightBy::Rays, SoftLightBy::Maps}) {
    const double open = lit({}, by, 0);
    const std::string how = by == SoftLightBy::Rays ? "by rays" : "by maps";
    for (const float alpha : {0.3f, 0.75f, 0.9f}) {
      EXPECT_NEAR(lit(Lamp::BehindAPane, by, alpha) / open, 1 - alpha, 0.02) << how << ", behind a pane of " << alpha;
      EXPECT_NEAR(lit(Lamp::Pane, by, alpha) / open, alpha, 0.02) << how << ", a pane of " << alpha;
    }
    EXPECT_NEAR(lit(Lamp::Masked, by, 0) / open, 0.25, 0.02) << how << ", bars";
  }
  // The truth, which knows them by rays that meet them and by connections.
  HandScene scene;
  scene.quad({-4, 0, -4}, {0, 0, 8}, {8, 0, 0}, scene.material(vec3(0.5f)));
  const uint32_t pane = blended(scene, 0.5f);
  scene.assets.materials[pane].emission = vec3(4);
  scene.assets.materials[pane].doubleSided = true;
  scene.quad({-1, 2, -1}, {0, 0, 2}, {2, 0, 0}, pane);
  scene.camera = cameraAt({0, 0.9f, 2}, {0, 0, 0}, 0.9f, 48, 32);
  const auto truth = [&] {
    const SceneView view = scene.view();
    EmbreeQuery rays(scene.assets);
    rays.update(view);
    const LightSet lights = collectLights(view);
    return meanLuminance(trace({.rays = rays, .lights = lights, .camera = view.camera, .bounces = 0, .blended = &view},
                               64, ReferenceBuffer::Direct)
                             .mean);
  };
  const double half = truth();
  scene.assets.materials[pane].alphaMode = AlphaMode::Opaque;
  EXPECT_NEAR(half / truth(), 0.5, 0.01);
}

/// What is seen of a floor beside a decal is seen by the holes that light comes by.
TEST_F(BlendingTest, DecalsDoNotShadeWhatTheyLieOn) {
  for (const int kind : {0, 1, 2}) {
    const auto lit = [&](bool decal) {
      HandScene scene;
      scene.quad({-4, 0, -4}, {0, 0, 8}, {8, 0, 0}, scene.material(vec3(0.5f)));
      if (decal) scene.quad({-3, 0.001f, -3}, {0, 0, 6}, {6, 0, 0}, blended(scene, 0.6f, vec3(0.5f)));
      if (kind == 0)
        scene.lights.push_back({.type = LightType::Directional, .direction = {0.3f, -1, 0}, .intensity = vec3(3)});
      else if (kind == 1)
        scene.lamp({0, 2, 0}, vec3(10));
      else
        scene.quad({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}, scene.material(vec3(0), vec3(4)));
      scene.camera = cameraAt({0, 1.5f, 1}, {0, 0, 0}, 0.9f, 64, 48);
      return meanLuminance(firstFrame(Settings(), scene.view(), Buffer::Direct));
    };
    EXPECT_NEAR(lit(true) / lit(false), 1, 0.01) << kind;
  }
}

/// Where a texture of alpha is minified, pixels and rays meet other surfaces: light is of those that pixels show.
TEST_F(BlendingTest, SoftLightIsOfTheSurfaceThatAPixelShows) {
  HandScene scene;
  const uint32_t pane = blended(scene, 1, vec3(1));
  std::vector<u8vec4> texels;
  for (uint32_t i = 0; i < 256 * 256; ++i) texels.push_back({255, 255, 255, coverageHash(i, 1, 2) & 255u});
  scene.assets.materials[pane].baseColorTexture = scene.texture(256, texels);
  scene.assets.materials[pane].baseColorTexture.nearest = false;
  scene.quad({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}, scene.material(vec3(0)));
  scene.quad({-4, -4, 0.5f}, {8, 0, 0}, {0, 8, 0}, pane); // its back is lit, through its holes
  scene.quad({-0.2f, -0.2f, 0.45f}, {0, 0.4f, 0}, {0.4f, 0, 0},
             scene.material(vec3(0), vec3(40))); // which faces the wall
  scene.camera = cameraAt({0, 0, 3}, vec3(0), 1.0f, 64, 64);
  EXPECT_LT(meanLuminance(firstFrame(Settings(), scene.view(), Buffer::Direct)), 1e-4) << "nothing lit is white";
}

/// A window that stands still, whose shadow rays are switched off and on.
TEST_F(BlendingTest, MapsAreDrawnAnewWhereTheyAreReadOtherwise) {
  HandScene scene;
  scene.quad({-4, 0, -4}, {0, 0, 8}, {8, 0, 0}, scene.material(vec3(0.5f)));
  scene.quad({-4, 1, -4}, {0, 0, 8}, {8, 0, 0}, blended(scene, 0.9f));
  scene.lamp({0, 2, 0}, vec3(10));
  scene.camera = cameraAt({0, 0.9f, 2}, {0, 0, 0}, 0.9f, 48, 32);
  Settings settings;
  Viewer viewer(settings);
  double light[3];
  for (int i = 0; i < 3; ++i) {
    viewer.settings().shadow.rays = i != 1;
    const bool first = i == 0;
    light[i] = meanLuminance(nextFrame(viewer, scene.view(first ? SceneChanges() : kStill), Buffer::Direct));
  }
  settings.shadow.rays = false;
  const double fresh = meanLuminance(firstFrame(settings, scene.view(), Buffer::Direct));
  EXPECT_NEAR(light[1] / fresh, 1, 0.01);
  EXPECT_NEAR(light[2] / light[0], 1, 0.01);
}

/// Rays meet a pane by its alpha: who tells areas by how near the next one is counts as much of it.
TEST_F(BlendingTest, BouncesOfPanesAreOfTheirShare) {
  const auto bounced = [&](float alpha, const std::function<void(Settings&)>& change) {
    HandScene scene;
    for (int i = 0; i < 4; ++i)
      scene.quad({-4, 1.2f + 0.2f * float(i), -4}, {8, 0, 0}, {0, 0, 8}, blended(scene, alpha, vec3(1)));
    scene.lamp({0, 1, 0}, vec3(10));
    Settings settings;
    settings.smc.bounces = 1;
    settings.smc.vpls = 1024;
    change(settings);
    return floorLight(scene, settings, Buffer::Indirect);
  };
  const double cells = bounced(0.15f, [](Settings&) {});
  EXPECT_NEAR(bounced(0.15f, [](Settings& s) { s.smc.density = DensityEstimator::Knn; }) / cells, 1, 0.25);
  EXPECT_NEAR(bounced(0.15f, [](Settings& s) { applyTechnique(s, "mir"); }) / cells, 1, 0.25);
}

TEST_F(BlendingTest, RaysPassByChance) {
  HandScene scene;
  std::vector<u8vec4> texels;
  for (int i = 0; i < 16; ++i) texels.push_back({255, 255, 255, uint8_t(17 * i)});
  const uint32_t material = blended(scene, 0.8f);
  scene.assets.materials[material].baseColorTexture = scene.texture(4, texels);
  scene.assets.materials[material].baseColorTexture.nearest = true;
  const uint32_t first = scene.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, material);
  scene.instance(scene.instances[first].mesh, glm::translate(mat4(1), vec3(0, -1, 0)));
  EmbreeQuery embree(scene.assets);
  embree.update(scene.view());
  GpuRays gpu(programs, scene.assets);
  gpu.update(scene.view());
  double left = 0;
  for (const u8vec4& t : texels) left += std::pow(1 - 0.8 * double(t.w) / 255, 2) / double(texels.size());
  constexpr int kRays = 40000;
  for (const bool own : {false, true}) { // by the rays' bits, and by keys
    std::vector<Ray> rays;
    for (uint32_t i = 0; i < kRays; ++i) {
      Rng rng(5, Stream::Test, i);
      const vec2 at = 2.0f * rng.next2() - 1.0f;
      rays.push_back({{at.x, 1, at.y}, {0, -1, 0}, kInfinity, own ? rng.nextUint() >> 1 | 1 : 0});
    }
    const Answers byEmbree(embree, rays), byGpu(gpu, rays);
    for (const bool near : {false, true}) { // decals that rays begin on are passed
      std::vector<Ray> close = rays;
      for (Ray& r : close) r.origin.y = near ? 1e-4f : 1e-2f;
      double byBoth = 0;
      for (const u8vec4& t : texels)
        byBoth += std::pow(1 - double(shareCovered(0.8f * float(t.w) / 255)), near ? 1 : 2) / double(texels.size());
      EXPECT_NEAR(double(Answers(embree, close).free()) / kRays, byBoth, 0.01) << near;
      EXPECT_NEAR(double(Answers(gpu, close).free()) / kRays, byBoth, 0.01) << near;
    }
    const double sigma = std::sqrt(left * (1 - left) / kRays);
    EXPECT_NEAR(double(byEmbree.free()) / kRays, left, 4 * sigma) << own;
    EXPECT_NEAR(double(byGpu.free()) / kRays, left, 4 * sigma) << own;
    int differing = 0;
    for (size_t i = 0; i < rays.size(); ++i)
      differing += byEmbree.hits[i].valid() != byGpu.hits[i].valid() || byEmbree.blocked[i] != byGpu.blocked[i];
    EXPECT_LE(differing, 20) << "beside edges of texels";
    std::vector<float> open(rays.size());
    embree.transmittance(rays, open);
    double passes = 0; // exactly, of each
    for (const float share : open) passes += double(share) / double(rays.size());
    EXPECT_NEAR(passes, left, 0.005);
    for (size_t i = 0; i < rays.size(); ++i) {
      const vec3& at = rays[i].origin;
      const int column = std::clamp(int((at.z + 1) * 2), 0, 3), row = std::clamp(int((at.x + 1) * 2), 0, 3);
      const float alpha = 0.8f * float(texels[size_t(4 * row + column)].w) / 255;
      if (std::abs(glm::fract(2 * at.x) - 0.5f) < 0.49f && std::abs(glm::fract(2 * at.z) - 0.5f) < 0.49f) {
        EXPECT_NEAR(open[i], std::pow(1 - shareCovered(alpha), 2.0f), 1e-4f) << i;
      }
    }
    int otherwise = 0; // a ray and the segment along it meet the same
    for (size_t i = 0; i < rays.size(); ++i) otherwise += byEmbree.hits[i].valid() != bool(byEmbree.blocked[i]);
    EXPECT_EQ(otherwise, 0);
  }
}

} // namespace lambent::test::blending_test

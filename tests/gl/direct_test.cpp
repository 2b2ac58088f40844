// Direct light against closed forms, and shadow maps that are drawn only when they must be.
#include "frames.h"

namespace lambent::test::direct_test {

class DirectTest : public GlTest {
 protected:
  /// Direct irradiance of the picture, row 0 at the top; with emissive surfaces if there are some.
  Image irradianceOf(const HandScene& scene, const LightSet& emitters = {}) {
    Settings all;
    all.shadow = settings;
    all.direct.soft = SoftLightBy::Maps;
    all.effects[EffectId::Emissive] = emitters.emitters.empty() ? EffectMode::Off : EffectMode::On;
    all.effects[EffectId::SoftShadows] = EffectMode::On;
    LightSet lights = emitters;
    lights.sky = scene.sky;
    return directOf(passes, scene, lights, all, stats, mostDoubts);
  }

  /// The passes need sizes; 0 (from the picture's width) is resolved by the frame.
  ShadowSettings settings{.sunResolution = 2048, .pointResolution = 512, .spotResolution = 1024};
  uint32_t mostDoubts = ShadowRayPass::kMost;
  FrameStats stats; // of the last image
};

constexpr float kShare = 1e-3f; // tolerance of the closed forms

/// Every pixel of the floor within 0.1 % of expected(position), or a hundred-thousandth of the largest where it is
/// dark.
void expectFloor(const Floor& floor, const Image& image, const std::function<float(const vec3&)>& expected) {
  float largest = 0;
  for (const auto [x, y] : Pixels(image)) largest = std::max(largest, expected(floor.at(x, y)));
  ASSERT_GT(largest, 0);
  for (const auto [x, y] : Pixels(image)) {
    const float wanted = expected(floor.at(x, y));
    ASSERT_NEAR(image.at(x, y).y, wanted, kShare * wanted + 1e-5f * largest) << "pixel " << x << ' ' << y;
  }
}

TEST_F(DirectTest, PointLightOnAPlane) {
  Floor floor;
  floor.scene.lamp({0.5f, 1.5f, 0.3f}, vec3(10));
  expectFloor(floor, irradianceOf(floor.scene), [](const vec3& p) {
    const vec3 d = vec3(0.5f, 1.5f, 0.3f) - p;
    return 10 * d.y / std::pow(glm::dot(d, d), 1.5f);
  });
}

TEST_F(DirectTest, PointLightWithRange) {
  Floor floor;
  floor.scene.lights.push_back({.type = LightType::Point, .position = {0, 1, 0}, .intensity = vec3(10), .range = 2});
  expectFloor(floor, irradianceOf(floor.scene), [](const vec3& p) {
    const vec3 d = vec3(0, 1, 0) - p;
    const float r2 = glm::dot(d, d);
    return 10 * d.y / std::pow(r2, 1.5f) * glm::clamp(1 - r2 * r2 / 16, 0.0f, 1.0f);
  });
}

TEST_F(DirectTest, SpotLightOnAPlane) {
  for (const float outer : {0.6f, 1.4f}) { // a 2D map, and one too wide for it, which gets a cube
    Floor floor;
    const vec3 position(0.4f, 2, -0.2f), direction = glm::normalize(vec3(0.2f, -1, 0.1f));
    floor.scene.lights.push_back({.type = LightType::Spot,
                                  .position = position,
                                  .direction = direction,
                                  .intensity = vec3(7),
                                  .innerConeCos = std::cos(0.3f),
                                  .outerConeCos = std::cos(outer)});
    expectFloor(floor, irradianceOf(floor.scene), [&](const vec3& p) {
      const vec3 d = position - p;
      const float scale = 1 / std::max(0.001f, std::cos(0.3f) - std::cos(outer));
      const float cone = glm::clamp((glm::dot(direction, -glm::normalize(d)) - std::cos(outer)) * scale, 0.0f, 1.0f);
      return 7 * d.y / std::pow(glm::dot(d, d), 1.5f) * cone * cone;
    });
  }
}

TEST_F(DirectTest, DirectionalLightAndSkyOnAPlane) {
  Floor floor;
  const vec3 direction = glm::normalize(vec3(0.5f, -1, 0.2f));
  floor.scene.lights.push_back({.type = LightType::Directional, .direction = direction, .intensity = vec3(3)});
  expectFloor(floor, irradianceOf(floor.scene), [&](const vec3&) { return 3 * -direction.y; });

  Floor open;
  open.scene.sky = vec3(2);
  expectFloor(open, irradianceOf(open.scene), [](const vec3&) { return 2 * kPi; });
}

TEST_F(DirectTest, MoreLightsThanABlockHolds) {
  Floor floor;
  settings.pointResolution = 16;
  for (int i = 0; i < 150; ++i) floor.scene.lamp({0, 2, 0}, vec3(0.1f));
  const Image image = irradianceOf(floor.scene);
  const vec3 d = vec3(0, 2, 0) - floor.at(32, 24);
  const float wanted = 15 * d.y / std::pow(glm::dot(d, d), 1.5f);
  EXPECT_NEAR(image.at(32, 24).x, wanted, kShare * wanted);
}

TEST_F(DirectTest, EmissiveSampleOnAPlane) {
  Floor floor;
  settings.emitterSamples = 1;
  const LightSet lamp = emitterAt({0, 1.2f, 0}, {0, -1, 0}, vec3(5), 0.3f);
  const EmitterPatch sample = emitterPatches(lamp, 1).at(0);
  EXPECT_NEAR(sample.area, 0.3f, 1e-6f);
  expectFloor(floor, irradianceOf(floor.scene, lamp), [&](const vec3& p) {
    const vec3 d = sample.position - p;
    const float r2 = glm::dot(d, d), cosine = d.y / std::sqrt(r2);
    return 5 * 0.3f * cosine * cosine / (r2 + 0.3f / kPi);
  });
}

/// More than a block of them, and more than maps of one array in a row: each counts once.
TEST_F(DirectTest, ManyEmissiveSamples) {
  Floor floor;
  const LightSet lamp = emitterAt({0, 1.2f, 0}, {0, -1, 0}, vec3(5), 0.3f);
  settings.emitterResolution = 16;
  settings.emitterSamples = 64;
  const Image few = irradianceOf(floor.scene, lamp);
  settings.emitterSamples = 512;
  const Image many = irradianceOf(floor.scene, lamp);
  EXPECT_GT(few.at(32, 24).x, 0.1f);
  for (const glm::ivec2 p : {glm::ivec2(32, 24), glm::ivec2(5, 5), glm::ivec2(60, 40)})
    EXPECT_NEAR(many.at(p.x, p.y).x, few.at(p.x, p.y).x, 0.01f * few.at(p.x, p.y).x);
}

TEST_F(DirectTest, BlockersCastShadowsOfEveryKind) {
  const vec3 above(0, 2, 0), down(0, -1, 0);
  std::vector<LightView> lights = {
      {.type = LightType::Point, .position = above, .intensity = vec3(10)},
      {.type = LightType::Spot, .position = above, .direction = down, .intensity = vec3(10), .outerConeCos = 0.6f},
      {.type = LightType::Directional, .direction = down, .intensity = vec3(1)},
  };
  for (const LightView& light : lights) {
    Floor floor;
    floor.scene.lights.push_back(light);
    const Image open = irradianceOf(floor.scene);
    floor.scene.quad(vec3(-0.3f, 1, 0.3f), vec3(0.6f, 0, 0), vec3(0, 0, -0.6f), 0);
    floor.scene.camera = cameraAt(vec3(0, 0.9f, 0), vec3(0), 1.0f); // below the blocker
    const Image shadowed = irradianceOf(floor.scene);
    EXPECT_EQ(shadowed.at(32, 24).x, 0) << "kind " << int(light.type);
    // A blocker halfway throws a shadow twice its size, a directional light one of its own size.
    const float edge = light.type == LightType::Directional ? 0.3f : 0.6f;
    int lit = 0, dark = 0, wrong = 0;
    for (const auto [x, y] : Pixels(64, 48)) {
      const vec3 p = floor.at(x, y);
      const float outside = std::max(std::abs(p.x), std::abs(p.z)) - edge;
      const bool isLit = shadowed.at(x, y).x > 0;
      (isLit ? lit : dark)++;
      if (std::abs(outside) > 1e-3f && isLit != (outside > 0)) ++wrong;
    }
    EXPECT_EQ(wrong, 0) << "kind " << int(light.type);
    EXPECT_GT(dark, 100);
    EXPECT_GT(open.at(32, 24).x, 0);
  }
}

/// A square over the floor, seen from below it, under one light of each kind, at odd places so that no texel ends where
/// its shadow does.
class DoubtTest : public DirectTest {
 protected:
  struct Case {
    const char* name;
    std::vector<LightView> lights;
    LightSet lamp;
    vec3 from{0.13f, 2.03f, 0.07f}; // the light, or where it comes from
    bool parallel = false;
  };
  static constexpr float kHalf = 0.31f, kHeight = 0.97f;

  std::vector<Case> cases() {
    const vec3 at = Case{}.from, down(0, -1, 0), along = glm::normalize(vec3(0.11f, -1, 0.23f));
    return {
        {"point", {{.type = LightType::Point, .position = at, .intensity = vec3(10)}}, {}},
        {"spot",
         {{.type = LightType::Spot, .position = at, .direction = down, .intensity = vec3(10), .outerConeCos = 0.4f}},
         {}},
        {"sun", {{.type = LightType::Directional, .direction = along, .intensity = vec3(1)}}, {}, -along, true},
        {"emitter", {}, emitterAt(at, down, vec3(5), 1e-4f)}};
  }
  Image picture(const Case& c) {
    floor_ = std::make_unique<Floor>();
    floor_->scene.lights = c.lights;
    floor_->scene.quad(vec3(-kHalf, kHeight, kHalf), vec3(2 * kHalf, 0, 0), vec3(0, 0, -2 * kHalf), 0);
    floor_->scene.camera = cameraAt(vec3(0, 0.9f, 0), vec3(0), 1.0f);
    return irradianceOf(floor_->scene, c.lamp);
  }
  /// Pixels of the last picture that are lit and should not be, or the other way; those within a millimetre of the edge
  /// do not count.
  int wrong(const Case& c, const Image& image) const {
    int count = 0;
    for (const auto [x, y] : Pixels(64, 48)) {
      const vec3 p = floor_->at(x, y), d = c.parallel ? c.from : c.from - p;
      const vec3 met = p + d * (kHeight / d.y);
      const float outside = std::max(std::abs(met.x), std::abs(met.z)) - kHalf;
      if (std::abs(outside) > 1e-3f && (image.at(x, y).x > 0) != (outside > 0)) ++count;
    }
    return count;
  }

  std::unique_ptr<Floor> floor_; // of the last picture
};

TEST_F(DoubtTest, RaysDecideAtTheEdgesOfShadows) {
  settings.sunResolution = settings.pointResolution = settings.spotResolution = settings.emitterResolution = 128;
  settings.emitterSamples = 1;
  for (const Case& c : cases()) {
    settings.rays = false;
    EXPECT_GT(wrong(c, picture(c)), 20) << c.name;
    EXPECT_EQ(stats.raysShadows.occlusion, 0u);
    settings.rays = true;
    EXPECT_EQ(wrong(c, picture(c)), 0) << c.name;
    EXPECT_GT(stats.raysShadows.occlusion, 40u) << c.name;
    EXPECT_LT(stats.raysShadows.occlusion, 64u * 48u / 3) << c.name; // only there
  }
}

/// A map all around a lamp that stands for the moon has texels larger than all that it shines on.
TEST_F(DoubtTest, LampsFarOffThrowShadows) {
  settings.pointResolution = 160;
  settings.spotResolution = 320;
  for (const float far : {60.0f, 3000.0f, 1e5f})
    for (Case c : cases()) {
      if (c.lights.empty() || c.parallel) continue;
      SCOPED_TRACE(testing::Message() << c.name << " at " << far << " m");
      c.from = far * glm::normalize(vec3(0.13f, 1, 0.07f));
      c.lights[0].position = c.from;
      c.lights[0].intensity = vec3(far * far);
      c.lights[0].direction = glm::normalize(vec3(0.1f, -1, 0)); // not at what is seen
      c.lights[0].innerConeCos = 0.9f;
      settings.rays = false;
      Image image = picture(c);
      EXPECT_LT(wrong(c, image), far > 1e4f ? 350 : 100) << "texels at the edge";
      EXPECT_EQ(image.at(32, 24).x, 0);
      EXPECT_NEAR(image.at(0, 0).x, glm::normalize(c.from).y, 0.05f);
      settings.rays = true;
      image = picture(c);
      EXPECT_EQ(wrong(c, image), 0);
      EXPECT_LT(stats.raysShadows.occlusion, 64u * 48u / 3) << "at edges only";
    }
}

TEST_F(DoubtTest, MoreDoubtsThanTheListHolds) {
  Case c = cases()[0];
  settings.pointResolution = 16;
  c.lights.resize(150, c.lights[0]);
  for (const uint32_t most : {ShadowRayPass::kMost, 3000u}) { // it may grow; the picture is taken in parts
    mostDoubts = most;
    const Image image = picture(c);
    EXPECT_GT(stats.raysShadows.occlusion, 1u << 14);
    EXPECT_EQ(wrong(c, image), 0);
    for (const auto [x, y] : Pixels(64, 48)) {
      if (image.at(x, y).x <= 0) continue;
      const vec3 d = c.from - floor_->at(x, y);
      const float wanted = 1500 * d.y / std::pow(glm::dot(d, d), 1.5f);
      ASSERT_NEAR(image.at(x, y).x, wanted, kShare * wanted) << "each light once: " << x << ' ' << y;
    }
  }
}

/// A room turned so that no wall is along an axis, with a block in it: coarse maps of a lamp, a spot and a sample, of
/// whose faces and texels every kind comes up, give what a ray for every pixel gives.
TEST_F(DirectTest, InATurnedRoomEveryPixelIsAsByRays) {
  const mat4 turned = glm::rotate(glm::rotate(mat4(1), 0.5f, vec3(0, 1, 0)), 0.35f, vec3(1, 0, 0));
  settings.pointResolution = settings.spotResolution = settings.emitterResolution = 64;
  settings.emitterSamples = 1;
  const vec3 at = vec3(turned * vec4(0.31f, 0.43f, 0.27f, 1)), down = glm::normalize(vec3(-0.7f, -0.6f, -0.4f));
  for (const char* kind : {"point", "spot", "emitter"}) {
    Room room;
    for (const vec3& c :
         {vec3(-0.1f, 0.2f, 0.1f), vec3(0.6f, 0.45f, 0.3f), vec3(0.3f, 0.7f, 0.6f), vec3(0.35f, 0.35f, -0.2f)})
      room.scene.box(c - 0.08f, c + 0.08f, 0, false); // around the lamp
    room.scene.turn(turned);
    LightSet lamp;
    LightView light{.type = LightType::Point, .position = at, .intensity = vec3(10)};
    if (kind == std::string("spot"))
      light = {.type = LightType::Spot, .position = at, .direction = down, .intensity = vec3(10), .outerConeCos = 0.5f};
    if (kind == std::string("emitter"))
      lamp = emitterAt(at, down, vec3(5), 1e-4f);
    else
      room.scene.lights = {light};
    EmbreeQuery rays(room.scene.assets);
    rays.update(room.scene.view(), true);
    int wrong = 0, lit = 0, dark = 0;
    uint64_t asked = 0;
    for (const vec3& target :
         {vec3(-1, -0.6f, -0.8f), vec3(1, 0.5f, 0.7f), vec3(-0.8f, 0.6f, 0.9f), vec3(0.7f, -0.8f, -1)}) {
      room.scene.camera = cameraAt(vec3(turned * vec4(0.1f, 0.1f, 0.2f, 1)), target, 1.4f);
      const Image image = irradianceOf(room.scene, lamp);
      asked += stats.raysShadows.occlusion;
      for (const auto [x, y] : Pixels(64, 48)) {
        const CameraRay ray = pixelRay(room.scene.camera, x, y);
        const SurfaceHit h = rays.closest(Ray{ray.origin, ray.direction});
        ASSERT_TRUE(h.valid());
        const vec3 towards = at - h.position, unit = glm::normalize(towards);
        if (std::abs(glm::dot(unit, h.normal)) < 0.02f) continue; // as good as along the surface
        float shines = glm::dot(unit, h.normal);
        if (kind == std::string("spot")) shines = glm::min(shines, glm::dot(-unit, down) - 0.52f);
        if (kind == std::string("emitter")) shines = glm::min(shines, glm::dot(-unit, down) - 0.02f);
        const vec3 start = offsetPoint(h.position, h.normal, 1e-4f);
        const bool expected = shines > 0 && !rays.occluded(segment(start, at));
        if (std::abs(shines) < 0.04f) continue;
        (expected ? lit : dark)++;
        wrong += expected != (image.at(x, y).y > 0);
      }
    }
    EXPECT_LE(wrong, 8) << kind;     // of 12 288: edges that the rasteriser puts elsewhere
    EXPECT_LT(asked, 1300u) << kind; // as many as edges need: 783, 698 and 924
    EXPECT_GT(lit, 500) << kind;
    EXPECT_GT(dark, 300) << kind;
  }
}

/// Under the open sky its shadows stay soft: no rays.
TEST_F(DirectTest, RaysAreNotAskedWhereTheSkyIsSeen) {
  Floor floor;
  floor.scene.sky = vec3(1);
  floor.scene.quad(vec3(-0.5f, 0.5f, 0.5f), vec3(1, 0, 0), vec3(0, 0, -1), 0);
  irradianceOf(floor.scene);
  EXPECT_EQ(stats.raysShadows.occlusion, 0u);
}

/// Walls, floor and ceiling are meshes of their own, without thickness: nothing of the sky may come in at their joints,
/// whichever way they are turned.
TEST_F(DirectTest, AClosedRoomUnderTheSkyIsBlack) {
  for (const float angle : {0.0f, 0.3f, 0.8f}) {
    Room room;
    room.scene.sky = vec3(1);
    const mat4 turned = glm::rotate(glm::rotate(mat4(1), angle, vec3(0, 1, 0)), 0.7f * angle, vec3(1, 0, 0));
    room.scene.turn(turned);
    room.scene.camera = cameraAt(vec3(0.3f, 0.1f, 0.2f), vec3(-0.4f, -0.9f, -0.6f), 1.5f);
    const Image image = irradianceOf(room.scene);
    float most = 0;
    for (const vec3& p : image.pixels) most = std::max(most, maxComponent(p));
    EXPECT_LT(most, 1e-4f) << "turned by " << angle;
    settings.rays = false;
    const Image leaking = irradianceOf(room.scene);
    EXPECT_GT(std::count_if(leaking.pixels.begin(), leaking.pixels.end(), [](const vec3& p) { return p.x > 0.01f; }),
              10)
        << "nothing to keep out";
    settings.rays = true;
  }
}

TEST(SunFit, LeavesOutWhatIsFarOff) {
  std::vector<vec3> places;
  for (int i = 0; i < 1000; ++i) places.push_back(vec3(i % 10, i / 10 % 10, i / 100) * 0.1f);
  EXPECT_EQ(withoutOutliers(places).size(), 1000u) << "a box full of places is cut nowhere";
  for (int i = 0; i < 20; ++i) places.push_back(vec3(0.5f, 0.5f, 50 + i));
  places.push_back(vec3(-300, 0.5f, 0.5f));
  const std::vector<vec3> rest = withoutOutliers(places);
  EXPECT_EQ(rest.size(), 1000u);
  for (const vec3& p : rest) EXPECT_LT(glm::length(p), 2);
  for (int i = 0; i < 100; ++i) places.push_back(vec3(0.5f, 0.5f, 30 + 0.1f * float(i)));
  const std::vector<vec3> kept = withoutOutliers(places);
  EXPECT_GT(std::count_if(kept.begin(), kept.end(), [](const vec3& p) { return p.z >= 30 && p.z < 40; }), 90)
      << "a tenth is no outlier";
}

TEST_F(DirectTest, MapsAreDrawnOnlyWhenTheyMust) {
  Room room;
  room.scene.lights.push_back({.type = LightType::Directional, .direction = {0, -1, 0}});
  room.scene.lights.push_back({.type = LightType::Point, .position = {0, 0.5f, 0.5f}});
  SceneView view = room.scene.view();
  GpuScene gpu(passes, room.scene.assets);
  gpu.place(view.instances);
  LightShadowPass pass(passes);
  Aabb receivers{vec3(-0.2f), vec3(0.2f)};
  std::vector<Aabb> moved;
  const auto draws = [&](bool geometryChanged) {
    pass.run({gpu, room.scene.lights, false, vec3(0), receivers, receivers, view.boundsWorld, geometryChanged, moved,
              settings});
    return pass.mapsDrawn();
  };
  EXPECT_EQ(draws(true), 2u) << "first frame";
  EXPECT_EQ(draws(false), 0u) << "nothing changed";
  receivers = {vec3(-0.21f), vec3(0.19f)};
  EXPECT_EQ(draws(false), 0u) << "receivers still inside the fit";
  receivers = {vec3(-0.8f), vec3(0.8f)};
  EXPECT_EQ(draws(false), 1u) << "receivers outgrew the sun's map";
  receivers = {vec3(-0.1f), vec3(0.1f)};
  EXPECT_EQ(draws(false), 1u) << "the sun's map is far too large";
  room.scene.lights[1].intensity = vec3(5);
  EXPECT_EQ(draws(false), 0u) << "brightness is not in the map";
  room.scene.lights[1].position.x = 0.1f;
  EXPECT_EQ(draws(false), 1u) << "the point light moved";
  EXPECT_EQ(draws(true), 2u) << "geometry changed";
  moved = {{vec3(0.8f), vec3(0.9f)}};
  EXPECT_EQ(draws(false), 1u) << "something moved that the sun's map does not show, as no receiver is there";
  moved = {{vec3(-0.05f), vec3(0.05f)}};
  EXPECT_EQ(draws(false), 2u) << "something moved in the middle";
  moved.clear();
  receivers = {};
  EXPECT_EQ(draws(false), 0u) << "the camera sees nothing: keep what there is";
}

/// What stands still is kept without what moves, which is drawn over it: maps are as if all were drawn, whoever moves,
/// comes to rest, moves again, or is drawn otherwise; and an object that moves is not drawn together with the room.
TEST_F(DirectTest, WhatMovesIsDrawnOverWhatStandsStill) {
  Room room;
  std::vector<LightView>& lights = room.scene.lights;
  lights.push_back({.type = LightType::Directional, .direction = {0.1f, -1, 0.2f}});
  lights.push_back({.type = LightType::Point, .position = {0, 0.5f, 0.5f}});
  lights.push_back({.type = LightType::Spot, .position = {0.5f, 0.9f, 0.5f}, .direction = {-0.3f, -1, -0.2f}});
  lights.back().outerConeCos = 0.5f;
  room.scene.box({-0.1f, -0.1f, 0.2f}, {0.1f, 0.1f, 0.4f}, room.scene.material(vec3(0.5f)), false);
  const size_t block = room.scene.instances.size() - 2, ball = room.scene.instances.size() - 1;
  const uint32_t cut = room.scene.material(vec3(0.5f)); // out, where masks are tested
  room.scene.assets.materials[cut].alphaMode = AlphaMode::Mask;
  room.scene.assets.materials[cut].alpha = 0.2f;
  room.scene.box({0.2f, -0.4f, 0.3f}, {0.5f, -0.3f, 0.6f}, cut, false);
  GpuScene gpu(passes, room.scene.assets);
  settings.sunResolution = settings.pointResolution = settings.spotResolution = 64;
  LightShadowPass kept(passes);
  const auto texels = [](std::span<const LightBlock> blocks) {
    std::vector<float> all;
    for (const LightBlock& b : blocks) {
      const gl::TextureDesc& d = b.maps->desc();
      std::vector<float> own(size_t(d.width) * d.height * d.layers * (b.kind == MapKind::Cube ? 6 : 1));
      glGetTextureImage(b.maps->name(), 0, GL_DEPTH_COMPONENT, GL_FLOAT, GLsizei(own.size() * sizeof(float)),
                        own.data());
      all.insert(all.end(), own.begin(), own.end());
    }
    return all;
  };
  std::vector<float> before;
  int changes = 0;
  for (int frame = 0; frame < 80; ++frame) {
    std::vector<Aabb> moved;
    const auto move = [&](size_t which, const vec3& by) {
      InstanceView& i = room.scene.instances[which];
      moved.push_back(i.boundsWorld);
      i.worldFromObject = glm::translate(mat4(1), by) * i.worldFromObject;
      i.boundsWorld = transformed(room.scene.assets.meshes[i.mesh].boundsObject, i.worldFromObject);
      moved.push_back(i.boundsWorld);
    };
    if (frame % 40 > 0 && frame % 40 < 5) move(ball, {0.03f, 0.02f * float(frame % 3 - 1), -0.02f});
    if (frame > 37 && frame < 45) move(block, {0, 0.01f, 0.02f}); // once the ball has come to rest
    if (frame == 42) gpu.setAlphaTest(AlphaTest::None);           // while both move
    if (frame == 60) lights[1].position.x += 0.1f;
    const SceneView view = room.scene.view();
    gpu.place(view.instances);
    const Aabb receivers{vec3(-0.9f), vec3(0.9f)};
    const LightShadowInputs in{gpu,       lights,           false,      vec3(0), receivers,
                               receivers, view.boundsWorld, frame == 0, moved,   settings};
    const std::vector<float> now = texels(kept.run(in));
    LightShadowInputs all = in;
    all.allChanged = true;
    LightShadowPass anew(passes);
    ASSERT_EQ(now, texels(anew.run(all))) << "frame " << frame;
    changes += now != std::exchange(before, now);
  }
  EXPECT_GT(changes, 12);

  // One that moves is drawn alone.
  gpu.setAlphaTest(AlphaTest::None); // one call for all
  const gl::Texture depth("depth", {.kind = gl::TextureKind::Array, .format = GL_DEPTH_COMPONENT32F});
  gl::Framebuffer target("target");
  target.bind();
  target.attachDepthLayer(depth, 0);
  const auto drawn = [&](Instances which) { return gpu.draw(DrawKind::Depth, mat4(1), vec3(0), which); };
  EXPECT_EQ(drawn(Instances::Moving), 0u) << "all came to rest";
  room.scene.instances[ball].worldFromObject[3].x += 0.1f;
  gpu.place(room.scene.view().instances);
  EXPECT_EQ(drawn(Instances::Moving), 1u);
  EXPECT_EQ(drawn(Instances::Still), 1u);
}

TEST(SkyDirections, CoverTheSphereEvenly) {
  const std::vector<SkyDirection> directions = skyDirections(vec3(1), 32);
  vec3 sum(0);
  for (const SkyDirection& d : directions) {
    EXPECT_NEAR(glm::length(d.direction), 1, 1e-5f);
    sum += d.direction;
  }
  EXPECT_LT(glm::length(sum) / 32, 0.01f);
  // Irradiance of a plane at any tilt: Σ cos · 4π/32 ≈ π.
  for (const vec3& n : {vec3(0, 1, 0), vec3(1, 0, 0), vec3(0, 0, 1), glm::normalize(vec3(1, 1, 1))}) {
    float e = 0;
    for (const SkyDirection& d : directions) e += std::max(0.0f, -glm::dot(n, d.direction)) * d.irradiance.y;
    EXPECT_NEAR(e, kPi, 0.03f * kPi);
  }
}

} // namespace lambent::test::direct_test

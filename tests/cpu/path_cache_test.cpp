// The path cache must not be seen in results: a set that keeps its paths and one that traces them all in every frame go
// through the same random edits of lights, objects and camera, and stay equal bit by bit.
#include "engine/core/rng.h"
#include "engine/trace/embree_query.h"
#include "gi/vpl/smc.h"
#include "tests/support/hand_scene.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include <memory>

namespace lambent {
namespace {

constexpr int kObjects = 24;

/// A room of 8×3×8 m with boxes that may be moved, hidden and shown, one of them a lamp.
class World {
 public:
  World() {
    const uint32_t wall = scene_.material({0.7f, 0.6f, 0.5f}),
                   body = scene_.material({0.3f, 0.6f, 0.4f}, vec3(0), true),
                   lamp = scene_.material(vec3(0.2f), vec3(20), true);
    scene_.box({-4, 0, -4}, {4, 3, 4}, wall, true);
    fixed_ = scene_.instances.size();
    for (int i = 0; i < kObjects; ++i) {
      const vec3 size = 0.15f + 0.35f * number3();
      scene_.quad(-0.5f * size, {size.x, 0, 0}, {0, size.y, 0.3f * size.z}, i == 0 ? lamp : body);
      // Meshes stand around their origin; where each instance is follows.
      scene_.instances.back().worldFromObject = glm::translate(mat4(1), place());
    }
    scene_.lights.resize(3);
    scene_.lights[0].intensity = vec3(6, 5, 4);
    scene_.lights[0].position = {1, 2.5f, 1};
    scene_.lights[1].type = LightType::Spot;
    scene_.lights[1].position = {-2, 2.8f, 0};
    scene_.lights[1].intensity = vec3(10);
    scene_.lights[2].type = LightType::Directional;
    scene_.lights[2].direction = glm::normalize(vec3(0.3f, -1, 0.2f));
    scene_.lights[2].intensity = vec3(0);
    shown_ = scene_.instances;
    for (InstanceView& i : shown_) settle(i);
    rays_ = std::make_unique<EmbreeQuery>(scene_.assets);
  }

  /// The next frame after `edits` random changes.
  const SceneView& step(int edits) {
    for (InstanceView& i : shown_) settle(i);
    changes_ = {frame_ == 0, frame_ == 0, frame_ == 0, false, frame_ == 0};
    places_.clear();
    ++frame_;
    for (int i = 0; i < edits; ++i) edit();
    view_ = scene_.view();
    view_.instances = shown_;
    view_.addedOrRemoved = places_;
    view_.changes = changes_;
    rays_->update(view_);
    return view_;
  }
  const RayQuery& rays() const { return *rays_; }

 private:
  float number() { return random_.next(); }
  vec3 number3() { return {number(), number(), number()}; }
  vec3 place() { return vec3(-3.3f, 0.4f, -3.3f) + vec3(6.6f, 2.2f, 6.6f) * number3(); }

  static Aabb boundsOf(const InstanceView& i, const SceneAssets& assets) {
    return transformed(assets.meshes[i.mesh].boundsObject, i.worldFromObject);
  }
  void settle(InstanceView& i) {
    i.moved = false;
    i.worldFromObjectBefore = i.worldFromObject;
    i.boundsWorld = i.boundsWorldBefore = boundsOf(i, scene_.assets);
  }

  void edit() {
    const float what = number();
    if (what < 0.45f) { // an object moves a little or far
      InstanceView& i = shown_[fixed_ + random_.below(uint32_t(shown_.size() - fixed_))];
      const vec3 at = number() < 0.8f ? vec3(i.worldFromObject[3]) + 0.1f * (number3() - 0.5f) : place();
      i.worldFromObject = glm::rotate(glm::translate(mat4(1), at), 6 * number(), glm::normalize(number3() + 0.1f));
      i.boundsWorld = boundsOf(i, scene_.assets);
      i.moved = changes_.geometry = true;
    } else if (what < 0.7f) { // a light moves, dims, or goes out
      LightView& l = scene_.lights[random_.below(3)];
      if (l.type != LightType::Directional && number() < 0.5f)
        l.position = place();
      else
        l.intensity = number() < 0.3f ? vec3(0) : 8.0f * number3();
      changes_.lights = true;
    } else if (what < 0.75f) {
      scene_.sky = number() < 0.5f ? vec3(0) : number3();
      changes_.lights = true;
    } else if (what < 0.85f) {
      scene_.camera.worldFromView = glm::inverse(glm::lookAt(place(), place(), vec3(0, 1, 0)));
      changes_.camera = true;
    } else if (what < 0.93f) { // away with one, the lamp too
      if (shown_.size() < fixed_ + 3) return;
      const size_t k = fixed_ + random_.below(uint32_t(shown_.size() - fixed_));
      places_.push_back(shown_[k].boundsWorldBefore);
      shown_.erase(shown_.begin() + k);
      changes_.instances = true;
    } else { // and back
      for (const InstanceView& i : scene_.instances) {
        const auto same = [&](const InstanceView& s) { return s.id == i.id; };
        if (std::any_of(shown_.begin(), shown_.end(), same)) continue;
        shown_.push_back(i);
        settle(shown_.back());
        places_.push_back(shown_.back().boundsWorld);
        changes_.instances = true;
        return;
      }
    }
  }

  test::HandScene scene_;
  Rng random_{11, Stream::Test, 0};
  size_t fixed_ = 0;
  std::vector<InstanceView> shown_;
  std::vector<Aabb> places_;
  SceneChanges changes_;
  SceneView view_;
  int frame_ = 0;
  std::unique_ptr<EmbreeQuery> rays_; // after the meshes are there
};

void expectEqual(const VplSet& a, const VplSet& b, int frame) {
  ASSERT_EQ(a.pool.size(), b.pool.size()) << "frame " << frame;
  for (size_t i = 0; i < a.pool.size(); ++i) {
    ASSERT_EQ(a.pool[i].id, b.pool[i].id) << "candidate " << i << ", frame " << frame;
    ASSERT_EQ(a.pool[i].samplerRadiance, b.pool[i].samplerRadiance) << "candidate " << i << ", frame " << frame;
  }
  ASSERT_EQ(a.slots.size(), b.slots.size());
  for (size_t i = 0; i < a.slots.size(); ++i) {
    const Vpl &x = a.slots[i], &y = b.slots[i];
    ASSERT_EQ(x.id, y.id) << "slot " << i << ", frame " << frame;
    ASSERT_EQ(x.alive, y.alive) << "slot " << i << ", frame " << frame;
    if (!x.alive) continue;
    ASSERT_EQ(x.position, y.position) << "slot " << i << ", frame " << frame;
    ASSERT_EQ(x.area, y.area) << "slot " << i << ", frame " << frame;
    ASSERT_EQ(x.samplerRadiance, y.samplerRadiance) << "slot " << i << ", frame " << frame;
    ASSERT_EQ(x.radiance, y.radiance) << "slot " << i << ", frame " << frame;
  }
}

TEST(PathCache, EqualsTracingAllPathsThroughRandomEdits) {
  World world;
  SmcSettings kept;
  kept.vpls = 48;
  kept.points = 64;
  kept.candidateRays = 4;
  kept.paths = 4;
  kept.warmup = 4;
  SmcSettings anew = kept;
  anew.cache = false;
  VplSet a, b;
  uint64_t traced = 0, all = 0;
  constexpr int kFrames = 3000;
  for (int frame = 0; frame < kFrames; ++frame) {
    const SceneView& view = world.step(frame % 4);
    const LightSet lights = collectLights(view);
    VplUpdateLog logA, logB;
    updateVpls(a, {view, world.rays(), lights, kept, 5}, logA);
    updateVpls(b, {view, world.rays(), lights, anew, 5}, logB);
    ASSERT_NO_FATAL_FAILURE(expectEqual(a, b, frame));
    traced += logA.paths.traced;
    all += logB.paths.traced;
  }
  RecordProperty("traced_share", std::to_string(double(traced) / double(all)));
  std::printf("%d frames: %.1f %% of the paths traced anew\n", kFrames, 100.0 * double(traced) / double(all));
  EXPECT_LT(traced, all / 2);
}

TEST(PathCache, LightsThatMoveTraceNoPath) {
  World world;
  SmcSettings settings;
  settings.vpls = 64;
  settings.points = 128;
  settings.moves = 0;
  VplSet set;
  const LightSet lights = collectLights(world.step(0));
  SceneView view = world.step(0);
  VplUpdateLog log;
  view.changes.first = view.changes.camera = view.changes.lights = true;
  updateVpls(set, {view, world.rays(), lights, settings, 1}, log);
  view.changes = {false, false, true, false, false};
  LightSet moved = lights;
  moved.punctual[0].position += vec3(0.3f, 0, 0.1f);
  log = {};
  updateVpls(set, {view, world.rays(), moved, settings, 1}, log);
  // Only the candidates drawn in this frame.
  EXPECT_EQ(log.paths.traced, uint64_t(settings.vpls / settings.poolFrames) * (settings.paths / 2));
  EXPECT_EQ(log.relit, 64u);
  EXPECT_GT(log.radiosity.occlusion, 1000u);
}

} // namespace
} // namespace lambent

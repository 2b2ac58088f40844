// Meshes, materials and textures that come and go while frames run: light goes on, and is that of the scene as it is.
#include "engine/core/error.h"
#include "engine/core/rng.h"
#include "gi/contract/frame_outputs.h"
#include "gi/frame/gi_frame.h"
#include "gi/host/host_scene.h"
#include "gi/plan/needs.h"
#include "gi/plan/presets.h"
#include "in_host.h"
#include "tests/support/effort.h"
#include "tests/support/test.h"

#include <epoxy/gl.h>

#include <glm/gtc/matrix_transform.hpp>

#include <atomic>
#include <chrono>
#include <functional>
#include <map>
#include <set>
#include <thread>

namespace lambent::test::streaming_test {

namespace {

constexpr int kWidth = 48, kHeight = 32;

uint32_t addBox(HostScene& scene, float half, bool inward, uint32_t material = 0) {
  std::vector<vec3> positions;
  std::vector<vec2> uvs;
  std::vector<uvec3> triangles;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-half, half}) {
      const uint32_t first = uint32_t(positions.size());
      for (int corner = 0; corner < 4; ++corner) {
        vec3 p;
        p[axis] = side;
        p[(axis + 1) % 3] = corner == 1 || corner == 2 ? half : -half;
        p[(axis + 2) % 3] = corner >= 2 ? half : -half;
        positions.push_back(p);
        uvs.emplace_back(p[(axis + 1) % 3], p[(axis + 2) % 3]);
      }
      const bool turned = (side < 0) != inward;
      for (const uvec3& t : {uvec3(0, 1, 2), uvec3(0, 2, 3)})
        triangles.push_back(first + (turned ? uvec3(t.x, t.z, t.y) : t));
    }
  return scene.addMesh({.positions = positions, .uvs = uvs, .triangles = triangles, .material = material});
}

struct World {
  HostScene scene;
  ViewChanges changes;
  GiFrame gi;
  int starts = 0; // times that its lights were placed anew

  explicit World(const Settings& settings, bool furnished = true) : gi(settings) {
    if (!furnished) return;
    scene.addInstance(addBox(scene, 1, true), mat4(1));
    LightView lamp;
    lamp.position = {0.4f, 0.6f, 0.2f};
    scene.addLight(lamp);
  }
  static Settings settings() {
    Settings s;
    s.smc.vpls = s.smc.points = 256;
    s.smc.warmup = 8;
    return s;
  }
  void run(int frames = 1) {
    CameraView camera = lookAt({0, 0.1f, 0.9f}, {0, 0, 0}, 1.2f);
    camera.width = kWidth;
    camera.height = kHeight;
    for (int i = 0; i < frames; ++i)
      gi.run(scene.view(changes, camera, 0), [&](int done, int) { starts += done == 1; });
  }
  std::vector<vec3> read(uint32_t texture) const {
    std::vector<vec3> texels(size_t(kWidth * kHeight));
    glGetTextureImage(texture, 0, GL_RGB, GL_FLOAT, GLsizei(texels.size() * sizeof(vec3)), texels.data());
    return texels;
  }
  static double mean(const std::vector<vec3>& values) {
    double sum = 0;
    for (const vec3& v : values) sum += double(luminance(v)) / double(values.size());
    return sum;
  }
  std::set<uint64_t> ids() const {
    std::set<uint64_t> all;
    for (const Vpl& v : gi.vpls().slots)
      if (v.alive) all.insert(v.id);
    return all;
  }
};

double shared(const std::set<uint64_t>& before, const std::set<uint64_t>& now) {
  size_t same = 0;
  for (const uint64_t id : now) same += before.contains(id);
  return double(same) / double(before.size());
}

/// Mean difference over the mean.
double apart(const std::vector<vec3>& a, const std::vector<vec3>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += double(glm::length(a[i] - b[i])) / double(a.size());
  return sum > 0 ? sum / World::mean(b) : 0;
}
/// Of direct light.
double apart(const World& a, const World& b) {
  return apart(a.read(a.gi.directIrradiance()), b.read(b.gi.directIrradiance()));
}

class Streaming : public InHost {};

} // namespace

TEST_F(Streaming, LightGoesOnWhereMeshesComeAndGo) {
  World world(World::settings());
  world.run(8);
  const std::vector<vec3> empty = world.read(world.gi.directIrradiance());
  const std::set<uint64_t> before = world.ids();

  // What nothing shows changes no light at all.
  TextureImage image;
  image.width = image.height = 2;
  image.texels = {u8vec4(255), u8vec4(128), u8vec4(128), u8vec4(255)};
  Material material;
  material.baseColorTexture = {.image = world.scene.addTexture(image)};
  const uint32_t textured = world.scene.addMaterial(material);
  const uint32_t mesh = addBox(world.scene, 0.25f, false, textured);
  world.run();
  EXPECT_GT(shared(before, world.ids()), 0.95);
  EXPECT_EQ(world.read(world.gi.directIrradiance()), empty);
  addBox(world.scene, 0.5f, false);
  LightView lamp;
  lamp.position = {0.3f, 0.6f, 0.2f};
  world.scene.setLight(0, lamp); // all is drawn again, though all stands as before
  world.run();
  EXPECT_LT(std::abs(World::mean(world.read(world.gi.directIrradiance())) / World::mean(empty) - 1), 0.1);
  lamp.position.x = 0.4f;
  world.scene.setLight(0, lamp);
  world.run();
  EXPECT_EQ(world.read(world.gi.directIrradiance()), empty);

  const uint32_t block = world.scene.addInstance(mesh, glm::translate(mat4(1), vec3(-0.3f, -0.7f, -0.2f)));
  world.run();
  EXPECT_GT(shared(before, world.ids()), 0.6) << "a block does not take all lights";
  const std::vector<vec3> filled = world.read(world.gi.directIrradiance());
  world.run(8);
  {
    World fresh(World::settings()); // of the same things from the start
    TextureImage other = image;
    material.baseColorTexture.image = fresh.scene.addTexture(other);
    fresh.scene.addInstance(addBox(fresh.scene, 0.25f, false, fresh.scene.addMaterial(material)),
                            glm::translate(mat4(1), vec3(-0.3f, -0.7f, -0.2f)));
    fresh.run(9);
    EXPECT_LT(apart(filled, fresh.read(fresh.gi.directIrradiance())), 0.01) << "shadows in the first frame";
    const auto indirect = [](const World& w) { return World::mean(w.read(w.gi.indirectIrradiance())); };
    EXPECT_NEAR(indirect(world) / indirect(fresh), 1, 0.05);
    const std::vector<vec3> albedo = world.read(world.gi.outputs().surfaces.albedo->name()),
                            same = fresh.read(fresh.gi.outputs().surfaces.albedo->name());
    EXPECT_EQ(albedo, same);
  }

  world.scene.removeInstance(block);
  world.scene.removeMesh(mesh);
  world.scene.removeMaterial(textured);
  world.scene.removeTexture(material.baseColorTexture.image);
  const std::set<uint64_t> with = world.ids();
  world.run();
  EXPECT_GT(shared(with, world.ids()), 0.6);
  EXPECT_EQ(world.read(world.gi.directIrradiance()), empty);
  world.run(4);
  // And again, under other numbers, deformed.
  const uint32_t second = addBox(world.scene, 0.2f, false);
  const uint32_t shown = world.scene.addInstance(second, mat4(1));
  std::vector<vec3> positions(24, vec3(0));
  for (size_t i = 0; i < positions.size(); ++i)
    positions[i] = 0.3f * vec3(i % 2 ? 1 : -1, i / 2 % 2 ? 1 : -1, i / 4 % 2 ? 1 : -1);
  world.scene.deformInstance(shown, positions, {});
  addBox(world.scene, 0.1f, false);
  world.run(2);
  World fresh(World::settings());
  fresh.scene.deformInstance(fresh.scene.addInstance(addBox(fresh.scene, 0.2f, false), mat4(1)), positions, {});
  fresh.run(2);
  EXPECT_LT(apart(world, fresh), 0.01);
  EXPECT_NE(world.read(world.gi.directIrradiance()), empty);
  EXPECT_EQ(world.starts, 1);
}

/// Maps of what stands still are of the scene as it is, while something moves.
TEST_F(Streaming, AMaterialThatChangesIsSeenByEveryMap) {
  Settings settings = World::settings();
  settings.shadow.rays = false;
  World world(settings), fresh(settings);
  Material mask;
  mask.alpha = 0;
  std::vector<uint32_t> materials, movers;
  for (World* w : {&world, &fresh}) {
    materials.push_back(w->scene.addMaterial(mask));
    w->scene.addInstance(addBox(w->scene, 0.25f, false, materials.back()),
                         glm::translate(mat4(1), vec3(0.2f, 0.1f, 0)));
    movers.push_back(w->scene.addInstance(addBox(w->scene, 0.05f, false), mat4(1)));
  }
  const auto move = [&](int frame) {
    for (int i = 0; i < 2; ++i)
      (i ? fresh : world)
          .scene.moveInstance(movers[size_t(i)],
                              glm::translate(mat4(1), vec3(-0.6f + 0.01f * float(frame), -0.5f, 0.3f)));
  };
  for (int i = 0; i < 4; ++i) move(i), world.run();
  mask.alphaMode = AlphaMode::Mask; // it is not there
  world.scene.setMaterial(materials[0], mask);
  fresh.scene.setMaterial(materials[1], mask);
  for (int i = 4; i < 10; ++i) {
    move(i);
    world.run();
    fresh.run();
    EXPECT_LT(apart(world, fresh), 0.005) << i;
  }
}

/// With objects that are kept where they stood, what they show may have gone.
TEST_F(Streaming, FrozenObjectsDoNotShowWhatHasGone) {
  Settings settings = World::settings();
  World world(settings);
  const uint32_t mesh = addBox(world.scene, 0.25f, false), block = world.scene.addInstance(mesh, mat4(1));
  world.run(2);
  world.gi.settings().effects[EffectId::Motion] = EffectMode::Off;
  world.run(2);
  world.scene.removeInstance(block);
  world.scene.removeMesh(mesh);
  world.run(2);
  World empty(settings);
  empty.run(2);
  EXPECT_LT(apart(world, empty), 0.01);
  // They freeze in the frame in which it has gone.
  World other(settings);
  const uint32_t gone = addBox(other.scene, 0.25f, false), shown = other.scene.addInstance(gone, mat4(1));
  other.run(2);
  other.gi.settings().effects[EffectId::Motion] = EffectMode::Off;
  other.scene.removeInstance(shown);
  other.scene.removeMesh(gone);
  other.run(2);
  EXPECT_LT(apart(other, empty), 0.01);
}

/// Lamps traced on the GPU know what came too.
TEST_F(Streaming, RaysOnTheGpuMeetWhatCame) {
  Settings settings = World::settings();
  applySetting(settings, "shadow.emitters", "patches");
  applySetting(settings, "area.tracer", "gpu");
  World world(settings), fresh(settings);
  Material glow;
  glow.emission = vec3(5);
  glow.doubleSided = true;
  const auto addLamp = [&](World& w) {
    w.scene.addInstance(addBox(w.scene, 0.15f, false, w.scene.addMaterial(glow)),
                        glm::translate(mat4(1), vec3(0, 0.8f, -0.3f)));
  };
  const auto addShade = [](World& w) {
    w.scene.addInstance(addBox(w.scene, 0.3f, false), glm::translate(mat4(1), vec3(0, 0.3f, -0.3f)));
  };
  addLamp(world);
  world.run(3);
  const std::vector<vec3> before = world.read(world.gi.directIrradiance());
  addShade(world);
  world.run();
  addLamp(fresh);
  addShade(fresh);
  fresh.run();
  const std::vector<vec3> now = world.read(world.gi.directIrradiance()),
                          expected = fresh.read(fresh.gi.directIrradiance());
  EXPECT_LT(apart(now, expected), 0.01);
  EXPECT_GT(apart(before, expected), 0.1);
}

/// An update of lights beside the GPU reads meshes and materials until it ends: what changes them waits.
TEST_F(Streaming, ChangesWaitForWhoReadsBesideTheGpu) {
  World world(World::settings());
  TextureImage image;
  image.width = image.height = 1;
  image.texels = {u8vec4(255)};
  uint32_t texture = 0, material = 0, mesh = 0;
  const std::vector<std::function<void()>> calls{[&] { texture = world.scene.addTexture(image); },
                                                 [&] { material = world.scene.addMaterial({}); },
                                                 [&] { mesh = addBox(world.scene, 0.1f, false, material); },
                                                 [&] { world.scene.setMaterial(material, {}); },
                                                 [&] { world.scene.removeMesh(mesh); },
                                                 [&] { world.scene.removeMaterial(material); },
                                                 [&] { world.scene.removeTexture(texture); }};
  CameraView camera = lookAt({0, 0.1f, 0.9f}, {0, 0, 0}, 1.2f);
  const SceneAssets& assets = *world.scene.view(world.changes, camera, 0).assets;
  for (size_t i = 0; i < calls.size(); ++i) {
    std::atomic<bool> reads = false, over = false;
    std::thread reader([&] {
      const Readers::Reading reading(assets.readers);
      reads = true;
      std::this_thread::sleep_for(std::chrono::milliseconds(30));
      over = true;
    });
    while (!reads) std::this_thread::yield();
    calls[i]();
    EXPECT_TRUE(over) << i;
    reader.join();
  }
  // And an update is known to read, as long as it does.
  world.gi.settings().frame.overlap = true;
  world.gi.settings().smc.paths = 256;
  LightView lamp;
  bool seen = false;
  for (int frame = 0; frame < 50 && !seen; ++frame) {
    lamp.position = {0.3f, 0.6f, 0.01f * float(frame % 9)};
    world.scene.setLight(0, lamp);
    world.run();
    seen = assets.readers.any();
  }
  EXPECT_TRUE(seen);
  world.gi.vpls();
  EXPECT_FALSE(assets.readers.any());
}

/// A room told call by call at random, and what of it is there, so that another can be told the same.
class RandomRoom {
 public:
  RandomRoom(HostScene& scene, uint32_t seed, bool glows)
      : scene_(scene), random_(seed, Stream::Test, 0), glows_(glows) {
    walls_ = scene.addInstance(addBox(scene, 1, true), mat4(1));
    LightView lamp;
    lamp.position = {0.2f, 0.7f, 0.3f};
    lights_[scene.addLight(lamp)] = lamp;
  }
  void change() {
    switch (below(9)) {
    case 0: {
      TextureImage image;
      image.width = image.height = 2;
      for (int k = 0; k < 4; ++k) image.texels.push_back(u8vec4(80 + 40 * k, 200, 250 - 40 * k, k % 2 ? 255 : 0));
      textures_[scene_.addTexture(image)] = image;
      break;
    }
    case 1: {
      Material m;
      m.baseColor = vec3(0.3f + 0.6f * random_.next());
      if (!textures_.empty() && below(2)) m.baseColorTexture = {.image = any(textures_), .nearest = true};
      if (m.baseColorTexture.image != kNone && below(2)) m.alphaMode = AlphaMode::Mask;
      if (glows_ && below(4) == 0) m.emission = vec3(2 * random_.next());
      materials_[scene_.addMaterial(m)] = m;
      break;
    }
    case 2:
    case 3: {
      const Shape shape{0.1f + 0.15f * random_.next(), materials_.empty() ? 0 : any(materials_)};
      meshes_[addBox(scene_, shape.half, false, shape.material)] = shape;
      break;
    }
    case 4:
    case 5:
      if (!meshes_.empty()) {
        const uint32_t mesh = any(meshes_);
        const mat4 place = somewhere();
        instances_[scene_.addInstance(mesh, place)] = {mesh, place};
      }
      break;
    case 6:
      if (!instances_.empty()) {
        const uint32_t which = any(instances_);
        instances_[which].second = somewhere();
        scene_.moveInstance(which, instances_[which].second);
      }
      break;
    case 7: { // away with one of each, where nothing holds it
      if (!instances_.empty() && below(2)) {
        const uint32_t gone = any(instances_);
        scene_.removeInstance(gone);
        instances_.erase(gone);
      }
      drop(meshes_, [&](uint32_t mesh) { scene_.removeMesh(mesh); });
      drop(materials_, [&](uint32_t material) { scene_.removeMaterial(material); });
      drop(textures_, [&](uint32_t texture) { scene_.removeTexture(texture); });
      break;
    }
    case 8: {
      LightView lamp;
      lamp.position = 1.6f * random_.next3() - 0.8f;
      lamp.intensity = vec3(random_.next());
      if (lights_.size() < 3)
        lights_[scene_.addLight(lamp)] = lamp;
      else
        scene_.setLight(lights_.rbegin()->first, lights_.rbegin()->second = lamp);
      break;
    }
    }
  }
  /// The same, told anew in order.
  void tell(HostScene& to) const {
    std::map<uint32_t, uint32_t> textures, materials, meshes;
    to.addInstance(addBox(to, 1, true), mat4(1));
    for (const auto& [n, image] : textures_) textures[n] = to.addTexture(image);
    for (auto [n, m] : materials_) {
      if (m.baseColorTexture.image != kNone) m.baseColorTexture.image = textures.at(m.baseColorTexture.image);
      materials[n] = to.addMaterial(m);
    }
    for (const auto& [n, shape] : meshes_)
      meshes[n] = addBox(to, shape.half, false, shape.material == 0 ? 0 : materials.at(shape.material));
    for (const auto& [n, placed] : instances_) to.addInstance(meshes.at(placed.first), placed.second);
    for (const auto& [n, light] : lights_) to.addLight(light);
  }

 private:
  struct Shape {
    float half;
    uint32_t material;
  };
  uint32_t below(uint32_t n) { return std::min(uint32_t(random_.next() * float(n)), n - 1); }
  template <class Map> uint32_t any(const Map& map) {
    return std::next(map.begin(), below(uint32_t(map.size())))->first;
  }
  template <class Map, class Remove> void drop(Map& map, const Remove& remove) {
    if (map.empty()) return;
    const uint32_t which = any(map);
    try {
      remove(which);
      map.erase(which);
    } catch (const InputError&) { // something holds it
    }
  }
  mat4 somewhere() { return glm::translate(mat4(1), 1.2f * random_.next3() - 0.6f); }

  HostScene& scene_;
  Rng random_;
  bool glows_;
  uint32_t walls_;
  std::map<uint32_t, TextureImage> textures_;
  std::map<uint32_t, Material> materials_;
  std::map<uint32_t, Shape> meshes_;
  std::map<uint32_t, std::pair<uint32_t, mat4>> instances_;
  std::map<uint32_t, LightView> lights_;
};

/// Whatever came and went between frames, the light is that of a scene that was so from the start.
TEST_F(Streaming, AnyChangesLeaveTheLightOfTheSceneAsItIs) {
  const int changes = isLong() ? 120 : 20;
  std::vector<Assignments> ways{{},
                                {{"technique", "mir"}},
                                {{"technique", "isr"}},
                                {{"technique", "lpv"}},
                                {{"technique", "ibrr"}},
                                {{"gather.mode", "full"}, {"shadow.maker", "raster"}},
                                {{"shadow.emitters", "patches"}, {"area.tracer", "gpu"}},
                                {{"direct.soft", "maps"}, {"frame.overlap", "on"}}};
  if (!isLong()) ways.erase(ways.begin() + 1, ways.begin() + 5);
  uint32_t seed = 0;
  for (const Assignments& way : ways) {
    Settings settings = World::settings();
    settings.smc.vpls = settings.smc.points = 128;
    settings.cube.resolution = 16;
    for (const auto& [name, value] : way)
      if (name == "technique")
        applyTechnique(settings, value);
      else
        applySetting(settings, name, value);
    SCOPED_TRACE(way.empty() ? "as set" : way.front().second);
    World world(settings, false), fresh(settings, false);
    // Light of rays has noise, which other frames before have otherwise.
    const bool exact = settings.direct.soft == SoftLightBy::Maps || settings.shadow.emitters == EmitterShadows::Patches;
    RandomRoom room(world.scene, ++seed, exact);
    for (int i = 0; i < changes; ++i) {
      for (int k = 0; k < 1 + i % 4; ++k) room.change();
      if (i % 25 == 24 &&
          axesOf(settings).gather != GatherMode::Volume) // what a volume keeps outlives a pause of motion: gi/README.md
        world.gi.settings().effects[EffectId::Motion] = i % 50 == 24 ? EffectMode::Off : EffectMode::Auto;
      world.run();
    }
    world.gi.settings().effects[EffectId::Motion] = EffectMode::Auto;
    room.tell(fresh.scene);
    world.run(24);
    fresh.run(24);
    EXPECT_LT(apart(world, fresh), 0.02);
    const auto indirect = [](const World& w) { return World::mean(w.read(w.gi.indirectIrradiance())); };
    EXPECT_NEAR(indirect(world) / indirect(fresh), 1, 0.15);
  }
}

} // namespace lambent::test::streaming_test

#include "hard_case.h"

#include "gi/plan/presets.h"

namespace lambent::test {

CameraView look(const vec3& eye, const vec3& target) {
  CameraView camera = lookAt(eye, target, 1.2f);
  camera.width = 32, camera.height = 18;
  return camera;
}

HardWorld::HardWorld(const char* preset) {
  scene.camera = look({0.1f, 0.1f, 0.9f}, {0, -0.1f, -1});
  settings.image.exposure = 1;
  if (preset) {
    applyPreset(settings, preset);
    return;
  }
  settings.smc = {.vpls = 64, .moves = 8, .points = 128, .warmup = 4};
  settings.shadow.resolution = 32;
  settings.shadow.maker = ShadowMaker::Rays;
  settings.vpl.mirCandidates = 4;
  settings.rsm.resolution = 32;
  settings.cube.resolution = 32;
}

void HardWorld::room(const vec3& lo, const vec3& hi, const vec3& albedo) {
  scene.box(lo, hi, scene.material(albedo), true);
}

LightView& HardWorld::lamp(const vec3& position, float intensity) {
  LightView& light = scene.lamp(position, vec3(intensity));
  light.id = uint32_t(scene.lights.size() - 1);
  light.changed = true;
  return light;
}

namespace {

// A lamp of 1 W/sr in the middle of room() sends 4π W to its 24 m²: three bounces at an albedo of 0.7 make 0.80 W/m²
// (paths: 0.797 ± 0.0004 from this camera, 0.70 to 0.86 from others).
constexpr HardBounds kRoom{0.65, 1.05, 0.5};

/// The room and its lamp `unit` times as large, around `centre`.
void roomOf(HardWorld& w, float unit, const vec3& centre = vec3(0), float light = 1) {
  w.room(centre - vec3(unit), centre + vec3(unit));
  w.lamp(centre + unit * vec3(0.1f, 0.3f, 0.2f), light * unit * unit);
  w.scene.camera = look(centre + unit * vec3(0.1f, 0.1f, 0.9f), centre - unit * vec3(0, 0.1f, 1));
  w.scene.camera.near = 0.01f * unit;
}

/// The room with settings of its own.
std::function<void(HardWorld&)> roomWith(std::map<std::string, std::string> set) {
  return [set](HardWorld& w) {
    roomOf(w, 1);
    for (const auto& [name, value] : set) applySetting(w.settings, name, value);
  };
}

template <class List> std::vector<HardCase> listed(const List& list) {
  std::vector<HardCase> cases;
  list([&](const char* name, const char* reason, const HardBounds& bounds, std::function<void(HardWorld&)> make) {
    cases.push_back({name, reason, bounds, std::move(make)});
  });
  return cases;
}

/// Maps as fine as leaks ask for: at 32² the texels at a wall's edge let 0.2 to 0.4 % of the light of ir's few lights
/// through, at 64² a quarter of that, at 128² 0.005 %.
void fineMaps(HardWorld& w) { w.settings.shadow.resolution = 128; }

/// Two rooms side by side, a wall of this thickness between them; the lamp in the one that the camera is not in.
void twoRooms(HardWorld& w, float wall) {
  fineMaps(w);
  w.room(vec3(-1), vec3(1));
  w.room(vec3(1 + wall, -1, -1), vec3(3 + wall, 1, 1));
  w.lamp({2 + wall, 0.3f, 0});
  w.scene.camera = look({-0.9f, 0, 0}, {1, 0, 0});
}

void lamps(HardWorld& w, int count) {
  for (int i = 0; i < count; ++i)
    w.lamp(0.9f * vec3(std::sin(float(i) * 12.99f), std::sin(float(i) * 78.23f), std::sin(float(i) * 37.72f)),
           1.0f / float(count));
}

void spot(LightView& light, const vec3& direction, float cosine) {
  light.type = LightType::Spot;
  light.direction = glm::normalize(direction);
  light.innerConeCos = light.outerConeCos = cosine;
}

} // namespace

const std::vector<HardCase>& longCases() {
  static const std::vector<HardCase> cases = listed([](const auto& add) {
    add("TenThousandLamps", "more lamps than virtual lights", {0.65, 1.05}, [](HardWorld& w) {
      w.room();
      lamps(w, 10000);
      w.frames = 2;
    });
    add("ManyVpls", "N = 65536: more layers than an array of textures holds", kRoom,
        roomWith({{"smc.vpls", "65536"}, {"smc.points", "65536"}, {"shadow.resolution", "16"}}));
    add("ALongStand", "10⁵ frames in which nothing changes: counts of pictures saturate", {0.65, 1.05, 0.01},
        [](HardWorld& w) {
          roomOf(w, 1);
          w.scene.camera.width = 8, w.scene.camera.height = 5;
          w.frames = 100000;
        });
  });
  return cases;
}

const std::vector<HardCase>& hardCases() {
  static const std::vector<HardCase> cases = listed([](const auto& add) {
    // Where lights are.
    add("Room", "nothing hard: what the others are measured by", kRoom, [](HardWorld& w) { roomOf(w, 1); });
    add("CoincidentLights", "a beam as thin as a thread lights one point: densities divide by the distance of lights",
        {0, 1e-3, 5}, [](HardWorld& w) {
          w.room();
          spot(w.lamp({0, 0.9f, 0}, 100), {0, -1, 0}, 0.9999999f);
        });
    add("LightsAtTheEye", "lights on the shaded points: 1/r² without bound", kRoom, [](HardWorld& w) {
      roomOf(w, 1);
      w.scene.camera = look({0.999f, 0, 0}, {1, 0.01f, 0.3f});
      w.scene.camera.near = 1e-5f;
    });
    add("FlatWorld", "all receivers lie in the plane of all lights: there is no indirect light", {0, 1e-5},
        [](HardWorld& w) {
          w.scene.quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, w.scene.material(vec3(0.7f)));
          w.lamp({0, 1, 0});
          w.scene.camera = look({0, 1.5f, 1.5f}, vec3(0));
        });
    add("GrazingLamp",
        "a lamp a tenth of a millimetre above the floor: half its light falls on a spot that paths from the eye do not "
        "find "
        "(they bring 0.43 W/m², photons 0.83)",
        {0.3, 0.95}, [](HardWorld& w) {
          w.room();
          w.lamp({0, -0.9999f, 0});
        });
    add("LampInTheCorner",
        "most light falls on three spots of a millimetre; path tracing: 0.40 ± 0.04 W/m² (65,536 paths)", {0.05, 1.6},
        [](HardWorld& w) {
          w.room();
          w.lamp({-0.999f, -0.999f, -0.999f});
        });
    add("LampInAWall", "behind every front side", HardBounds{.most = 1e-4, .leak = true}, [](HardWorld& w) {
      w.room();
      w.scene.box(vec3(-1.2f), vec3(1.2f), w.scene.material(vec3(0.7f)), false);
      w.lamp({-1.1f, 0, 0});
      fineMaps(w);
    });
    add("LampInABox", "a lit box that nothing leaves", HardBounds{.most = 1e-3, .leak = true}, [](HardWorld& w) {
      w.room();
      w.scene.box(vec3(-0.2f), vec3(0.2f), w.scene.material(vec3(0.7f)), false);
      w.room(vec3(-0.19f), vec3(0.19f));
      w.lamp(vec3(0));
      w.scene.camera = look({0.5f, 0.5f, 0.9f}, vec3(0));
    });
    add("Wire", "lights on a wire of 0.1 mm: areas that stand for almost nothing", kRoom, [](HardWorld& w) {
      roomOf(w, 1);
      w.scene.box({-5e-5f, -1, -5e-5f}, {5e-5f, 1, 5e-5f}, w.scene.material(vec3(0.9f)), false);
    });
    add("Leaves", "two hundred leaves of one triangle pair: every light has neighbours on other surfaces", {0.55, 1},
        [](HardWorld& w) {
          roomOf(w, 1);
          const uint32_t green = w.scene.material(vec3(0.2f, 0.6f, 0.1f), vec3(0), true);
          for (int i = 0; i < 200; ++i) {
            const vec3 at(std::sin(float(i) * 12.99f), std::sin(float(i) * 78.23f), std::sin(float(i) * 37.72f));
            w.scene.quad(0.6f * at, {0.05f, 0.01f * at.x, 0}, {0, 0.01f * at.z, -0.05f}, green);
          }
        });
    add("BrightSpeck", "a glowing speck of 1 mm² and 10⁶ W/(m² sr)", {0.3, 0.6}, [](HardWorld& w) {
      w.room();
      w.scene.quad({0, 0.5f, 0}, {1e-3f, 0, 0}, {0, 0, 1e-3f}, w.scene.material(vec3(0), vec3(1e6f), true));
    });
    add("OneHit", "of all camera rays one or none meets a surface", {0, 1e-4}, [](HardWorld& w) {
      w.scene.quad({-1e-3f, -1e-3f, -1}, {2e-3f, 0, 0}, {0, 2e-3f, 0}, w.scene.material(vec3(0.7f)));
      w.lamp({0, 0, 1});
      w.scene.camera = look({0, 0, 1}, {0, 0, -1});
    });
    add("ManyLamps", "three hundred: more than one block of lights, and trees over them", {0.65, 1.05},
        [](HardWorld& w) {
          w.room();
          lamps(w, 300);
          w.settings.rsm.resolution = 16; // trees of so many lamps take long
          w.frames = 2;
        });
    // How much light there is.
    add("LightOf1e-20", "products of small numbers", {0.65e-20, 1.05e-20, 0.5},
        [](HardWorld& w) { roomOf(w, 1, vec3(0), 1e-20f); });
    add("LightOf1e30", "sums beyond half and near the end of single precision", {0.65e30, 1.05e30, 0.5},
        [](HardWorld& w) { roomOf(w, 1, vec3(0), 1e30f); });
    add("NoLight", "nothing to divide by", {0, 0}, [](HardWorld& w) { w.room(); });
    add("NoGeometry", "nothing to hit", {0, 0}, [](HardWorld& w) { w.lamp({0, 1, 0}); });
    add("NothingAtAll", "no light, no surface", {0, 0}, [](HardWorld&) {});
    add("Black", "albedo 0: no light is reflected", {0, 0}, [](HardWorld& w) {
      w.room(vec3(-1), vec3(1), vec3(0));
      w.lamp(vec3(0));
    });
    add("White", "albedo 1: light paths never end by themselves", {1.2, 2}, [](HardWorld& w) {
      w.room(vec3(-1), vec3(1), vec3(1));
      w.lamp({0.1f, 0.3f, 0.2f});
    });
    add("MoreThanWhite", "albedo 1.5, taken as 1: every reflection would add light", {1.2, 2}, [](HardWorld& w) {
      w.room(vec3(-1), vec3(1), vec3(1.5f));
      w.lamp({0.1f, 0.3f, 0.2f});
    });
    // Sizes and places.
    add("ATenthOfAMillimetre", "a room of 0.2 mm", kRoom, [](HardWorld& w) { roomOf(w, 1e-4f); });
    add("AThousandKilometres", "a room of 2000 km", kRoom, [](HardWorld& w) { roomOf(w, 1e6f); });
    add("FarFromTheOrigin", "200 m at 1000 km: positions in steps of 6 cm", {0.6, 1.1},
        [](HardWorld& w) { roomOf(w, 100, vec3(1e6f, 0, -1e6f)); });
    add("LongCorridor", "200 m by 2 m, the lamp at the far end", {1e-4, 1.5e-3}, [](HardWorld& w) {
      w.room({-1, -1, -200}, {1, 1, 1});
      w.lamp({0, 0, -199}, 100);
      w.settings.cube.resolution = 128; // texels narrower than the corridor
    });
    // What must not leak.
    add("TwoRooms", "a wall of 10 cm between light and eye", HardBounds{.most = 8e-4, .leak = true},
        [](HardWorld& w) { twoRooms(w, 0.1f); });
    add("PaperWall", "a wall of 0.1 mm between light and eye", HardBounds{.most = 8e-4, .leak = true},
        [](HardWorld& w) { twoRooms(w, 1e-4f); });
    add("LitOnBothSides", "a sheet of paper between two lamps of unlike strength", {0.05, 0.12, 0.6, true},
        [](HardWorld& w) {
          twoRooms(w, 1e-4f);
          w.lamp({-0.2f, 0.3f, 0}, 0.1f);
        });
    add("Slit", "light through 2 mm from far behind", {5e-4, 1e-2, kInfinity, true}, [](HardWorld& w) {
      const uint32_t white = w.scene.material(vec3(0.7f), vec3(0), true);
      w.room({-1, -1, -1}, {1, 1, 3});
      w.scene.quad({-1, -1, 1}, {0.999f, 0, 0}, {0, 2, 0}, white);
      w.scene.quad({0.001f, -1, 1}, {0.999f, 0, 0}, {0, 2, 0}, white);
      w.lamp({0, 0, 2.9f}, 10);
      w.scene.camera = look({0, 0, 0.9f}, {0, 0, -1});
    });
    // Surfaces.
    add("Degenerate", "triangles without area, and every triangle twice", kRoom, [](HardWorld& w) {
      roomOf(w, 1);
      for (Mesh& mesh : w.scene.assets.meshes) {
        mesh.triangles.insert(mesh.triangles.end(), {{0, 1, 2}, {0, 2, 3}, {0, 0, 1}, {2, 2, 2}});
        mesh.primitives[0].triangleCount = 6;
      }
    });
    add("NoExtent", "every corner of every triangle is one point: a scene of no size", {0, 0}, [](HardWorld& w) {
      const uint32_t quad = w.scene.quad({0, 0, -1}, {1, 0, 0}, {0, 1, 0}, w.scene.material(vec3(0.7f)));
      Mesh& mesh = w.scene.assets.meshes[0];
      mesh.positions.assign(4, vec3(0, 0, -1));
      mesh.boundsObject = mesh.primitives[0].boundsObject = {vec3(0, 0, -1), vec3(0, 0, -1)};
      w.scene.place(quad, mat4(1));
      w.lamp({0, 0, -1});
      w.step = [&w, quad](int) { w.scene.place(quad, mat4(1)); };
    });
    add("OddNormals", "shading normals of length 0 and 10, and away from the front", {0.65, 1.05}, [](HardWorld& w) {
      roomOf(w, 1);
      w.scene.assets.meshes[0].normals.assign(4, vec3(0));
      w.scene.assets.meshes[2].normals.assign(4, vec3(0, 10, 0));
      w.scene.assets.meshes[4].normals.assign(4, vec3(0, 0, -1));
    });
    add("Mirrored", "instances of negative scale: the front is still the front", kRoom, [](HardWorld& w) {
      roomOf(w, 1);
      for (uint32_t i = 0; i < 6; ++i) w.scene.place(i, glm::scale(mat4(1), vec3(-1, 1, 1)));
    });
    add("Flattened", "an object scaled to nothing and to a sheet in turn", {0.55, 1.1}, [](HardWorld& w) {
      roomOf(w, 1);
      w.scene.box(vec3(-0.2f), vec3(0.2f), w.scene.material(vec3(0.5f)), false);
      w.step = [&w](int frame) {
        for (uint32_t i = 6; i < 12; ++i) w.scene.place(i, glm::scale(mat4(1), vec3(1, frame % 2 ? 1e-6f : 1, 1)));
      };
    });
    // Eyes.
    add("EyeInAWall", "the camera sees back sides only", {0, 1e-6}, [](HardWorld& w) {
      roomOf(w, 1);
      w.scene.camera = look({0, 0, 1.5f}, vec3(0));
    });
    add("FacingTheSky", "not one surface in view", {0, 0}, [](HardWorld& w) {
      w.scene.quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, w.scene.material(vec3(0.7f)));
      w.scene.sky = Sky(vec3(1));
      w.scene.camera = look({0, 1, 0}, {0, 2, -0.01f});
    });
    add("Horizon", "rays at the height of the eye are parallel to the floor below, and beside them is the sky",
        {0.006, 0.03, 1}, [](HardWorld& w) {
          const uint32_t white = w.scene.material(vec3(0.7f));
          w.scene.quad({-50, -1, 50}, {100, 0, 0}, {0, 0, -100}, white);
          w.scene.box({-1.5f, -0.99f, -7}, {-0.5f, -0.2f, -6}, white, false);
          w.lamp({0.5f, 0.5f, -5}, 20);
          w.scene.camera = look(vec3(0), {0, 0, -1});
          w.settings.smc.vpls = 512;  // mir: 50 times too bright with 64, twice with 512, right with 2048
          w.scene.camera.height = 21; // where that is so to the last bit
        });
    add("Teleport", "no frame sees what the one before saw", {0.65, 1.1}, [](HardWorld& w) {
      roomOf(w, 1);
      w.frames = 6;
      w.step = [&w](int frame) {
        const float side = frame % 2 ? -0.9f : 0.9f;
        w.scene.camera = look({side, 0.1f, side}, {-side, -0.1f, -side});
      };
    });
    add("NarrowView", "a field of view of 0.1°", {0.65, 1.15}, [](HardWorld& w) {
      roomOf(w, 1);
      w.scene.camera.fovY = glm::radians(0.1f);
    });
    add("WideView", "a field of view of 179°", {0.22, 0.42}, [](HardWorld& w) {
      roomOf(w, 1);
      w.scene.camera.fovY = glm::radians(179.0f);
    });
    add("OnePixel", "a picture of 1×1", {0.5, 1.5},
        [](HardWorld& w) { roomOf(w, 1), w.scene.camera.width = w.scene.camera.height = 1; });
    add("SevenByFive", "a picture that 4×4 subsets do not divide", {0.6, 1},
        [](HardWorld& w) { roomOf(w, 1), w.scene.camera.width = 7, w.scene.camera.height = 5; });
    add("Resized", "another size in every frame", {0.65, 1.1}, [](HardWorld& w) {
      roomOf(w, 1);
      w.frames = 5;
      w.step = [&w](int frame) { w.scene.camera.width = 9 * frame + 3, w.scene.camera.height = 37 - 8 * frame; };
    });
    // What comes and goes.
    add("LampsComeAndGo", "another set of lights in every frame", {1.2, 2.1}, [](HardWorld& w) {
      roomOf(w, 1);
      w.frames = 6;
      w.step = [&w](int frame) {
        w.scene.lights.clear();
        for (int i = 0; i < frame % 3; ++i) w.lamp({0.2f * float(i), 0.3f, 0.2f}).id = uint32_t(10 * frame + i);
      };
    });
    add("ObjectsComeAndGo", "a block is there in every other frame", {0.6, 1.05}, [](HardWorld& w) {
      roomOf(w, 1);
      w.scene.box(vec3(-0.3f), vec3(0.3f), w.scene.material(vec3(0.5f)), false);
      w.frames = 6;
      w.step = [&w,
                block = std::vector<InstanceView>(w.scene.instances.begin() + 6, w.scene.instances.end())](int frame) {
        w.scene.instances.resize(6);
        if (frame % 2 == 0) w.scene.instances.insert(w.scene.instances.end(), block.begin(), block.end());
        w.addedOrRemoved = {Aabb{vec3(-0.3f), vec3(0.3f)}};
      };
    });
    add("AllLightsRide", "every virtual light is on one object, and that moves", {0.18, 0.4, 1}, [](HardWorld& w) {
      w.room();
      w.scene.quad({-0.8f, -0.9f, 0.8f}, {1.6f, 0, 0}, {0, 0, -1.6f}, w.scene.material(vec3(0.9f)));
      spot(w.lamp({0, 0.5f, 0}, 20), {0, -1, 0}, 0.95f);
      w.settings.smc.bounces = 1;
      w.frames = 6;
      w.step = [&w](int frame) {
        w.scene.place(6, glm::translate(mat4(1), vec3(0.05f * float(frame), 0.02f * float(frame), 0)));
      };
    });
    add("HugeSteps", "an object jumps through the room, out of it, and far away", {0.6, 1.05}, [](HardWorld& w) {
      roomOf(w, 1);
      w.scene.box(vec3(-0.2f), vec3(0.2f), w.scene.material(vec3(0.5f)), false);
      w.frames = 5;
      w.step = [&w](int frame) {
        for (uint32_t i = 6; i < 12; ++i)
          w.scene.place(i, glm::translate(mat4(1), vec3(0, frame % 2 ? 1e5f : 0.0f, 0)));
      };
    });
    // Settings at their ends.
    add("OneVpl", "N = 1", {0, 3}, roomWith({{"smc.vpls", "1"}}));
    add("ThreeVpls", "N = 3: fewer lights than neighbours and subsets", {0.2, 2}, roomWith({{"smc.vpls", "3"}}));
    add("MoreNeighboursThanLights", "k = 1024 of 16", {0.5, 1.1},
        roomWith({{"smc.vpls", "16"}, {"smc.density", "knn"}, {"smc.neighbours", "1024"}}));
    add("NoMoves", "M_max = 0", kRoom, roomWith({{"smc.moves", "0"}}));
    add("AllMove", "M_max = N", {0.65, 1.05, 0.8}, roomWith({{"smc.moves", "64"}}));
    add("NoBounce", "B = 0: direct light alone", {0, 0}, roomWith({{"smc.bounces", "0"}}));
    add("ManyBounces", "B = 32", {0.9, 1.6}, roomWith({{"smc.bounces", "32"}}));
    add("NoBoundOfEnergy", "1/r² as it is: no disk, no rays for what it takes", {0.5, 1.5},
        roomWith({{"gather.disk", "0"}, {"gather.near", "0"}}));
    add("NoHistory", "every picture by itself", {0.5, 1.1}, roomWith({{"history.frames", "0"}}));
  });
  return cases;
}

} // namespace lambent::test

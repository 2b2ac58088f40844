#include "tests/hard/hard_worlds.h"

namespace lambent::test {

namespace {

/// A quad of `side` metres around `centre`, its front down, that sends `power` W.
void glow(HardWorld& w, const vec3& centre, float side, float power, bool doubleSided = false) {
  const float sides = doubleSided ? 2 : 1;
  const uint32_t material = w.scene.material(vec3(0), vec3(power / (sides * kPi * side * side)), doubleSided);
  w.scene.quad(centre - 0.5f * vec3(side, 0, side), {side, 0, 0}, {0, 0, side}, material);
}

/// Slats along both ways in the plane z = 1 of a room two rooms long: 100 holes, `open` of each way free.
void grille(HardWorld& w, float open) {
  const uint32_t white = w.scene.material(vec3(0.7f), vec3(0), true);
  w.room({-1, -1, -1}, {1, 1, 3});
  const float step = 0.2f, wide = (1 - open) * step;
  for (int i = 0; i < 10; ++i) {
    const float at = -1 + step * float(i);
    w.scene.quad({at, -1, 1}, {wide, 0, 0}, {0, 2, 0}, white);
    w.scene.quad({-1, at, 1}, {2, 0, 0}, {0, wide, 0}, white);
  }
  w.lamp({0.1f, 0.2f, 2.5f}, 20);
  w.scene.camera = look({0, 0, 0.9f}, {0, 0, -1});
}

} // namespace

void addLightCases(const Add& add, const Add& some) {
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
  add("ManyLamps", "three hundred: more than one block of lights, and trees over them", {0.65, 1.05}, [](HardWorld& w) {
    w.room();
    lamps(w, 300);
    w.settings.rsm.resolution = 16; // trees of so many lamps take long
    w.frames = 2;
  });
  // Half of the light comes from a spot that smc seldom finds, as paths from the eye do not: 0.42 W/m² of the 0.74 that
  // photons bring.
  some("LampAMillimetreFromAWall", "half of its light falls on a spot of a millimetre", {0.3, 0.95}, [](HardWorld& w) {
    w.room();
    w.lamp({0.999f, 0.3f, 0.2f});
  }).mostOfPresets = 2.7; // of many lights one may stand in the spot, and has the light of all around it
  // smc: 0.52 on the mean of eight seeds; photons: 0.75.
  some("LampACentimetreFromAWall", "half of its light falls on a spot of a centimetre", {0.38, 0.95}, [](HardWorld& w) {
    w.room();
    w.lamp({0.99f, 0.3f, 0.2f});
  }).mostOfPresets = 2.7;
  some("LampInThePlaneOfAWall", "the wall's own distance from its lamp is nothing", {0.25, 0.6}, [](HardWorld& w) {
    w.room();
    w.lamp({1, 0.3f, 0.2f});
  });
  some("LampAtTheEye", "the camera sees what the lamp lights, from the same point", {0.55, 1.1}, [](HardWorld& w) {
    w.room();
    w.lamp(w.scene.camera.position());
  });
  // Of the truth, 0.223, smc has 0.14 on the mean of eight seeds, with 64 lights as with 1024.
  some("LampBehindAGrille", "of what falls on a grille, holes of 4 cm let 4 % through", {0.08, 0.3, kInfinity, true},
       [](HardWorld& w) { grille(w, 0.2f); });
  some("SpotOfNoWidth", "a cone of 0 degrees divides by the difference of equal cosines", kRoom, [](HardWorld& w) {
    roomOf(w, 1);
    spot(w.lamp({0.5f, 0.5f, 0.5f}, 1e6f), {0, -1, 0.1f}, 1);
  });
  some("SpotOfAHalfSpace", "a cone as wide as a file may ask for: 180 degrees across", {0.6, 1}, [](HardWorld& w) {
    w.room();
    spot(w.lamp({0.1f, 0.9f, 0.2f}, 2), {0, -1, 0}, 0);
  });
  some("SpotOfAllDirections", "a cone of 360 degrees: what is behind the spot is lit too", kRoom, [](HardWorld& w) {
    roomOf(w, 1);
    spot(w.scene.lights[0], {0, -1, 0}, -1);
  });
  some("RangeOfNothing", "twelve lamps that reach 1e-30 m: the square of their range is 0", kRoom, [](HardWorld& w) {
    roomOf(w, 1);
    for (int i = 0; i < 12; ++i) w.lamp({0.08f * float(i) - 0.5f, 0.5f, 0}).range = 1e-30f;
  });
  some("RangeBeyondSquares", "a lamp that reaches 1e30 m: the square of its range is infinite", kRoom,
       [](HardWorld& w) {
         roomOf(w, 1);
         w.scene.lights[0].range = 1e30f;
       });
  some("RangeEndsShortOfMostWalls", "light that reaches a spot on one wall alone", {0.7, 1.4}, [](HardWorld& w) {
    w.room();
    w.lamp({0.6f, 0.1f, -0.5f}, 10).range = 0.6f;
  });
  some("LampsInOnePlace", "64 lamps with no distance between them: trees cannot part them", kRoom, [](HardWorld& w) {
    w.room();
    for (int i = 0; i < 64; ++i) w.lamp({0.1f, 0.3f, 0.2f}, 1.0f / 64);
    w.settings.rsm.resolution = 16;
  });
  some("OneLampAmongFaintOnes", "one in a hundred brings all the light", kRoom, [](HardWorld& w) {
    w.room();
    for (int i = 0; i < 99; ++i)
      w.lamp(0.9f * vec3(std::sin(float(i) * 12.99f), 0.5f, std::sin(float(i) * 37.72f)), 1e-9f);
    w.lamp({0.1f, 0.3f, 0.2f});
    w.settings.rsm.resolution = 16;
  });
  // Of the truth, 0.015, 64 lights have 0.009 on the mean of eight seeds, 1024 have 0.013.
  some("ShaftUnderTheSun", "a shaft 10 m deep: the sun lights a stripe high up", {0.004, 0.025}, [](HardWorld& w) {
    w.scene.box({-1, -5, -1}, {1, 5, 1}, w.scene.material(vec3(0.7f)), true);
    w.scene.instances.erase(w.scene.instances.begin() + 3); // the upper side
    LightView& sun = w.lamp(vec3(0), 10);
    sun.type = LightType::Directional;
    sun.direction = glm::normalize(vec3(1, -1, 0));
    w.scene.camera = look({0.1f, -4.8f, 0.9f}, {0, -4.5f, -1});
  });
  some("SunAlongTheFloor", "the sun's way lies in the plane of the floor: a wall alone is lit", {0.8, 1.25},
       [](HardWorld& w) {
         const uint32_t white = w.scene.material(vec3(0.7f));
         w.scene.quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, white);
         w.scene.quad({1, 0, -2}, {0, 0, 4}, {0, 2, 0}, white);
         LightView& sun = w.lamp(vec3(0), 10);
         sun.type = LightType::Directional;
         sun.direction = {1, 0, 0};
         w.scene.camera = look({-1, 1, 0}, {1, 0.2f, 0});
       });
  some("SkyAlone", "no lamp: a yard of 2 m by 2 m under an even sky", {0.48, 0.76}, [](HardWorld& w) {
    roomOf(w, 1);
    w.scene.lights.clear();
    w.scene.instances.erase(w.scene.instances.begin() + 3);
    w.scene.sky = Sky(vec3(1));
  });
  HardCase& hole =
      some("SkyThroughAHole", "of the sky, a hole of 20 cm brings all the light", {0.1, 1}, [](HardWorld& w) {
        const uint32_t white = w.scene.material(vec3(0.7f), vec3(0), true);
        roomOf(w, 1);
        w.scene.lights.clear();
        w.scene.instances.erase(w.scene.instances.begin() + 3);
        w.scene.quad({-1, 1, -1}, {0.9f, 0, 0}, {0, 0, 2}, white);
        w.scene.quad({0.1f, 1, -1}, {0.9f, 0, 0}, {0, 0, 2}, white);
        w.scene.quad({-0.1f, 1, -1}, {0.2f, 0, 0}, {0, 0, 0.9f}, white);
        w.scene.quad({-0.1f, 1, 0.1f}, {0.2f, 0, 0}, {0, 0, 0.9f}, white);
        w.scene.sky = Sky(vec3(100));
      });
  hole.tooFineForVolumes = hole.tooFineForCubes = true;
  // All walls send 1 W/(m² sr): π a (1 + a + a²) W/m² by indirect light, wherever one looks.
  some("Furnace", "every point is a lamp and a mirror of all others", {2.6, 2.9, 0.3},
       [](HardWorld& w) { w.scene.box(vec3(-1), vec3(1), w.scene.material(vec3(0.5f), vec3(1)), true); });
  some("FurnaceOf1e12", "the same beyond half floats, in which emission is drawn", {2.6e12, 2.9e12, 0.3},
       [](HardWorld& w) { w.scene.box(vec3(-1), vec3(1), w.scene.material(vec3(0.5f), vec3(1e12f)), true); });
  some("BlackGlow", "a lamp of 10⁶ W/(m² sr) whose texture is black: no texel sends light", {0, 1e-6},
       [](HardWorld& w) {
         w.room();
         glow(w, {0, 0.9f, 0}, 0.5f, 1e6f);
         w.scene.assets.materials.back().emissiveTexture = w.scene.texture(2, std::vector<u8vec4>(4, {0, 0, 0, 255}));
       });
  // Where one texel of 1024 sends it, seven sets of 64 lights in eight have none of the light (truth: 0.76).
  some("GlowOfOneTexelInSixteen", "a texel of 16 sends all the light", {0.4, 1.3}, [](HardWorld& w) {
    w.room();
    glow(w, {0, 0.9f, 0}, 1, 4 * kPi * 16);
    std::vector<u8vec4> texels(16, {0, 0, 0, 255});
    texels[5] = {255, 255, 255, 255};
    w.scene.assets.materials.back().emissiveTexture = w.scene.texture(4, texels);
  });
  some("GlowSeenFromBehind", "a lamp that sends light to one side alone, away from the room",
       HardBounds{.most = 1e-3, .leak = true}, [](HardWorld& w) {
         w.room();
         glow(w, {0, -1.001f, 0}, 1, 100);
       });
  some("GlowOnBothSides", "a sheet that sends light to both sides, edge on", {0.65, 1}, [](HardWorld& w) {
    w.room();
    glow(w, {0, 0.1f, 0}, 0.5f, 4 * kPi, true);
    w.scene.camera = look({0.1f, 0.1f, 0.9f}, {0, 0.1f, -1});
  });
  some("GlowingNeedle", "a lamp of 2 m by a hundredth of a millimetre", {0.65, 1.05}, [](HardWorld& w) {
    w.room();
    w.scene.quad({-0.9f, 0.5f, 0}, {1.8f, 0, 0}, {0, 0, 1e-5f},
                 w.scene.material(vec3(0), vec3(4 / (2 * 1.8e-5f)), true));
  });
  some("GlowOfNoArea", "lamps of two and of one corner among others: their power is 0", kRoom, [](HardWorld& w) {
    roomOf(w, 1);
    for (const vec3& e2 : {vec3(0.5f, 0, 0), vec3(0)}) {
      glow(w, {0, 0.2f, 0}, 0.5f, 1e6f);
      Mesh& mesh = w.scene.assets.meshes.back();
      const vec3 p = mesh.positions[0];
      mesh.positions = {p, p + e2, p + e2, p};
    }
  });
  some("Sparks", "a thousand specks of a tenth of a millimetre", {0.65, 1}, [](HardWorld& w) {
    w.room();
    const uint32_t spark = w.scene.material(vec3(0), vec3(4 / (2 * 1000 * 1e-8f)), true);
    for (int i = 0; i < 1000; ++i) {
      const vec3 at(std::sin(float(i) * 12.99f), std::sin(float(i) * 78.23f), std::sin(float(i) * 37.72f));
      w.scene.quad(0.9f * at, {1e-4f, 0, 0}, {0, 0, 1e-4f}, spark);
    }
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
  some("RedLampInAGreenRoom", "there is light everywhere, and none of it is reflected", {0, 1e-9}, [](HardWorld& w) {
    w.room(vec3(-1), vec3(1), {0, 0.7f, 0});
    w.lamp(vec3(0)).intensity = {1, 0, 0};
  });
  some("BlueLamp", "what is drawn by luminance has a fourteenth of it", kRoom, [](HardWorld& w) {
    roomOf(w, 1);
    w.scene.lights[0].intensity = {0, 0, 3};
  });
}

} // namespace lambent::test

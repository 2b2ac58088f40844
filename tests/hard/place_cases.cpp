#include "tests/hard/hard_worlds.h"

namespace lambent::test {

void addPlaceCases(const Add& add, const Add& some) {
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
  some("ARoomAtTenKilometres", "2 m at 10 km: positions in steps of a millimetre", {0.6, 1.1},
       [](HardWorld& w) { roomOf(w, 1, vec3(1e4f, 1e4f, -1e4f)); });
  some("AHouseAtAThousandKilometres", "40 m at 1000 km: positions in steps of 6 cm", {0.6, 1.1},
       [](HardWorld& w) { roomOf(w, 20, vec3(1e6f, 0, 0)); });
  // Views of lamps begin 10⁻⁴ of the world's size off: 14 m here, behind the walls. Rays start 2⁻¹⁹ of the world's size
  // off a surface, which are 10 cm here. With a world of 1000 km they would be 2 m, as far as the room is high.
  HardCase& landscape = some("ARoomInALandscape", "a room of 2 m in a world of 100 km", kRoom, [](HardWorld& w) {
    roomOf(w, 1);
    w.scene.quad({-5e4f, -10, 5e4f}, {1e5f, 0, 0}, {0, 0, -1e5f}, w.scene.material(vec3(0.7f)));
  });
  landscape.tooFineForMaps = landscape.tooFineForVolumes = landscape.tooFineForCubes = true;
  HardCase& matchbox = some("AMatchboxInAHall", "a lit room of 4 mm within one of 40 m", kRoom, [](HardWorld& w) {
    w.room(vec3(-20), vec3(20));
    roomOf(w, 2e-3f);
  });
  matchbox.tooFineForMaps = matchbox.tooFineForVolumes = matchbox.tooFineForCubes = true;
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
  some("Onion", "ten shells a tenth of a millimetre apart between the eye and a lamp of 10 W/sr",
       HardBounds{.most = 2e-3, .leak = true}, [](HardWorld& w) {
         for (int i = 0; i < 10; ++i) w.room(vec3(-1 - 1e-4f * float(i)), vec3(1 + 1e-4f * float(i)));
         w.scene.box(vec3(-1.001f), vec3(1.001f), w.scene.material(vec3(0.7f)), false);
         w.room(vec3(-2), vec3(2));
         w.lamp({0, 1.5f, 0}, 10);
         fineMaps(w);
       });
  some("DoorAjar", "a door that leaves a gap of a millimetre", HardBounds{.most = 2e-3, .leak = true},
       [](HardWorld& w) {
         doorway(w);
         slide(w, 0.001f);
       });
  // 64 lights stand for 25 cm each, 1 cm from what they light: sets bring 0.8 to 1.8 of the truth, 9e-5.
  HardCase& plates =
      some("BetweenPlates", "eye and lamp between plates 1 cm apart: all rays graze", {4e-5, 2.5e-4}, [](HardWorld& w) {
        w.room({-1, -0.005f, -1}, {1, 0.005f, 1});
        w.lamp({0.1f, 0, -0.2f}, 0.01f);
        w.scene.camera = look({0.1f, 0, 0.9f}, {0, -1e-3f, -1});
        w.scene.camera.near = 1e-4f;
      });
  plates.tooFineForMaps = plates.tooFineForVolumes = true;
  some("AlphaOneWall", "a wall whose mask lets nothing through", HardBounds{.most = 8e-4, .leak = true},
       [](HardWorld& w) {
         twoRooms(w, 0.01f);
         Material& mask = w.scene.assets.materials[0];
         mask.alphaMode = AlphaMode::Mask;
         mask.baseColorTexture = w.scene.texture(1, {{255, 255, 255, 255}});
         mask.alphaCutoff = 1;
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
  some("EyeInThePlaneOfAWall", "half of what is seen is neither in front of the wall nor behind", {0.3, 0.5},
       [](HardWorld& w) {
         roomOf(w, 1);
         w.scene.camera = look({1, 0.1f, 0.9f}, {1, -0.1f, -1});
         w.scene.camera.near = 1e-3f;
       });
  some("NearPlaneAtTheEye", "1e-9 m: depths are steps of the last digit", kRoom, [](HardWorld& w) {
    roomOf(w, 1);
    w.scene.camera.near = 1e-9f;
  });
  some("NearPlaneBehindTheWalls", "all that rays meet is cut off", {0, 1e-6}, [](HardWorld& w) {
    roomOf(w, 1);
    w.scene.camera.near = 10;
  });
  some("ParallelView", "rays of the camera have no point in common", {0.65, 1.05}, [](HardWorld& w) {
    roomOf(w, 1);
    w.scene.camera.orthoHalfHeight = 0.5f;
  });
  some("ARowOfPixels", "a picture of 4096×1", {0.02, 0.045},
       [](HardWorld& w) { roomOf(w, 1), w.scene.camera.width = 4096, w.scene.camera.height = 1; });
  some("AColumnOfPixels", "a picture of 1×500", {0.65, 1.05},
       [](HardWorld& w) { roomOf(w, 1), w.scene.camera.width = 1, w.scene.camera.height = 500; });
}

} // namespace lambent::test

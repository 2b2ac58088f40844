#include "tests/hard/hard_worlds.h"

namespace lambent::test {

namespace {

LightView& sun(HardWorld& w, const vec3& direction, float irradiance) {
  LightView& light = w.lamp(vec3(0), irradiance);
  light.type = LightType::Directional;
  light.direction = glm::normalize(direction);
  return light;
}

/// The camera of a room in which all is carried along.
void carried(HardWorld& w, const mat4& by) {
  for (uint32_t i = 0; i < w.scene.instances.size(); ++i) w.scene.place(i, by * w.scene.instances[i].worldFromObject);
  for (LightView& l : w.scene.lights) {
    l.position = vec3(by * vec4(l.position, 1));
    l.direction = mat3(by) * l.direction;
  }
  w.scene.camera.worldFromView = by * w.scene.camera.worldFromView;
}

/// A room with a coloured wall, a block and two lamps, one of them a glowing sheet: no side is like another.
void unlikeSides(HardWorld& w) {
  w.room();
  w.scene.assets.materials.push_back(w.scene.assets.materials[0]);
  w.scene.assets.materials.back().baseColor = {0.7f, 0.1f, 0.1f};
  w.scene.assets.meshes[0].primitives[0].material = 1;
  w.scene.box({-0.7f, -1, -0.6f}, {-0.2f, -0.2f, -0.2f}, w.scene.material(vec3(0.5f)), false);
  w.scene.quad({0.4f, 0.99f, -0.5f}, {0.4f, 0, 0}, {0, 0, 0.4f}, w.scene.material(vec3(0), vec3(4)));
  w.lamp({0.5f, 0.3f, 0.4f}, 0.5f);
  w.settings.smc.vpls = 256;
}

/// As a mirror beside it shows the world.
void mirror(HardWorld& w) {
  const mat4 flip = glm::scale(mat4(1), vec3(-1, 1, 1));
  w.scene.turn(flip);
  for (LightView& l : w.scene.lights) l.position.x *= -1, l.direction.x *= -1;
  const vec3 eye = w.scene.camera.position(), ahead = -vec3(w.scene.camera.worldFromView[2]);
  w.scene.camera.worldFromView =
      look(vec3(-eye.x, eye.y, eye.z), vec3(-eye.x - ahead.x, eye.y + ahead.y, eye.z + ahead.z)).worldFromView;
}

} // namespace

void addMovingCases(const Add& add, const Add& some) {
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
      for (uint32_t i = 6; i < 12; ++i) w.scene.place(i, glm::translate(mat4(1), vec3(0, frame % 2 ? 1e5f : 0.0f, 0)));
    };
  });
  some("LampComesThroughAWall", "it is outside, in the wall, and inside", {0.65, 1.05}, [](HardWorld& w) {
    twoRooms(w, 0.2f);
    w.frames = 8;
    w.step = [&w](int frame) { w.scene.lights[0].position.x = std::max(0.1f, 2.2f - 0.35f * float(frame)); };
  });
  some("LampLeavesThroughAWall", "what lit the room is behind its wall two frames later",
       HardBounds{.most = 8e-4, .leak = true}, [](HardWorld& w) {
         twoRooms(w, 0.2f);
         w.scene.lights[0].position.x = 0.5f;
         w.frames = 6;
         w.step = [&w](int frame) { w.scene.lights[0].position.x = 0.5f + 0.3f * float(frame); };
       });
  some("DoorOpens", "a dark room is lit within frames", {0.9, 2.2, kInfinity, true}, [](HardWorld& w) {
    doorway(w);
    w.frames = 8;
    w.step = [&w](int frame) { slide(w, 0.1f * float(frame)); };
  });
  some("DoorSlams", "a lit room is dark at once", HardBounds{.most = 1e-3, .leak = true}, [](HardWorld& w) {
    doorway(w);
    slide(w, 0.7f);
    w.frames = 6;
    w.step = [&w](int frame) { slide(w, frame < 3 ? 0.7f : -0.04f); };
  });
  some("LampBlinks", "on and off with every frame, at last on", {0.65, 1.05}, [](HardWorld& w) {
    roomOf(w, 1);
    w.frames = 7;
    w.step = [&w](int frame) { w.scene.lights[0].intensity = vec3(frame % 2 ? 0.0f : 1.0f); };
  });
  some("LampBlinksOut", "on and off with every frame, at last off: nothing glows on", {0, 1e-6}, [](HardWorld& w) {
    roomOf(w, 1);
    w.frames = 6;
    w.step = [&w](int frame) { w.scene.lights[0].intensity = vec3(frame % 2 ? 0.0f : 1.0f); };
  });
  some("LightOf1e12ThenOf1e-12", "the frame before had 10²⁴ times the light", {0.65e-12, 1.05e-12}, [](HardWorld& w) {
    roomOf(w, 1);
    w.frames = 6;
    w.step = [&w](int frame) { w.scene.lights[0].intensity = vec3(frame % 2 ? 1e-12f : 1e12f); };
  });
  some("SunGoesRound", "a quarter of a turn with every frame, over a yard", {1, 1.8}, [](HardWorld& w) {
    w.room();
    w.scene.instances.erase(w.scene.instances.begin() + 3);
    sun(w, {1, -1, 0}, 10);
    w.frames = 7;
    w.step = [&w](int frame) {
      const float angle = 0.5f * kPi * float(frame);
      w.scene.lights[0].direction = glm::normalize(vec3(std::cos(angle), -1, std::sin(angle)));
    };
  });
  some("SkyBlinks", "a sky of 1 W/(m² sr) and a black one in turn, at last the bright one", {0.45, 0.8},
       [](HardWorld& w) {
         w.room();
         w.scene.instances.erase(w.scene.instances.begin() + 3);
         w.scene.sky = Sky(vec3(1));
         w.frames = 5;
         w.step = [&w](int frame) { w.scene.sky = Sky(vec3(frame % 2 ? 0.0f : 1.0f)); };
       });
  // To those who are carried along all stands still. With 48 maps of 256 drawn anew in a frame, as by default, 9 % of
  // the light is lost: walls are where maps still have others. With all maps anew none is.
  const auto standsStill = [](HardWorld& w) {
    unlikeSides(w);
    w.frames = 6;
  };
  some("Train", "the world, its lamp and the camera go 3 m with every frame", {0.33, 0.52},
       [standsStill](HardWorld& w) {
         standsStill(w);
         w.step = [&w](int) { carried(w, glm::translate(mat4(1), vec3(3, 0.5f, -1))); };
       })
      .twin = {.make = standsStill, .apart = 0.16};
  some("Carousel", "the same, turned by 40° with every frame, with maps drawn anew", {0.33, 0.52},
       [standsStill](HardWorld& w) {
         standsStill(w);
         w.settings.shadow.refresh = 256;
         w.step = [&w](int) { carried(w, glm::rotate(mat4(1), glm::radians(40.0f), glm::normalize(vec3(1, 2, 0)))); };
       })
      .twin = {.make = standsStill};
  some("MirroredWorld", "every transform has a negative determinant", {0.33, 0.52}, [](HardWorld& w) {
    unlikeSides(w);
    mirror(w);
  }).twin = {unlikeSides, true};
  some("MirroredWorldInMotion", "the same while its block moves", {0.33, 0.52},
       [](HardWorld& w) {
         unlikeSides(w);
         mirror(w);
         w.frames = 5;
         w.step = [&w](int) { w.scene.move(6, {-0.1f, 0, 0}, 12); };
       })
      .twin = {[](HardWorld& w) {
                 unlikeSides(w);
                 w.frames = 5;
                 w.step = [&w](int) { w.scene.move(6, {0.1f, 0, 0}, 12); };
               },
               true};
  some("TurnedInsideOutAndBack", "scales change their sign with every frame", kRoom, [](HardWorld& w) {
    roomOf(w, 1);
    w.scene.box(vec3(-0.15f), vec3(0.15f), w.scene.material(vec3(0.7f)), false);
    w.frames = 6;
    w.step = [&w](int frame) {
      for (uint32_t i = 0; i < 12; ++i)
        w.scene.place(i, glm::scale(mat4(1), vec3(frame % 2 ? -1 : 1, 1, frame % 3 ? 1 : -1)));
    };
  }).leastOfPresets = 0.85; // 48 of 1024 maps are drawn anew in a frame
  some("GrowsFromNothing", "a block of scale 0, 0.2, 0.4, …: the first has no inverse", {0.5, 0.95}, [](HardWorld& w) {
    roomOf(w, 1);
    w.scene.box(vec3(-0.2f), vec3(0.2f), w.scene.material(vec3(0.5f)), false);
    const auto scaled = [&w](float scale) {
      for (uint32_t i = 6; i < 12; ++i) w.scene.place(i, glm::scale(mat4(1), vec3(scale)));
    };
    scaled(0);
    w.frames = 6;
    w.step = [scaled](int frame) { scaled(0.2f * float(frame)); };
  });
  some("Breathes", "a room, its lamp and its eye are a hundredth as large in every other frame", kRoom,
       [](HardWorld& w) {
         roomOf(w, 1);
         w.frames = 5;
         w.step = [&w](int frame) {
           const float unit = frame % 2 ? 0.01f : 1;
           for (uint32_t i = 0; i < 6; ++i) w.scene.place(i, glm::scale(mat4(1), vec3(unit)));
           w.scene.lights[0].position = unit * vec3(0.1f, 0.3f, 0.2f);
           w.scene.lights[0].intensity = vec3(unit * unit);
           w.scene.camera = look(unit * vec3(0.1f, 0.1f, 0.9f), -unit * vec3(0, 0.1f, 1));
           w.scene.camera.near = 0.01f * unit;
         };
       });
  some("BornFromNothing", "no surface and no lamp at first", kRoom, [](HardWorld& w) {
    roomOf(w, 1);
    const std::vector<InstanceView> walls = std::exchange(w.scene.instances, {});
    const std::vector<LightView> lights = std::exchange(w.scene.lights, {});
    w.frames = 6;
    w.step = [&w, walls, lights](int frame) {
      if (frame == 2) w.scene.lights = lights;
      if (frame != 3) return;
      w.scene.instances = walls;
      w.addedOrRemoved = {Aabb{vec3(-1), vec3(1)}};
    };
  });
  some("AllVanishes", "what was lit is gone, and its lights stand on nothing", {0, 0}, [](HardWorld& w) {
    roomOf(w, 1);
    w.frames = 5;
    w.step = [&w](int frame) {
      if (frame != 3) return;
      w.scene.instances.clear();
      w.addedOrRemoved = {Aabb{vec3(-1), vec3(1)}};
    };
  });
  some("WallsComeAndGo", "all six are there in every other frame", {0.65, 1.05}, [](HardWorld& w) {
    roomOf(w, 1);
    w.frames = 7;
    w.step = [&w, walls = w.scene.instances](int frame) {
      w.scene.instances.clear();
      if (frame % 2 == 0) w.scene.instances = walls;
      w.addedOrRemoved = {Aabb{vec3(-1), vec3(1)}};
    };
  });
  some("EyeThroughAWall", "it is outside, in the wall, and inside", {0.65, 1.05}, [](HardWorld& w) {
    roomOf(w, 1);
    w.scene.box(vec3(-1.1f), vec3(1.1f), w.scene.material(vec3(0.7f)), false);
    w.frames = 8;
    const auto at = [&w](int frame) {
      w.scene.camera = look({0.1f, 0.1f, 1.25f - 0.05f * float(frame)}, {0, -0.1f, -1});
    };
    at(0);
    w.step = at;
  });
  some("LampOnTheForehead", "lamp and eye are one point and walk along a wall", {0.5, 1.05}, [](HardWorld& w) {
    roomOf(w, 1);
    w.frames = 6;
    const auto at = [&w](int frame) {
      w.scene.camera = look({0.9f, 0.1f, 0.9f - 0.1f * float(frame)}, {0, -0.1f, -1});
      w.scene.lights[0].position = w.scene.camera.position();
    };
    at(0);
    w.step = at;
  });
  some("Waves", "the floor is another mesh in every frame", {0.65, 1.15}, [](HardWorld& w) {
    roomOf(w, 1);
    const uint32_t floor =
        w.scene.add(sheet(12, w.scene.material(vec3(0.7f), vec3(0), true)),
                    glm::translate(mat4(1), vec3(0, -0.8f, 0)) * glm::rotate(mat4(1), -0.5f * kPi, vec3(1, 0, 0)));
    w.frames = 5;
    w.step = [&w, floor](int frame) {
      w.scene.reshape(floor, waves(w.scene.assets.meshes.back(), 0.15f, float(frame)));
    };
  });
  some("CollapsesToAPoint", "a sheet's corners are one point in every other frame", kRoom, [](HardWorld& w) {
    roomOf(w, 1);
    const uint32_t cloth =
        w.scene.add(sheet(4, w.scene.material(vec3(0.7f), vec3(0), true)), glm::scale(mat4(1), vec3(0.3f)));
    w.frames = 6;
    w.step = [&w, cloth](int frame) {
      std::vector<vec3> positions = w.scene.assets.meshes.back().positions;
      if (frame % 2)
        for (vec3& p : positions) p = vec3(0.1f);
      w.scene.reshape(cloth, std::move(positions));
      auto shape = std::make_shared<DeformedMesh>(*w.scene.instances[cloth].deformed);
      shape->normals.assign(shape->normals.size(), vec3(0, 0, 1)); // as deform() leaves those without a length
      w.scene.instances[cloth].deformed = shape;
    };
  });
  some("SparksFly", "a hundred glowing specks, each somewhere else in every frame", {0.5, 0.95}, [](HardWorld& w) {
    w.room();
    const uint32_t spark = w.scene.material(vec3(0), vec3(4 / (2 * 100 * 1e-6f)), true);
    for (int i = 0; i < 100; ++i) w.scene.quad(vec3(0), {1e-3f, 0, 0}, {0, 0, 1e-3f}, spark);
    const auto at = [&w](int frame) {
      for (uint32_t i = 0; i < 100; ++i) {
        const float k = float(i) + 100 * float(frame);
        w.scene.place(6 + i, glm::translate(mat4(1), 0.9f * vec3(std::sin(k * 12.99f), std::sin(k * 78.23f),
                                                                 std::sin(k * 37.72f))));
      }
    };
    at(0);
    w.frames = 4;
    w.step = at;
  });
}

} // namespace lambent::test

// A scene made by hand as rays and light paths see it, when nothing moves.
#pragma once

#include "engine/trace/embree_query.h"
#include "gi/lighting/light_set.h"
#include "tests/support/hand_scene.h"

namespace lambent::test {

struct TracedScene {
  SceneView view;
  EmbreeQuery rays;
  LightSet lights;

  explicit TracedScene(const HandScene& scene) : view(scene.view()), rays(scene.assets), lights(collectLights(view)) {
    rays.update(view, true);
  }
};

} // namespace lambent::test

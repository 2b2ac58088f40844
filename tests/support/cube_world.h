// A layered depth cube over rooms made by hand.
#pragma once

#include "gi/cube/layered_cube.h"
#include "gi/lighting/light_set.h"
#include "tests/support/hand_scene.h"

#include <memory>

namespace lambent::test {

inline CubeSettings smallCube(CubeVisibility sights = CubeVisibility::Rays, int resolution = 32) {
  return {.resolution = resolution, .visibility = sights, .hemicube = 64};
}

inline VirtualLight lightAt(const vec3& position, const vec3& normal, const vec3& power, float area = 0.01f) {
  return {position, normal, normal, power / area, area, true};
}

/// Rooms made by hand, and a cube over them.
struct CubeWorld {
  HandScene scene;
  std::unique_ptr<EmbreeQuery> rays;
  SceneView view;
  GatherSettings gather;
  std::vector<VirtualLight> lights;

  void place() {
    rays = std::make_unique<EmbreeQuery>(scene.assets);
    view = scene.view();
    rays->update(view, true);
  }
  /// A closed one.
  void room() {
    scene.box(vec3(-1), vec3(1), scene.material(vec3(0.5f)), true);
    place();
  }
  CubeInputs inputs(const CubeSettings& settings) {
    return {view.boundsWorld, *rays, kNothingMoved, false, lights, ~0u, settings, gather};
  }
  CubeSurfaces surfaces(const CubeSettings& settings = smallCube()) const {
    CubeSurfaces built;
    RayCounts counts;
    built.build(view.boundsWorld, settings, *rays, counts);
    EXPECT_GT(counts.closest, 0u);
    return built;
  }
};

} // namespace lambent::test

// A room whose virtual lights stay the same in every picture, and views of it in which something or nothing changes.
#pragma once

#include "frames.h"

namespace lambent::test {

class StillRoomTest : public GlTest {
 protected:
  StillRoomTest() {
    settings.smc = {.vpls = 512, .moves = 0, .points = 512, .warmup = 20};
    settings.gather.near = 0;
    settings.shadow.maker = ShadowMaker::Rays;
    settings.image.exposure = 1;
    room.scene.lamp({0.4f, 0.7f, 0.4f});
  }

  SceneView view(const SceneChanges& changes) const {
    SceneView v = room.scene.view(changes);
    for (const LightView& l : v.lights) const_cast<LightView&>(l).changed = changes.lights;
    return v;
  }
  SceneView still() const { return view(kStill); }
  /// So many pictures of a view that stands.
  void stand(Viewer& gi, int pictures) const {
    gi.run(room.scene.view());
    for (int i = 1; i < pictures; ++i) gi.run(still());
  }

  Room room;
  Settings settings;
};

} // namespace lambent::test

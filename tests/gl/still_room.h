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

/// Its light averaged over frames, and what they come to.
class AveragedRoomTest : public StillRoomTest {
 protected:
  AveragedRoomTest() {
    settings.gather.mode = GatherMode::Interleaved;
    settings.gather.checks = false;
    settings.shadow.resolution = 64;
    settings.history.frames = 16;
    room.scene.size(96, 72);
  }

  static Settings with(Settings s, GatherMode mode, int frames) {
    s.gather.mode = mode;
    s.history.frames = frames;
    return s;
  }
  /// Every light at every pixel.
  Image allLights() const { return firstFrame(with(settings, GatherMode::Full, 0), room.scene.view()); }
};

} // namespace lambent::test

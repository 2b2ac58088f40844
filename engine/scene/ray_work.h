// What a ray has to look at on its way: scenes whose rays are slow, whatever traces them.
#pragma once

#include "engine/scene/scene.h"

namespace lambent {

/// Means over rays, each from in front of a surface in a random direction to where it ends. Rays that only lead to
/// where others begin are not counted. Of three means the largest: from surfaces by their area, from what rays meet
/// that leave what a picture by the file's first camera (or the default view) shows, and of what that camera's own
/// pass.
struct RayWork {
  float boxes = 0;  // of triangles, which it enters: no tree of boxes can do without a look at what is in them; of the
                    // camera's own rays the hidden backs that they pass
  float cutOut = 0; // triangles that it passes where they are cut out
  vec3 place{0};    // world space; where the ray begins that has most to look at

  /// In boxes: to ask a texture whether a triangle is cut out takes as long as these many.
  float sum() const { return boxes + kCutOut * cutOut; }
  static constexpr float kCutOut = 7;
};

/// Of a scene as it stands. Draws 256 places on its triangles by their area, fewer (down to 64) where it has more than
/// a million of them, and goes on from each to what is met, twice: where many triangles share a place, only what can be
/// seen of them counts. As many rays leave the camera, and 16 times as many what they meet.
RayWork rayWork(const Scene& scene);
/// The same of what one camera shows alone.
RayWork rayWork(const Scene& scene, const CameraView& camera);

/// Throws InputError where rays would take too long, unless the file is trusted; notes what they take in the scene's
/// rayWork. loadScene asks for the scene, with its file's first camera; others that are looked through are asked for.
void requireQuickRays(Scene& scene, FileTrust trust);
void requireQuickRays(Scene& scene, const CameraView& camera, FileTrust trust);

} // namespace lambent

// Direct light of what glows by brute force: many rays to the lamps from every pixel, and nothing that a frame does.
#pragma once

#include "engine/image/image.h"
#include "engine/view/scene_view.h"

namespace lambent {

/// Radiance towards the camera, albedo/π times the irradiance of emissive surfaces at what the middles of pixels meet,
/// without emission of their own; `rays` from each pixel, in strata over the lamps in proportion to power. Lambert; a
/// lamp's texture counts with its mean. Pixels that glow or show nothing are 0.
struct LampTruth {
  Image light;
  Image noise;    // of light: half the difference of two halves of the rays, rather more than the standard error
  Image distance; // along the view direction, metres; 0: such a pixel
  Image normal;
};
LampTruth traceLamps(const SceneView& view, int rays);

} // namespace lambent

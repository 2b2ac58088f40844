// What smooth surfaces mirror of the scene: rays by their lobes (gather.mirrors). Virtual lights are points, and a
// sharp lobe would show each of them; below about kLeastVplRoughness (shaders/shared/ggx.h) rays take over mirrorShare
// of their light. What a ray meets is Lambert, as wherever light is reflected on its way to the camera's surfaces, and
// its radiance is one light path's. Lamps and skies that rays meet are direct light.
#pragma once

#include "engine/trace/ray_query.h"
#include "gi/lighting/light_set.h"

#include <span>
#include <vector>

namespace lambent {

/// Pixels of an image, from `lo` up to but not `hi`; rows from the top.
struct PixelBox {
  glm::ivec2 lo{0}, hi{1 << 30};
  bool empty() const { return lo.x >= hi.x || lo.y >= hi.y; }
};

/// Where the view may show a surface that mirrors: instances that have one, by their bounds.
PixelBox mirrorsOf(const SceneView& view);

struct MirrorInputs {
  const SceneView& view;
  const RayQuery& rays;
  const LightSet& lights;
  PixelBox pixels = {}; // that are asked; the others get none
  int samples = 1;      // of each
  int bounces = 1;      // of light that reaches what is mirrored, as SmcSettings::bounces
  /// What the image has at its pixels, as makeReceiver takes it, rows from the bottom: virtual lights leave the share
  /// of this. Empty: what the surface has where a ray through the pixel's centre meets it.
  std::span<const vec4> finish = {};
  bool normalMaps = false;
  uint32_t seed = 1;
  uint32_t sample = 0; // number of the first one: those of a mean follow each other
};

/// Traces mirrorShare of the lobes' light that surfaces reflect, at pixel centres of the view's camera, row by row from
/// the top: W/(m² sr) over glossyTint. Its expectation is that of path tracing.
std::vector<vec3> traceMirrors(const MirrorInputs& in, RayCounts& counts);

} // namespace lambent

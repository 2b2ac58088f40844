// What every pass that looks out from a punctual light must agree on: which lights count, how many views one takes, and
// how its light falls off.
#pragma once

#include "engine/view/scene_view.h"

namespace lambent {

/// Which views a light takes: six faces around a point; one square around a cone; parallel rays.
enum class LightKind { Cube, Spot, Sun };

/// Spots wider than 70° from their axis take a cube: one perspective would have hardly any texels in the middle.
LightKind kindOf(const LightView& light);

/// Says whether the light brings any light at all.
bool shines(const LightView& light);

/// Near plane of views from lights in a scene of these bounds, metres. What is nearer is the lamp's own housing as
/// often as not. Relative to the bounds, since scenes come in all sizes.
float nearPlane(const Aabb& bounds);

// Reference formulas of KHR_lights_punctual.
vec2 coneFactors(
    const LightView& light); // (s, o): the light falls off as clamp(s cosθ + o, 0, 1)²; (0, 1): it does not
float inverseRange4(const LightView& light); // 1/range⁴, 0 when the range is infinite

} // namespace lambent

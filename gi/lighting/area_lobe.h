// Table of linearly transformed cosines for the lobe of shaders/shared/ggx.h: how area lights light glossy receivers.
// Read by shaders/shared/area_lobe.h.
#pragma once

#include "shaders/shared/area_lobe.h"

#include <vector>

namespace lambent {

/// A linearly transformed cosine.
struct FittedLobe {
  vec4 map{1, 0, 0, 1}; // inLobeSpace
  float share = 0;      // of uniform light from above that the lobe reflects
  double error = 0;     // what fits are compared by
};

/// Fits the map to lobe times cosine by Levenberg and Marquardt's method from `start`. `f0`: of Schlick's term.
FittedLobe fitLobe(float alpha, float cosViewer, float f0, const vec4& start);

/// All entries, row by row: kLobeRoughnesses in a row, kLobeAngles rows. Made on the first call, 0.3 s on one core.
const std::vector<AreaLobe>& lobeTable();

/// Between entries as a texture with linear filter has it. `place`: lobePlace.
AreaLobe lobeAt(const std::vector<AreaLobe>& table, const vec2& place);

/// Radiance towards the viewer that a receiver's lobe makes of a piece where nothing is between.
vec3 lobeRadiance(const std::vector<AreaLobe>& table, const AreaPiece& piece, const vec3& position,
                  const Receiver& receiver);

} // namespace lambent

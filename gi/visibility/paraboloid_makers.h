// Shared by the two source files of ParaboloidMapPass.
#pragma once

#include "gi/visibility/paraboloid_maps.h"

namespace lambent {

/// Casts the texels of a part of one map on the CPU, row by row: paraboloidValue(distance / farDistance) in 16 bits,
/// 65535 where nothing is met. Coarse: a ray for every second texel of every second row; texels between have the mean
/// of their neighbours on one surface, where these are nearly equal, else the nearest one's. Thread-safe.
std::vector<uint16_t> castMap(const ParaboloidMapInputs& in, const MapPose& pose, const TexelRect& texels,
                              bool coarse = false);
/// Reads a layer as distances in metres, kInfinity where nothing is met.
std::vector<float> readMap(const gl::Texture& array, int layer, float farDistance);

} // namespace lambent

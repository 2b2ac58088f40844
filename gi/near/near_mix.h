// Light traced at neighbouring pixels, which cast different rays, brought together.
#pragma once

#include "engine/core/math.h"

#include <span>
#include <vector>

namespace lambent {

/// The surfaces that an image's pixels see, row by row. Those that are not to be mixed are infinitely far off.
struct NeighbourSurfaces {
  std::span<const vec3> positions, normals; // world space, m; unit vectors
  int width = 0;                            // pixels
  float cell = 0; // m: side of a virtual light's cell, the scale over which near light changes
};

/// Mixes pixels of one colour of a chessboard, all of which cast, each by its own patternOf. What a pixel may not take
/// from a neighbour it keeps, so that light is moved, never made or lost. (Divided by the weights that count instead,
/// what lies next to a bright edge takes more than it gives: relMSE hall 0.037, citadel 0.047, with what is kept 0.035,
/// 0.045; bias of living-room-2 -2.9 and -2.2 %.)
void mixPatterns(std::vector<vec3>& light, const NeighbourSurfaces& seen);

/// Takes from a pixel what it has above 8 times the mean of its neighbours and 4 times what it had before, and shares
/// it equally among the pixel and these: pixels of 7×7 whose surfaces are near (0.4 cells) and alike. Keeps the sum
/// over the image, not each pixel's mean. `light`: irradiance; `before`: its luminance as NearMemory::light, 0 where
/// nothing is known. Of irradiance alone: lobes keep their outliers. What it brings: docs/decisions.md, 2026-11-27.
void spreadOutliers(std::vector<vec3>& light, std::span<const float> before, const NeighbourSurfaces& seen);

/// Mixes 5×5 pixels, so that each of the 16 parts of a block's one pattern weighs alike. The filter over the subsets,
/// which separates normals, finds too few pixels to mix on mouldings and leaves.
void mixBlocks(std::vector<vec3>& light, const NeighbourSurfaces& seen);

/// Mixes 5×5 pixels, each with light of its own; light is moved, not made, as by mixPatterns.
void mixPixels(std::vector<vec3>& light, const NeighbourSurfaces& seen);

} // namespace lambent

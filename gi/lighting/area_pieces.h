// The surface of an emitter as few plane pieces of even radiance. World space.
#pragma once

#include "gi/lighting/light_set.h"
#include "shaders/shared/area_piece.h"

namespace lambent {

/// A point of an emitter's surface.
struct SurfaceLight {
  vec3 position, normal; // unit, to the front
  vec3 radiance;
  float area = 0;        // m² that it stands for
  uint32_t triangle = 0; // of the emitter
};

/// Pieces of some triangles: two that make a parallelogram are one, and so are parallelograms side by side that make a
/// larger one, where they shine alike. `of` gets for each triangle its piece.
std::vector<AreaPiece> mergedPieces(std::span<const EmitterTriangle> triangles, bool doubleSided,
                                    std::vector<uint32_t>& of);

/// The same surface with each piece's radiance the mean of the points on it; pieces are halved where they shine least
/// evenly, until there are `most` or nothing is uneven. `pieceOf`: by triangle.
std::vector<AreaPiece> piecesByRadiance(std::vector<AreaPiece> pieces, std::span<const SurfaceLight> points,
                                        std::span<const uint32_t> pieceOf, size_t most);

} // namespace lambent

// Lights chosen for who receives them. Each tile of the image looks at a few of its places, found by camera rays: what
// every virtual light would bring there, were it seen, next to what all bring. From that each light has its chance of
// being in a list of the tile; it counts 1 over its chance, so that the expectation is that of all lights (Horvitz and
// Thompson 1952). The strongest have chance 1: all pixels of the tile gather them. The others are shared out to the
// sixteen classes of pixels by systematic sampling (Madow 1949) along a curve through space, so that each list has
// lights of every region. Costs and errors beside those of paper 1's interleaving: docs/measurements/light.md.
#pragma once

#include "engine/trace/ray_query.h"
#include "gi/contract/virtual_lights.h"
#include "gi/plan/settings.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lambent {

inline constexpr int kListPlaces = 4; // of a tile

struct ListInputs {
  const SceneView& view;
  const RayQuery& rays;
  std::span<const VirtualLight> lights; // by slots
  const GatherSettings& gather;         // bounds, lights, tile
  uint32_t sample = 0;                  // of those that are averaged: every 16 share the lights out anew
  uint32_t seed = 1;
};

/// Lists as LightLists::texture has them (gi/contract/light_lists.h).
struct ListTable {
  int tile = 4;
  glm::ivec2 tiles{0};
  int length = 0, chunks = 1;
  std::vector<uint32_t> texels;
  std::vector<SurfaceHit> places; // kListPlaces of each tile
  size_t row() const { return size_t(kLightClasses) * size_t(chunks + length); }
};
/// Chooses them anew. Texels past the end of a list are whatever was there.
void chooseLights(const ListInputs& in, ListTable& table, uint64_t& rays);

/// Chances that sum to `wanted` (or to the number of weights above 0, if that is less), in proportion to weights and at
/// most 1.
void chancesOf(std::span<const float> weights, float wanted, std::span<float> chances);

} // namespace lambent

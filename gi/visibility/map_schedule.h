// Which VPL maps are drawn in a frame while objects move: only those that see one, only the part that it covers, most
// important first within a budget.
#pragma once

#include "gi/contract/map_job.h"
#include "gi/lighting/dirty_region.h"

#include <vector>

namespace lambent {

class MapSchedule {
 public:
  /// Queues the texels of each map in which something that moved is seen or was. `poses` and `brightness` (what the
  /// light brings; 0: it needs no map) by slot. Whether a place is seen is tried with up to `raysPerBox` rays.
  void invalidate(std::span<const MapPose> poses, std::span<const float> brightness, const DirtyRegion& moved,
                  const RayQuery& rays, int resolution, int raysPerBox, uint32_t seed, uint32_t frame,
                  RayCounts& counts);
  /// Queues the maps of `count` slots, going on where the last call stopped.
  void invalidateInTurn(size_t slots, size_t count, int resolution);
  /// Queues these maps as wholes.
  void invalidateWhole(std::span<const uint32_t> which, size_t slots, int resolution);
  /// Queues every map as a whole.
  void invalidateAll(size_t slots, int resolution);

  /// Queues all that was drawn coarsely just now and nothing else: what has half the rays a side, for when nothing else
  /// waits; what has a quarter, as what shows where something was.
  void drawnCoarsely(std::span<const MapJob> jobs, size_t slots);

  /// Takes jobs out of the queue, those of `first` (slots, ascending, whose VPL is another than before) whole and for
  /// certain, others in order of light per texel times the square of frames waited until `texels` have been traced (the
  /// last map may exceed them). Where they do not suffice for all, maps are drawn coarsely, as many as need be, and
  /// stay in the queue until nothing else waits. By slot, ascending.
  std::vector<MapJob> take(std::span<const uint32_t> first, std::span<const float> brightness, int resolution,
                           int64_t texels);

  size_t waiting() const; // maps with texels in the queue, coarse ones too
  void clear() { stale_.clear(); }

 private:
  struct Stale {
    TexelRect texels;    // that show where something was
    TexelRect rough;     // drawn coarsely since
    uint32_t frames = 0; // waited
  };
  std::vector<Stale> stale_; // by slot
  size_t turn_ = 0;
};

/// The smallest rectangle of texels whose rays can meet the box, widened for rounding; empty when none can.
TexelRect texelsCovered(const MapPose& pose, const Aabb& box, int resolution);

} // namespace lambent

// Lights as columns of numbers: what they would bring to a place, were they seen, many at a time.
#pragma once

#include "engine/trace/ray_query.h"
#include "gi/contract/virtual_lights.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace lambent {

/// Sums side by side: one alone would wait for each addition.
inline constexpr size_t kLanes = 16;
using Lanes = std::array<float, kLanes>;
inline float sumOf(const Lanes& lanes) { return std::accumulate(lanes.begin(), lanes.end(), 0.0f); }

/// Component by component, so that compilers make vectors of loops; filled up to whole lanes by lights without power.
struct LightColumns {
  std::vector<float> x, y, z, nx, ny, nz; // world space, m; unit normals
  std::vector<float> power;               // W/sr, luminance
  std::vector<float> widening;            // m²: what bounds add to squared distances
  float least = 0;                        // squared distance, m²
};
/// Columns of some slots; `disk`: GatherSettings::disk.
LightColumns columnsOf(std::span<const VirtualLight> lights, std::span<const uint32_t> order, float disk);

/// Irradiance per power that lights bring to a place, bounded, as if nothing stood between; their cosines are at least
/// a tenth, as normals differ around the place.
class Unshadowed {
 public:
  Unshadowed(const LightColumns& c, const SurfaceHit& place)
      : px_(place.position.x), py_(place.position.y), pz_(place.position.z), nx_(place.normal.x), ny_(place.normal.y),
        nz_(place.normal.z), x_(c.x.data()), y_(c.y.data()), z_(c.z.data()), lx_(c.nx.data()), ly_(c.ny.data()),
        lz_(c.nz.data()), widening_(c.widening.data()), least_(c.least) {}

  float operator()(size_t i) const {
    constexpr float kLeastCosine = 0.1f;
    const float dx = px_ - x_[i], dy = py_ - y_[i], dz = pz_ - z_[i];
    const float squared = dx * dx + dy * dy + dz * dz + least_, least = kLeastCosine * std::sqrt(squared);
    const float atPlace = -(dx * nx_ + dy * ny_ + dz * nz_), atLight = dx * lx_[i] + dy * ly_[i] + dz * lz_[i];
    const float cosines = (atPlace > least ? atPlace : least) * (atLight > least ? atLight : least) / squared;
    return cosines / (squared + widening_[i]);
  }

 private:
  float px_, py_, pz_, nx_, ny_, nz_;
  const float *x_, *y_, *z_, *lx_, *ly_, *lz_, *widening_;
  float least_;
};

} // namespace lambent

#include "gi/lists/choose_lights.h"

#include "engine/core/parallel.h"
#include "engine/core/rng.h"
#include "gi/vpl/smc.h"

#include <glm/gtc/packing.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

namespace lambent {

namespace {

constexpr int kPlaces = 4;           // of a tile
constexpr float kLeastCosine = 0.1f; // normals differ within a tile
constexpr float kEven = 0.1f;        // share of the weights that all lights have alike, for what no place of a tile saw
constexpr float kLeastChance = 1 / 60000.0f; // its inverse is a half float
constexpr int kMostTiles = 4096;             // of an image: its tiles grow until they are no more
constexpr uint32_t kChunk = kLightsPerChunk;

/// What a place needs of lights, component by component, so that compilers make vectors of the loop.
struct LightColumns {
  std::vector<float> x, y, z, nx, ny, nz, power, widening;
};

LightColumns columnsOf(std::span<const VirtualLight> lights, std::span<const uint32_t> order, float disk) {
  LightColumns c;
  for (const uint32_t slot : order) {
    const VirtualLight& l = lights[slot];
    c.x.push_back(l.position.x), c.y.push_back(l.position.y), c.z.push_back(l.position.z);
    c.nx.push_back(l.normal.x), c.ny.push_back(l.normal.y), c.nz.push_back(l.normal.z);
    c.power.push_back(l.intensity());
    c.widening.push_back(std::max(disk * l.area / kPi, 1e-12f));
  }
  return c;
}

uint32_t spread(uint32_t v) { // ten bits to every third
  v = (v | v << 16) & 0x030000ff;
  v = (v | v << 8) & 0x0300f00f;
  v = (v | v << 4) & 0x030c30c3;
  return (v | v << 2) & 0x09249249;
}

/// Slots with light, chunk by chunk, along a Morton curve.
std::vector<uint32_t> alongCurve(std::span<const VirtualLight> lights) {
  std::vector<uint32_t> order;
  vec3 low(kInfinity), high(-kInfinity);
  for (uint32_t slot = 0; slot < lights.size(); ++slot) {
    const VirtualLight& l = lights[slot];
    const float length = glm::dot(l.position, l.position) + glm::dot(l.normal, l.normal);
    if (!l.alive || !(l.intensity() > 0) || !std::isfinite(l.intensity()) || !std::isfinite(length)) continue;
    order.push_back(slot);
    low = glm::min(low, l.position), high = glm::max(high, l.position);
  }
  const vec3 scale = vec3(1023) / glm::max(high - low, vec3(1e-20f));
  std::vector<uint32_t> codes(lights.size());
  for (const uint32_t slot : order) {
    const glm::uvec3 p((lights[slot].position - low) * scale);
    codes[slot] = spread(p.x) | spread(p.y) << 1 | spread(p.z) << 2;
  }
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    return std::tuple(a / kChunk, codes[a], a) < std::tuple(b / kChunk, codes[b], b);
  });
  return order;
}

/// What each light would bring to a place, were it seen.
void bringsTo(const LightColumns& lights, const SurfaceHit& place, std::span<float> brings) {
  const float px = place.position.x, py = place.position.y, pz = place.position.z;
  const float nx = place.normal.x, ny = place.normal.y, nz = place.normal.z;
  const size_t n = brings.size();
  for (size_t i = 0; i < n; ++i) {
    const float dx = px - lights.x[i], dy = py - lights.y[i], dz = pz - lights.z[i];
    const float squared = dx * dx + dy * dy + dz * dz, inverse = 1 / std::sqrt(squared + 1e-20f);
    const float atPlace = -(dx * nx + dy * ny + dz * nz) * inverse;
    const float atLight = (dx * lights.nx[i] + dy * lights.ny[i] + dz * lights.nz[i]) * inverse;
    const float cosines =
        (atPlace > kLeastCosine ? atPlace : kLeastCosine) * (atLight > kLeastCosine ? atLight : kLeastCosine);
    brings[i] = lights.power[i] * cosines / (squared + lights.widening[i]);
  }
}

} // namespace

void chancesOf(std::span<const float> weights, float wanted, std::span<float> chances) {
  double left = wanted, sum = 0;
  size_t some = 0;
  for (const float w : weights) sum += double(w), some += w > 0;
  if (double(some) <= left) {
    for (size_t i = 0; i < weights.size(); ++i) chances[i] = weights[i] > 0 ? 1.0f : 0.0f;
    return;
  }
  // Those whose share would be more than 1 have chance 1, and the rest share what is left.
  float limit = kInfinity; // weights from here on have chance 1
  while (true) {
    const float next = float(sum / left);
    if (!(next < limit)) break;
    double below = 0;
    size_t whole = 0;
    for (const float w : weights) w >= next ? void(++whole) : void(below += double(w));
    limit = next;
    if (double(wanted) - double(whole) == left) break;
    left = double(wanted) - double(whole), sum = below;
  }
  const double factor = sum > 0 ? left / sum : 0;
  for (size_t i = 0; i < weights.size(); ++i)
    chances[i] = weights[i] >= limit ? 1.0f : std::min(1.0f, float(double(weights[i]) * factor));
}

ListTable chooseLights(const ListInputs& in, uint64_t& rays) {
  const CameraView& camera = in.view.camera;
  ListTable table;
  table.tile = in.gather.tile;
  const auto tilesOf = [&] { return (glm::ivec2(camera.width, camera.height) + table.tile - 1) / table.tile; };
  while (tilesOf().x * tilesOf().y > kMostTiles) table.tile *= 2;
  table.tiles = tilesOf();
  table.chunks = std::max(1, int((in.lights.size() + kChunk - 1) / kChunk));
  table.length =
      in.gather.lights + 3; // systematic samples of a sum that is not whole, or a little more by kLeastChance
  table.texels.assign(table.row() * size_t(table.tiles.x) * size_t(table.tiles.y), 0);
  const std::vector<uint32_t> order = alongCurve(in.lights);
  if (order.empty()) return table;
  const LightColumns columns = columnsOf(in.lights, order, in.gather.disk);
  const size_t n = order.size();
  constexpr size_t kGrain = 8;
  parallelCount(size_t(table.tiles.x) * size_t(table.tiles.y), kGrain, rays,
                [&](size_t begin, size_t end, uint64_t& count) {
                  std::vector<vec2> at;
                  const float quarter = 0.25f * float(table.tile);
                  for (size_t t = begin; t < end; ++t) {
                    const vec2 corner = vec2(glm::ivec2(int(t) % table.tiles.x, int(t) / table.tiles.x) * table.tile);
                    for (int k = 0; k < kPlaces; ++k) {
                      const vec2 pixel = glm::floor(corner + quarter * vec2(k % 2 ? 3 : 1, k / 2 ? 3 : 1)) + 0.5f;
                      at.push_back(glm::min(pixel / vec2(camera.width, camera.height), vec2(1)));
                      at.back().y = 1 - at.back().y; // rows from the bottom
                    }
                  }
                  const std::vector<SurfaceHit> hits = surfacesAt(in.rays, camera, at);
                  count += at.size();
                  std::vector<float> brings(n), mean(n), most(n), chances(n);
                  std::array<uint32_t, kLightClasses> filled;
                  for (size_t t = begin; t < end; ++t) {
                    std::fill(mean.begin(), mean.end(), kEven / float(n));
                    std::fill(most.begin(), most.end(), 0.0f);
                    int places = 0;
                    for (int k = 0; k < kPlaces; ++k) places += hits[(t - begin) * kPlaces + size_t(k)].valid();
                    for (int k = 0; k < kPlaces; ++k) {
                      const SurfaceHit& hit = hits[(t - begin) * kPlaces + size_t(k)];
                      if (!hit.valid()) continue;
                      bringsTo(columns, hit, brings);
                      const float sum = std::accumulate(brings.begin(), brings.end(), 0.0f), share = 1 / sum;
                      if (!(sum > 0) || !std::isfinite(sum) || !std::isfinite(share)) continue;
                      for (size_t i = 0; i < n; ++i) {
                        const float relative = brings[i] * share;
                        mean[i] += relative / float(places);
                        most[i] = std::max(most[i], relative);
                      }
                    }
                    for (size_t i = 0; i < n; ++i) mean[i] += most[i];
                    chancesOf(mean, float(in.gather.lights), chances);

                    // A tick in each sixteenth of a step of 1 along the sum of chances, each for a class.
                    filled.fill(0);
                    uint32_t* row = table.texels.data() + t * table.row();
                    const size_t list = size_t(table.chunks + table.length);
                    Rng rng(in.seed, Stream::Turns, uint32_t(t), in.sample / kLightClasses);
                    double sum = 0;
                    const double tick = double(rng.next());
                    uint32_t next = 0, chunk = 0;
                    const auto endChunks = [&](uint32_t until) {
                      for (; chunk < until; ++chunk)
                        for (size_t c = 0; c < kLightClasses; ++c) row[c * list + chunk] = filled[c];
                    };
                    for (size_t i = 0; i < n; ++i) {
                      if (!(chances[i] > 0)) continue;
                      endChunks(order[i] / kChunk);
                      const float chance = std::clamp(chances[i], kLeastChance, 1.0f);
                      const uint32_t entry = order[i] % kChunk | uint32_t(glm::packHalf1x16(1 / chance)) << 16;
                      sum += double(chance);
                      for (; (double(next) + tick) / kLightClasses < sum; ++next) {
                        const size_t c = next % kLightClasses;
                        if (filled[c] < uint32_t(table.length))
                          row[c * list + size_t(table.chunks) + filled[c]++] = entry;
                      }
                    }
                    endChunks(uint32_t(table.chunks));
                  }
                });
  return table;
}

} // namespace lambent

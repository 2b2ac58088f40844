#include "gi/lists/choose_lights.h"

#include "engine/core/parallel.h"
#include "engine/core/rng.h"
#include "engine/core/sampling.h"
#include "gi/lists/light_columns.h"
#include "gi/vpl/smc.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <tuple>

namespace lambent {

namespace {

constexpr int kPlaces = kListPlaces;
constexpr float kEven = 0.1f; // share of the weights that all lights have alike, for what no place of a tile saw
constexpr float kLeastChance = 1 / 60000.0f; // its inverse is a half float
constexpr int kMostTiles = 1024;             // of an image: its tiles grow until they are no more
constexpr uint32_t kChunk = kLightsPerChunk;

/// Slots with light, chunk by chunk, along a Morton curve.
std::vector<uint32_t> orderOf(std::span<const VirtualLight> lights) {
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
    codes[slot] = alongCurve(uvec3((lights[slot].position - low) * scale));
  }
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    return std::tuple(a / kChunk, codes[a], a) < std::tuple(b / kChunk, codes[b], b);
  });
  return order;
}

/// What each light would bring to a place, were it seen; returns the sum.
float bringsTo(const LightColumns& lights, const SurfaceHit& place, std::span<float> brings) {
  const Unshadowed unshadowed(lights, place);
  const float* power = lights.power.data();
  Lanes sums{};
  for (size_t first = 0; first < brings.size(); first += kLanes) {
    float* to = brings.data() + first;
    for (size_t k = 0; k < kLanes; ++k) {
      to[k] = power[first + k] * unshadowed(first + k);
      sums[k] += to[k];
    }
  }
  return sumOf(sums);
}

/// The pixel of a tile whose ray finds its k-th place: the middles of its quarters, as (u, v) of the image, v down.
vec2 placeOf(const CameraView& camera, const ListTable& table, size_t tile, int k) {
  const glm::ivec2 at(int(tile) % table.tiles.x, int(tile) / table.tiles.x);
  const vec2 quarter = vec2(k % 2 ? 3 : 1, k / 2 ? 3 : 1) * (0.25f * float(table.tile));
  const vec2 pixel = glm::floor(vec2(at * table.tile) + quarter) + 0.5f;
  const vec2 uv = glm::min(pixel / vec2(camera.width, camera.height), vec2(1));
  return {uv.x, 1 - uv.y}; // tiles count from the bottom
}

/// What lights are worth to a tile: their shares of what reaches its places, on the mean and where they are largest.
class TileWeights {
 public:
  TileWeights(const LightColumns& lights, size_t count)
      : lights_(lights), count_(count), brings_(lights.x.size()), weights_(brings_.size()), most_(brings_.size()) {}

  std::span<const float> of(std::span<const SurfaceHit> places) {
    std::fill(weights_.begin(), weights_.end(), kEven / float(count_));
    std::fill(most_.begin(), most_.end(), 0.0f);
    const auto seen = std::count_if(places.begin(), places.end(), [](const SurfaceHit& p) { return p.valid(); });
    for (const SurfaceHit& place : places) {
      if (!place.valid()) continue;
      const float sum = bringsTo(lights_, place, brings_), share = 1 / sum;
      if (!(sum > 0) || !std::isfinite(sum) || !std::isfinite(share)) continue;
      const float mean = share / float(seen);
      for (size_t i = 0; i < weights_.size(); ++i) {
        weights_[i] += brings_[i] * mean;
        most_[i] = std::max(most_[i], brings_[i] * share);
      }
    }
    for (size_t i = 0; i < weights_.size(); ++i) weights_[i] += most_[i];
    return std::span(weights_).first(count_);
  }

 private:
  const LightColumns& lights_;
  size_t count_;
  std::vector<float> brings_, weights_, most_;
};

/// A half float; x in [1, 65504].
uint32_t halfOf(float x) {
  const uint32_t bits = std::bit_cast<uint32_t>(x);
  return (bits - 0x38000000u + 0xfffu + (bits >> 13 & 1)) >> 13;
}

/// The class of the pixel of 4×4 that takes a tick: ordered dither, so that the ticks of 2×2 pixels are four apart.
constexpr std::array<uint8_t, kLightClasses> kClassOfTick = [] {
  std::array<uint8_t, kLightClasses> classes{};
  for (uint32_t c = 0; c < kLightClasses; ++c) {
    const uint32_t y = c / 4, d = c % 4 ^ y;
    classes[(d & 1) << 3 | (y & 1) << 2 | (d & 2) | (y & 2) >> 1] = uint8_t(c);
  }
  return classes;
}();

/// Fills the lists of a tile: a tick in each sixteenth of a step of 1 along the sum of chances, each for a class. The
/// classes take turns from `turn` on: if every tile began with the same one, rows of pixels in all of them had lights
/// of the same regions, which shows as stripes.
void fillLists(const ListTable& table, std::span<const uint32_t> slots, std::span<const float> chances, float first,
               uint32_t turn, uint32_t* row) {
  std::array<uint32_t*, kLightClasses> begins, ends;
  for (size_t c = 0; c < kLightClasses; ++c)
    begins[c] = ends[c] = row + c * size_t(table.chunks + table.length) + table.chunks;
  const uint32_t most = uint32_t(table.length) * kLightClasses;
  double sum = 0; // in ticks
  uint32_t tick = 0, chunk = 0;
  const auto endChunks = [&](uint32_t until) {
    for (; chunk < until; ++chunk)
      for (size_t c = 0; c < kLightClasses; ++c) (begins[c] - table.chunks)[chunk] = uint32_t(ends[c] - begins[c]);
  };
  for (size_t i = 0; i < slots.size(); ++i) {
    if (!(chances[i] > 0)) continue;
    const float chance = std::clamp(chances[i], kLeastChance, 1.0f);
    sum += double(chance * float(kLightClasses));
    const uint32_t until = std::min(uint32_t(sum + double(first)), most); // ticks up to here
    if (until == tick) continue;
    if (slots[i] / kChunk != chunk) endChunks(slots[i] / kChunk);
    const uint32_t entry = slots[i] % kChunk | halfOf(1 / chance) << 16;
    for (; tick < until; ++tick) *ends[kClassOfTick[(tick + turn) % kLightClasses]]++ = entry;
  }
  endChunks(uint32_t(table.chunks));
}

/// Weights above 0 and below a limit.
struct Shares {
  double sum = 0, count = 0;
};
Shares sharesBelow(std::span<const float> weights, float limit) {
  Lanes sums{}, counts{};
  const auto add = [&](size_t lane, float w) {
    const bool counted = w > 0 && w < limit;
    sums[lane] += counted ? w : 0.0f;
    counts[lane] += counted ? 1.0f : 0.0f;
  };
  const size_t whole = weights.size() / kLanes * kLanes;
  for (size_t first = 0; first < whole; first += kLanes)
    for (size_t k = 0; k < kLanes; ++k) add(k, weights[first + k]);
  for (size_t i = whole; i < weights.size(); ++i) add(i - whole, weights[i]);
  return {double(sumOf(sums)), double(sumOf(counts))};
}

} // namespace

void chancesOf(std::span<const float> weights, float wanted, std::span<float> chances) {
  const Shares all = sharesBelow(weights, kInfinity);
  if (all.count <= double(wanted)) {
    for (size_t i = 0; i < weights.size(); ++i) chances[i] = weights[i] > 0 ? 1.0f : 0.0f;
    return;
  }
  // Those whose share would be more than 1 have chance 1, and the rest share what is left.
  double left = double(wanted), sum = all.sum;
  float limit = kInfinity; // weights from here on have chance 1
  while (true) {
    const float next = float(sum / left);
    if (!(next < limit)) break;
    const Shares below = sharesBelow(weights, next);
    limit = next;
    const double rest = double(wanted) - (all.count - below.count);
    if (rest == left) break;
    left = rest, sum = below.sum;
  }
  const float factor = sum > 0 ? float(left / sum) : 0;
  for (size_t i = 0; i < weights.size(); ++i)
    chances[i] = weights[i] >= limit ? 1.0f : std::min(1.0f, weights[i] * factor);
}

void chooseLights(const ListInputs& in, ListTable& table, uint64_t& rays) {
  const CameraView& camera = in.view.camera;
  table.tile = in.gather.tile;
  const auto tilesOf = [&] { return (glm::ivec2(camera.width, camera.height) + table.tile - 1) / table.tile; };
  while (tilesOf().x * tilesOf().y > kMostTiles) table.tile += in.gather.tile;
  table.tiles = tilesOf();
  table.chunks = std::max(1, int((in.lights.size() + kChunk - 1) / kChunk));
  // Systematic samples of a sum that is not whole, or a little more by kLeastChance.
  table.length = in.gather.lights + 3;
  const size_t tiles = size_t(table.tiles.x) * size_t(table.tiles.y);
  table.texels.resize(table.row() * tiles);
  table.places.resize(tiles * kPlaces);
  const std::vector<uint32_t> order = orderOf(in.lights);
  const LightColumns columns = columnsOf(in.lights, order, in.gather.disk);
  constexpr size_t kGrain = 8;
  parallelCount(tiles, kGrain, rays, [&](size_t begin, size_t end, uint64_t& count) {
    std::vector<vec2> at;
    for (size_t t = begin; t < end; ++t)
      for (int k = 0; k < kPlaces; ++k) at.push_back(placeOf(camera, table, t, k));
    std::ranges::copy(surfacesAt(in.rays, camera, at), table.places.begin() + ptrdiff_t(begin * kPlaces));
    count += at.size();
    TileWeights weights(columns, order.size());
    std::vector<float> chances(order.size());
    for (size_t t = begin; t < end; ++t) {
      chancesOf(weights.of(std::span(table.places).subspan(t * kPlaces, kPlaces)), float(in.gather.lights), chances);
      Rng rng(in.seed, Stream::LightLists, uint32_t(t), in.sample / kLightClasses);
      const float first = rng.next();
      const uint32_t turn = uint32_t(rng.next() * kLightClasses);
      fillLists(table, order, chances, first, turn, table.texels.data() + t * table.row());
    }
  });
}

} // namespace lambent

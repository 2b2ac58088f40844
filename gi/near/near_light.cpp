// What reaches a point is an integral over the surfaces y around it, and of its integrand the bounded virtual lights
// give the share G_bounded(x, y; a(y))/G(x, y), with a(y) the area of the light in whose cell y lies. The rest, which
// only near surfaces have, is found by tracing (Kollig and Keller 2006, "Illumination in the presence of weak
// singularities"): a cosine-distributed ray to y, the light in whose cell y lies, and one light path for what y
// reflects. That radiance must be y's own. The cell's mean brightens the gaps of a pavement and the undersides of
// chairs, for cells are larger than the places where bounds matter (relMSE of the citadel 0.33, with y's own 0.15).
//
// One path is noise, and next to lamps a tail of bright spots: it counts up to GatherSettings::nearLimit times the
// cell's mean. (Without, N = 2048: hall relMSE 0.16 in place of 0.11, bias -0.4 in place of -2.1 %; limit 2: 0.09, -3.6
// %.)
//
// Rays whose rest is small go on with a probability in proportion to it. The pixels of 4×4 cast the rays of one
// stratified pattern, the same in every block and fixed in the surface's frame. Over the frames that are averaged
// each pixel casts all rays of one of four longer patterns, and takes its neighbours' in. (With one pattern for all
// there is no noise between pixels to mix, but its few dozen directions are seen as streaks and specks on folded
// cloth.) In motion pixels cast as many rays as gi/near/near_memory.h says, and what one finds by chance its neighbours
// share.
#include "gi/near/near_light.h"

#include "engine/core/parallel.h"
#include "engine/core/rng.h"
#include "engine/core/sampling.h"
#include "gi/lighting/receivers.h"
#include "gi/near/near_mix.h"

#include <algorithm>
#include <array>
#include <bit>

namespace lambent {

namespace {

constexpr float kCertain = 0.25f; // rests of this and more are always traced on
constexpr float kWide = 2;        // lights of this many times the mean area are as likely as they should be
constexpr uint32_t kPatterns = 4; // that mixPatterns brings together

/// Finds the light in whose cell a surface lies.
class Cells {
 public:
  explicit Cells(std::span<const VirtualLight> lights)
      : lights_(lights), live_(livePoints(lights)), tree_(live_.points) {
    double area = 0;
    for (uint32_t slot : live_.slots) area += lights[slot].area;
    meanArea_ = live_.slots.empty() ? 0 : float(area / double(live_.slots.size()));
  }
  float meanArea() const { return meanArea_; }
  /// The nearest that may be on the same piece of surface; null where none of some is.
  const VirtualLight* at(const SurfaceHit& h) const {
    constexpr size_t kNeighbours = 8;
    std::array<uint32_t, kNeighbours> index;
    std::array<float, kNeighbours> distance2;
    for (const size_t asked : {size_t(2), kNeighbours}) { // mostly the nearest is
      const size_t found = tree_.nearest(h.position, asked, index, distance2);
      for (size_t j = 0; j < found; ++j)
        if (sameSide(live_.points[index[j]].normal, h.normal)) return &lights_[live_.slots[index[j]]];
      if (found < asked) break;
    }
    return nullptr;
  }

 private:
  std::span<const VirtualLight> lights_;
  LivePoints live_;
  NeighbourTree tree_;
  float meanArea_ = 0;
};

/// Share of the integrand that bounds leave out.
float restOf(float cosReceiver, float cosLight, float distance2, float area, const GatherSettings& settings) {
  const float exact = cosReceiver * cosLight / distance2;
  return exact > 0 ? 1 - geometryTerm(cosReceiver, cosLight, distance2, area, settings) / exact : 0;
}

/// How far off surfaces may be that leave out `rest` or more of the light of an area, m².
float reach2Of(float rest, float area, const GatherSettings& settings) {
  if (rest >= 1) return 0;
  const float byDisk = settings.disk * area / kPi * (1 / rest - 1);
  return settings.clamp > 0 ? std::max(byDisk, (1 - rest) / settings.clamp) : byDisk;
}

/// Which of the pixels of 4×4 comes first, second and so on: those of a few turns are spread evenly (ordered dither).
uint32_t turnOf(size_t x, size_t y) {
  const uint32_t v = uint32_t(y), d = uint32_t(x) ^ v;
  return (d & 1) << 3 | (v & 1) << 2 | (d & 2) | (v & 2) >> 1;
}

/// The pattern of a pixel: columns and rows of the chessboard's diagonals take turns.
uint32_t patternOf(uint32_t x, uint32_t y) { return ((x + y) >> 1 & 1) | ((x + ~y) >> 1 & 1) << 1; }

/// Which of 2×2 blocks of 4×4 pixels holds a pixel.
uint32_t quarterOf(uint32_t x, uint32_t y) { return (x >> 2 & 1) | (y >> 2 & 1) << 1; }

/// A ray that goes on.
struct Near {
  uint32_t surface;   // that it leaves
  vec3 direction;     // from there
  float weight;       // first the number that says whether it goes on; then, times the radiance met, irradiance
  float spread;       // lobeSpread of the surface met
  uint32_t lightPath; // estimates the radiance of the surface met
  float most;         // luminance that the radiance met counts up to
};

/// Near light of a few surfaces, ray by ray.
struct NearTracer {
  const RayQuery& rays;
  const LightSet& lights;
  const GatherSettings& gather;
  const Cells& cells;
  RadianceUpdate update;
  vec3 shift;  // of the pattern
  float share; // of a surface's rays that one stands for, inverse

  std::vector<Ray> segments = {};
  std::vector<Near> near = {};

  /// Casts ray `ray` of the pattern; `lightPath` estimates the radiance of what it meets.
  void cast(const SurfaceHit& h, uint32_t surface, uint32_t ray, uint32_t lightPath) {
    const vec3 u = additiveRecurrence3(ray, shift);
    const vec3 direction = sampleCosineHemisphere(h.normal, {u.x, u.y});
    if (glm::dot(direction, h.geometricNormal) <= 0) return;
    // Whether it goes on is drawn first, as for a light of mean area: it need not look farther than that.
    const float reach2 = reach2Of(std::max(u.z, 1e-6f) * kCertain / kWide, cells.meanArea(), gather);
    segments.push_back({offsetPoint(h.position, h.geometricNormal, rays.rayEpsilon()), direction, std::sqrt(reach2)});
    near.push_back({surface, direction, u.z, 0, lightPath, kInfinity});
  }
  /// Calls found(ray, irradiance) for each that brings any.
  template <class Found> void follow(std::span<const SurfaceHit> surfaces, const Found& found, RayCounts& count) {
    std::vector<SurfaceHit> hits(segments.size());
    rays.closest(segments, hits);
    count.closest += segments.size();
    std::vector<Vpl> met;
    size_t kept = 0;
    for (size_t j = 0; j < hits.size(); ++j) {
      const SurfaceHit& h = hits[j];
      if (!h.valid() || !(h.t > 0) || maxComponent(h.albedo) <= 0) continue;
      Near n = near[j];
      const float cosReceiver = glm::dot(n.direction, surfaces[n.surface].normal),
                  cosLight = -glm::dot(n.direction, h.normal), distance2 = h.t * h.t;
      const float u = n.weight, mean = restOf(cosReceiver, cosLight, distance2, cells.meanArea(), gather);
      const float likely = std::min(1.0f, kWide * mean / kCertain);
      if (!(u < likely)) continue;
      const VirtualLight* light = cells.at(h);
      if (!light) continue;
      const float rest = restOf(cosReceiver, cosLight, distance2, light->area, gather);
      const float chance = std::min(likely, rest / kCertain);
      if (!(u < chance)) continue;
      n.weight = kPi * rest * share / chance;
      n.spread = lobeSpread(gather.spread, light->area, cosLight, distance2);
      if (gather.nearLimit > 0) n.most = gather.nearLimit * luminance(light->radiance);
      near[kept++] = n;
      met.push_back(patchOf(h, 1));
    }
    std::vector<RadianceJob> jobs;
    for (size_t j = 0; j < kept; ++j) jobs.push_back({.vpl = &met[j], .path = int(near[j].lightPath)});
    count += estimateRadiance(jobs, rays, lights, update).rays;
    for (size_t j = 0; j < kept; ++j) {
      const Near& n = near[j];
      const float brightness = luminance(met[j].radiance);
      if (brightness > 0) found(n, met[j].radiance * (n.weight * std::min(1.0f, n.most / brightness)));
    }
  }
};

} // namespace

// By lists, whose other noise is little, times the rays of a still view: where light changes, whose means are the
// shortest, and where only the camera moves. Where classes take turns more rays bring little. What they cost and bring:
// docs/decisions.md, 2026-11-26, near light by lists.
int nearTimes(bool lists, bool averaged, bool changes) {
  constexpr int kChanges = 3, kMoves = 2;
  if (lists && averaged) return changes ? kChanges : kMoves;
  return changes ? 2 : 1;
}

std::vector<vec3> traceNearLightAt(std::span<const SurfaceHit> surfaces, const NearLightInputs& in, RayCounts& counts) {
  std::vector<vec3> irradiance(surfaces.size(), vec3(0));
  const Cells cells(in.virtuals);
  if (!(cells.meanArea() > 0)) return irradiance;
  const RadianceUpdate update{.paths = in.casts, .bounces = in.bounces, .seed = in.seed};
  const vec3 shift = Rng(in.seed, Stream::NearLight, 0).next3();
  constexpr size_t kGrain = 64;
  parallelCount(surfaces.size(), kGrain, counts, [&](size_t begin, size_t end, RayCounts& count) {
    NearTracer tracer{in.rays, in.lights, in.gather, cells, update, shift, 1 / float(in.casts)};
    for (size_t s = begin; s < end; ++s)
      for (uint32_t path = 0; path < uint32_t(in.casts); ++path) tracer.cast(surfaces[s], uint32_t(s), path, path);
    tracer.follow(
        surfaces, [&](const Near& n, const vec3& light) { irradiance[n.surface] += light; }, count);
  });
  return irradiance;
}

namespace {

NearLight noNearLight(const NearLightInputs& in) {
  NearLight out;
  out.irradiance.assign(size_t(in.view.camera.width) * in.view.camera.height, vec3(0));
  if (in.glossy) out.glossy.assign(out.irradiance.size(), vec3(0));
  return out;
}

/// Adds what a ray brings to a pixel that sees `h`.
void add(NearLight& out, size_t pixel, const Near& ray, const vec3& light, const NearLightInputs& in,
         const SurfaceHit& h) {
  out.irradiance[pixel] += light;
  if (out.glossy.empty()) return;
  const Receiver seen = receiverOf(in.view, h), receiver = forVirtualLights(seen, in.gather.mirrors > 0);
  out.glossy[pixel] += light * glossyReflectance(receiver, ray.direction, ray.spread) / glossyTint(seen);
}

/// What the camera sees at these points, as what is gathered has it.
std::vector<SurfaceHit> surfacesOf(const NearLightInputs& in, std::span<const vec2> points) {
  return surfacesAt(in.rays, in.view.camera, points, in.normalMaps ? &in.view : nullptr);
}

/// Light of pixels that cast other rays, mixed.
void mixNeighbours(NearLight& light, const NeighbourSurfaces& seen, bool averaged) {
  for (std::vector<vec3>* of : {&light.irradiance, &light.glossy})
    if (!of->empty()) averaged ? mixPatterns(*of, seen) : mixBlocks(*of, seen);
}

/// Surfaces of about a thousand pixels, spread over the image.
std::vector<SurfaceHit> someSurfaces(const NearLightInputs& in, RayCounts& counts) {
  const CameraView& camera = in.view.camera;
  const int step = std::max(1, int(std::sqrt(float(camera.width) * float(camera.height) / 1024)));
  std::vector<vec2> centres;
  for (int y = step / 2; y < camera.height; y += step)
    for (int x = step / 2; x < camera.width; x += step)
      centres.push_back(pixelCentre(camera, size_t(y) * size_t(camera.width) + size_t(x)));
  counts.closest += centres.size();
  return surfacesOf(in, centres);
}

/// Every pixel casts as many rays as the frame before says, each frame the next ones of its pattern.
NearLight traceInMotion(const NearLightInputs& in, const Cells& cells, RayCounts& counts) {
  constexpr uint32_t kPattern = 64;
  constexpr size_t kGrain = 512; // pixels
  const CameraView& camera = in.view.camera;
  NearLight out = noNearLight(in);
  NearMemory now;
  now.fit(camera);
  std::vector<float> lightBefore(out.irradiance.size(), 0); // luminance
  const NearRates rates(*in.memory, someSurfaces(in, counts), float(in.casts) / 16);
  const vec3 shift = Rng(in.seed, Stream::NearLight, 0).next3();
  const RadianceUpdate update{.paths = int(kPatterns * kPattern), .bounces = in.bounces, .seed = in.seed};
  parallelCount(out.irradiance.size(), kGrain, counts, [&](size_t begin, size_t end, RayCounts& count) {
    std::vector<vec2> centres;
    for (size_t i = begin; i < end; ++i) centres.push_back(pixelCentre(camera, i));
    const std::vector<SurfaceHit> surfaces = surfacesOf(in, centres);
    count.closest += centres.size();

    NearTracer tracer{in.rays, in.lights, in.gather, cells, update, shift, 1};
    std::vector<NearExpected> expected(surfaces.size());
    std::vector<uint32_t> cast(surfaces.size(), 0), went(surfaces.size(), 0);
    for (size_t s = 0; s < surfaces.size(); ++s) {
      const SurfaceHit& h = surfaces[s];
      if (!h.valid()) continue;
      const uint32_t pixel = uint32_t(begin + s), x = pixel % uint32_t(camera.width),
                     y = pixel / uint32_t(camera.width);
      now.positions[pixel] = h.position;
      now.normals[pixel] = h.normal;
      expected[s] = rates.at(h);
      cast[s] = uint32_t(expected[s].rays + Rng(in.seed, Stream::NearLight, pixel + 1, in.frame).next());
      // Rays of a frame are a quarter of the pattern apart, pixels of a block and frames side by side. Blocks take the
      // quarters of the light paths in turn: by the same few in all of them, a wall flashes in the frame of a bright
      // one.
      for (uint32_t ray = 0; ray < cast[s]; ++ray) {
        const uint32_t turn = turnOf(x, y) + 5 * in.frame + ray * kPattern / 4 + ray / 4;
        const auto path = [&](uint32_t t) { return t % kPattern * kPatterns + patternOf(x, y); };
        tracer.cast(h, uint32_t(s), path(turn), path(turn + quarterOf(x, y) * kPattern / 4));
      }
    }
    tracer.follow(
        surfaces,
        [&](const Near& n, const vec3& light) {
          ++went[n.surface];
          add(out, begin + n.surface, n, light / expected[n.surface].rays, in, surfaces[n.surface]);
        },
        count);
    for (size_t s = 0; s < surfaces.size(); ++s) {
      lightBefore[begin + s] = expected[s].light;
      now.keep(begin + s, expected[s], cast[s], went[s], luminance(out.irradiance[begin + s]));
    }
  });
  *in.memory = std::move(now);
  const NeighbourSurfaces seen{in.memory->positions, in.memory->normals, camera.width, std::sqrt(cells.meanArea())};
  spreadOutliers(out.irradiance, lightBefore, seen);
  mixNeighbours(out, seen, true);
  return out;
}

} // namespace

NearLight traceNearLight(const NearLightInputs& in, RayCounts& counts) {
  const CameraView& camera = in.view.camera;
  NearLight out = noNearLight(in);
  const size_t pixels = out.irradiance.size();
  const Cells cells(in.virtuals);
  if (!(cells.meanArea() > 0)) return out;
  if (in.memory && in.subsets && in.frames > 1) return traceInMotion(in, cells, counts);
  std::vector<vec3> positions(pixels, vec3(kInfinity)), normals(pixels, vec3(0)); // that pixels see
  const int perBlock = in.casts;
  const uint32_t stride = in.subsets ? 16 : 1; // paths of a pixel: every so many
  const vec3 shift = Rng(in.seed, Stream::NearLight, 0).next3();
  // Within a cycle each pixel casts once; the cycles begin anywhere, so that nothing that moves over the pixels keeps
  // step with them.
  const uint32_t cycle = std::max(1u, stride / uint32_t(perBlock)), casts = in.frame / cycle;
  const uint32_t turn = (in.frame % cycle + Rng(in.seed, Stream::NearLightTurns, casts).below(cycle)) % cycle;
  // The pattern has as many rays as a pixel casts in all frames that are averaged, one after the other.
  const bool averaged = in.frames > 1;
  const uint32_t steps = std::bit_floor(std::max(1u, uint32_t(in.frames) / cycle));
  const uint32_t pattern = averaged ? std::max(steps, stride) : std::min(stride, uint32_t(perBlock));
  const int ofPattern = int(averaged ? kPatterns * pattern : pattern);
  const RadianceUpdate update{
      .paths = ofPattern * ((perBlock + int(stride) - 1) / int(stride)), .bounces = in.bounces, .seed = in.seed};

  const size_t grain = size_t(std::clamp(4096 * int(stride) / perBlock, 16, 512)); // pixels
  parallelCount(pixels, grain, counts, [&](size_t begin, size_t end, RayCounts& count) {
    // Pixels that cast, the first path of each; where blocks are mixed, those too that take from their neighbours.
    std::vector<uint32_t> asked, paths;
    std::vector<vec2> centres;
    for (size_t i = begin; i < end; ++i) {
      const uint32_t x = uint32_t(i % camera.width), y = uint32_t(i / camera.width);
      const uint32_t path = (turnOf(x, y) + uint32_t(perBlock) * turn) % stride;
      if (averaged && path >= uint32_t(perBlock)) continue;
      asked.push_back(uint32_t(i));
      paths.push_back(path);
      centres.push_back(pixelCentre(camera, i));
    }
    const std::vector<SurfaceHit> surfaces = surfacesOf(in, centres);
    count.closest += centres.size();

    NearTracer tracer{in.rays, in.lights, in.gather, cells, update, shift, float(stride) / float(perBlock)};
    for (uint32_t s = 0; s < asked.size(); ++s) {
      const SurfaceHit& h = surfaces[s];
      if (!h.valid()) continue;
      positions[asked[s]] = h.position;
      normals[asked[s]] = h.normal;
      for (uint32_t p = paths[s]; p < uint32_t(perBlock); p += stride) {
        uint32_t path = (p % stride + 5 * casts) % pattern + pattern * (p / stride);
        if (averaged) path = path * kPatterns + patternOf(asked[s] % camera.width, asked[s] / camera.width);
        tracer.cast(h, s, path, path);
      }
    }
    tracer.follow(
        surfaces,
        [&](const Near& n, const vec3& light) { add(out, asked[n.surface], n, light, in, surfaces[n.surface]); },
        count);
  });
  if (in.subsets) mixNeighbours(out, {positions, normals, camera.width, std::sqrt(cells.meanArea())}, averaged);
  return out;
}

} // namespace lambent

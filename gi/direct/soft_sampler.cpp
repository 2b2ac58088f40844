#include "gi/direct/soft_sampler.h"

#include "engine/core/parallel.h"
#include "engine/core/rng.h"
#include "gi/lighting/light_paths.h"
#include "gi/lighting/receivers.h"
#include "gi/vpl/smc.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

/// What a pair of numbers is for. Pairs of one sample are independent of each other.
enum class Pair : uint32_t { Choice, Place, Sky, Ray, Lobe };

/// First two dimensions of the Sobol' sequence, as fractions of 2^32.
glm::uvec2 sobol(uint32_t i) {
  glm::uvec2 point(0);
  for (uint32_t first = 1u << 31, second = 1u << 31; i; i >>= 1, first >>= 1, second ^= second >> 1)
    if (i & 1) point ^= glm::uvec2(first, second);
  return point;
}

uint32_t reversed(uint32_t x) {
  x = (x >> 1 & 0x55555555u) | (x & 0x55555555u) << 1;
  x = (x >> 2 & 0x33333333u) | (x & 0x33333333u) << 2;
  x = (x >> 4 & 0x0f0f0f0fu) | (x & 0x0f0f0f0fu) << 4;
  return __builtin_bswap32(x);
}

/// Flips each binary digit by a hash of the more significant ones: Owen's scrambling, as Laine and Karras hash it
/// ("Stratified sampling for stochastic transparency", 2011).
uint32_t scrambled(uint32_t x, uint32_t seed) {
  x = reversed(x) + seed;
  for (const uint32_t factor : {0x6c50b47cu, 0xb82f1e52u, 0xc7afe638u, 0x8d22f6e6u}) x ^= x * factor;
  return reversed(x);
}

/// Which of the pixels of 4×4 comes first, second and so on: ordered dither.
uint32_t turnOf(const glm::ivec2& pixel) {
  const uint32_t v = uint32_t(pixel.y), d = uint32_t(pixel.x) ^ v;
  return (d & 1) << 3 | (v & 1) << 2 | (d & 2) | (v & 2) >> 1;
}

/// The numbers of a pixel. One of each pair of Choice, Sky and Ray takes the strata of its block in turn, so that a
/// block has all of them in one frame; the rest are the pixel's own, so that blocks do not err as one.
class PixelNumbers {
 public:
  PixelNumbers(const glm::ivec2& pixel, uint32_t seed)
      : turn_(turnOf(pixel)), pixel_(keyOf(pixel, seed)), block_(keyOf(pixel >> 2, ~seed)) {}

  /// Numbers in [0, 1).
  vec2 operator()(uint32_t sample, Pair pair) const {
    constexpr uint32_t kStrata = 0xf0000000u; // sixteen
    // Points in another order for each pair (Burley, "Practical hash-based Owen scrambling", 2020): else the same half
    // of one pair would always meet the same half of another.
    const bool shared = pair == Pair::Choice || pair == Pair::Sky || pair == Pair::Ray;
    const uint64_t order = (shared ? block_ : pixel_) - 1 - uint32_t(pair);
    const glm::uvec2 point = sobol(scrambled(sample ^ turn_, uint32_t(mix64(order))));
    vec2 u;
    for (uint32_t axis = 0; axis < 2; ++axis) {
      const uint32_t strata = shared && axis == 0 ? kStrata : 0;
      const uint32_t stream = 2 * uint32_t(pair) + axis;
      const uint32_t coarse = scrambled(point[int(axis)], uint32_t(mix64(block_ + stream))),
                     fine = scrambled(point[int(axis)], uint32_t(mix64(pixel_ + stream)));
      u[int(axis)] = float(((coarse & strata) | (fine & ~strata)) >> 8) * 0x1p-24f;
    }
    return u;
  }

 private:
  static uint64_t keyOf(const glm::ivec2& at, uint32_t seed) {
    return mix64(mix64(uint64_t(uint32_t(at.y)) << 32 | uint32_t(at.x)) + seed);
  }
  uint32_t turn_;
  uint64_t pixel_, block_;
};

constexpr uint32_t kMore = 1u << 30; // numbers of samples from here on are of those beyond SoftSampling::samples
constexpr uint32_t kMost = 256;      // of a pixel in a frame

/// What a pixel shows, for rays.
struct Place {
  uint32_t pixel; // row by row from the top
  PathVertex vertex;
  Receiver receiver; // where lobes are asked for
  bool lobe = false;
  int samples;
  PixelNumbers numbers;
};

/// Rays meet the scene at its triangles, the image at its depths. Where both show the same surface, the ray's place is
/// the exact one; elsewhere, as at the rims of leaves, the image's counts.
bool isSame(const FrameSurfaces& surfaces, const glm::ivec2& pixel, const SurfaceHit& hit, float apart) {
  if (!hit.valid() || glm::dot(hit.geometricNormal, surfaces.normalAt(pixel)) < 0.5f) return false;
  const vec3 way = hit.position - surfaces.positionAt(pixel);
  return glm::dot(way, way) <= apart * apart;
}

struct Start {
  PathVertex vertex;
  bool atHit;
};

/// Where a pixel's samples start.
Start startOf(const FrameSurfaces* surfaces, const glm::ivec2& pixel, const SurfaceHit& hit) {
  if (!surfaces) return {{hit.position, hit.normal, hit.geometricNormal}, true};
  const float distance = viewDistanceFromDepth(surfaces->camera, surfaces->depth[surfaces->at(pixel)]);
  const vec4& lens = surfaces->camera.lens;
  const float pixelSize = 2 * lens.y * surfaces->camera.size.w * (lens.w > 0 ? 1 : distance);
  const vec3 normal = surfaces->normalAt(pixel);
  if (!isSame(*surfaces, pixel, hit, pixelSize + placeSlack(surfaces->camera, distance)))
    return {{surfaces->placeAt(pixel), normal, normal}, false};
  constexpr float kSameNormal = 0.98f;
  const bool alike = glm::dot(hit.normal, normal) > kSameNormal;
  return {{hit.position, alike ? hit.normal : normal, hit.geometricNormal}, true};
}

/// Light that a ray would bring.
struct Pending {
  uint32_t place;
  vec3 value; // irradiance: of a connection whole, of a ray of the place per radiance
};

} // namespace

int MoreSamples::at(const vec3& position) const {
  if (pixels.empty()) return 0;
  const vec4 clip = clipFromWorld * vec4(position, 1);
  const vec2 at = (vec2(clip) / clip.w * 0.5f + 0.5f) * vec2(width, height);
  if (!(clip.w > 0 && at.x >= 0 && at.y >= 0 && at.x < float(width) && at.y < float(height))) return 0;
  return pixels[size_t(at.y) * size_t(width) + size_t(at.x)];
}

LightSet softLightsOf(const LightSet& lights, SoftParts parts) {
  LightSet soft;
  soft.view = lights.view;
  soft.emission = lights.emission && parts != SoftParts::SkyAndSuns;
  if (soft.emission) {
    soft.emitters = lights.emitters;
    soft.triangles = lights.triangles;
  }
  soft.sky = lights.sky;
  for (const LightView& light : lights.punctual)
    if (hasDisk(light)) soft.punctual.push_back(light);
  soft.tree = LightTree(soft);
  return soft;
}

SoftLight sampleSoftLight(const SoftSampling& in, RayCounts& counts) {
  const CameraView& camera = in.view.camera;
  const LightSet& lights = in.lights;
  const float epsilon = in.rays.rayEpsilon();
  const bool connects = lights.lightCount() > 0, sky = !lights.sky.black();
  const bool casts = sky || !lights.emitters.empty(), suns = std::ranges::any_of(lights.punctual, hasDisk);
  SoftLight out;
  out.irradiance.assign(size_t(camera.width) * camera.height, vec3(0));
  if (in.glossy) out.glossy.assign(out.irradiance.size(), vec3(0));
  constexpr size_t kGrain = 256;
  parallelCount(out.irradiance.size(), kGrain, counts, [&](size_t begin, size_t end, RayCounts& count) {
    std::vector<uint32_t> seen;
    std::vector<vec2> centres;
    for (size_t i = begin; i < end; ++i) {
      const glm::ivec2 at(int(i % size_t(camera.width)), int(i / size_t(camera.width)));
      if (in.surfaces && !in.surfaces->seen({at.x, camera.height - 1 - at.y})) continue;
      seen.push_back(uint32_t(i));
      centres.push_back(pixelCentre(camera, i));
    }
    std::vector<SurfaceHit> hits = surfacesAt(in.rays, camera, centres);
    count.closest += centres.size();
    std::vector<Place> places;
    for (size_t k = 0; k < seen.size(); ++k) {
      if (!in.surfaces && !hits[k].valid()) continue;
      const glm::ivec2 pixel(int(seen[k] % uint32_t(camera.width)),
                             camera.height - 1 - int(seen[k] / uint32_t(camera.width)));
      Start start = startOf(in.surfaces, pixel, hits[k]);
      if (in.normalMaps && start.atHit) {
        applyNormalMap(in.view, hits[k]);
        start.vertex.normal = hits[k].normal;
      }
      const int samples = in.samples + in.more.at(start.vertex.position);
      Place place{seen[k], start.vertex, {}, false, samples, PixelNumbers(pixel, in.seed)};
      if (in.glossy && start.atHit) { // the lobes of another surface would be of another light
        place.receiver = receiverOf(in.view, hits[k]);
        place.lobe = true;
      }
      places.push_back(place);
    }

    std::vector<Ray> segments, rays;
    std::vector<Pending> connected, cast;
    const auto connect = [&](uint32_t place, const LightConnection& c) {
      if (maxComponent(c.value) <= 0) return;
      segments.push_back(c.segment);
      connected.push_back({place, c.value});
    };
    for (Place& place : places) place.vertex.receiver = place.lobe ? &place.receiver : nullptr;
    for (uint32_t p = 0; p < places.size(); ++p) {
      const PathVertex& vertex = places[p].vertex;
      const PixelNumbers& numbers = places[p].numbers;
      const int samples = places[p].samples;
      const float weight = kPi / float(samples);
      for (int k = 0; k < samples; ++k) {
        const uint32_t s = k < in.samples ? in.sample + uint32_t(k) : kMore + in.sample * kMost + uint32_t(k);
        if (connects) {
          const vec2 choice = numbers(s, Pair::Choice);
          connect(p, connectToLight(lights, vertex, vec3(weight), choice.x, vec3(choice.y, numbers(s, Pair::Place)),
                                    epsilon));
        }
        if (sky && !lights.sky.constant())
          connect(p, connectToSky(lights, vertex, vec3(weight), numbers(s, Pair::Sky), epsilon));
        if (!casts && !(suns && vertex.receiver)) continue;
        const vec2 u = numbers(s, Pair::Ray);
        const vec3 direction = vertex.receiver ? sampleReflection(*vertex.receiver, numbers(s, Pair::Lobe).x, u)
                                               : sampleCosineHemisphere(vertex.normal, u);
        const float cosine = glm::dot(direction, vertex.normal);
        if (!(cosine > 0) || glm::dot(direction, vertex.geometricNormal) <= 0) continue;
        const Ray ray{offsetPoint(vertex.position, vertex.geometricNormal, epsilon), direction};
        const vec3 perRadiance(cosine / (pdfOfRay(vertex, direction) * float(samples)));
        if (lights.emission) {
          rays.push_back(ray);
          cast.push_back({p, perRadiance});
        } else { // which surface it meets, if any, is all the same
          connect(p, {ray, skyByRay(lights, vertex, direction) * perRadiance});
        }
      }
    }

    const auto bring = [&](const Place& place, const vec3& light, const vec3& way) {
      out.irradiance[place.pixel] += light;
      if (place.lobe)
        out.glossy[place.pixel] +=
            light * glossyReflectance(place.receiver, glm::normalize(way), 0) / glossyTint(place.receiver);
    };
    std::vector<float> passes(segments.size());
    in.rays.transmittance(segments, passes);
    count.occlusion += segments.size();
    for (size_t k = 0; k < segments.size(); ++k)
      if (passes[k] > 0) bring(places[connected[k].place], connected[k].value * passes[k], segments[k].direction);
    std::vector<SurfaceHit> met(rays.size());
    in.rays.closest(rays, met);
    count.closest += rays.size();
    for (size_t k = 0; k < rays.size(); ++k) {
      const Place& place = places[cast[k].place];
      const vec3& direction = rays[k].direction;
      vec3 radiance(0);
      if (!met[k].valid())
        radiance = skyByRay(lights, place.vertex, direction);
      else if (lights.emission && maxComponent(met[k].emission) > 0)
        radiance = met[k].emission * emitterShare(lights, place.vertex, direction, met[k]);
      if (maxComponent(radiance) > 0) bring(place, radiance * cast[k].value, direction);
    }
  });
  return out;
}

} // namespace lambent

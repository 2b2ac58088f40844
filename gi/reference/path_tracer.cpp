// Paths advance together, one vertex at a time, for a block of pixels.
#include "gi/reference/path_tracer.h"

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/core/rng.h"
#include "engine/view/surface_point.h"
#include "gi/lighting/light_paths.h"
#include "gi/lighting/receivers.h"
#include "gi/vpl/smc.h"
#include "shaders/shared/coverage.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

constexpr size_t kBlockPixels = 16; // small images still keep all threads busy

/// Surfaces at the centres of pixels [begin, end).
std::vector<SurfaceHit> primaryHits(const ReferenceInputs& in, size_t begin, size_t end,
                                    std::span<const uint32_t> keys = {}) {
  const CameraView& camera = in.camera;
  std::vector<vec2> centres;
  for (size_t i = begin; i < end; ++i) centres.push_back(pixelCentre(camera, i));
  return surfacesAt(in.rays, camera, centres, in.normalMaps, keys);
}

/// Which of the pixels [begin, end) show blended surfaces, before what else they show.
std::vector<uint8_t> mixedAt(const ReferenceInputs& in, size_t begin, size_t end) {
  std::vector<uint8_t> out(end - begin);
  if (!in.mixes) return out;
  const std::vector<uint32_t> all(out.size(), kMeetsAll);
  const std::vector<SurfaceHit> nearest = primaryHits(in, begin, end, all);
  for (size_t i = 0; i < out.size(); ++i) {
    const SurfaceHit& h = nearest[i];
    if (!h.valid()) continue;
    const SceneAssets& assets = *in.blended->assets;
    const Mesh& mesh = assets.meshes[in.blended->instances[h.instance].mesh];
    const Primitive& primitive = mesh.primitives[h.primitive];
    const Material& material = assets.materials[primitive.material];
    if (material.alphaMode != AlphaMode::Blend) continue;
    const TrianglePlace place = trianglePlace(mesh, primitive, h.triangle, h.barycentric);
    out[i] = alphaAt(assets, mesh, material, place) < 1 - kLeastBlended;
  }
  return out;
}

vec3 skyAt(const ReferenceInputs& in, size_t pixel) {
  const vec2 at = pixelCentre(in.camera, pixel);
  return in.lights.sky.radiance(cameraRay(in.camera, at.x, at.y).direction);
}

/// Of chances of meeting what is blended.
uint32_t keyFrom(Rng& rng) { return rng.nextUint() >> 1 | 1; }

/// One path's present vertex. `weight` turns irradiance/π here into irradiance/π at the primary hit.
struct Path {
  PathVertex vertex;
  vec3 weight;
  uint32_t pixel; // of the block
  Rng rng;
};

struct Sample {
  vec3 direct{0}, indirect{0};
};

class BlockTracer {
 public:
  /// `mixed`: which draw their surface anew in each sample; empty: none.
  BlockTracer(const ReferenceInputs& in, size_t firstPixel, std::span<const SurfaceHit> primary,
              std::vector<uint8_t> mixed = {})
      : in_(in), firstPixel_(firstPixel), primary_(primary.begin(), primary.end()), mixed_(std::move(mixed)),
        samples_(primary.size()) {
    if (in.glossy) receivers_.resize(primary.size());
    for (size_t i = 0; i < primary.size(); ++i) findReceiver(i);
  }

  /// Sample number `index` of every pixel of the block; valid until the next call.
  std::span<const Sample> trace(uint32_t index, RayCounts& counts) {
    std::fill(samples_.begin(), samples_.end(), Sample{});
    paths_.clear();
    drawSurfaces(index, counts);
    for (uint32_t i = 0; i < primary_.size(); ++i) {
      Rng rng = rngOf(i, index);
      const bool mixed = isMixed(i);
      if (mixed) keyFrom(rng); // its surface is drawn by it
      const SurfaceHit& h = primary_[i];
      if (h.valid())
        paths_.push_back({{h.position, h.normal, h.geometricNormal, receivers_.empty() ? nullptr : &receivers_[i]},
                          mixed && receivers_.empty() ? h.albedo : vec3(1),
                          i,
                          rng});
    }
    const bool raysMeetLight = !in_.lights.emitters.empty() || !in_.lights.sky.black() ||
                               (in_.bounces == 0 && in_.glossy && std::ranges::any_of(in_.lights.punctual, hasDisk));
    for (int vertex = 0; vertex <= in_.bounces && !paths_.empty(); ++vertex) {
      connect(vertex, counts);
      if (!in_.lights.sky.constant()) connectSky(vertex, counts);
      // The last vertex needs its cosine ray only to meet sky and emitters.
      if (vertex < in_.bounces || raysMeetLight) extend(vertex, counts);
    }
    for (uint32_t i = 0; i < primary_.size(); ++i)
      if (isMixed(i)) samples_[i].direct += primary_[i].valid() ? primary_[i].emission : skyAt(in_, firstPixel_ + i);
    return samples_;
  }

 private:
  bool isMixed(uint32_t pixel) const { return !mixed_.empty() && mixed_[pixel]; }

  Rng rngOf(size_t pixel, uint32_t index) const {
    return Rng(in_.seed, Stream::Reference, uint32_t(firstPixel_ + pixel), index);
  }

  void drawSurfaces(uint32_t index, RayCounts& counts) {
    if (std::ranges::find(mixed_, 1) == mixed_.end()) return;
    std::vector<vec2> centres;
    std::vector<uint32_t> keys;
    for (size_t i = 0; i < mixed_.size(); ++i) {
      if (!mixed_[i]) continue;
      Rng rng = rngOf(i, index);
      centres.push_back(pixelCentre(in_.camera, firstPixel_ + i));
      keys.push_back(keyFrom(rng));
    }
    const std::vector<SurfaceHit> drawn = surfacesAt(in_.rays, in_.camera, centres, in_.normalMaps, keys);
    counts.closest += drawn.size();
    for (size_t i = 0, next = 0; i < mixed_.size(); ++i) {
      if (!mixed_[i]) continue;
      primary_[i] = drawn[next++];
      findReceiver(i);
    }
  }

  void findReceiver(size_t pixel) {
    if (in_.glossy && primary_[pixel].valid()) receivers_[pixel] = receiverOf(*in_.glossy, primary_[pixel]);
  }

  vec3& sumOf(const Path& path, int vertex) {
    Sample& s = samples_[path.pixel];
    return vertex == 0 ? s.direct : s.indirect;
  }

  void connect(int vertex, RayCounts& counts) {
    if (in_.lights.lightCount() == 0) return;
    connectBy(vertex, counts, [&](Path& p) {
      const float uLight = p.rng.next();
      const vec2 a = p.rng.next2();
      return connectToLight(in_.lights, p.vertex, p.weight, uLight, {a, p.rng.next()}, in_.rays.rayEpsilon());
    });
  }

  void connectSky(int vertex, RayCounts& counts) {
    connectBy(vertex, counts, [&](Path& p) {
      return connectToSky(in_.lights, p.vertex, p.weight, p.rng.next2(), in_.rays.rayEpsilon());
    });
  }

  /// `connection(path)` gives what is to be tested.
  template <class Connection> void connectBy(int vertex, RayCounts& counts, const Connection& connection) {
    segments_.clear();
    pending_.clear();
    owners_.clear();
    for (uint32_t i = 0; i < paths_.size(); ++i) {
      Path& p = paths_[i];
      LightConnection c = connection(p);
      if (glossyAt(vertex)) c.value *= kPi * reflectanceOf(receivers_[p.pixel], glm::normalize(c.segment.direction));
      if (maxComponent(c.value) <= 0) continue;
      if (in_.blended) c.segment.key = keyFrom(p.rng);
      segments_.push_back(c.segment);
      pending_.push_back(c.value);
      owners_.push_back(i);
    }
    blocked_.resize(segments_.size());
    in_.rays.occluded(segments_, blocked_);
    counts.occlusion += segments_.size();
    for (size_t j = 0; j < owners_.size(); ++j)
      if (!blocked_[j]) sumOf(paths_[owners_[j]], vertex) += pending_[j];
  }

  void extend(int vertex, RayCounts& counts) {
    segments_.clear();
    for (Path& p : paths_) {
      const vec3 direction =
          glossyAt(vertex) ? drawReflection(p) : sampleCosineHemisphere(p.vertex.normal, p.rng.next2());
      // Under the real surface of a smooth-shaded one: the path ends, as a ray of length zero.
      const bool above = glm::dot(direction, p.vertex.geometricNormal) > 0;
      segments_.push_back({offsetPoint(p.vertex.position, p.vertex.geometricNormal, in_.rays.rayEpsilon()), direction,
                           above ? kInfinity : 0.0f, in_.blended ? keyFrom(p.rng) : 0});
    }
    hits_.resize(segments_.size());
    in_.rays.closest(segments_, hits_);
    counts.closest += segments_.size();
    size_t alive = 0;
    for (size_t j = 0; j < paths_.size(); ++j) {
      Path p = paths_[j];
      const Ray& ray = segments_[j];
      const SurfaceHit& h = hits_[j];
      if (ray.tMax == 0) continue;
      if (!h.valid()) {
        sumOf(p, vertex) += p.weight * skyByRay(in_.lights, p.vertex, ray.direction);
        continue;
      }
      if (luminance(h.emission) > 0)
        sumOf(p, vertex) += p.weight * h.emission * emitterShare(in_.lights, p.vertex, ray.direction, h);
      p.weight *= h.albedo;
      if (vertex == 0) p.weight *= clampFactor(p.vertex, ray.direction, h);
      p.vertex = {h.position, h.normal, h.geometricNormal};
      if (maxComponent(p.weight) > 0) paths_[alive++] = p;
    }
    paths_.erase(paths_.begin() + long(alive), paths_.end());
  }

  bool glossyAt(int vertex) const { return vertex == 0 && !receivers_.empty(); }

  /// Direction of a glossy receiver's ray; the path's weight then is that of radiance from there.
  vec3 drawReflection(Path& p) const {
    const Receiver& receiver = receivers_[p.pixel];
    const vec2 u = p.rng.next2();
    const vec3 direction = sampleReflection(receiver, p.rng.next(), u);
    const float cosine = std::max(0.0f, glm::dot(direction, receiver.normal));
    p.weight *=
        cosine > 0 ? reflectanceOf(receiver, direction) * (cosine / pdfReflection(receiver, direction)) : vec3(0);
    return direction;
  }

  /// Share of the light along the first segment that remains when its geometry term is bounded: in the area formulation
  /// a cosine-distributed hit carries G/G, so min(G, clamp)/G (paper 1, 5.4).
  float clampFactor(const PathVertex& x, const vec3& direction, const SurfaceHit& h) const {
    if (in_.clamp <= 0) return 1;
    const float cosines =
        std::max(0.0f, glm::dot(direction, x.normal)) * std::max(0.0f, -glm::dot(direction, h.normal));
    return cosines > in_.clamp * h.t * h.t ? in_.clamp * h.t * h.t / cosines : 1.0f;
  }

  const ReferenceInputs& in_;
  const size_t firstPixel_;
  std::vector<SurfaceHit> primary_;
  const std::vector<uint8_t> mixed_;
  std::vector<Sample> samples_;
  std::vector<Receiver> receivers_; // by pixel; empty: Lambert
  std::vector<Path> paths_;
  std::vector<Ray> segments_;
  std::vector<vec3> pending_; // added to the owner's sum if the segment is clear
  std::vector<uint32_t> owners_;
  std::vector<uint8_t> blocked_;
  std::vector<SurfaceHit> hits_;
};

void addTo(PixelSums& p, const Sample& s) {
  const glm::dvec3 direct(s.direct), indirect(s.indirect);
  p.direct += direct;
  p.directSquares += direct * direct;
  p.indirect += indirect;
  p.indirectSquares += indirect * indirect;
  p.product += direct * indirect;
}

struct Estimate {
  double mean = 0, variance = double(kInfinity); // the variance is the mean's
};

/// One channel of a pixel's direct or indirect light, or of both.
Estimate estimateOf(const PixelSums& p, int c, uint32_t samples, bool direct, bool indirect) {
  const double n = samples;
  double sum = 0, squares = 0;
  if (direct) sum += p.direct[c], squares += p.directSquares[c];
  if (indirect) sum += p.indirect[c], squares += p.indirectSquares[c];
  if (direct && indirect) squares += 2 * p.product[c];
  if (samples < 2) return {samples ? sum : 0};
  return {sum / n, std::max(0.0, squares - sum * sum / n) / (n - 1) / n};
}

} // namespace

void addSamples(ReferenceSums& sums, const ReferenceInputs& in, uint32_t count, RayCounts& counts) {
  CHECK_EQ(sums.width, in.camera.width);
  CHECK_EQ(sums.height, in.camera.height);
  const size_t pixels = sums.pixels.size();
  parallelCount(pixels, kBlockPixels, counts, [&](size_t begin, size_t end, RayCounts& ofBlock) {
    if (in.stopped && *in.stopped) return;
    const std::vector<SurfaceHit> primary = primaryHits(in, begin, end);
    ofBlock.closest += in.mixes ? 2 * primary.size() : primary.size();
    BlockTracer tracer(in, begin, primary, mixedAt(in, begin, end));
    for (uint32_t s = 0; s < count; ++s) {
      const std::span<const Sample> samples = tracer.trace(sums.samples + s, ofBlock);
      for (size_t i = begin; i < end; ++i) addTo(sums.pixels[i], samples[i - begin]);
    }
  });
  sums.samples += count;
}

std::vector<PixelSums> sampleSurfaces(std::span<const SurfaceHit> surfaces, const ReferenceInputs& in, uint32_t samples,
                                      RayCounts& counts) {
  std::vector<PixelSums> sums(surfaces.size());
  constexpr size_t kGrain = 8;
  parallelCount(surfaces.size(), kGrain, counts, [&](size_t begin, size_t end, RayCounts& ofBlock) {
    BlockTracer tracer(in, begin, surfaces.subspan(begin, end - begin));
    for (uint32_t s = 0; s < samples; ++s) {
      const std::span<const Sample> values = tracer.trace(s, ofBlock);
      for (size_t i = begin; i < end; ++i) addTo(sums[i], values[i - begin]);
    }
  });
  return sums;
}

ReferenceImage readReference(const ReferenceSums& sums, const ReferenceInputs& in, ReferenceBuffer buffer) {
  const bool irradiance = buffer == ReferenceBuffer::Irradiance;
  CHECK(!(irradiance && (in.glossy || in.mixes)));
  ReferenceImage image{Image(sums.width, sums.height), Image(sums.width, sums.height), {}};
  image.surface.resize(sums.pixels.size());
  const bool direct = buffer == ReferenceBuffer::Beauty || buffer == ReferenceBuffer::Direct;
  const bool indirect = buffer != ReferenceBuffer::Direct;
  struct Row {
    glm::dvec3 total{0}, variance{0};
  };
  std::vector<Row> rows(size_t(sums.height));
  parallelFor(rows.size(), 1, [&](size_t firstRow, size_t lastRow) {
    const size_t first = firstRow * sums.width;
    const std::vector<uint8_t> mixed = mixedAt(in, first, lastRow * sums.width);
    for (size_t i = first; i < lastRow * sums.width; ++i) {
      SurfaceHit h;
      if (!mixed[i - first]) h = primaryHits(in, i, i + 1)[0];
      Row& row = rows[i / sums.width];
      vec3& mean = image.mean.pixels[i];
      const bool seen = mixed[i - first] || h.valid();
      image.surface[i] = seen;
      if (seen) {
        const bool reflected = in.glossy || mixed[i - first];
        const vec3 factor = irradiance ? vec3(kPi) : reflected ? vec3(1) : h.albedo;
        for (int c = 0; c < 3; ++c) {
          const Estimate e = estimateOf(sums.pixels[i], c, sums.samples, direct, indirect);
          mean[c] = (direct ? h.emission[c] : 0) + factor[c] * float(e.mean);
          const double variance = factor[c] > 0 ? e.variance * factor[c] * factor[c] : 0; // not 0·∞
          image.error.pixels[i][c] = float(std::sqrt(variance));
          row.variance[c] += variance;
        }
      } else if (direct) {
        mean = skyAt(in, i);
      }
      row.total += glm::dvec3(mean);
    }
  });
  glm::dvec3 total(0), variance(0);
  for (const Row& r : rows) total += r.total, variance += r.variance;
  const double count = 3 * double(sums.pixels.size()), sum = total.x + total.y + total.z;
  if (sum > 0) {
    image.relativeError = std::sqrt((variance.x + variance.y + variance.z) / count) / (sum / count);
    image.relativeErrorOfMean = (std::sqrt(variance.x) + std::sqrt(variance.y) + std::sqrt(variance.z)) / sum;
  }
  return image;
}

} // namespace lambent

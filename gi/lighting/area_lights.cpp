#include "gi/lighting/area_lights.h"

#include "engine/core/rng.h"
#include "engine/core/sampling.h"
#include "gi/lighting/area_pieces.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numeric>
#include <span>

namespace lambent {

namespace {

/// Number of the cell that a place in [0,1]³ lies in along a curve that fills the cube.
uint32_t numberOf(const vec3& place) {
  const uvec3 cell = uvec3(glm::clamp(place, 0.0f, 0.999f) * 1024.0f);
  return alongCurve(uvec3(cell.z, cell.y, cell.x));
}

bool textured(const LightSet& lights, const Emitter& emitter) {
  if (!lights.view) return false;
  const InstanceView& instance = lights.view->instances[emitter.instance];
  const Mesh& mesh = lights.view->assets->meshes[instance.mesh];
  const Material& material = lights.view->assets->materials[mesh.primitives[emitter.primitive].material];
  return material.emissiveTexture.image != kNone ||
         (lights.alpha && material.alphaMode != AlphaMode::Opaque &&
          (material.baseColorTexture.image != kNone || !mesh.colors.empty()));
}

/// The emitters by themselves, each in the parts that do not touch, which are lights of their own: many lamps may be
/// one mesh. (Corners that rounding parts make two of one, which is only slower.)
LightSet byParts(const LightSet& lights) {
  LightSet parts;
  parts.view = lights.view;
  parts.alpha = lights.alpha;
  for (const Emitter& emitter : lights.emitters) {
    if (!(emitter.power > 0)) continue;
    const std::span of = std::span(lights.triangles).subspan(emitter.firstTriangle, emitter.triangleCount);
    Aabb box;
    for (const EmitterTriangle& t : of) box.add(t.p0), box.add(t.p0 + t.e1), box.add(t.p0 + t.e2);
    const float step = std::max(1e-5f * maxComponent(box.size()), 1e-30f);
    std::vector<uint32_t> part(of.size()); // another triangle of the same part, or itself
    std::iota(part.begin(), part.end(), 0u);
    const auto root = [&](uint32_t i) {
      while (part[i] != i) i = part[i] = part[part[i]];
      return i;
    };
    std::map<std::array<int, 3>, uint32_t> at;
    for (uint32_t i = 0; i < of.size(); ++i)
      for (const vec3& c : {of[i].p0, of[i].p0 + of[i].e1, of[i].p0 + of[i].e2}) {
        const vec3 place = glm::round((c - box.lo) / step);
        const auto [known, added] = at.try_emplace({int(place.x), int(place.y), int(place.z)}, i);
        if (!added) part[root(i)] = root(known->second);
      }
    constexpr size_t kMostParts = 512; // of an emitter; with more it stays whole
    std::map<uint32_t, std::vector<EmitterTriangle>> triangles;
    for (uint32_t i = 0; i < of.size(); ++i)
      if (of[i].area > 0) triangles[root(i)].push_back(of[i]);
    if (triangles.size() > kMostParts) triangles = {{0, {of.begin(), of.end()}}};
    for (auto& [first, some] : triangles)
      addEmitter(parts, emitter.instance, emitter.primitive, std::move(some), emitter.doubleSided);
  }
  return parts;
}

/// Points spread evenly over an emitter's area, along a curve that fills its box.
std::vector<SurfaceLight> pointsOf(const LightSet& lights, const Emitter& emitter, uint32_t count) {
  std::vector<SurfaceLight> points;
  Aabb box;
  for (uint32_t i = 0; i < count; ++i) {
    const vec3 spread = additiveRecurrence3(i, vec3(0.5f));
    const float u = (float(i) + 0.5f) / float(count);
    const EmitterPoint p = sampleEmitter(lights, emitter, {u, spread.x, spread.y});
    points.push_back({p.position, p.normal, p.radiance, 1 / (p.pdfArea * float(count)), emitter.byPower.sample(u)});
    box.add(p.position);
  }
  const vec3 size = glm::max(box.size(), vec3(maxComponent(box.size()) * 1e-3f + 1e-30f));
  std::vector<std::pair<uint32_t, uint32_t>> order;
  for (uint32_t i = 0; i < count; ++i) order.emplace_back(numberOf((points[i].position - box.lo) / size), i);
  std::sort(order.begin(), order.end());
  std::vector<SurfaceLight> sorted;
  for (const auto& [place, i] : order) sorted.push_back(points[i]);
  return sorted;
}

/// `count` of the points, in proportion to their brightness.
void addSamples(std::span<const SurfaceLight> points, uint32_t count, std::vector<AreaSample>& to) {
  std::vector<float> brightness;
  double area = 0;
  for (const SurfaceLight& p : points) {
    brightness.push_back(luminance(p.radiance) * p.area);
    area += p.area;
  }
  const Distribution byBrightness(brightness);
  const float mean = float(byBrightness.total() / area);
  for (uint32_t i = 0; i < count; ++i) {
    const SurfaceLight& p = points[byBrightness.sample((float(i) + 0.5f) / float(count))];
    to.push_back({p.position, p.normal, p.radiance * (mean / luminance(p.radiance))});
  }
}

float bitsReversed(uint32_t i) {
  uint32_t out = 0;
  for (int bit = 0; bit < 32; ++bit) out = out << 1 | (i >> bit & 1);
  return float(out) * 0x1p-32f;
}

/// `count` places in the unit square, a power of two. Where R rays, a power of two, ask for place (k + 1/2) count / R
/// each, these are a Hammersley set along the curve: of every strip along a side as wide as 1/R they know one point, so
/// that shadows' edges along a side are known to 1/R. (Points that merely lie in a grid of cells each know them to its
/// rows, 1/√R.)
std::vector<vec2> netsOf(uint32_t count) {
  std::vector<vec2> places(count, vec2(0.5f / std::sqrt(float(count)))); // the first, along the curve, is of no set
  for (uint32_t rays = 1; rays < count; rays *= 2) {                     // sets for unlike R have no place in common
    const uint32_t other = uint32_t(mix64(rays)) % rays;                 // and are unlike one another
    std::vector<std::pair<uint32_t, vec2>> net;
    for (uint32_t i = 0; i < rays; ++i) {
      const vec2 at = vec2(float(i) / float(rays), bitsReversed(i ^ other)) + 0.5f / float(rays);
      net.emplace_back(numberOf(vec3(at, 0)), at);
    }
    std::ranges::sort(net, {}, &std::pair<uint32_t, vec2>::first);
    for (uint32_t k = 0; k < rays; ++k) places[(2 * k + 1) * (count / rays / 2)] = net[k].second;
  }
  return places;
}

/// Samples of a parallelogram.
void addSamples(const AreaPiece& piece, std::span<const vec2> places, std::vector<AreaSample>& to) {
  const vec3 corner(piece.corners[0]), e1 = vec3(piece.corners[1]) - corner, e2 = vec3(piece.corners[3]) - corner;
  for (const vec2& at : places)
    to.push_back({corner + at.x * e1 + at.y * e2, vec3(piece.normalArea), vec3(piece.radianceSides)});
}

/// `count` of a light's samples as disks that share its surface.
void addDisks(std::span<const AreaSample> samples, size_t count, float area, bool doubleSided,
              std::vector<AreaPiece>& to) {
  count = std::min(count, samples.size());
  for (size_t i = 0; i < count; ++i) {
    const AreaSample& sample = samples[(2 * i + 1) * samples.size() / (2 * count)];
    AreaPiece& piece = to.emplace_back();
    piece.corners[0] = vec4(sample.position, 0);
    piece.normalArea = vec4(sample.normal, area / float(count));
    piece.radianceSides = vec4(sample.radiance, doubleSided ? 1 : 0);
  }
}

} // namespace

AreaLights areaLights(const LightSet& lights) {
  constexpr uint32_t kAllTexturedPoints = 1 << 18, kLeastTexturedPoints = 1 << 8, kTexturedPoints = 1 << 14;
  AreaLights out;
  const LightSet parts = byParts(lights);
  const uint32_t count = std::max(1u, uint32_t(parts.emitters.size()));
  const uint32_t samples =
      std::bit_floor(std::clamp(AreaLights::kAllSamples / count, AreaLights::kLeastSamples, AreaLights::kSamples));
  const uint32_t texturedPoints = std::clamp(kAllTexturedPoints / count, kLeastTexturedPoints, kTexturedPoints);
  const uint32_t most = std::clamp(AreaLights::kAllPieces / count, 1u, AreaLights::kMostPieces);
  const std::vector<vec2> nets = netsOf(samples);
  for (const Emitter& emitter : parts.emitters) {
    const bool uneven = textured(parts, emitter);
    const std::vector<SurfaceLight> points =
        pointsOf(parts, emitter, uneven ? std::max(texturedPoints, samples) : samples);
    if (std::ranges::none_of(points, [](const SurfaceLight& p) { return luminance(p.radiance) > 0; })) continue;
    AreaLight light{.firstPiece = uint32_t(out.pieces.size()),
                    .firstSample = uint32_t(out.samples.size()),
                    .samples = samples,
                    .doubleSided = emitter.doubleSided};
    const std::span of = std::span(parts.triangles).subspan(emitter.firstTriangle, emitter.triangleCount);
    std::vector<uint32_t> pieceOf;
    std::vector<AreaPiece> pieces = mergedPieces(of, emitter.doubleSided, pieceOf);
    if (!uneven && pieces.size() == 1 && pieces[0].corners[0].w == 4)
      addSamples(pieces[0], nets, out.samples);
    else
      addSamples(points, samples, out.samples);
    if (pieces.size() > most) {
      float area = 0;
      for (const EmitterTriangle& t : of) area += t.area;
      pieces.clear();
      addDisks(std::span(out.samples).last(samples), most, area, emitter.doubleSided, pieces);
    } else if (uneven) {
      pieces = piecesByRadiance(std::move(pieces), points, pieceOf, most);
    }
    out.pieces.insert(out.pieces.end(), pieces.begin(), pieces.end());
    light.pieces = uint32_t(pieces.size());
    out.lights.push_back(light);
  }
  return out;
}

vec3 unshadowed(const AreaLights& all, const AreaLight& light, const vec3& position, const vec3& normal) {
  vec3 sum(0);
  for (uint32_t i = 0; i < light.pieces; ++i) {
    const AreaPiece& piece = all.pieces[light.firstPiece + i];
    sum += vec3(piece.radianceSides) * areaFormFactor(piece, position, normal);
  }
  return sum;
}

} // namespace lambent

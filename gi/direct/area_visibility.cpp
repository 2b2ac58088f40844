#include "gi/direct/area_visibility.h"

#include "engine/core/parallel.h"
#include "engine/core/rng.h"

#include <numeric>

namespace lambent {

namespace {

/// Rays go to the lights in proportion to what these bring: ray k to part k/n of all light. Each of four quarters,
/// whose rays follow each other in turn, is spread over the lights as evenly as all.
constexpr int kQuarterOf[4] = {0, 2, 3, 1}; // by sub-fragment: of those that lie opposite, next to each other
constexpr int kPartOf[4] = {0, 3, 1, 2};    // the inverse
constexpr int kCommon = 2;                  // quarter of a pixel's rays that its patch asked, where all ask the same
constexpr int kMostAll = 4 * kMostAreaRays;

} // namespace

/// The rays of a fragment: where they go, and what is known of them.
struct AreaVisibility::Question {
  Unshadowed from;
  std::vector<float> due;                         // share of the samples that each light gets
  int drawn = 0;                                  // samples
  std::array<uint32_t, kMostAll> lights, samples; // where they end
  std::array<Ray, kMostAll> segments;
  std::array<float, kMostAll> weights; // of a sample's light, for a receiver; 0: not traced
  std::array<bool, kMostAll> open;
  std::array<bool, 4> quarters{}; // to be traced next
  uint64_t traced = 0;
  size_t quad = ~size_t(0); // whose lights and samples these are

  bool wanted(int k) const { return quarters[size_t(k % 4)] && weights[size_t(k)] > 0; }
};

AreaVisibility::Place AreaVisibility::placeAt(const glm::ivec2& pixel) const {
  return {surfaces_.placeAt(pixel), surfaces_.normalAt(pixel)};
}

std::array<AreaVisibility::Place, 4> AreaVisibility::partsOf(const glm::ivec2& texel, int level) const {
  const int side = 1 << level;
  std::array<Place, 4> parts;
  for (int s = 0; s < 4; ++s) {
    const glm::ivec2 within = side / 4 + side / 2 * glm::ivec2(s & 1, s >> 1); // of 2×2 pixels one each
    const glm::ivec2 pixel = clamped(texel * side + within);
    parts[size_t(s)] = placeAt(surfaces_.seen(pixel) ? pixel : clamped(texel * side));
  }
  return parts;
}

AreaVisibility::Unshadowed AreaVisibility::unshadowedAt(const Place& place) const {
  Unshadowed out{std::vector<vec3>(lights_.lights.size())};
  for (size_t l = 0; l < out.light.size(); ++l) {
    out.light[l] = unshadowed(lights_, lights_.lights[l], place.position, place.normal);
    out.total += luminance(out.light[l]);
  }
  return out;
}

AreaVisibility::Unshadowed AreaVisibility::unshadowedAround(const Place& middle,
                                                            const std::array<Place, 4>& parts) const {
  Unshadowed from = unshadowedAt(middle);
  for (size_t s = 0; s < 4 && !(from.total > 0); ++s) from = unshadowedAt(parts[s]);
  return from;
}

void AreaVisibility::choose(Question& q, bool alike) const {
  q.due.clear();
  for (const vec3& light : q.from.light) q.due.push_back(luminance(light));
  draw(q, alike);
}

void AreaVisibility::chooseForAll(Question& q) const {
  float sum = 0;
  for (const AreaLight& light : lights_.lights) sum += light.brought;
  const float least = sum > 0 ? sum / float(all()) : 1; // a ray for those that bring little
  q.due.clear();
  for (const AreaLight& light : lights_.lights) q.due.push_back(light.brought + least);
  draw(q, false);
}

void AreaVisibility::draw(Question& q, bool alike) const {
  const float sum = std::accumulate(q.due.begin(), q.due.end(), 0.0f);
  for (float& due : q.due) due /= sum;
  q.drawn = alike ? count_ : all();
  float below = 0; // due to lights before `l`
  size_t l = 0;
  for (int k = 0; k < all(); ++k) {
    // The samples that all quarters ask lie in the middles of their own strata, also where the others are added.
    const bool common = aims_ == AreaAims::Same && (alike || k % 4 == kCommon);
    const float u = common ? (float(k / 4) + 0.5f) / float(count_) : (float(k) + 0.5f) / float(all());
    while (l + 1 < q.due.size() && below + q.due[l] <= u) below += q.due[l++];
    const AreaLight& light = lights_.lights[l];
    const float within = std::max(u - below, 0.0f) / std::max(q.due[l], 1e-30f);
    q.lights[size_t(k)] = uint32_t(l);
    q.samples[size_t(k)] = light.firstSample + std::min(uint32_t(within * float(light.samples)), light.samples - 1);
  }
}

Ray AreaVisibility::rayTo(const AreaSample& sample, const Place& from) const {
  const bool behind = glm::dot(sample.normal, from.position - sample.position) < 0;
  return segment(offsetPoint(from.position, from.normal, rays_.rayEpsilon()),
                 offsetPoint(sample.position, behind ? -sample.normal : sample.normal, rays_.rayEpsilon()));
}

void AreaVisibility::aim(Question& q, int k, const Place& place) const {
  const AreaSample& sample = lights_.samples[q.samples[size_t(k)]];
  const bool doubleSided = lights_.lights[q.lights[size_t(k)]].doubleSided;
  const vec3 way = sample.position - place.position;
  const float distance2 = std::max(glm::dot(way, way), 1e-20f);
  const float cosine = std::max(glm::dot(place.normal, way), 0.0f), cosineLight = -glm::dot(sample.normal, way);
  q.weights[size_t(k)] =
      cosine * (doubleSided ? std::abs(cosineLight) : std::max(cosineLight, 0.0f)) / (distance2 * distance2);
  q.segments[size_t(k)] = rayTo(sample, place);
}

bool AreaVisibility::oneSurface(const glm::ivec2& a, const glm::ivec2& b) const {
  if (!surfaces_.seen(a) || !surfaces_.seen(b)) return false;
  constexpr float kMostHeight = 0.3f, kLeastCos = 0.9f;
  const Place one = placeAt(a), other = placeAt(b);
  const vec3 way = other.position - one.position;
  return glm::dot(one.normal, other.normal) > kLeastCos &&
         std::abs(glm::dot(one.normal, way)) < kMostHeight * glm::length(way);
}

void AreaVisibility::askEach(const glm::ivec2& pixel, std::span<double> brought,
                             std::vector<std::pair<uint32_t, Ray>>& asked) const {
  const Place place = placeAt(pixel);
  for (uint32_t l = 0; l < brought.size(); ++l) {
    const float light = luminance(unshadowed(lights_, lights_.lights[l], place.position, place.normal));
    if (!(light > 0)) continue;
    brought[l] += double(light);
    const AreaLight& of = lights_.lights[l];
    const uint32_t sample = uint32_t(mix64(uint64_t(surfaces_.at(pixel)) << 32 | l) % of.samples);
    asked.emplace_back(l, rayTo(lights_.samples[of.firstSample + sample], place));
  }
}

template <class Begin, class Asked>
void AreaVisibility::ask(size_t count, const Begin& begin, const Asked& asked) const {
  constexpr size_t kGrain = 32;
  if (!rays_.ownThread()) {
    parallelFor(count, kGrain, [&](size_t first, size_t end) {
      Question q;
      std::array<Ray, kMostAll> segments;
      std::array<uint8_t, kMostAll> blocked;
      for (size_t i = first; i < end; ++i) {
        q.traced = 0;
        q.quarters = {};
        for (bool more = begin(i, q); more; more = asked(i, q)) {
          size_t n = 0;
          for (int k = 0; k < all(); ++k)
            if (q.wanted(k)) segments[n++] = q.segments[size_t(k)];
          rays_.occluded(std::span(segments).first(n), std::span(blocked).first(n));
          q.traced += n;
          n = 0;
          for (int k = 0; k < all(); ++k)
            if (q.wanted(k)) q.open[size_t(k)] = !blocked[n++];
        }
      }
    });
    return;
  }
  constexpr size_t kAtOnce = 4096; // 47 MB of questions
  for (size_t first = 0; first < count; first += kAtOnce) {
    std::vector<Question> questions(std::min(kAtOnce, count - first));
    std::vector<uint8_t> more(questions.size());
    parallelFor(questions.size(), kGrain, [&](size_t from, size_t end) {
      for (size_t i = from; i < end; ++i) more[i] = begin(first + i, questions[i]);
    });
    while (std::ranges::find(more, 1) != more.end()) {
      std::vector<Ray> segments;
      for (size_t i = 0; i < questions.size(); ++i)
        for (int k = 0; k < all() && more[i]; ++k)
          if (questions[i].wanted(k)) segments.push_back(questions[i].segments[size_t(k)]);
      std::vector<uint8_t> blocked(segments.size());
      rays_.occluded(segments, blocked);
      size_t n = 0;
      for (size_t i = 0; i < questions.size(); ++i) {
        if (!more[i]) continue;
        Question& q = questions[i];
        for (int k = 0; k < all(); ++k)
          if (q.wanted(k)) q.open[size_t(k)] = !blocked[n++], ++q.traced;
        more[i] = asked(first + i, q);
      }
    }
  }
}

/// The share that the rays found open, over their weights: 1 where all are.
void AreaVisibility::addUp(const Question& q, AreaSeen& to) const {
  to.rays = q.traced;
  vec3 lit(0), whole(0);
  for (int k = 0; k < all();) {
    const uint32_t light = q.lights[size_t(k)];
    vec3 open(0), sum(0);
    for (; k < all() && q.lights[size_t(k)] == light; ++k) {
      if (!(q.weights[size_t(k)] > 0)) continue;
      const vec3 weight = q.weights[size_t(k)] * lights_.samples[q.samples[size_t(k)]].radiance;
      sum += weight;
      ++to.asked[size_t(kPartOf[k % 4])];
      if (!q.open[size_t(k)]) continue;
      open += weight;
      to.bits[size_t(kPartOf[k % 4])] |= uint64_t(1) << (k / 4);
    }
    // A light that is due less than one sample stands for others like it.
    const vec3& own = q.from.light[light];
    const float share = std::max(1.0f, 1 / (float(q.drawn) * std::max(q.due[light], 1e-30f)));
    for (int c = 0; c < 3; ++c) {
      if (!(sum[c] > 0)) continue;
      whole[c] += share * own[c];
      lit[c] += share * own[c] * (open[c] / sum[c]);
    }
  }
  // A colour that no light has that was asked goes by the brightness.
  const float bright = luminance(whole) > 0 ? luminance(lit) / luminance(whole) : 0;
  for (int c = 0; c < 3; ++c) to.visible[c] = std::min(whole[c] > 0 ? lit[c] / whole[c] : bright, 1.0f);
}

std::vector<AreaSeen> AreaVisibility::ofPatches(std::span<const glm::ivec2> texels, int level) const {
  std::vector<AreaSeen> seen(texels.size());
  ask(
      texels.size(),
      [&](size_t i, Question& q) {
        const std::array<Place, 4> parts = partsOf(texels[i], level);
        q.from = unshadowedAround(placeAt(middleOf(texels[i], level)), parts);
        if (!(q.from.total > 0)) return false;
        choose(q, aims_ == AreaAims::Same);
        for (int k = 0; k < all(); ++k) aim(q, k, parts[size_t(kPartOf[k % 4])]);
        q.quarters.fill(true);
        return true;
      },
      [&](size_t i, const Question& q) {
        addUp(q, seen[i]);
        return false;
      });
  return seen;
}

template <class Choose>
std::vector<AreaSeen> AreaVisibility::askPixels(std::span<const glm::ivec2> pixels, bool askAll,
                                                const Choose& choose) const {
  constexpr int kFirst = 1; // the quarter that is asked before the others
  std::vector<AreaSeen> seen(pixels.size());
  ask(
      pixels.size(),
      [&](size_t i, Question& q) {
        const Place place = placeAt(pixels[i]);
        q.from = unshadowedAt(place);
        if (!(q.from.total > 0)) return false;
        choose(q);
        for (int k = 0; k < all(); ++k) aim(q, k, place);
        q.quarters.fill(askAll);
        q.quarters[kFirst] = true;
        return true;
      },
      [&](size_t i, Question& q) {
        if (!askAll && q.quarters[kFirst]) {
          uint64_t opened = 0;
          for (int k = 0; k < all(); ++k) opened += q.wanted(k) && q.open[size_t(k)];
          if (opened == 0 || opened != q.traced) { // few that are open hide among many that are not
            q.quarters.fill(true);
            q.quarters[kFirst] = false;
            return true;
          }
          q.open.fill(true);
        }
        addUp(q, seen[i]);
        return false;
      });
  return seen;
}

std::vector<AreaSeen> AreaVisibility::ofPixels(std::span<const glm::ivec2> pixels, bool askAll) const {
  return askPixels(pixels, askAll, [&](Question& q) { choose(q); });
}

std::vector<AreaSeen> AreaVisibility::ofPixelsAlike(std::span<const glm::ivec2> pixels) const {
  return askPixels(pixels, true, [&](Question& q) { chooseForAll(q); });
}

std::vector<AreaSeen> AreaVisibility::ofQuads(std::span<const glm::ivec2> texels,
                                              std::span<const AreaSeen> patches) const {
  std::vector<AreaSeen> seen(4 * texels.size());
  ask(
      seen.size(),
      [&](size_t i, Question& q) {
        const glm::ivec2& texel = texels[i / 4];
        const size_t s = i % 4;
        const std::array<Place, 4> parts = partsOf(texel, 1);
        if (q.quad != i / 4) { // the four come one after the other
          q.quad = i / 4;
          q.from = unshadowedAround(placeAt(middleOf(texel, 1)), parts); // as when the patch was asked
          if (q.from.total > 0) choose(q);
        }
        if (!(q.from.total > 0)) return false;
        for (int k = 0; k < all(); ++k) aim(q, k, parts[s]);
        const int known = aims_ == AreaAims::Same ? kCommon : kQuarterOf[s];
        for (int k = 0; k < all(); ++k)
          if (k % 4 == known) q.open[size_t(k)] = patches[i / 4].bits[s] >> (k / 4) & 1;
        q.quarters.fill(true);
        q.quarters[size_t(known)] = false;
        return true;
      },
      [&](size_t i, const Question& q) {
        addUp(q, seen[i]);
        return false;
      });
  return seen;
}

} // namespace lambent

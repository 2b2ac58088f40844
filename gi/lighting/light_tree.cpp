#include "gi/lighting/light_tree.h"

#include "engine/core/error.h"
#include "gi/lighting/light_set.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

constexpr float kLargestWeight = 1e30f; // sums stay finite
// Round-off must not take a light away: relative, of lengths; and of cosines that come from angles.
constexpr float kSlack = 1e-5f, kAngleSlack = 2e-3f;
constexpr float kFlat = 1 - 1e-6f; // axes this near to one lie within kAngleSlack of it

float sineOf(float cosine) { return std::sqrt(std::max(0.0f, 1 - cosine * cosine)); }

/// Cosine and sine of a − b.
vec2 difference(const vec2& a, const vec2& b) { return {a.x * b.x + a.y * b.y, a.y * b.x - a.x * b.y}; }

/// The smallest cone around two cones of axes.
void addCone(LightBounds& a, const LightBounds& b) {
  if (a.cosAxes <= -1) return;
  if (b.cosAxes <= -1) {
    a.cosAxes = -1;
    return;
  }
  const float angleA = std::acos(a.cosAxes), angleB = std::acos(b.cosAxes);
  const float between = std::acos(glm::clamp(glm::dot(a.axis, b.axis), -1.0f, 1.0f));
  if (between + angleB <= angleA) return;
  if (between + angleA <= angleB) {
    a.axis = b.axis;
    a.cosAxes = b.cosAxes;
    return;
  }
  const float all = 0.5f * (angleA + between + angleB);
  const vec3 across = b.axis - a.axis * glm::dot(a.axis, b.axis);
  const float length = glm::length(across);
  if (all >= kPi || !(length > 0)) {
    a.cosAxes = -1;
    return;
  }
  const float turn = all - angleA;
  a.axis = glm::normalize(a.axis * std::cos(turn) + across * (std::sin(turn) / length));
  a.cosAxes = std::max(-1.0f, std::cos(all) - kSlack);
}

void add(LightBounds& a, const LightBounds& b) {
  Aabb box;
  box.add(a.centre - a.half), box.add(a.centre + a.half);
  box.add(b.centre - b.half), box.add(b.centre + b.half);
  a.centre = box.centre();
  a.half = 0.5f * box.size();
  addCone(a, b);
  a.cosEmission = std::min(a.cosEmission, b.cosEmission);
  a.bothSides |= b.bothSides;
  a.power += b.power;
  a.range = std::max(a.range, b.range);
}

LightBounds boundsOf(const LightView& light) {
  LightBounds b;
  b.centre = light.position;
  b.power = luminance(light.intensity);
  b.range = light.range;
  if (light.type == LightType::Spot) {
    b.axis = light.direction;
    const float outer = glm::clamp(light.outerConeCos, -1.0f, 1.0f),
                inner = glm::clamp(light.innerConeCos, outer, 1.0f);
    b.cosAxes = inner;
    b.cosEmission = std::cos(std::acos(outer) - std::acos(inner));
  }
  return b;
}

float sizeOf(const Aabb& box) {
  const vec3 size = box.size();
  return glm::dot(size, size);
}

} // namespace

float LightBounds::importance(const vec3& x, const vec3& n) const {
  const vec3 d = centre - x, away = glm::abs(d);
  const float height = glm::dot(d, n) + glm::dot(glm::abs(n), half); // of its highest place
  const float top = height + kSlack * (away.x + away.y + away.z + half.x + half.y + half.z);
  if (top <= 0) return 0; // all of it is below the horizon; or x is where all its lights are
  if (range < kInfinity) {
    const vec3 gap = glm::max(away - half, vec3(0));
    if (glm::dot(gap, gap) > range * range * (1 + kSlack)) return 0;
  }
  const float r2 = glm::dot(d, d), radius2 = glm::dot(half, half);
  if (r2 <= radius2) return std::min(power * std::min(1.0f, top / std::sqrt(r2)) / radius2, kLargestWeight);
  const float invR = 1 / std::sqrt(r2);
  float cosine = std::min(1.0f, top * invR);
  if (cosAxes > -1) {
    float cosTowards = -glm::dot(axis, d) * invR, cosLeft = 1;
    if (bothSides) cosTowards = std::abs(cosTowards);
    if (cosAxes > kFlat && cosEmission == 0) { // panels that face one way: of the place farthest behind x
      cosLeft = std::min(1.0f, cosTowards + glm::dot(glm::abs(axis), half) * invR);
    } else {
      // Angle at the group between its axis and the way to x, less what axes and places within the group make up for.
      cosTowards = std::min(1.0f, cosTowards);
      vec2 angle{1, 0};
      if (cosTowards < cosAxes) angle = difference({cosTowards, sineOf(cosTowards)}, {cosAxes, sineOf(cosAxes)});
      const float sinBox2 = radius2 * (invR * invR), cosBox = std::sqrt(std::max(0.0f, 1 - sinBox2));
      if (angle.x < cosBox) cosLeft = angle.x * cosBox + angle.y * std::sqrt(sinBox2);
    }
    if (cosLeft < cosEmission - kAngleSlack) return 0;
    cosine *= std::max(cosLeft, kAngleSlack);
  }
  return std::min(power * cosine * (invR * invR), kLargestWeight);
}

LightTree::LightTree(const LightSet& lights) : lightCount_(lights.lightCount()) {
  if (lightCount_ <= LightChoice::kFewLights) return;
  place_.assign(lightCount_, kNone);
  std::vector<Item> items;
  items.reserve(lightCount_);
  for (uint32_t i = 0; i < lights.punctual.size(); ++i) {
    if (lights.punctual[i].type == LightType::Directional)
      suns_.push_back(i);
    else
      items.push_back({boundsOf(lights.punctual[i]), i});
  }
  for (const Emitter& e : lights.emitters) items.push_back({e.bounds, uint32_t(items.size() + suns_.size())});
  if (items.empty()) return;
  nodes_.reserve(items.size());
  order_.resize(items.size());
  grow(items, 0);
}

/// Splits where the groups are small, and shine one way, in proportion to their power: the surface-area-orientation
/// heuristic over eight slices of each axis, with the square of the diagonal for the area (lamps in a row have none),
/// and how far the sum of the axes falls short of their number for the cone.
void LightTree::grow(std::span<Item> items, uint32_t first) {
  const size_t self = nodes_.size();
  nodes_.push_back({items[0].bounds, first, uint32_t(items.size())});
  if (items.size() <= kLeafLights) {
    for (uint32_t i = 0; i < items.size(); ++i) {
      order_[first + i] = items[i].light;
      place_[items[i].light] = first + i;
      if (i) add(nodes_[self].bounds, items[i].bounds);
    }
    return;
  }
  Aabb centres;
  for (const Item& i : items) centres.add(i.bounds.centre);
  constexpr int kSlices = 8;
  struct Slice {
    Aabb box;
    float power = 0, count = 0;
    vec3 axes{0};
    void add(const Slice& s) { box.add(s.box), power += s.power, count += s.count, axes += s.axes; }
    float cost() const { return count > 0 ? power * sizeOf(box) * (2 - glm::length(axes) / count) : 0; }
  };
  const auto sliceOf = [&](const Item& i, int axis) {
    const float share = (i.bounds.centre[axis] - centres.lo[axis]) / (centres.hi[axis] - centres.lo[axis]);
    return int(std::min(std::max(0.0f, share * kSlices), kSlices - 1.0f)); // 0 for what is not a number
  };
  float best = kInfinity;
  int bestAxis = -1, bestSlice = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(centres.hi[axis] > centres.lo[axis])) continue;
    std::array<Slice, kSlices> slices;
    for (const Item& i : items) {
      Slice& s = slices[sliceOf(i, axis)];
      s.box.add(i.bounds.centre - i.bounds.half), s.box.add(i.bounds.centre + i.bounds.half);
      s.power += i.bounds.power;
      ++s.count;
      if (i.bounds.cosAxes > -1) s.axes += i.bounds.axis;
    }
    std::array<float, kSlices> above; // cost of all slices from the next one on
    Slice sum;
    for (int k = kSlices - 1; k > 0; --k) sum.add(slices[k]), above[k - 1] = sum.cost();
    sum = {};
    for (int k = 0; k + 1 < kSlices; ++k) {
      sum.add(slices[k]);
      if (sum.count == 0 || sum.count == float(items.size())) continue;
      if (const float cost = sum.cost() + above[k]; cost < best) best = cost, bestAxis = axis, bestSlice = k;
    }
  }
  size_t middle = items.size() / 2; // where all are at one place
  if (bestAxis >= 0)
    middle = size_t(
        std::partition(items.begin(), items.end(), [&](const Item& i) { return sliceOf(i, bestAxis) <= bestSlice; }) -
        items.begin());
  grow(items.first(middle), first);
  nodes_[self].second = uint32_t(nodes_.size());
  grow(items.subspan(middle), first + uint32_t(middle));
  nodes_[self].bounds = nodes_[self + 1].bounds;
  add(nodes_[self].bounds, nodes_[nodes_[self].second].bounds);
}

LightChoice::LightChoice(const LightSet& lights, const vec3& x, const vec3& n) : lights_(lights), x_(x), n_(n) {
  static constexpr auto kAll = [] {
    std::array<uint32_t, kFewLights> all;
    for (uint32_t i = 0; i < kFewLights; ++i) all[i] = i;
    return all;
  }();
  const LightTree& tree = lights.tree;
  const bool few = lights.lightCount() <= kFewLights;
  single_ = few ? std::span(kAll).first(lights.lightCount()) : std::span(tree.suns_);
  if (few) {
    uint32_t i = 0;
    for (const LightView& l : lights.punctual) singleWeight_ += weights_[i++] = weightOf(l);
    for (const Emitter& e : lights.emitters) singleWeight_ += weights_[i++] = e.bounds.importance(x, n);
  } else {
    for (uint32_t i = 0; i < single_.size(); ++i) {
      const float weight = weightOf(single_[i]);
      if (i < kFewLights) weights_[i] = weight;
      singleWeight_ += weight;
    }
  }
  total_ = singleWeight_;
  if (few) return;
  CHECK_EQ(tree.lightCount(), lights.lightCount());
  if (tree.nodes_.empty()) return;
  // Near groups are opened, larger ones before their parts.
  partCount_ = 1;
  parts_[0].node = 0;
  for (uint32_t i = 0; i < partCount_;) {
    Part& part = parts_[i];
    const LightTree::Node& node = tree.nodes_[part.node];
    const bool near = isNear(node.bounds);
    if (near && node.second && partCount_ < kMostParts) {
      parts_[partCount_++] = {node.second, 0};
      ++part.node; // its first child
      continue;
    }
    part.weight = node.bounds.importance(x_, n_);
    if (near && !node.second && part.weight > 0) part.weight = weightOf(lightsOf(part.node));
    total_ += part.weight;
    ++i;
  }
}

bool LightChoice::isNear(const LightBounds& b) const {
  constexpr float kNear = 2; // times its radius
  const vec3 d = b.centre - x_;
  return glm::dot(d, d) <= kNear * kNear * glm::dot(b.half, b.half);
}

std::span<const uint32_t> LightChoice::lightsOf(uint32_t node) const {
  const LightTree& tree = lights_.tree;
  return std::span(tree.order_).subspan(tree.nodes_[node].first, tree.nodes_[node].count);
}

float LightChoice::weightOf(uint32_t light) const {
  const size_t punctual = lights_.punctual.size();
  return light < punctual ? weightOf(lights_.punctual[light])
                          : lights_.emitters[light - punctual].bounds.importance(x_, n_);
}

float LightChoice::weightOf(const LightView& light) const {
  float weight = luminance(punctualIrradiance(light, x_, n_).irradiance);
  if (hasDisk(light)) // the upper rim of its disk may be above the horizon
    weight += luminance(light.intensity) * std::sin(light.angularRadius) *
              float(glm::dot(n_, -light.direction) > -std::sin(light.angularRadius));
  return std::min(weight, kLargestWeight);
}

float LightChoice::weightOf(std::span<const uint32_t> lights) const {
  float sum = 0;
  for (uint32_t light : lights) sum += weightOf(light);
  return sum;
}

template <class WeightOf>
LightChoice::Chosen LightChoice::among(std::span<const uint32_t> lights, WeightOf&& weightOf, float rest, float sum,
                                       float probability) {
  Chosen chosen;
  for (size_t i = 0; i < lights.size(); ++i) {
    const float weight = weightOf(i);
    if (!(weight > 0)) continue;
    chosen = {lights[i], probability * (weight / sum)};
    if ((rest -= weight) < 0) break; // else rounding may leave a remainder: the last one
  }
  return chosen;
}

LightChoice::Chosen LightChoice::sample(float u) const {
  if (empty()) return {};
  float rest = u * total_;
  const auto single = [&](float r) {
    const auto weight = [&](size_t i) { return i < kFewLights ? weights_[i] : weightOf(single_[i]); };
    return among(single_, weight, r, singleWeight_, singleWeight_ / total_);
  };
  if (rest < singleWeight_ || partCount_ == 0) return single(rest);
  rest -= singleWeight_;
  const Part* part = nullptr;
  for (uint32_t i = 0; i < partCount_; ++i) {
    if (!(parts_[i].weight > 0)) continue;
    part = &parts_[i];
    if (rest < part->weight) break;
    rest -= part->weight;
  }
  if (!part) return single(singleWeight_); // rounding
  u = std::min(rest / part->weight, kBelowOne);
  float probability = part->weight / total_;
  const std::vector<LightTree::Node>& nodes = lights_.tree.nodes_;
  uint32_t at = part->node;
  while (nodes[at].second) {
    const float a = nodes[at + 1].bounds.importance(x_, n_), b = nodes[nodes[at].second].bounds.importance(x_, n_);
    if (!(a + b > 0)) return {};
    const float share = a / (a + b);
    const bool first = b <= 0 || u < share;
    probability *= first ? share : b / (a + b);
    u = std::min(first ? u / share : (u - share) / (1 - share), kBelowOne);
    at = first ? at + 1 : nodes[at].second;
  }
  const std::span<const uint32_t> lights = lightsOf(at);
  std::array<float, LightTree::kLeafLights> weights;
  float sum = 0;
  for (size_t i = 0; i < lights.size(); ++i) sum += weights[i] = weightOf(lights[i]);
  return among(
      lights, [&](size_t i) { return weights[i]; }, u * sum, sum, probability);
}

float LightChoice::probability(uint32_t light) const {
  if (empty()) return 0;
  const LightTree& tree = lights_.tree;
  if (partCount_ == 0 || tree.place_[light] == kNone) {
    const float weight = weightOf(light);
    return weight > 0 ? singleWeight_ / total_ * (weight / singleWeight_) : 0;
  }
  const uint32_t place = tree.place_[light];
  const auto holds = [&](uint32_t node) { return place - tree.nodes_[node].first < tree.nodes_[node].count; };
  const Part* part = parts_.data();
  while (!holds(part->node)) ++part;
  float probability = part->weight / total_;
  uint32_t at = part->node;
  while (tree.nodes_[at].second && probability > 0) {
    const uint32_t second = tree.nodes_[at].second;
    const float a = tree.nodes_[at + 1].bounds.importance(x_, n_), b = tree.nodes_[second].bounds.importance(x_, n_);
    const bool first = !holds(second);
    if (!((first ? a : b) > 0)) return 0;
    probability *= (first ? a : b) / (a + b);
    at = first ? at + 1 : second;
  }
  const float weight = probability > 0 ? weightOf(light) : 0;
  return weight > 0 ? probability * (weight / weightOf(lightsOf(at))) : 0;
}

} // namespace lambent

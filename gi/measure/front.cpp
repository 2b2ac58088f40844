#include "gi/measure/front.h"

#include "engine/core/error.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lambent {

namespace {

constexpr double kDeviations = 2; // standard errors that a difference must have

/// Whether a is below b by more than noise; both are above 0.
bool below(double a, double aNoise, double b, double bNoise) {
  return std::log(b / a) > kDeviations * std::hypot(aNoise, bNoise);
}
bool cheaper(const CostError& a, const CostError& b) { return below(a.cost, a.costNoise, b.cost, b.costNoise); }
bool nearer(const CostError& a, const CostError& b) { return below(a.error, a.errorNoise, b.error, b.errorNoise); }

} // namespace

std::vector<size_t> frontOf(std::span<const CostError> points) {
  std::vector<size_t> order(points.size()), front;
  std::iota(order.begin(), order.end(), size_t(0));
  std::ranges::sort(order, [&](size_t a, size_t b) {
    return std::pair(points[a].cost, points[a].error) < std::pair(points[b].cost, points[b].error);
  });
  for (size_t i : order)
    if (front.empty() || points[i].error < points[front.back()].error) front.push_back(i);
  return front;
}

bool offFront(std::span<const CostError> points, size_t index) {
  const CostError& own = points[index];
  return std::ranges::any_of(points, [&](const CostError& p) {
    return (cheaper(p, own) && p.error <= own.error) || (nearer(p, own) && p.cost <= own.cost);
  });
}

std::vector<size_t> ladderOf(std::span<const CostError> points, const LadderRule& rule) {
  const std::vector<size_t> front = frontOf(points);
  std::vector<size_t> steps(front.size(), 1), below(front.size(), front.size());
  for (size_t i = 0; i < front.size(); ++i)
    for (size_t k = 0; k < i; ++k) {
      const CostError &upper = points[front[i]], &lower = points[front[k]];
      const bool step = upper.cost >= rule.dearer * lower.cost && upper.error <= rule.nearer * lower.error;
      if (step && steps[k] + 1 > steps[i]) steps[i] = steps[k] + 1, below[i] = k;
    }
  std::vector<size_t> ladder;
  const auto last = std::ranges::max_element(steps); // the first of equals: the cheapest
  for (size_t i = size_t(last - steps.begin()); i < front.size(); i = below[i]) ladder.push_back(front[i]);
  std::ranges::reverse(ladder);
  return ladder;
}

KnobVerdict knobVerdict(std::span<const CostError> points) {
  CHECK(points.size() >= 2);
  KnobVerdict verdict{points.back().cost / points.front().cost, points.back().error / points.front().error};
  for (size_t i = 1; i < points.size(); ++i) verdict.monotone &= !cheaper(points[i], points[i - 1]);
  verdict.costs = cheaper(points.front(), points.back());
  verdict.buys = nearer(points.back(), points.front());
  return verdict;
}

CostError overScenes(std::span<const CostError> points, std::span<const CostError> references) {
  CHECK(!points.empty());
  CHECK_EQ(points.size(), references.size());
  CostError sum;
  for (size_t i = 0; i < points.size(); ++i) {
    sum.cost += std::log(points[i].cost / references[i].cost);
    sum.error += std::log(points[i].error / references[i].error);
    sum.costNoise += std::pow(points[i].costNoise, 2);
    sum.errorNoise += std::pow(points[i].errorNoise, 2);
  }
  const double n = double(points.size());
  return {std::exp(sum.cost / n), std::exp(sum.error / n), std::sqrt(sum.costNoise) / n, std::sqrt(sum.errorNoise) / n};
}

} // namespace lambent

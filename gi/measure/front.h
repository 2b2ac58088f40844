// Choosing among ways to set the program by what they cost and how far off they are. Pure functions of measured points.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace lambent {

/// One way, as measured. Cost and error are above 0, in any unit that is the same for all; noises are relative standard
/// errors.
struct CostError {
  double cost = 0, error = 0;
  double costNoise = 0, errorNoise = 0;
};

/// Indices of the points that no other beats (as cheap and as near, and better in one), by ascending cost.
std::vector<size_t> frontOf(std::span<const CostError> points);

/// Whether some other point is better in one by more than noise, two standard errors of the difference, and no worse in
/// the other.
bool offFront(std::span<const CostError> points, size_t index);

/// What a step up must cost at least, and what error it may leave at most, both of the step below.
struct LadderRule {
  double dearer = 1.5, nearer = 0.75;
};
/// The longest ladder of points of the front whose steps follow the rule, cheapest first: where the last step could be
/// another, the cheapest; below each, the cheapest that leaves the ladder as long. Points beyond the last bring less
/// than a step is worth. This is how presets are chosen.
std::vector<size_t> ladderOf(std::span<const CostError> points, const LadderRule& rule = {});

/// What a knob buys, its points in the order in which they should become dearer.
struct KnobVerdict {
  double dearer = 1, nearer = 1; // of the last point over the first: cost, error
  bool monotone = true;          // no point is cheaper than the one before by more than noise
  bool costs = false;            // the last point is dearer than the first by more than noise
  bool buys = false;             // the last point is nearer than the first by more than noise
};
/// Of two points at least.
KnobVerdict knobVerdict(std::span<const CostError> points);

/// Geometric mean of the same point over several scenes, each over that scene's reference point, so that no scene
/// counts more because it is slow or dark. Noises as of independent measurements.
CostError overScenes(std::span<const CostError> points, std::span<const CostError> references);

} // namespace lambent

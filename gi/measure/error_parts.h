// Which part of the error of indirect light in motion comes from what: each approximation is replaced by the exact
// thing, one after the other, and what the squared error loses by it is that part's. Squared errors add up where parts
// are independent. What hides the noise of others has a negative part: what it takes away is more than what it adds.
//
// From the first step on a pixel casts the same number of near rays a frame, so that their noise moves from no part to
// another. What is left of it differs still: by lists it is mixed with neighbours', which counts to the choice of
// lights, and averaged over frames, which counts to the history.
#pragma once

#include "gi/measure/statistics.h"
#include "gi/plan/settings.h"

#include <span>
#include <string>
#include <vector>

namespace lambent {

/// An approximation that is replaced, on top of those before it.
struct ExactStep {
  std::string part, by; // what it is; what takes its place
  Settings settings;    // of frames without it
};
/// `lightChanges`: in the frames that are measured, of which then other numbers of near rays are cast.
std::vector<ExactStep> exactSteps(const Settings& asSet, bool lightChanges);

/// Near rays that a pixel casts in a frame in motion, on the mean.
double nearRaysOfPixel(const Settings& settings, bool lightChanges);

struct ErrorPart {
  std::string part, by;
  UncertainValue error; // squared
};
/// `errors`: squared, as set and after each step; of each the same seeds. `ofTruth`: what the truth brings to them.
/// After the steps' parts that of the set of lights, which is what is left, and the truth's: the sum is the error as
/// set.
std::vector<ErrorPart> errorParts(std::span<const ExactStep> steps, std::span<const std::vector<double>> errors,
                                  double ofTruth);

} // namespace lambent

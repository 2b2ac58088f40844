// What the truth's own noise adds to mean |E| and |E'|, and what is left without it. Pure functions of recorded series.
//
// The truth is the mean of two independent halves, (A + B)/2. Where noise is small, independent of the technique and
// alike in both halves, half their difference, (A − B)/2, has the noise of the truth: the same variance, and the same
// distribution if that is symmetric. Its mean absolute value is the floor f: |E| of a technique without error. The
// floor of |E'| is that of changes of (A − B)/2, so it holds no more of the noise than differs from frame to frame.
//
// The statistic m is a mean of absolute values, m = mean |S + n| of an error S and noise n. m² = s² + f², s = mean |S|,
// holds where both are normal and their deviations have the same ratio at all pixels (of root mean squares it would
// hold for any S). It takes off too little where S is large in few places or pixels differ in that ratio, too much
// where |S| is the same everywhere. Whatever S is, m − f ≤ s ≤ m, as n has the mean 0. How far the model is off shows
// against one half of the truth, where the variance of n is twice as large: there it says m_half² = s² + 2f².
#pragma once

#include "gi/measure/stability.h"
#include "gi/measure/statistics.h"

namespace lambent {

/// Sums of absolute values of E or E' over some pixels and frames.
struct NoisySums {
  double whole = 0;  // against the truth
  double halves = 0; // against each half of it, the mean of both
  double noise = 0;  // of half the difference between the halves
  double count = 0;

  NoisySums& operator+=(const NoisySums& b);
  NoisySums operator-(const NoisySums& b) const;
};

/// The same values, summed by pixel and by part of the frames: errors have much in common over the frames of a pixel,
/// and over the pixels of a frame.
struct NoisyErrors {
  std::vector<NoisySums> pixels, parts;

  NoisySums sum() const;
  double mean() const;  // m; 0 of no values
  double floor() const; // f
};

enum class ErrorKind { Error, Change }; // E | E'

/// Adds what one seed's series gives. All series have the same shape; to be called with the same one for each seed.
void addNoisyErrors(NoisyErrors& to, ErrorKind kind, const PixelSeries& technique, const PixelSeries& truth,
                    const PixelSeries& halfA, const PixelSeries& halfB, std::span<const uint32_t> pixels);

/// s = √(m² − f²), 0 where noise is all there is. Its error holds those of a jackknife over pixels and over parts of
/// the frames, and an estimate of the model's: what it misses between the whole truth and its halves, extrapolated to
/// no noise as if it grew with the noise's deviation, the slowest that it may. NaN: too few values.
UncertainValue withoutNoise(const NoisyErrors& errors);

/// s of a over s of b, which share the truth and so much of its noise. NaN where noise is all that b has.
UncertainValue ratioWithoutNoise(const NoisyErrors& a, const NoisyErrors& b);

} // namespace lambent

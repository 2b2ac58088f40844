// Comparison of images in tests: a failure leaves both images and their difference, and says how to look again.
#pragma once

#include "engine/image/image.h"
#include "tests/support/test.h"

namespace lambent::test {

/// Root of the mean squared difference over the root of b's mean square.
double relativeRmse(const Image& a, const Image& b);
/// Mean |difference| of luminances over b's mean.
double relativeDifference(const Image& a, const Image& b);
/// Mean of the luminances.
double meanLuminance(const Image& a);
bool sameBits(const Image& a, const Image& b);
vec3 byteAt(const Image8& image, int x, int y);

/// Fails when the images differ by more than `bound`, and then writes NAME-actual.exr, NAME-expected.exr and
/// NAME-difference.exr to out/failed.
void expectClose(const std::string& name, const Image& actual, const Image& expected, double bound);

} // namespace lambent::test

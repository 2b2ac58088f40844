// Variance of the luminance of a pixel's frames about their mean.
const vec3 kLuminance = vec3(0.2126, 0.7152, 0.0722);

/// With one frame more, which differs by `difference` from the mean of the `frames` before it (Welford 1962; of a mean
/// that forgets, its exponential form).
float varianceWith(float variance, vec3 difference, float frames) {
  float distance = dot(kLuminance, difference), share = 1.0 / (frames + 1.0);
  return frames > 0.0 ? (1.0 - share) * (variance + share * distance * distance) : 0.0;
}

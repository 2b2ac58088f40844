// Variance of the luminance of a pixel's frames about their mean.
const vec3 kLuminance = vec3(0.2126, 0.7152, 0.0722);

/// Smallest and largest luminance.
vec2 spanWith(vec2 span, vec3 light) {
  float brightness = dot(kLuminance, light);
  return vec2(min(span.x, brightness), max(span.y, brightness));
}

/// With one frame more, whose luminance is `now`, after `frames` whose means span `before` at the places that were
/// looked up (Welford 1962; of a mean that forgets, its exponential form). What lies between is an edge, not noise.
float varianceWith(float variance, float now, vec2 before, float frames) {
  float distance = now - clamp(now, before.x, before.y), share = 1.0 / (frames + 1.0);
  float sum = frames > 0.0 ? (1.0 - share) * (variance + share * distance * distance) : 0.0;
  return isnan(sum) || isinf(sum) ? 0.0 : sum;
}

/// Frames that a mean is worth where looking it up blurs an edge of light: as many as make its noise as small as that
/// blur, and all where the span of the means is noise.
float framesWorth(float variance, vec2 span) {
  const float kNoiseOfSpan = 1.0;
  float edge = span.y - span.x;
  return edge > 0.0 ? kNoiseOfSpan * variance / (edge * edge) : 1e6;
}

// Variance of the luminance of a pixel's frames about what the denoised frame before showed there.
const vec3 kLuminance = vec3(0.2126, 0.7152, 0.0722);

/// Smallest and largest luminance.
vec2 spanWith(vec2 span, vec3 light) {
  float brightness = dot(kLuminance, light);
  return vec2(min(span.x, brightness), max(span.y, brightness));
}

/// With one frame more, whose luminance is `now`, after `frames`. The frame before spans `before` where it was looked
/// up; what lies between is an edge, not noise. 0 of a first frame, which has nothing to differ from.
float varianceWith(float variance, float now, vec2 before, float frames) {
  float distance = now - clamp(now, before.x, before.y), share = 1.0 / max(frames, 1.0);
  float sum = frames > 0.0 ? mix(variance, distance * distance, share) : 0.0;
  return isnan(sum) || isinf(sum) ? 0.0 : sum;
}

/// Frames that a mean is worth where looking it up blurs an edge of light: as many as make its noise as small as that
/// edge.
float framesWorth(float variance, vec2 span) {
  float edge = span.y - span.x;
  return edge > 0.0 ? variance / (edge * edge) : 1e6;
}

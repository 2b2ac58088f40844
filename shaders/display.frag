#version 450
// One buffer as a display shows it. MODE: 0 radiance (exposure, Reinhard on luminance, sRGB), 1 colour in [0,1] (sRGB),
// 2 unit vector, 3 depth. The texture of mode 1 and 3 in background pixels is black.
layout(binding = 0) uniform sampler2D gbufferDepth;
layout(binding = 2) uniform sampler2D source;
uniform float factor;   // exposure (mode 0); metres shown as mid grey (mode 3)
uniform vec2 lens;      // near, far (0: perspective), metres
uniform int markNan;
layout(location = 0) out vec4 outColor;

vec3 srgbFromLinear(vec3 c) {
  c = clamp(c, 0.0, 1.0);
  return mix(c * 12.92, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, greaterThan(c, vec3(0.0031308)));
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec3 value = texelFetch(source, min(pixel, textureSize(source, 0) - 1), 0).rgb;
#if MODE == 0
  if (markNan != 0 && any(isnan(value))) {
    outColor = vec4(1.0, 0.0, 1.0, 1.0);
    return;
  }
  if (markNan != 0 && any(isinf(value))) {
    outColor = vec4(0.0, 1.0, 1.0, 1.0);
    return;
  }
  value = max(value * factor, 0.0);
  value /= 1.0 + dot(value, vec3(0.2126, 0.7152, 0.0722));
#ifdef GREY
  value = vec3(dot(value, vec3(0.2126, 0.7152, 0.0722)));
#endif
  outColor = vec4(srgbFromLinear(value), 1.0);
#else
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  outColor = vec4(0.0, 0.0, 0.0, 1.0);
  if (depth == 0.0) return;
#if MODE == 1
  outColor.rgb = srgbFromLinear(value);
#elif MODE == 2
  outColor.rgb = value * 0.5 + 0.5;
#else
  float distance = lens.y > 0.0 ? lens.y - depth * (lens.y - lens.x) : lens.x / depth;
  outColor.rgb = vec3(factor / (factor + distance));
#endif
#endif
}

#version 450
// The image without stairs along its edges. An edge that is seen at pixel centres only is made of straight runs, each
// a pixel from the next; the line through the middles of their ends is near the edge that made them, and what it cuts
// off a pixel takes the colour of the pixel beyond (morphological antialiasing: Reshetov 2009; which way the edge runs,
// as FXAA: Lottes 2009). Ours: both sides of a line at once, so that thin ones stay as bright as they are; runs whose
// end is out of reach. Pixels next to no edge are discarded, which keeps their bytes and, on software Mesa, saves the
// time that a branch does not.
layout(binding = 0) uniform sampler2D shown; // display-encoded; a: luma before clipping, 0: a mark, no colour
layout(location = 0) out vec4 outColor;

const float kLeastStep = 0.06; // of luma; what is less is no edge
const int kReach = 24;         // pixels of a run that are looked at on either side

float lumaAt(ivec2 pixel) { return texelFetch(shown, clamp(pixel, ivec2(0), textureSize(shown, 0) - 1), 0).a; }
vec3 linearAt(ivec2 pixel) { // pixel inside
  vec3 c = texelFetch(shown, pixel, 0).rgb;
  return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), greaterThan(c, vec3(0.04045)));
}
vec3 srgbFromLinear(vec3 c) {
  return mix(c * 12.92, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, greaterThan(c, vec3(0.0031308)));
}

/// ∫ max(0, h) over a unit on which h goes from a to b in a straight line.
float areaAbove(float a, float b) {
  float high = max(a, b), low = min(a, b);
  return low >= 0.0 ? 0.5 * (a + b) : high <= 0.0 ? 0.0 : 0.5 * high * high / (high - low);
}

/// What the pixel beyond an edge covers of `pixel`. `across` leads there, the edge runs `along`.
float coverage(ivec2 pixel, ivec2 across, ivec2 along) {
  float here = lumaAt(pixel), beyond = lumaAt(pixel + across);
  if (beyond == 0.0) return 0.0;
  float difference = beyond - here, enough = 0.5 * difference * difference;
  bool thinHere = abs(lumaAt(pixel - across) - beyond) < 0.5 * abs(difference);
  bool thinBeyond = abs(lumaAt(pixel + 2 * across) - here) < 0.5 * abs(difference);

  vec2 pixels = vec2(kReach); // of the run, before and after this one
  vec2 end = vec2(0.0);       // height of the line there, towards this pixel; 0: the edge fades or goes on
  for (int side = 0; side < 2; ++side) {
    ivec2 forward = side == 0 ? -along : along;
    float lastHere = here, lastBeyond = beyond;
    for (int k = 1; k <= kReach; ++k) {
      float nextHere = lumaAt(pixel + k * forward), nextBeyond = lumaAt(pixel + across + k * forward);
      if ((nextBeyond - nextHere) * difference < enough) {
        bool cutsHere = (nextHere - lastHere) * difference > enough;
        bool cutsBeyond = (lastBeyond - nextBeyond) * difference > enough;
        if (cutsHere && cutsBeyond) { // four pixels like a chessboard: the thin line goes on
          cutsHere = thinBeyond && !thinHere;
          cutsBeyond = thinHere && !thinBeyond;
        }
        end[side] = cutsHere ? 0.5 : cutsBeyond ? -0.5 : 0.0;
        pixels[side] = float(k - 1);
        break;
      }
      lastHere = nextHere;
      lastBeyond = nextBeyond;
    }
  }

  // The line falls from either end to the middle of the run, or as far as ends are looked for.
  float run = pixels.x + 1.0 + pixels.y;
  float fall = max(pixels.x, pixels.y) < float(kReach) ? 0.5 * run : float(kReach + 1);
  vec3 place = pixels.x + vec3(0.0, clamp(0.5 * run - pixels.x, 0.0, 1.0), 1.0);
  vec3 height = end.x * max(1.0 - place / fall, 0.0) + end.y * max(1.0 - (run - place) / fall, 0.0);
  return (place.y - place.x) * areaAbove(height.x, height.y) + (place.z - place.y) * areaAbove(height.y, height.z);
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float here = lumaAt(pixel);
  float up = lumaAt(pixel + ivec2(0, 1)), down = lumaAt(pixel - ivec2(0, 1));
  float right = lumaAt(pixel + ivec2(1, 0)), left = lumaAt(pixel - ivec2(1, 0));
  vec4 steps = abs(vec4(left, right, down, up) - here);
  if (max(max(steps.x, steps.y), max(steps.z, steps.w)) < kLeastStep || here == 0.0) discard;

  float upRight = lumaAt(pixel + ivec2(1, 1)), downLeft = lumaAt(pixel - ivec2(1, 1));
  float upLeft = lumaAt(pixel + ivec2(-1, 1)), downRight = lumaAt(pixel - ivec2(-1, 1));
  float bendsUp = abs(upLeft + downLeft - 2.0 * left) + 2.0 * abs(up + down - 2.0 * here) +
                  abs(upRight + downRight - 2.0 * right);
  float bendsRight = abs(upLeft + upRight - 2.0 * up) + 2.0 * abs(left + right - 2.0 * here) +
                     abs(downLeft + downRight - 2.0 * down);
  bool runsRight = bendsUp >= bendsRight;
  vec2 side = runsRight ? steps.zw : steps.xy;
  float most = max(side.x, side.y), least = min(side.x, side.y);
  if (most < kLeastStep) discard;
  ivec2 across = runsRight ? ivec2(0, 1) : ivec2(1, 0);
  if (side.x > side.y) across = -across;
  int sides = least >= max(kLeastStep, 0.5 * most) ? 2 : 1;
  vec3 own = linearAt(pixel), color = own;
  for (int i = 0; i < sides; ++i) { // neither covers more than half
    ivec2 there = i == 0 ? across : -across;
    color += coverage(pixel, there, across.yx) * (linearAt(pixel + there) - own);
  }
  outColor = vec4(srgbFromLinear(color), 1.0);
}

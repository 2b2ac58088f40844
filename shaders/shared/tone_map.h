// From exposed radiance to what a display shows, before its transfer function; one text for C++ and GLSL.
#pragma once
#include "interop.h"
SHARED_BEGIN

/// x/(1+x) on luminance (Reinhard et al. 2002, as paper 1): hues stay, bright colours leave [0, 1] and are cut off.
SHARED_INLINE vec3 reinhard(vec3 c) { return c / (1.0f + dot(c, vec3(0.2126f, 0.7152f, 0.0722f))); }

/// Khronos PBR Neutral (2024): as it is up to 0.76, less the 0.04 that dielectrics reflect; brighter colours are
/// compressed by their largest component and go over to white.
SHARED_INLINE vec3 pbrNeutral(vec3 c) {
  float least = min(c.x, min(c.y, c.z));
  c = c - vec3(least < 0.08f ? least - 6.25f * least * least : 0.04f);
  float peak = max(c.x, max(c.y, c.z));
  const float start = 0.76f, room = 1.0f - start;
  if (peak < start) return c;
  float compressed = 1.0f - room * room / (peak + room - start);
  float white = 1.0f - 1.0f / (0.15f * (peak - compressed) + 1.0f);
  return mix(c * (compressed / peak), vec3(compressed), white);
}

/// Narkowicz's fit of the ACES film curve (2015), by component: contrast of film, bright colours go over to white. Squares
/// end at 1e38; from 1e9 on it is flat to rounding.
SHARED_INLINE vec3 filmic(vec3 c) {
  c = min(c, vec3(1e9f));
  return c * (2.51f * c + 0.03f) / (c * (2.43f * c + 0.59f) + 0.14f);
}

/// Finite, for grey rising, and above -1e-6, for every finite c of which no channel is negative. `toneMapper`: ToneMapper (gi/plan/settings.h).
SHARED_INLINE vec3 toneMapped(vec3 c, int toneMapper) {
  return toneMapper == 1 ? pbrNeutral(c) : toneMapper == 2 ? filmic(c) : reinhard(c);
}

SHARED_END

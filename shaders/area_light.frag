#version 450
// Direct light of one block of area lights' pieces: what they bring where nothing is between, times the share of it that
// reaches the pixel. GLOSSY: the receivers' lobes too, by disks that stand for the pieces (DISKS: of one block of them).
#include "lib/gbuffer.glsl"
#ifdef GLOSSY
#include "lib/receiver.glsl"
#endif
#include "shared/area_piece.h"

layout(std140, binding = 1) uniform Pieces { AreaPiece pieces[kPiecesPerBlock]; };
layout(binding = 2) uniform sampler2D visible; // share per channel
uniform int pieceCount;
uniform float spread; // GLOSSY: GatherSettings::spread
layout(location = 0) out vec4 outIrradiance;
#ifdef GLOSSY
layout(location = 1) out vec4 outGlossy; // radiance over glossyTint
#endif

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  outIrradiance = vec4(0.0);
#ifdef GLOSSY
  outGlossy = vec4(0.0);
#endif
  float depth = texelFetch(gbufferDepth, pixel, 0).r;
  vec3 share = texelFetch(visible, pixel, 0).rgb;
  if (depth == 0.0 || share == vec3(0.0)) return;
  vec3 position = positionFromDepth(pixel, depth);
  vec3 normal = texelFetch(gbufferNormal, pixel, 0).xyz;
#ifdef DISKS
  Receiver receiver = receiverAt(pixel, position, normal);
#endif
  vec3 sum = vec3(0.0);
  for (int i = 0; i < pieceCount; ++i) {
    AreaPiece piece = pieces[i];
    float factor = areaFormFactor(piece, position, normal);
#ifdef DISKS
    if (factor == 0.0) continue;
    vec3 way = piece.corners[0].xyz - position;
    float distance2 = squaredLength(way);
    vec3 towardsLight = way * inversesqrt(distance2);
    float widening = lobeSpread(spread, piece.normalArea.w, abs(dot(piece.normalArea.xyz, towardsLight)), distance2);
    factor *= glossyReflectance(receiver, towardsLight, widening);
#endif
    sum += piece.radianceSides.rgb * factor;
  }
#ifdef DISKS
  outGlossy = vec4(share * sum / glossyTint(receiver), 1.0);
#else
  outIrradiance = vec4(share * sum, 1.0);
#endif
}

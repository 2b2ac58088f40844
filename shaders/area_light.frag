#version 450
// Direct light of one block of area lights' pieces: what they bring where nothing is between, times the share of it that
// reaches the pixel. DISKS: of a block without polygons (software Mesa runs both branches of what differs among pieces).
// GLOSSY: the receivers' lobes too, by linearly transformed cosines.
#include "lib/gbuffer.glsl"
#include "shared/area_piece.h"
#ifdef GLOSSY
#include "lib/receiver.glsl"
#include "shared/area_lobe.h"
#endif

layout(std140, binding = 1) uniform Pieces { AreaPiece pieces[kPiecesPerBlock]; };
layout(binding = 2) uniform sampler2D visible; // share per channel
uniform int pieceCount;
layout(location = 0) out vec4 outIrradiance;
#ifdef GLOSSY
layout(binding = 3) uniform sampler2DArray lobes; // members of AreaLobe
uniform float spread;                             // GatherSettings::spread
layout(location = 1) out vec4 outGlossy;          // radiance over glossyTint

AreaLobe lobeFor(float alpha2, float cosViewer) {
  vec2 place = lobePlace(alpha2, cosViewer);
  return forViewer(AreaLobe(textureLod(lobes, vec3(place, 0.0), 0.0), textureLod(lobes, vec3(place, 1.0), 0.0),
                            textureLod(lobes, vec3(place, 2.0), 0.0)),
                   cosViewer);
}
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
  vec3 normal = normalForLight(pixel, texelFetch(gbufferNormal, pixel, 0).xyz);
#ifdef GLOSSY
  Receiver receiver = receiverAt(pixel, position, normal);
  AreaLobe lobe = lobeFor(receiver.alpha2, receiver.cosViewer);
  vec3 glossy = vec3(0.0), x, y;
  lobeFrame(receiver, x, y);
#endif
  vec3 sum = vec3(0.0);
  for (int i = 0; i < pieceCount; ++i) {
#ifdef DISKS
    float factor = diskFormFactor(pieces[i], position, normal);
#else
    float factor = areaFormFactor(pieces[i], position, normal);
#endif
    sum += pieces[i].radianceSides.rgb * factor;
#ifdef GLOSSY
    if (factor == 0.0 || receiver.grazing == vec3(0.0)) continue;
    AreaPiece piece = pieces[i];
    AreaLobe lobeOfPiece = lobe;
    if (piece.corners[0].w == 0.0) { // disks have gaps between them, which a wider lobe does not see
      vec3 way = piece.corners[0].xyz - position;
      float distance2 = squaredLength(way), facing = abs(dot(piece.normalArea.xyz, way)) * inversesqrt(distance2);
      float widened = receiver.alpha2 + lobeSpread(spread, piece.normalArea.w, facing, distance2);
      lobeOfPiece = lobeFor(min(widened, 1.0), receiver.cosViewer);
    }
    glossy += piece.radianceSides.rgb * lobeReflection(piece, position, receiver, lobeOfPiece, x, y);
#endif
  }
  outIrradiance = vec4(share * sum * lengthForLight(pixel), 1.0);
#ifdef GLOSSY
  outGlossy = vec4(share * glossy / glossyTint(receiver), 1.0);
#endif
}

// A VPL from texels or clusters of reflective shadow maps, for transform feedback: fields of VplLight.
#include "shared/paraboloid.h"
#include "shared/vpl_light.h"

out vec4 positionArea;
out vec4 powerNormalX;
out vec4 tangentNormalY;
out vec4 bitangentNormalZ;

void setNoLight() { positionArea = powerNormalX = tangentNormalY = bitangentNormalZ = vec4(0.0); }

/// Intensity of a diffuse reflector is flux/π along its normal (paper 2, equation 1). False: there is no light.
bool setLight(vec3 position, vec3 normal, vec3 flux, float area) {
  setNoLight();
  float size = length(normal);
  if (!(size > 0.0) || !(area > 0.0) || !(max(max(flux.r, flux.g), flux.b) > 0.0)) return false;
  vec3 n = normal / size, tangent, bitangent;
  basisAround(n, tangent, bitangent);
  positionArea = vec4(position, area);
  powerNormalX = vec4(flux * 0.318309886, n.x);
  tangentNormalY = vec4(tangent, n.y);
  bitangentNormalZ = vec4(bitangent, n.z);
  return true;
}

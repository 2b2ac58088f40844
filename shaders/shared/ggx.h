// Reflection of a glossy receiver, the surface that the camera sees; one text for C++ and GLSL. A Lambert part and a
// lobe: GGX normals (Walter et al. 2007, eq. 33) with α = roughness², height-correlated Smith masking (Heitz 2014,
// eq. 99), Schlick's Fresnel term. Materials are glTF's: F0 is 0.04 for dielectrics and the albedo for metals.
//
// Where the lobe takes light, the Lambert part must give it up, or a white wall would send out more than it gets. It is
// scaled by one minus a bound of what a dielectric lobe reflects altogether towards this viewer. The scale does not
// depend on the light, so the irradiance that the passes gather, store and filter stays what it is for Lambert
// surfaces; the price is that the Lambert part alone is not reciprocal. (The lobe is.)
#pragma once
#include "interop.h"
SHARED_BEGIN

/// Sharper lobes are drawn as this one: virtual lights are points, and would be seen one by one.
const float kLeastRoughness = 0.3f;
const float kDielectricF0 = 0.04f;

/// A surface point as its viewer sees it, made once for all lights.
struct Receiver {
  vec3 normal;        // unit
  vec3 towardsViewer; // unit
  vec3 specular;      // F0
  vec3 diffuse;       // what is left of the albedo
  float cosViewer;    // at least 1e-4
  float alpha2;       // α²
  float strength;     // of the lobe, [0,1]
};

/// Bound of the share of uniform light that a dielectric's lobe reflects towards a viewer, for roughness in [0.3, 1]. A
/// fit to numerical integrals: 0 to 0.04 above them.
SHARED_INLINE float dielectricShare(float roughness, float cosViewer) {
  float grazing = 1.0f - cosViewer;
  return kDielectricF0 + (0.157f / roughness - 0.115f) * grazing * grazing * sqrt(grazing);
}

/// `roughness` is perceptual (glTF's). Over its last tenth the lobe of a dielectric fades out: at 1 it is Lambert,
/// which is how this program shows everything while gather.glossy is off.
SHARED_INLINE Receiver makeReceiver(vec3 normal, vec3 towardsViewer, vec3 albedo, float roughness, float metalness) {
  Receiver r;
  r.normal = normal;
  r.towardsViewer = towardsViewer;
  r.specular = vec3(kDielectricF0) * (1.0f - metalness) + albedo * metalness;
  r.cosViewer = min(max(dot(normal, towardsViewer), 1e-4f), 1.0f);
  float clamped = max(roughness, kLeastRoughness);
  float alpha = clamped * clamped;
  r.alpha2 = alpha * alpha;
  float dielectric = min(10.0f * (1.0f - clamped), 1.0f);
  r.strength = dielectric + (1.0f - dielectric) * metalness;
  r.diffuse = albedo * ((1.0f - metalness) * (1.0f - r.strength * dielectricShare(clamped, r.cosViewer)));
  return r;
}

/// Density of the lobe's normals, 1/sr, at the cosine between normal and half vector; within 3e-5 of it for makeReceiver's
/// α².
SHARED_INLINE float ggxDensity(float alpha2, float cosHalf) {
  float t = cosHalf * cosHalf * (alpha2 - 1.0f) + 1.0f;
  return alpha2 / (3.14159265f * t * t);
}

/// What a virtual light adds to α², for it stands for a surface and not for a point: `factor` (GatherSettings::spread)
/// times the square of the angle under which the receiver sees the radius of its area. A disk by itself would ask for
/// 1/8 (half vectors turn by half the angle, α² is twice the variance of their slopes), and the gaps between lights for
/// more.
SHARED_INLINE float lobeSpread(float factor, float area, float cosLight, float distance2) {
  return factor * 0.318309886f * area * max(cosLight, 0.0f) / distance2;
}

/// The lobe, 1/sr: radiance towards the viewer per irradiance from the unit direction `towardsLight`, within 1e-3 of
/// itself. Finite everywhere; means nothing where the light is below the surface, for its irradiance is zero there. `spread`: see
/// lobeSpread; 0 for a light that is a point.
SHARED_INLINE vec3 glossyReflectance(Receiver r, vec3 towardsLight, float spread) {
  float alpha2 = min(r.alpha2 + spread, 1.0f);
  float cosLight = max(dot(r.normal, towardsLight), 0.0f);
  // |light + viewer|² = 2 + 2 light·viewer, so cosines with the half vector need not build it.
  float onePlus = max(1.0f + dot(towardsLight, r.towardsViewer), 1e-6f);
  float cosHalf = min((cosLight + r.cosViewer) / sqrt(2.0f * onePlus), 1.0f);
  float density = ggxDensity(alpha2, cosHalf);
  float masking = 0.5f / (cosLight * sqrt(r.cosViewer * r.cosViewer * (1.0f - alpha2) + alpha2) +
                          r.cosViewer * sqrt(cosLight * cosLight * (1.0f - alpha2) + alpha2));
  float grazing = max(1.0f - sqrt(0.5f * onePlus), 0.0f);
  float grazing2 = grazing * grazing;
  vec3 fresnel = r.specular + (vec3(1.0f) - r.specular) * (grazing2 * grazing2 * grazing);
  return fresnel * (r.strength * density * masking);
}

/// Colour that glossy light is divided by while it is stored and filtered, so that textures of metals stay sharp.
SHARED_INLINE vec3 glossyTint(Receiver r) { return max(r.specular, vec3(kDielectricF0)); }

SHARED_END

// Reflection of a glossy receiver, the surface that the camera sees; one text for C++ and GLSL. A Lambert part and a
// lobe: GGX normals (Walter et al. 2007, eq. 33) with α = roughness², height-correlated Smith masking (Heitz 2014,
// eq. 99), Schlick's Fresnel term. Materials are glTF's: F0 is the albedo for metals, 0.04 for dielectrics that do not
// say otherwise (KHR_materials_ior, KHR_materials_specular).
//
// Light that meets more than one facet is made up for by a factor (Turquin 2019, "Practical multiple scattering
// compensation for microfacet models", eq. 16), or rough metals would be dark. Where the lobe takes light, the Lambert
// part must give it up, or a white wall would send out more than it gets. It is scaled by one minus a bound of what a
// dielectric lobe reflects altogether towards this viewer. Neither factor depends on the light, so the irradiance that
// the passes gather, store and filter stays what it is for Lambert surfaces; the price is that both parts are
// reciprocal but for a factor of the viewer.
#pragma once
#include "interop.h"
SHARED_BEGIN

/// Sharper lobes are drawn as this one, half a degree wide; 0 would be a mirror, in which points of light have no size.
const float kLeastRoughness = 0.05f;
/// What virtual lights are mirrored by at least: they are points, and would be seen one by one.
const float kLeastVplRoughness = 0.3f;
const float kDielectricF0 = 0.04f;

/// A surface point as its viewer sees it, made once for all lights.
struct Receiver {
  vec3 normal;        // unit
  vec3 towardsViewer; // unit
  vec3 specular;      // of the lobe head-on, and
  vec3 grazing;       // what Schlick's term adds to it; both with what meets several facets
  vec3 diffuse;       // what is left of the albedo
  float cosViewer;    // at least 1e-4
  float alpha2;       // α²
};

/// Bound of the share of uniform light that a lobe of F0 = 1 reflects towards a viewer without compensation; a fit to
/// numerical integrals, 0 to 0.1 of it above them. The rest is light that facets hide.
SHARED_INLINE float lobeShare(float roughness, float cosViewer) {
  float alpha = roughness * roughness, x = alpha / (alpha + cosViewer);
  float hidden = x * ((0.2227f + (-1.1596f + 4.6133f * roughness) * roughness) +
                      x * ((-0.0075f + (1.5276f - 7.0770f * roughness) * roughness) +
                           x * (-0.0173f + (-1.1724f + 3.1393f * roughness) * roughness)));
  return min(max(1.043f * (1.0f - hidden), 1.0f - 5.0f * cosViewer), 1.0f);
}

/// Bound of the same for Schlick's part, F0 = 0: 0 to 0.05 above, 0.2 at cosines below 0.1.
SHARED_INLINE float schlickShare(float roughness, float cosViewer) {
  return 1.06f * pow(max(1.0f - cosViewer, 0.0f), 5.0945f * exp(-1.2469f * roughness)) /
         (1.0f + 23.2458f * pow(roughness, 2.5706f));
}

/// Finish of a surface: roughness (perceptual, glTF's), metalness, F0 of its dielectric part (0: kDielectricF0) and a
/// weight of that part's lobe, all in [0, 1].
SHARED_INLINE vec4 plainFinish(float roughness, float metalness) { return vec4(roughness, metalness, 0.0f, 1.0f); }

/// Over the last tenth of roughness the lobe of a dielectric fades out: at 1 it is Lambert.
SHARED_INLINE Receiver makeReceiver(vec3 normal, vec3 towardsViewer, vec3 albedo, vec4 finish) {
  Receiver r;
  r.normal = normal;
  r.towardsViewer = towardsViewer;
  float metalness = finish.y, f0 = finish.z > 0.0f ? finish.z : kDielectricF0;
  r.cosViewer = min(max(dot(normal, towardsViewer), 1e-4f), 1.0f);
  float roughness = max(finish.x, kLeastRoughness);
  float alpha = roughness * roughness;
  r.alpha2 = alpha * alpha;
  float dielectric = min(10.0f * (1.0f - roughness), 1.0f) * finish.w;
  float again = 1.0f / lobeShare(roughness, r.cosViewer) - 1.0f;
  float ofDielectric = (1.0f - metalness) * dielectric * (1.0f + f0 * again);
  vec3 ofMetal = metalness * (vec3(1.0f) + albedo * again);
  r.specular = vec3(ofDielectric * f0) + ofMetal * albedo;
  r.grazing = vec3(ofDielectric * (1.0f - f0)) + ofMetal * (vec3(1.0f) - albedo);
  float taken = f0 + (1.0f - f0) * schlickShare(roughness, r.cosViewer) * (1.0f + f0 * again);
  r.diffuse = albedo * ((1.0f - metalness) * max(1.0f - dielectric * taken, 0.0f));
  return r;
}

/// Share of a lobe's indirect light that rays bring where mirrors are traced (gather.mirrors); the rest is that of
/// virtual lights. The two meet around the roughness from which on virtual lights are mirrored as they should be.
SHARED_INLINE float mirrorShare(Receiver r) {
  return min(max(10.0f * (kLeastVplRoughness + 0.05f - sqrt(sqrt(r.alpha2))), 0.0f), 1.0f);
}

/// The same receiver as virtual lights are mirrored in it. `mirrors`: 1 where rays bring mirrorShare of it, else 0.
SHARED_INLINE Receiver forVirtualLights(Receiver r, float mirrors) {
  const float least = kLeastVplRoughness * kLeastVplRoughness * kLeastVplRoughness * kLeastVplRoughness;
  float share = 1.0f - mirrors * mirrorShare(r);
  r.specular *= share;
  r.grazing *= share;
  r.alpha2 = max(r.alpha2, least);
  return r;
}

/// Density of the lobe's normals, 1/sr, where the half vector has the tangent² `sine2 / cosine2` to the normal. The two
/// are squared parts of a unit vector; given both, the peak of a sharp lobe keeps its digits.
SHARED_INLINE float ggxDensity(float alpha2, float sine2, float cosine2) {
  float t = sine2 + alpha2 * cosine2;
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
/// itself. Finite everywhere; means nothing where the light is below the surface, for its irradiance is zero there.
/// `spread`: see lobeSpread; 0 for a light that is a point.
SHARED_INLINE vec3 glossyReflectance(Receiver r, vec3 towardsLight, float spread) {
  float alpha2 = min(r.alpha2 + spread, 1.0f);
  float cosLight = max(dot(r.normal, towardsLight), 0.0f);
  vec3 half_ = towardsLight + r.towardsViewer, across = cross(r.normal, half_);
  float length2 = max(dot(half_, half_), 1e-12f), along = cosLight + r.cosViewer;
  float density = ggxDensity(alpha2, dot(across, across) / length2, min(along * along / length2, 1.0f));
  float masking = 0.5f / (cosLight * sqrt(r.cosViewer * r.cosViewer * (1.0f - alpha2) + alpha2) +
                          r.cosViewer * sqrt(cosLight * cosLight * (1.0f - alpha2) + alpha2));
  float grazing = max(1.0f - 0.5f * sqrt(length2), 0.0f); // 1 − the cosine between half vector and light
  float grazing2 = grazing * grazing;
  return (r.specular + r.grazing * (grazing2 * grazing2 * grazing)) * (density * masking);
}

/// Colour that glossy light is divided by while it is stored and filtered, so that textures of metals stay sharp.
SHARED_INLINE vec3 glossyTint(Receiver r) { return max(r.specular, vec3(kDielectricF0)); }

SHARED_END

// Light leaving its sources as photons, for the techniques that start at the lights (ir, tcas): choice of a light in
// proportion to its power, a ray, and the flux that the photon stands for. World space, metres, W.
#pragma once

#include "gi/lighting/light_set.h"

namespace lambent {

/// The numbers in [0, 1) that one photon is made from.
struct PhotonNumbers {
  float light;
  vec2 position, direction;
};
/// `index`-th point of a sequence that fills these five dimensions evenly over any run of indices (additive
/// recurrence), shifted by the seed.
PhotonNumbers photonNumbers(uint32_t index, uint32_t seed);

/// Place in the sequence of the `i`-th of `count` photons in slot order. Interleaved sampling shows a pixel only the
/// slots of one class, slot mod 16; a run of the sequence for each class keeps every class as even as the whole.
uint32_t sequenceIndex(uint32_t i, uint32_t count);

/// One photon as it leaves a light.
struct Photon {
  Ray ray;                 // unit direction
  vec3 flux{0};            // W per channel over the density of its numbers: the mean over photons is the lights' power
  float range = kInfinity; // metres, of the light's window (KHR_lights_punctual)
};

/// All lights as one source of photons. Suns and sky send theirs through a disk that covers the scene's bounds as seen
/// along the direction, so in an open scene many photons meet nothing (paper 1, 5.1, of its citadel).
class PhotonSource {
 public:
  /// `lights` must outlive the source.
  PhotonSource(const LightSet& lights, const Aabb& boundsWorld, float rayEpsilon);

  /// Says whether no light has power or nothing is there to be lit.
  bool empty() const { return choice_.empty(); }
  /// Power of all lights, W as a luminance.
  float power() const { return power_; }
  /// Sends one photon. Requires !empty().
  Photon emit(const PhotonNumbers& u) const;

 private:
  Photon emitPunctual(const LightView& light, const PhotonNumbers& u) const;
  Photon emitSurface(const Emitter& emitter, float uTriangle, const PhotonNumbers& u) const;
  Photon emitSky(const PhotonNumbers& u) const;
  Photon fromDisk(const vec3& direction, float radius, vec2 u) const;
  float diskRadius(const vec3& direction) const;

  const LightSet& lights_;
  Aabb bounds_;
  float rayEpsilon_;    // of the ray query
  Distribution choice_; // punctual lights, then emitters, then the sky
  float power_ = 0;
};

/// Flux that a photon brings to what it met: within the light's range, and seen under the shading normal as the
/// reference and the radiosity estimate see it (Veach 1997, 5.3: cosine to the shading over cosine to the geometric
/// normal, here at most 4 so that grazing hits on coarse meshes stay in bounds).
vec3 arrivingFlux(const Photon& photon, const SurfaceHit& hit);

} // namespace lambent

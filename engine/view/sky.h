// The sky: radiance from every direction around a scene, the same everywhere in it. Nothing here is a length, so a
// scene may have any scale. +Y is up.
#pragma once

#include "engine/core/math.h"

#include <memory>
#include <vector>

namespace lambent {

struct DaylightModel;

/// Radiance from every direction by longitude (columns) and latitude (rows, the first one up). The middle of the
/// picture is +X, a quarter right of it +Z.
struct SkyImage {
  int width = 0, height = 0;
  std::vector<vec3> texels; // finite, not negative
};

/// A direction drawn from a sky.
struct SkySample {
  vec3 direction{0}; // unit, towards the sky
  vec3 radiance{0};
  float pdf = 0; // per steradian
};

/// Constant radiance, a clear sky by day, or a picture. Cheap to copy; never changes once made.
///
/// Daylight is in the units of a scene whose sun at noon is π W/m²: a white surface facing 100 000 lx sends radiance 1,
/// so 1 is 31.8 kcd/m². Colours are linear Rec.709, white is the sun's above the air.
class Sky {
 public:
  Sky() = default;                                           // black
  Sky(const vec3& radiance) : constantRadiance_(radiance) {} // constant; a colour is one, hence no `explicit`

  /// A clear sky for a sun in direction `towardsSun` (unit) seen through air of `turbidity`: 2 very clear, 3 clear,
  /// 6 hazy, 10 nearly fog; limited to [2, 10], for below the model breaks down. The sun's own light is `daylightSun`.
  /// Below the horizon lies ground of albedo 0.2, lit by both. A sun below the horizon leaves the sky of sunset, a
  /// tenth as bright with every three degrees, down to -18.
  static Sky daylight(const vec3& towardsSun, float turbidity);

  /// Radiance as `image` has it times `scale`, turned by `turn` (radians) around +Y, counter-clockwise seen from above.
  /// The image is at least 1×1. Takes 2 MiB beside it.
  static Sky image(std::shared_ptr<const SkyImage> image, float scale = 1, float turn = 0);

  /// Radiance that arrives from `direction` (unit). Of a picture: between its texels, linear.
  vec3 radiance(const vec3& direction) const;
  bool black() const { return !varying_ && luminance(constantRadiance_) <= 0; }
  bool constant() const { return !varying_; }
  float meanLuminance() const; // over the sphere
  /// Irradiance of an open horizontal plane from above, and from below, W/m².
  vec3 irradiance() const;
  vec3 irradianceBelow() const;

  /// Draws directions in proportion to luminance, from numbers in [0, 1): uniform over the sphere where the sky is
  /// constant, else over each of 32×32 cells of equal solid angle, or of 16×16 parts of each where it is a picture.
  SkySample sample(vec2 u) const;
  float pdf(const vec3& direction) const;

  /// Draws directions in proportion to what a surface of unit `normal` gets from there: luminance times cosine, by the
  /// cells' middles and for one of 81 normals, so that a direction below the surface may be drawn, and one just above
  /// it may not. Where the sky is constant, by the cosine.
  SkySample sampleFacing(const vec3& normal, vec2 u) const;
  float pdfFacing(const vec3& normal, const vec3& direction) const;

  const DaylightModel* model() const; // null: constant, or a picture
  /// A sky that is a picture; image null: it is none.
  struct Picture {
    std::shared_ptr<const SkyImage> image;
    float scale = 1, turn = 0;
  };
  const Picture& picture() const;
  /// Returns what the sky follows from: a colour, direction and turbidity, or a picture's digest, scale and turn. Equal
  /// numbers mean equal skies.
  std::vector<float> numbers() const;
  friend bool operator==(const Sky& a, const Sky& b) { return a.numbers() == b.numbers(); }

 private:
  struct Varying;
  vec3 constantRadiance_{0};
  std::shared_ptr<const Varying> varying_; // null: constant
};

/// Irradiance on a surface that faces the sun, as it is left by air of `turbidity` (Rayleigh and aerosol optical depths
/// of the same paper's appendix, at one wavelength for each channel). Zero below the horizon.
vec3 daylightSun(const vec3& towardsSun, float turbidity);

/// Radius of the sun's disk as seen from the ground, radians (0.53° across).
inline constexpr float kSunRadius = 0.5f * 0.53f / 180 * kPi;

} // namespace lambent

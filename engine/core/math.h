// Vector and matrix types, boxes and orthonormal bases. World space is right-handed, +Y up, metres.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include <cstdint>
#include <limits>

namespace lambent {

using glm::dmat4;
using glm::dvec3;
using glm::ivec3;
using glm::mat3;
using glm::mat4;
using glm::quat;
using glm::uvec3;
using glm::vec2;
using glm::vec3;
using glm::vec4;
using u8vec4 = glm::u8vec4;

inline constexpr float kPi = 3.14159265358979323846f;
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Axis-aligned box; empty until something is added.
struct Aabb {
  vec3 lo{kInfinity};
  vec3 hi{-kInfinity};

  void add(const vec3& p) {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  void add(const Aabb& b) {
    lo = glm::min(lo, b.lo);
    hi = glm::max(hi, b.hi);
  }
  bool empty() const { return !(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z); }
  bool contains(const vec3& p) const { // false for NaN
    return glm::all(glm::greaterThanEqual(p, lo)) && glm::all(glm::lessThanEqual(p, hi));
  }
  vec3 centre() const { return 0.5f * (lo + hi); }
  vec3 size() const { return empty() ? vec3(0) : hi - lo; }
  /// Length of the diagonal, metres; 0 when empty.
  float diameter() const { return glm::length(size()); }
};

/// Box around the eight transformed corners of `box`.
inline Aabb transformed(const Aabb& box, const mat4& m) {
  Aabb out;
  if (box.empty()) return out;
  for (int i = 0; i < 8; ++i)
    out.add(vec3(m * vec4(i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y, i & 4 ? box.hi.z : box.lo.z, 1)));
  return out;
}

/// Rec.709 luminance of a linear colour.
inline float luminance(const vec3& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

/// Says whether the fourth row is that of an affine matrix, to what rounding in files leaves of it.
inline bool isAffine(const mat4& m) {
  return std::abs(m[0][3]) + std::abs(m[1][3]) + std::abs(m[2][3]) + std::abs(m[3][3] - 1) < 1e-3f;
}
inline bool isFinite(const vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
inline bool isFinite(const vec4& v) { return isFinite(vec3(v)) && std::isfinite(v.w); }
inline bool isFinite(const mat4& m) { return isFinite(m[0]) && isFinite(m[1]) && isFinite(m[2]) && isFinite(m[3]); }
inline float maxComponent(const vec3& v) { return glm::max(v.x, glm::max(v.y, v.z)); }
/// Unit vector along v, `otherwise` where it has no direction.
inline vec3 unitOr(const vec3& v, const vec3& otherwise) {
  const float largest = maxComponent(glm::abs(v)); // scaled first: products of tiny or huge components leave float
  if (!(largest > 0) || !std::isfinite(largest)) return otherwise;
  return glm::normalize(v / largest);
}

} // namespace lambent

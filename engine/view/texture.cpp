// Texture lookup on the CPU. Matches what GL does with the base level of an sRGB texture: decode, then filter.

#include "engine/core/color.h"
#include "engine/view/assets.h"

#include <array>
#include <cmath>

namespace lambent {

vec4 decodeTexel(const u8vec4& texel, bool srgb) {
  if (!srgb) return vec4(texel) / 255.0f;
  static const std::array<float, 256> table = [] {
    std::array<float, 256> t;
    for (int i = 0; i < 256; ++i) t[i] = linearFromSrgb(float(i) / 255);
    return t;
  }();
  return {table[texel.x], table[texel.y], table[texel.z], float(texel.w) / 255};
}

void measureTexels(TextureImage& image) {
  glm::dvec4 sum(0);
  image.least = u8vec4(255);
  for (const u8vec4& t : image.texels) {
    sum += glm::dvec4(decodeTexel(t, image.srgb));
    image.least = glm::min(image.least, t);
  }
  image.averageLinear = image.texels.empty() ? vec4(1) : vec4(sum / double(image.texels.size()));
}

float leastRoughness(const SceneAssets& assets, const Material& material) {
  const uint32_t image = material.roughnessMetalnessTexture.image;
  return material.roughness * (image == kNone ? 1.0f : float(assets.images[image].least.y) / 255);
}

namespace {

/// `i` lies in [-1, 2 size + 1], in [-size - 1, 2 size] where it is clamped: as texelCoordinate leaves it.
int wrapped(int i, int size, Wrap wrap) {
  switch (wrap) {
  case Wrap::Repeat:
    if (i < 0) return i + size;
    while (i >= size) i -= size;
    return i;
  case Wrap::MirroredRepeat:
    if (i < 0) i += 2 * size;
    while (i >= 2 * size) i -= 2 * size;
    return i < size ? i : 2 * size - 1 - i;
  case Wrap::ClampToEdge:
    break;
  }
  return i < 0 ? 0 : i < size ? i : size - 1;
}

/// Continuous texel coordinate along one axis, brought near the image first so that it fits an int whatever the file
/// says. 2: the period of a mirrored image.
float texelCoordinate(float uv, int size, Wrap wrap) {
  if (!std::isfinite(uv)) return 0;
  if (wrap == Wrap::ClampToEdge) return glm::clamp(uv, -1.0f, 2.0f) * float(size);
  return (uv - 2 * std::floor(0.5f * uv)) * float(size);
}

/// What `of` makes of the texels around a place, filtered.
template <class Of> auto filtered(const TextureImage& image, const TextureRef& ref, vec2 uv, Of of) {
  const vec3 p = ref.uvTransform * vec3(uv, 1);
  const float x = texelCoordinate(p.x, image.width, ref.wrapU), y = texelCoordinate(p.y, image.height, ref.wrapV);
  const auto texel = [&](int i, int j) {
    const size_t column = size_t(wrapped(i, image.width, ref.wrapU)), row = size_t(wrapped(j, image.height, ref.wrapV));
    return of(image.texels[row * size_t(image.width) + column]);
  };
  if (ref.nearest) return texel(int(std::floor(x)), int(std::floor(y)));
  const float left = std::floor(x - 0.5f), top = std::floor(y - 0.5f);
  const int i = int(left), j = int(top);
  const float fx = x - 0.5f - left, fy = y - 0.5f - top;
  return glm::mix(glm::mix(texel(i, j), texel(i + 1, j), fx), glm::mix(texel(i, j + 1), texel(i + 1, j + 1), fx), fy);
}

} // namespace

vec4 sampleTexture(const SceneAssets& assets, const TextureRef& ref, vec2 uv) {
  if (ref.image == kNone) return vec4(1);
  const TextureImage& image = assets.images[ref.image];
  return filtered(image, ref, uv, [&](const u8vec4& texel) { return decodeTexel(texel, image.srgb); });
}

float sampleAlpha(const SceneAssets& assets, const TextureRef& ref, vec2 uv) {
  if (ref.image == kNone) return 1;
  return filtered(assets.images[ref.image], ref, uv, [](const u8vec4& texel) { return float(texel.w) / 255; });
}

} // namespace lambent

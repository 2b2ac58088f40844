#include "tools/lambent/linear_picture.h"

#include "engine/core/error.h"
#include "shaders/shared/tone_map.h"
#include "tools/lambent/commands.h"

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

/// shaders/display.frag, MODE 0.
vec3 displayed(const vec3& value, float factor, ToneMapper toneMapper) {
  if (glm::any(glm::isnan(value))) return {1, 0, 1};
  if (glm::any(glm::isinf(value))) return {0, 1, 1};
  const vec3 c = glm::clamp(toneMapped(glm::max(value * factor, vec3(0)), int(toneMapper)), vec3(0), vec3(1));
  return {srgbFromLinear(c.x), srgbFromLinear(c.y), srgbFromLinear(c.z)};
}

} // namespace

Image readLinear(const std::string& file) {
  const std::string extension = std::filesystem::path(file).extension().string();
  if (extension == ".exr") return readExr(file);
  if (extension == ".pfm") return readPfm(file);
  throw InputError(file, "not a linear picture (.exr or .pfm)");
}

void writePicture(const std::string& file, const Image& image, float factor, ToneMapper toneMapper) {
  checkPictureName(file);
  if (std::filesystem::path(file).extension() == ".exr") {
    writeExr(file, image);
    return;
  }
  writeShown(file, shownImage(image, factor, toneMapper));
}

Image absoluteDifference(const Image& a, const Image& b, float factor) {
  Image out = a;
  for (size_t i = 0; i < out.pixels.size(); ++i) out.pixels[i] = factor * glm::abs(a.pixels[i] - b.pixels[i]);
  return out;
}

Image shownImage(const Image& image, float factor, ToneMapper toneMapper) {
  Image out = image;
  for (vec3& pixel : out.pixels) pixel = displayed(pixel, factor, toneMapper);
  return out;
}

void writeShown(const std::string& file, const Image& shown) {
  Image8 out{shown.width, shown.height, {}};
  for (const vec3& pixel : shown.pixels)
    for (int c = 0; c < 3; ++c) out.rgb.push_back(uint8_t(std::lround(255 * std::clamp(pixel[c], 0.0f, 1.0f))));
  writePng(file, out);
}

} // namespace lambent

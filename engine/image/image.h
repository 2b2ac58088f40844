// Images on disk, written as engine/core/files.h says.
#pragma once

#include "engine/core/color.h"
#include "engine/core/math.h"

#include <cstdint>
#include <filesystem>
#include <vector>

namespace lambent {

/// Larger images are refused on reading, so that a damaged header cannot ask for all memory.
inline constexpr int kMaxImageSide = 32768;
inline constexpr uint64_t kMaxImageTexels = uint64_t(kMaxImageSide) * kMaxImageSide;

/// Throws InputError where a header asks for more than that, or for nothing.
void checkImageSize(const std::filesystem::path& file, int64_t width, int64_t height,
                    uint64_t mostTexels = kMaxImageTexels);

/// Linear RGB float image, row 0 at the top.
struct Image {
  int width = 0, height = 0;
  std::vector<vec3> pixels;

  Image() = default;
  Image(int w, int h, vec3 fill = vec3(0)) : width(w), height(h), pixels(size_t(w) * h, fill) {}
  vec3& at(int x, int y) { return pixels[size_t(y) * width + x]; }
  const vec3& at(int x, int y) const { return pixels[size_t(y) * width + x]; }
};

/// 8-bit RGB, row 0 at the top (already display-encoded).
struct Image8 {
  int width = 0, height = 0;
  std::vector<uint8_t> rgb;
};

/// Resizes bilinearly, on the encoded values.
Image8 resized(const Image8& image, int width, int height);

/// Writes 32-bit float RGB, ZIP-compressed.
void writeExr(const std::filesystem::path& file, const Image& image);
/// Reads R,G,B (or `layer`.R, …). Throws InputError naming what the file has instead.
Image readExr(const std::filesystem::path& file, const std::string& layer = {}, uint64_t mostTexels = kMaxImageTexels);
/// Reads a Radiance picture (RGBE).
Image readHdr(const std::filesystem::path& file, uint64_t mostTexels = kMaxImageTexels);
/// Reads a portable float map, colour or grey (grey is repeated in all three channels). The header's scale is taken as
/// byte order only.
Image readPfm(const std::filesystem::path& file);
void writePng(const std::filesystem::path& file, const Image8& image);
/// Whether it is a PNG of that size to its end, each part as its checksum says.
bool isWholePng(const std::filesystem::path& file, int width, int height);

} // namespace lambent

#include "engine/image/image.h"

#include "engine/core/error.h"
#include "engine/core/files.h"

#include <bit>
#include <cmath>
#include <fstream>
#include <iterator>

#include <stb/stb_image_resize.h>
#include <stb/stb_image_write.h>

namespace lambent {

namespace fs = std::filesystem;

void checkImageSize(const fs::path& file, int64_t width, int64_t height, uint64_t mostTexels) {
  if (width < 1 || height < 1 || width > kMaxImageSide || height > kMaxImageSide)
    throw InputError(file.string(), "the image's size is " + std::to_string(width) + "x" + std::to_string(height) +
                                        " (1 to " + std::to_string(kMaxImageSide) + " each way)");
  if (const uint64_t texels = uint64_t(width) * uint64_t(height); texels > mostTexels)
    throw InputError(file.string(),
                     "has " + std::to_string(texels) + " texels (" + std::to_string(mostTexels) + " at most)");
}

Image8 resized(const Image8& image, int width, int height) {
  Image8 out{width, height, std::vector<uint8_t>(size_t(3) * width * height)};
  const bool made = stbir_resize_uint8_generic(image.rgb.data(), image.width, image.height, 0, out.rgb.data(), width,
                                               height, 0, 3, STBIR_ALPHA_CHANNEL_NONE, 0, STBIR_EDGE_CLAMP,
                                               STBIR_FILTER_TRIANGLE, STBIR_COLORSPACE_LINEAR, nullptr) != 0;
  if (!made) throw RunError("no memory for an image of " + std::to_string(width) + "x" + std::to_string(height));
  return out;
}

void writePng(const fs::path& file, const Image8& image) {
  CHECK_EQ(image.rgb.size(), size_t(image.width) * image.height * 3);
  stbi_write_png_compression_level = 4; // a third of the default's time for images 5 % larger
  std::string bytes;                    // stb itself does not look whether its file took them
  const auto append = [](void* to, void* data, int size) {
    static_cast<std::string*>(to)->append(static_cast<const char*>(data), size_t(size));
  };
  if (!stbi_write_png_to_func(append, &bytes, image.width, image.height, 3, image.rgb.data(), image.width * 3))
    throw RunError(file.string() + ": the image cannot be encoded (out of memory?)");
  writeAtomically(file, bytes);
}

Image readPfm(const fs::path& file) {
  std::error_code none;
  if (fs::exists(file, none) && !fs::is_regular_file(file, none)) throw InputError(file.string(), "is not a file");
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(file.string(), "cannot be read (no such file?)");
  std::string kind;
  long width = 0, height = 0;
  float scale = 0;
  in >> kind >> width >> height >> scale;
  if (!in || (kind != "PF" && kind != "Pf"))
    throw InputError(file.string(), "is not a PFM image (the header would be: PF, width height, scale)");
  checkImageSize(file, width, height);
  if (scale == 0 || !std::isfinite(scale))
    throw InputError(file.string(), "the scale in the PFM header is not a number");
  in.get(); // exactly one white-space character ends the header
  const auto begin = in.tellg();
  const size_t needed = size_t(width) * size_t(height) * (kind == "PF" ? 12 : 4); // before there is memory for it
  if (size_t(in.seekg(0, std::ios::end).tellg() - begin) < needed)
    throw InputError(file.string(), "ends before the last of its " + std::to_string(height) + " rows");
  in.seekg(begin);

  const int channels = kind == "PF" ? 3 : 1;
  const bool swapBytes = (scale < 0) != (std::endian::native == std::endian::little);
  Image image{int(width), int(height)};
  std::vector<uint32_t> row(size_t(width) * channels);
  for (int y = image.height - 1; y >= 0; --y) { // PFM stores the bottom row first
    in.read(reinterpret_cast<char*>(row.data()), std::streamsize(row.size() * sizeof(uint32_t)));
    if (!in) throw InputError(file.string(), "ends before the last of its " + std::to_string(height) + " rows");
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < 3; ++c) {
        uint32_t bits = row[size_t(x) * channels + (channels == 3 ? c : 0)];
        if (swapBytes) bits = bits >> 24 | (bits >> 8 & 0xff00u) | (bits << 8 & 0xff0000u) | bits << 24;
        image.at(x, y)[c] = std::bit_cast<float>(bits);
      }
  }
  return image;
}

bool isWholePng(const fs::path& file, int width, int height) {
  std::ifstream in(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const auto big = [&](size_t at) {
    uint32_t v = 0;
    for (size_t i = 0; i < 4; ++i) v = v << 8 | uint8_t(text[at + i]);
    return v;
  };
  constexpr size_t kHead = 33, kAround = 12; // signature and header; of a chunk: length, name, checksum
  if (text.size() < kHead || !text.starts_with("\x89PNG\r\n\x1a\n") || text.compare(12, 4, "IHDR") != 0) return false;
  if (big(16) != uint32_t(width) || big(20) != uint32_t(height)) return false;
  for (size_t at = 8; text.size() - at >= kAround;) {
    const size_t length = big(at);
    if (length > text.size() - at - kAround) return false;
    uint32_t crc = ~0u; // of name and content, polynomial 0xedb88320
    for (size_t i = 0; i < length + 4; ++i) {
      crc ^= uint8_t(text[at + 4 + i]);
      for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
    }
    if (~crc != big(at + 8 + length)) return false;
    const bool last = text.compare(at + 4, 4, "IEND") == 0;
    at += length + kAround;
    if (last) return at == text.size();
  }
  return false;
}

} // namespace lambent

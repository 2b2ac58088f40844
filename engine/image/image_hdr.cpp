// Radiance RGBE pictures (.hdr) in.
#include "engine/core/error.h"
#include "engine/image/image.h"

#include <fstream>
#include <limits>
#include <memory>

#include <stb/stb_image.h>

namespace lambent {

Image readHdr(const std::filesystem::path& file, uint64_t mostTexels) {
  if (!std::filesystem::is_regular_file(file)) throw InputError(file.string(), "no such file");
  const auto size = std::filesystem::file_size(file);
  if (size > uintmax_t(std::numeric_limits<int>::max())) throw InputError(file.string(), "is larger than 2 GiB");
  std::vector<uint8_t> bytes(static_cast<size_t>(size));
  std::ifstream in(file, std::ios::binary);
  if (!in.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(size)))
    throw InputError(file.string(), "cannot be read to its end");
  int width = 0, height = 0, channels = 0;
  if (!stbi_is_hdr_from_memory(bytes.data(), int(size)) ||
      !stbi_info_from_memory(bytes.data(), int(size), &width, &height, &channels))
    throw InputError(file.string(), "is not a Radiance picture (.hdr)");
  if (width < 1 || height < 1 || width > kMaxImageSide || height > kMaxImageSide)
    throw InputError(file.string(), "the image's size is " + std::to_string(width) + "x" + std::to_string(height) +
                                        " (1 to " + std::to_string(kMaxImageSide) + " each way)");
  if (uint64_t(width) * uint64_t(height) > mostTexels)
    throw InputError(file.string(), "has " + std::to_string(uint64_t(width) * uint64_t(height)) + " texels (" +
                                        std::to_string(mostTexels) + " at most)");
  // A run of up to 127 equal bytes takes two, and a texel has four: more texels than that are not there.
  if (uint64_t(width) * uint64_t(height) > 16 * uint64_t(size))
    throw InputError(file.string(), "ends before the last of its " + std::to_string(height) + " rows");
  const std::unique_ptr<float, decltype(&stbi_image_free)> texels(
      stbi_loadf_from_memory(bytes.data(), int(size), &width, &height, &channels, 3), &stbi_image_free);
  if (!texels) throw InputError(file.string(), std::string("cannot be decoded: ") + stbi_failure_reason());
  Image image(width, height);
  for (size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = vec3(texels.get()[3 * i], texels.get()[3 * i + 1], texels.get()[3 * i + 2]);
  return image;
}

} // namespace lambent

#include "engine/scene/sky_file.h"

#include "engine/core/error.h"
#include "engine/core/open_watch.h"
#include "engine/image/image.h"

#include <algorithm>
#include <cctype>
#include <cmath>

namespace lambent {

namespace {

constexpr int kLongest = 4096;
constexpr float kMostRadiance = 65504; // of half floats

std::string extensionOf(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return extension;
}

Image halved(const Image& image) {
  Image out(std::max(image.width / 2, 1), std::max(image.height / 2, 1));
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const int right = std::min(2 * x + 1, image.width - 1), below = std::min(2 * y + 1, image.height - 1);
      out.at(x, y) =
          0.25f * (image.at(2 * x, 2 * y) + image.at(right, 2 * y) + image.at(2 * x, below) + image.at(right, below));
    }
  return out;
}

} // namespace

bool namesSky(const std::filesystem::path& file) {
  const std::string extension = extensionOf(file);
  return extension == ".hdr" || extension == ".exr";
}

std::shared_ptr<const SkyImage> readSky(const std::filesystem::path& file, std::vector<std::string>& notes,
                                        uint64_t mostTexels, const std::filesystem::path& opened) {
  if (!namesSky(file)) throw InputError(file.string(), "not a picture of the sky (.hdr or .exr)");
  const std::filesystem::path& source = opened.empty() ? file : opened;
  if (std::filesystem::is_directory(source))
    throw InputError(file.string(), "is a folder (a picture of the sky expected)");
  std::error_code unknown;
  const uintmax_t size = std::filesystem::file_size(source, unknown);
  if (!unknown) OpenWatch::read(size);
  Image image;
  try {
    image = extensionOf(file) == ".hdr" ? readHdr(source, mostTexels) : readExr(source, {}, mostTexels);
  } catch (const InputError& e) {
    const std::string said = e.what(), name = source.string() + ": ";
    throw InputError(file.string(), said.starts_with(name) ? said.substr(name.size()) : said);
  }
  size_t invalid = 0, bright = 0;
  for (vec3& texel : image.pixels)
    for (int c = 0; c < 3; ++c) {
      if (!(texel[c] >= 0)) texel[c] = 0, ++invalid;
      if (texel[c] > kMostRadiance) texel[c] = kMostRadiance, ++bright;
    }
  if (invalid > 0)
    notes.push_back(file.string() + ": " + std::to_string(invalid) + " value(s) that are no light taken as black");
  if (bright > 0)
    notes.push_back(file.string() + ": " + std::to_string(bright) + " value(s) above 65504 taken as that");
  while (std::max(image.width, image.height) > kLongest) image = halved(image);
  auto sky = std::make_shared<SkyImage>();
  sky->width = image.width;
  sky->height = image.height;
  sky->texels = std::move(image.pixels);
  return sky;
}

} // namespace lambent

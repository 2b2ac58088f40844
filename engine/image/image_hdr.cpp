// Radiance RGBE pictures (.hdr) in. Not by stb_image, which never ends where a run of a row is cut off.
#include "engine/core/error.h"
#include "engine/image/image.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <span>
#include <string_view>

namespace lambent {

namespace {

using Rgbe = std::array<uint8_t, 4>;

vec3 radianceOf(const Rgbe& t) {
  const float unit = t[3] == 0 ? 0.0f : std::ldexp(1.0f, int(t[3]) - 136);
  return unit * vec3(t[0], t[1], t[2]);
}

/// Takes the next `count` bytes; fails where there are fewer.
bool take(std::string_view& bytes, size_t count, const uint8_t*& at) {
  if (bytes.size() < count) return false;
  at = reinterpret_cast<const uint8_t*>(bytes.data());
  bytes.remove_prefix(count);
  return true;
}

/// A row: plain, or each channel in runs. Returns false where it ends too early or is damaged.
bool readRow(std::string_view& bytes, std::span<Rgbe> row) {
  const uint8_t* at = nullptr;
  const size_t width = row.size();
  const auto byte = [&](size_t i) { return uint8_t(bytes[i]); };
  const bool runs = width >= 8 && width < 32768 && bytes.size() >= 4 && byte(0) == 2 && byte(1) == 2 && byte(2) < 128;
  if (!runs) {
    if (!take(bytes, 4 * width, at)) return false;
    for (size_t x = 0; x < width; ++x) std::copy_n(at + 4 * x, 4, row[x].begin());
    return true;
  }
  if (size_t(byte(2)) << 8 != (width & 0xff00) || byte(3) != (width & 0xff)) return false;
  bytes.remove_prefix(4);
  for (size_t channel = 0; channel < 4; ++channel)
    for (size_t x = 0; x < width;) {
      if (!take(bytes, 1, at)) return false;
      const bool run = *at > 128;
      const size_t count = run ? size_t(*at) - 128 : *at;
      if (count == 0 || count > width - x || !take(bytes, run ? 1 : count, at)) return false;
      for (size_t i = 0; i < count; ++i) row[x++][channel] = at[run ? 0 : i];
    }
  return true;
}

/// The next line, without its end; fails where there is none of up to 4096 characters.
bool takeLine(std::string_view& bytes, std::string_view& line) {
  const size_t end = bytes.substr(0, 4096).find('\n');
  if (end == bytes.npos) return false;
  line = bytes.substr(0, end);
  bytes.remove_prefix(end + 1);
  return true;
}

/// "-Y height +X width"; nothing else that the format knows is in use.
bool readSize(std::string_view line, int& width, int& height) {
  const auto number = [&](std::string_view name, int& value) {
    if (!line.starts_with(name)) return false;
    line.remove_prefix(name.size());
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), value);
    line.remove_prefix(size_t(end - line.data()));
    return error == std::errc();
  };
  return number("-Y ", height) && number(" +X ", width) && line.empty();
}

/// "EXPOSURE=2" and "COLORCORR=1 1 2" say what the texels were multiplied by, each line by more.
void takeFactors(std::string_view line, vec3& factor) {
  std::array<float, 3> values{};
  const bool exposure = line.starts_with("EXPOSURE=");
  if (!exposure && !line.starts_with("COLORCORR=")) return;
  line.remove_prefix(line.find('=') + 1);
  const size_t count = exposure ? 1 : 3;
  for (size_t i = 0; i < count; ++i) {
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    if (line.starts_with('+')) line.remove_prefix(1);
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), values[i]);
    if (error != std::errc() || !(values[i] > 1e-9f && values[i] < 1e9f)) return; // none that is meant
    line.remove_prefix(size_t(end - line.data()));
  }
  factor *= exposure ? vec3(values[0]) : vec3(values[0], values[1], values[2]);
}

} // namespace

Image readHdr(const std::filesystem::path& file, uint64_t mostTexels) {
  if (!std::filesystem::is_regular_file(file)) throw InputError(file.string(), "no such file");
  std::ifstream in(file, std::ios::binary);
  const std::string content{std::istreambuf_iterator<char>(in), {}};
  if (in.bad()) throw InputError(file.string(), "cannot be read to its end");
  std::string_view bytes = content, line;
  bool known = takeLine(bytes, line) && (line == "#?RADIANCE" || line == "#?RGBE"), rgbe = false;
  vec3 factor(1);
  while (known && (known = takeLine(bytes, line)) && !line.empty()) {
    rgbe = rgbe || line == "FORMAT=32-bit_rle_rgbe";
    takeFactors(line, factor);
  }
  int width = 0, height = 0;
  if (!known || !rgbe || !takeLine(bytes, line) || !readSize(line, width, height))
    throw InputError(file.string(), "is not a Radiance picture (.hdr, RGBE, rows from the top)");
  checkImageSize(file, width, height, mostTexels);
  const auto cutOff = [&](int row) {
    return InputError(file.string(),
                      "is damaged or ends in row " + std::to_string(row + 1) + " of " + std::to_string(height));
  };
  // A run of up to 127 equal bytes takes two, and a texel has four: more texels than that are not there.
  if (uint64_t(width) * uint64_t(height) > 16 * uint64_t(content.size())) throw cutOff(height - 1);
  Image image(width, height);
  std::vector<Rgbe> row(static_cast<size_t>(width));
  for (int y = 0; y < height; ++y) {
    if (!readRow(bytes, row)) throw cutOff(y);
    std::ranges::transform(row, &image.at(0, y), [&](const Rgbe& t) { return radianceOf(t) / factor; });
  }
  return image;
}

} // namespace lambent

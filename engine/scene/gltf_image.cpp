// Encoded images to RGBA8 texels, several at a time.

#include "engine/core/free_memory.h"
#include "engine/core/parallel.h"
#include "engine/scene/gltf_import.h"
#include "engine/scene/jpeg.h"

#include <algorithm>
#include <atomic>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <new>
#include <string_view>

#include <png.h>
#include <webp/decode.h>

namespace lambent::gltf {

namespace {

constexpr int kMostTexels = 16384; // per side, that OpenGL 4.5 guarantees

std::string placeOf(const tinygltf::Image& image, int index) {
  return label("image", size_t(index), image.uri.empty() ? image.name : image.uri);
}

Bytes encodedBytes(const Document& doc, int index) {
  const tinygltf::Image& image = doc.model.images[size_t(index)];
  if (image.bufferView >= 0) return viewBytes(doc, image.bufferView, placeOf(image, index));
  return {image.image.data(), image.image.size()};
}

bool isWebp(Bytes bytes) {
  return bytes.size >= 12 && std::memcmp(bytes.data, "RIFF", 4) == 0 && std::memcmp(bytes.data + 8, "WEBP", 4) == 0;
}

bool isPng(Bytes bytes) { return bytes.size >= 4 && std::memcmp(bytes.data, "\x89PNG", 4) == 0; }
bool isJpeg(Bytes bytes) { return bytes.size >= 3 && std::memcmp(bytes.data, "\xff\xd8\xff", 3) == 0; }

/// By its first chunk, which is the header.
bool sizeOfPng(Bytes bytes, int& width, int& height) {
  constexpr size_t kHeader = 12, kSizes = 16, kEnd = 24; // bytes
  if (bytes.size < kEnd || std::memcmp(bytes.data + kHeader, "IHDR", 4) != 0) return false;
  const auto number = [&](size_t at) {
    uint32_t n = 0;
    for (size_t i = at; i < at + 4; ++i) n = n << 8 | bytes.data[i];
    return int(std::min<uint32_t>(n, 1u << 30));
  };
  width = number(kSizes), height = number(kSizes + 4);
  return true;
}

/// A PNG on its way into rows of four bytes for each texel.
struct PngReading {
  int width, height;
  png_bytepp rows;
  bool interlaced = false;
  char defect[128] = "";
};

void beginPng(png_structp png, png_infop info) {
  PngReading& reading = *static_cast<PngReading*>(png_get_progressive_ptr(png));
  png_set_expand(png);
  png_set_strip_16(png); // the upper bytes
  png_set_gray_to_rgb(png);
  png_set_add_alpha(png, 0xff, PNG_FILLER_AFTER);
  reading.interlaced = png_set_interlace_handling(png) > 1;
  png_read_update_info(png, info);
  if (png_get_rowbytes(png, info) != 4 * size_t(reading.width) ||
      png_get_image_height(png, info) != png_uint_32(reading.height))
    png_error(png, "it has two sizes");
}

/// Feeds the file to the library, which stops inflating at the last row, whatever follows it. Objects with destructors
/// have no place here: the library leaves by longjmp. Returns false where it is damaged.
bool readPng(Bytes bytes, PngReading& reading) {
  png_structp png = png_create_read_struct(
      PNG_LIBPNG_VER_STRING, &reading,
      [](png_structp p, png_const_charp text) {
        PngReading& r = *static_cast<PngReading*>(png_get_error_ptr(p));
        std::snprintf(r.defect, sizeof r.defect, "%s", text);
        png_longjmp(p, 1);
      },
      [](png_structp, png_const_charp) {});
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  if (!info || setjmp(png_jmpbuf(png))) { // NOLINT: its only way
    png_destroy_read_struct(&png, &info, nullptr);
    return false;
  }
  constexpr png_alloc_size_t kMostOfChunk = 8 << 20; // bytes, of what is beside the picture
  png_set_user_limits(png, kMostTexels, kMostTexels);
  png_set_chunk_malloc_max(png, kMostOfChunk);
  png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1); // -1: known ones that show nothing too
  png_set_crc_action(png, PNG_CRC_QUIET_USE, PNG_CRC_QUIET_USE);
  png_set_progressive_read_fn(
      png, &reading, beginPng,
      [](png_structp p, png_bytep row, png_uint_32 y, int) {
        const PngReading& r = *static_cast<PngReading*>(png_get_progressive_ptr(p));
        if (row && y < png_uint_32(r.height)) png_progressive_combine_row(p, r.rows[y], row);
      },
      nullptr);
  png_process_data(png, info, const_cast<png_bytep>(bytes.data), bytes.size);
  constexpr int kPasses = 7;
  const bool whole = reading.interlaced ? png_get_current_pass_number(png) >= kPasses
                                        : png_get_current_row_number(png) >= png_uint_32(reading.height);
  if (!whole) png_error(png, "it ends before its last row");
  png_destroy_read_struct(&png, &info, nullptr);
  return true;
}

struct TexelsFree {
  void (*free)(void*);
  void operator()(uint8_t* p) const { free(p); }
};
using Texels = std::unique_ptr<uint8_t, TexelsFree>;

/// RGBA8, or nothing where the bytes are damaged, and why. `width` and `height` are the picture's.
Texels decodeTexels(Bytes bytes, int& width, int& height, std::string& defect) {
  if (isPng(bytes)) {
    Texels texels{static_cast<uint8_t*>(std::malloc(4 * size_t(width) * size_t(height))), {std::free}};
    if (!texels) throw std::bad_alloc();
    std::vector<png_bytep> rows;
    for (int y = 0; y < height; ++y) rows.push_back(texels.get() + 4 * size_t(width) * size_t(y));
    PngReading reading{width, height, rows.data()};
    if (readPng(bytes, reading)) return texels;
    defect = std::string("cannot be decoded: damaged PNG, ") + reading.defect;
    return {nullptr, {std::free}};
  }
  if (isWebp(bytes)) {
    Texels texels{WebPDecodeRGBA(bytes.data, bytes.size, &width, &height), {WebPFree}};
    if (!texels) defect = "cannot be decoded: damaged WebP, or one that needs more memory than the file may ask for";
    return texels;
  }
  Texels texels{static_cast<uint8_t*>(std::malloc(4 * size_t(width) * size_t(height))), {std::free}};
  if (!texels) throw std::bad_alloc();
  if (readJpeg(bytes.data, bytes.size, width, height, texels.get(), defect)) return texels;
  defect = "cannot be decoded: damaged JPEG, " + defect;
  return {nullptr, {std::free}};
}

/// Passes over the picture that a JPEG makes, each as long as the picture is large; 0 of other formats. A marker is no
/// part of what is compressed.
size_t scansOf(Bytes bytes) {
  if (!isJpeg(bytes)) return 0;
  size_t scans = 0;
  for (size_t i = 2; i + 1 < bytes.size; ++i) scans += bytes.data[i] == 0xff && bytes.data[i + 1] == 0xda;
  return scans;
}

/// Bytes of a texel that decoding takes beside the texels. A JPEG of several passes keeps what they add up, a WebP
/// without loss the picture before it is written.
size_t workingBytes(Bytes bytes) { return isWebp(bytes) ? 4 : !isJpeg(bytes) ? 0 : scansOf(bytes) > 1 ? 16 : 6; }

/// Bytes that the decoder of a WebP without loss, or of its alpha, takes at most for tables of codes: by libwebp 1.2
/// some 5 KiB for 16 texels, and for 4 bytes of the file, which nothing of the picture's size tells.
size_t tableBytes(Bytes bytes, const glm::ivec2& size) {
  constexpr size_t kTable = 5500, kName = 4;
  const std::string_view text(reinterpret_cast<const char*>(bytes.data), isWebp(bytes) ? bytes.size : 0);
  size_t coded = text.find("VP8L") == text.npos ? 0 : bytes.size; // bytes
  if (const size_t alpha = text.find("ALPH"); alpha != text.npos && alpha + 2 * kName <= bytes.size) {
    uint32_t length = 0;
    std::memcpy(&length, bytes.data + alpha + kName, sizeof length);
    coded = std::max(coded, std::min(size_t(length), bytes.size));
  }
  return kTable * std::min(size_t(size.x) * size_t(size.y) / 16, coded / 4);
}

/// Why the image cannot be decoded; empty: it may be. `passed` sums over the file's JPEGs the texels that their passes
/// beyond the usual ones go over.
std::string defectOf(Bytes bytes, int& width, int& height, uint64_t& passed) {
  std::string why;
  if (bytes.size == 0) return "cannot be read (no such file, or it is empty)";
  if (bytes.size > size_t(std::numeric_limits<int>::max())) return "is larger than 2 GiB";
  constexpr uint8_t kKtx2[] = {0xab, 'K', 'T', 'X', ' ', '2', '0', 0xbb};
  if (bytes.size >= sizeof kKtx2 && std::memcmp(bytes.data, kKtx2, sizeof kKtx2) == 0)
    return "is KTX2, which is not decoded here (gltf-transform ktxdecompress IN OUT converts it)";
  if (isWebp(bytes) && !WebPGetInfo(bytes.data, bytes.size, &width, &height)) return "cannot be decoded: damaged WebP";
  if (!isWebp(bytes) && !isPng(bytes) && !isJpeg(bytes))
    return "cannot be decoded: unknown image type (PNG, JPEG or WebP expected)";
  if (isJpeg(bytes) && !sizeOfJpeg(bytes.data, bytes.size, width, height, why))
    return "cannot be decoded: damaged JPEG, " + why;
  if (isPng(bytes) && !sizeOfPng(bytes, width, height)) return "cannot be decoded: damaged PNG";
  if (width < 1 || height < 1 || width > kMostTexels || height > kMostTexels)
    return "is " + std::to_string(width) + "x" + std::to_string(height) + " texels (1 to " +
           std::to_string(kMostTexels) + " each way)";
  constexpr uint64_t kMostPassed = uint64_t(1) << 33, kUsual = 16; // 3 s, for all of a file's together
  if (const uint64_t scans = scansOf(bytes); scans > kUsual) {
    const uint64_t more = uint64_t(width) * uint64_t(height) * (scans - kUsual);
    if (more > kMostPassed - passed)
      return "is a JPEG of " + std::to_string(scans) + " passes, which take very long to decode (some ten are usual)";
    passed += more;
  }
  return {};
}

/// One texel: what is multiplied by it stays.
TextureImage white(bool srgb) {
  TextureImage out;
  out.width = out.height = 1;
  out.srgb = srgb;
  out.texels = {{255, 255, 255, 255}};
  out.averageLinear = vec4(1);
  return out;
}

/// Without texels: it could not be decoded, `defect` says why.
TextureImage decode(const Document& doc, int index, bool srgb, const glm::ivec2& size, std::string& defect) {
  int width = size.x, height = size.y;
  TextureImage out;
  const Texels texels = decodeTexels(encodedBytes(doc, index), width, height, defect);
  if (!texels) return out;
  out.width = width;
  out.height = height;
  out.srgb = srgb;
  const size_t count = size_t(width) * size_t(height);
  out.texels.resize(count);
  for (size_t i = 0; i < count; ++i) {
    const uint8_t* t = texels.get() + 4 * i;
    out.texels[i] = {t[0], t[1], t[2], t[3]};
  }
  measureTexels(out);
  return out;
}

} // namespace

void decodeImages(Import& import) {
  std::vector<std::pair<int, bool>> order(import.images.size());
  for (const auto& [image, slot] : import.images) order[slot] = image;
  Document& doc = import.doc;
  auto& images = import.scene.assets.images;
  images.resize(order.size());
  std::vector<std::string> defects(order.size());
  std::vector<glm::ivec2> sizes(order.size());
  std::vector<std::pair<size_t, std::string>> working; // bytes that decoding takes, and where
  uint64_t passed = 0;
  for (size_t i = 0; i < order.size(); ++i) {
    const Bytes bytes = encodedBytes(doc, order[i].first);
    defects[i] = defectOf(bytes, sizes[i].x, sizes[i].y, passed);
    if (!defects[i].empty()) continue;
    const size_t texels = size_t(sizes[i].x) * size_t(sizes[i].y);
    const std::string place = placeOf(doc.model.images[size_t(order[i].first)], order[i].first);
    doc.spend(texels, 2 * sizeof(u8vec4), place); // the decoder's and ours
    working.emplace_back(texels * workingBytes(bytes), place);
  }
  // Those that are decoded at once, the largest at worst.
  const size_t atOnce = std::min(working.size(), size_t(threadCount()));
  std::ranges::partial_sort(working, working.begin() + std::ptrdiff_t(atOnce), std::greater());
  for (size_t i = 0; i < atOnce; ++i) doc.spend(working[i].first, 1, working[i].second);
  std::atomic<size_t> done = 0;
  constexpr size_t kLarge = 64 << 20;
  std::vector<size_t> alone; // whose tables may be large
  for (size_t i = 0; i < order.size(); ++i)
    if (defects[i].empty() && tableBytes(encodedBytes(doc, order[i].first), sizes[i]) > kLarge) alone.push_back(i);
  parallelFor(order.size(), 1, [&](size_t begin, size_t end) {
    import.tell("textures", Import::kMeshes, 1, done++, order.size());
    for (size_t i = begin; i < end; ++i)
      if (defects[i].empty() && !std::ranges::binary_search(alone, i))
        images[i] = decode(doc, order[i].first, order[i].second, sizes[i], defects[i]);
  });
  for (const size_t i : alone) {
    constexpr size_t kPerTexel = 2 * sizeof(u8vec4) + 4; // charged, not yet taken
    const AllocationLimit limit(doc.budget.left() + kPerTexel * size_t(sizes[i].x) * size_t(sizes[i].y));
    images[i] = decode(doc, order[i].first, order[i].second, sizes[i], defects[i]);
  }
  for (size_t i = 0; i < order.size(); ++i) {
    const auto [index, srgb] = order[i];
    const tinygltf::Image& image = doc.model.images[size_t(index)];
    const std::string name = !image.name.empty()  ? image.name
                             : !image.uri.empty() ? image.uri
                                                  : "image " + std::to_string(index);
    if (!defects[i].empty()) {
      doc.warn(placeOf(image, index) + ": " + defects[i] + "; white instead");
      images[i] = white(srgb);
      for (lambent::Material& m : import.scene.assets.materials) // white would be a slope
        if (m.normalTexture.image == i) m.normalTexture.image = kNone;
    }
    images[i].name = name;
  }
}

} // namespace lambent::gltf

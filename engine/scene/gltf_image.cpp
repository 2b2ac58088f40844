// Encoded images to RGBA8 texels, several at a time.

#include "engine/core/parallel.h"
#include "engine/scene/gltf_import.h"

#include <atomic>
#include <cstring>
#include <memory>

#include <stb/stb_image.h>
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

struct StbOrWebpFree {
  bool webp;
  void operator()(uint8_t* p) const { webp ? WebPFree(p) : stbi_image_free(p); }
};
using Texels = std::unique_ptr<uint8_t, StbOrWebpFree>;

/// RGBA8, or nothing where the bytes are damaged.
Texels decodeTexels(Bytes bytes, int& width, int& height) {
  if (isWebp(bytes)) return {WebPDecodeRGBA(bytes.data, bytes.size, &width, &height), {true}};
  int channels = 0; // 16 bits of each are rounded to 8 by the decoder
  return {stbi_load_from_memory(bytes.data, int(bytes.size), &width, &height, &channels, 4), {false}};
}

/// Passes over the picture that a JPEG makes, each as long as the picture is large; 0 of other formats. A marker is no
/// part of what is compressed.
size_t scansOf(Bytes bytes) {
  if (!isJpeg(bytes)) return 0;
  size_t scans = 0;
  for (size_t i = 2; i + 1 < bytes.size; ++i) scans += bytes.data[i] == 0xff && bytes.data[i + 1] == 0xda;
  return scans;
}

/// Why the image cannot be decoded; empty: it may be.
std::string defectOf(Bytes bytes, int& width, int& height) {
  int channels = 0;
  if (bytes.size == 0) return "cannot be read (no such file, or it is empty)";
  if (bytes.size > size_t(std::numeric_limits<int>::max())) return "is larger than 2 GiB";
  constexpr uint8_t kKtx2[] = {0xab, 'K', 'T', 'X', ' ', '2', '0', 0xbb};
  if (bytes.size >= sizeof kKtx2 && std::memcmp(bytes.data, kKtx2, sizeof kKtx2) == 0)
    return "is KTX2, which is not decoded here (gltf-transform ktxdecompress IN OUT converts it)";
  if (isWebp(bytes) && !WebPGetInfo(bytes.data, bytes.size, &width, &height)) return "cannot be decoded: damaged WebP";
  // The library knows more kinds than glTF, and its reader of .hdr never ends where a run is cut off.
  if (!isWebp(bytes) && !isPng(bytes) && !isJpeg(bytes))
    return "cannot be decoded: unknown image type (PNG, JPEG or WebP expected)";
  if (!isWebp(bytes) && !stbi_info_from_memory(bytes.data, int(bytes.size), &width, &height, &channels))
    return std::string("cannot be decoded: ") + stbi_failure_reason() + " (PNG, JPEG or WebP expected)";
  if (width < 1 || height < 1 || width > kMostTexels || height > kMostTexels)
    return "is " + std::to_string(width) + "x" + std::to_string(height) + " texels (1 to " +
           std::to_string(kMostTexels) + " each way)";
  constexpr uint64_t kMostPassed = uint64_t(1) << 35; // 2 s
  if (const size_t scans = scansOf(bytes); uint64_t(width) * uint64_t(height) * scans > kMostPassed)
    return "is a JPEG of " + std::to_string(scans) + " passes, which take very long to decode (some ten are usual)";
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
TextureImage decode(const Document& doc, int index, bool srgb, std::string& defect) {
  const Bytes bytes = encodedBytes(doc, index);
  int width = 0, height = 0;
  const Texels texels = decodeTexels(bytes, width, height);
  TextureImage out;
  if (!texels) {
    defect = isWebp(bytes)
                 ? "cannot be decoded: damaged WebP"
                 : std::string("cannot be decoded: ") + stbi_failure_reason() + " (PNG, JPEG or WebP expected)";
    return out;
  }
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
  for (size_t i = 0; i < order.size(); ++i) {
    int width = 0, height = 0;
    defects[i] = defectOf(encodedBytes(doc, order[i].first), width, height);
    if (defects[i].empty()) // the decoder's and ours
      doc.spend(size_t(width) * size_t(height), 2 * sizeof(u8vec4),
                placeOf(doc.model.images[size_t(order[i].first)], order[i].first));
  }
  std::atomic<size_t> done = 0;
  parallelFor(order.size(), 1, [&](size_t begin, size_t end) {
    import.tell("textures", Import::kMeshes, 1, done++, order.size());
    for (size_t i = begin; i < end; ++i)
      if (defects[i].empty()) images[i] = decode(doc, order[i].first, order[i].second, defects[i]);
  });
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

// Encoded pictures to RGBA8 texels, several at a time.

#include "engine/core/parallel.h"
#include "engine/scene/gltf_import.h"
#include "engine/scene/texture_decode.h"

#include <memory>

#include <stb/stb_image.h>

namespace lambent::gltf {

namespace {

struct StbFree {
  void operator()(stbi_uc* p) const { stbi_image_free(p); }
};

TextureImage decode(const Document& doc, int index, bool srgb) {
  const Image& image = doc.images[size_t(index)];
  const std::string place = label("image", size_t(index), image.uri.empty() ? image.name : image.uri);
  Bytes bytes{image.encoded.data(), image.encoded.size()};
  if (image.bufferView >= 0) bytes = viewBytes(doc, image.bufferView, place);
  if (bytes.size == 0) doc.fail(place, "cannot be read (no such file, or it is empty)");
  if (bytes.size > size_t(std::numeric_limits<int>::max())) doc.fail(place, "is larger than 2 GiB");

  int width = 0, height = 0, channels = 0;
  // 16 bits per channel are rounded to 8 by the decoder.
  const std::unique_ptr<stbi_uc, StbFree> texels(
      stbi_load_from_memory(bytes.data, int(bytes.size), &width, &height, &channels, 4));
  if (!texels) doc.fail(place, std::string("cannot be decoded: ") + stbi_failure_reason() + " (PNG or JPEG expected)");

  TextureImage out;
  out.name = !image.name.empty() ? image.name : !image.uri.empty() ? image.uri : "image " + std::to_string(index);
  out.width = width;
  out.height = height;
  out.srgb = srgb;
  const size_t count = size_t(width) * size_t(height);
  out.texels.resize(count);
  glm::dvec4 sum(0);
  for (size_t i = 0; i < count; ++i) {
    const stbi_uc* t = texels.get() + 4 * i;
    out.texels[i] = {t[0], t[1], t[2], t[3]};
    sum += glm::dvec4(decodeTexel(out.texels[i], out.srgb));
  }
  out.averageLinear = vec4(sum / double(count));
  return out;
}

} // namespace

void decodeImages(Import& import) {
  std::vector<std::pair<int, bool>> order(import.images.size());
  for (const auto& [image, slot] : import.images) order[slot] = image;
  auto& images = import.scene.assets.images;
  images.resize(order.size());
  std::vector<std::string> errors(order.size()); // the first by index is thrown, whichever thread met one first
  parallelFor(order.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) try {
        images[i] = decode(import.doc, order[i].first, order[i].second);
      } catch (const InputError& e) {
        errors[i] = e.what();
      }
  });
  for (const std::string& error : errors)
    if (!error.empty()) throw InputError(import.doc.file.string(), error.substr(import.doc.file.string().size() + 2));
}

} // namespace lambent::gltf

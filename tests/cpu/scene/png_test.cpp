// PNG textures: every kind of them, and those that hold more than they show.
#include "engine/core/rng.h"
#include "tests/cpu/scene/support.h"
#include "tests/support/effort.h"

#include <algorithm>
#include <cstring>
#include <ctime>
#include <string_view>

#include <stb/stb_image.h>
#include <zlib.h>

namespace lambent::test::png_test {

std::vector<uint8_t> chunk(const char* type, const std::vector<uint8_t>& data) {
  std::vector<uint8_t> out;
  const auto number = [&](uint32_t n) {
    out.insert(out.end(), {uint8_t(n >> 24), uint8_t(n >> 16), uint8_t(n >> 8), uint8_t(n)});
  };
  number(uint32_t(data.size()));
  out.insert(out.end(), type, type + 4);
  out.insert(out.end(), data.begin(), data.end());
  number(uint32_t(crc32(0, out.data() + 4, uInt(out.size() - 4))));
  return out;
}

/// A PNG of that kind whose rows, filters and all, are `rows`.
std::vector<uint8_t> pngOf(int width, int height, int depth, int color, bool interlaced,
                           const std::vector<uint8_t>& rows, const std::vector<std::vector<uint8_t>>& before = {},
                           int level = 9) {
  std::vector<uint8_t> out{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  const auto add = [&](const std::vector<uint8_t>& bytes) { out.insert(out.end(), bytes.begin(), bytes.end()); };
  add(chunk("IHDR", {0, 0, uint8_t(width >> 8), uint8_t(width), 0, 0, uint8_t(height >> 8), uint8_t(height),
                     uint8_t(depth), uint8_t(color), 0, 0, uint8_t(interlaced)}));
  for (const auto& bytes : before) add(bytes);
  std::vector<uint8_t> packed(compressBound(uLong(rows.size())));
  uLongf size = packed.size();
  EXPECT_EQ(compress2(packed.data(), &size, rows.data(), uLong(rows.size()), level), Z_OK);
  packed.resize(size);
  add(chunk("IDAT", packed));
  add(chunk("IEND", {}));
  return out;
}

/// The only image of a file that holds these bytes.
Scene withImage(const std::vector<uint8_t>& bytes, const TemporaryFolder& folder) {
  GltfBuilder b = oneTriangle();
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  b.json["textures"] = {{{"source", 0}}};
  b.json["images"] = {{{"bufferView", b.view(bytes)}, {"mimeType", "image/png"}}};
  return b.load(folder);
}

/// Every kind of PNG, against another decoder's texels.
TEST(PngTextures, OfEveryKindAreDecoded) {
  const TemporaryFolder folder;
  Rng rng(1, Stream::Test, 0);
  constexpr int kKinds[][2] = {{1, 0}, {2, 0}, {4, 0}, {8, 0}, {16, 0}, {8, 2}, {16, 2}, {1, 3},
                               {2, 3}, {4, 3}, {8, 3}, {8, 4}, {16, 4}, {8, 6}, {16, 6}};
  for (const auto& [depth, color] : kKinds)
    for (const bool interlaced : {false, true})
      for (const bool keyed : {false, true})
        for (const auto& [width, height] : {std::pair(13, 9), {1, 1}, {5, 2}}) {
          const int channels = color == 2 ? 3 : color == 4 ? 2 : color == 6 ? 4 : 1;
          std::vector<uint8_t> rows;
          const auto pass = [&](int w, int h) {
            if (w == 0) return;
            for (int y = 0; y < h; ++y) {
              rows.push_back(uint8_t(rng.below(5))); // filter
              for (int i = 0; i < (w * channels * depth + 7) / 8; ++i) rows.push_back(uint8_t(rng.below(256)));
            }
          };
          if (!interlaced) pass(width, height);
          constexpr int kFirst[7][4] = {{0, 0, 8, 8}, {4, 0, 8, 8}, {0, 4, 4, 8}, {2, 0, 4, 4},
                                        {0, 2, 2, 4}, {1, 0, 2, 2}, {0, 1, 1, 2}};
          if (interlaced)
            for (const auto& [x, y, dx, dy] : kFirst) pass((width - x + dx - 1) / dx, (height - y + dy - 1) / dy);
          std::vector<std::vector<uint8_t>> before;
          if (color == 3) {
            std::vector<uint8_t> palette;
            for (int i = 0; i < 3 << depth; ++i) palette.push_back(uint8_t(rng.below(256)));
            before.push_back(chunk("PLTE", palette));
          }
          if (keyed && color == 3) before.push_back(chunk("tRNS", {7, 200}));
          if (keyed && color == 0) before.push_back(chunk("tRNS", {0, 1}));
          if (keyed && color == 2) before.push_back(chunk("tRNS", {0, 1, 0, 2, 0, 3}));
          const std::vector<uint8_t> bytes = pngOf(width, height, depth, color, interlaced, rows, before);
          int w = 0, h = 0, n = 0;
          stbi_uc* wanted = stbi_load_from_memory(bytes.data(), int(bytes.size()), &w, &h, &n, 4);
          ASSERT_NE(wanted, nullptr) << stbi_failure_reason();
          const Scene scene = withImage(bytes, folder);
          const TextureImage& got = scene.assets.images.at(0);
          EXPECT_EQ(got.width, width);
          EXPECT_EQ(std::memcmp(got.texels.data(), wanted, size_t(4 * width * height)), 0)
              << "depth " << depth << ", colour " << color << ", interlaced " << interlaced << ", key " << keyed;
          stbi_image_free(wanted);
          // Cut off in its last row, it is white, and said: its data as they are, without the last byte of it.
          const std::vector<uint8_t> plain = pngOf(width, height, depth, color, interlaced, rows, before, 0);
          constexpr std::string_view kData = "IDAT";
          constexpr ptrdiff_t kHead = 4 + 2 + 5; // name, zlib's and the only block's
          const auto data = std::ranges::search(plain, kData).begin();
          const std::vector<uint8_t> cut(plain.begin(), data + kHead + ptrdiff_t(rows.size()) - 1);
          EXPECT_TRUE(hasWarning(withImage(cut, folder), "white instead"))
              << "depth " << depth << ", colour " << color << ", interlaced " << interlaced << ' ' << width << 'x'
              << height;
        }
}

/// What follows the last row is not inflated: half a gigabyte of zeros after a single texel.
TEST(PngTextures, InflateNoMoreThanTheyShow) {
  if (kSanitized) GTEST_SKIP() << "fills half a gigabyte";
  const TemporaryFolder folder;
  std::vector<uint8_t> rows(size_t(512) << 20, 0);
  rows[1] = 10, rows[2] = 20, rows[3] = 30, rows[4] = 40;
  const std::vector<uint8_t> bytes = pngOf(1, 1, 8, 6, false, rows);
  rows = {};
  const std::clock_t begin = std::clock();
  const Scene scene = withImage(bytes, folder);
  EXPECT_LT(double(std::clock() - begin) / CLOCKS_PER_SEC, 0.2);
  EXPECT_EQ(scene.assets.images.at(0).texels.at(0), u8vec4(10, 20, 30, 40));
}

} // namespace lambent::test::png_test

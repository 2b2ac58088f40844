// JPEG pictures: whole ones are right, and of damaged ones nothing is believed.
#include "engine/scene/jpeg.h"

#include "tests/support/test.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

namespace lambent::test {

namespace {

std::string bytesOf(const std::string& hex) {
  std::string out;
  for (size_t i = 0; i + 1 < hex.size(); i += 2) out += char(std::stoi(hex.substr(i, 2), nullptr, 16));
  return out;
}

// 8 x 8 texels of one grey, 200.
const std::string kGrey = bytesOf(
    "ffd8ffe000104a46494600010100000100010000ffdb0043000302020302020303030304030304050805050404050a070706080c0a0c0c"
    "0b0a0b0b0d0e12100d0e110e0b0b1016101113141515150c0f171816141812141514ffc0000b080008000801011100ffc4001400010000"
    "0000000000000000000000000008ffc40014100100000000000000000000000000000000ffda0008010100003f00603fffd9");
// 8 x 8 of inks: no cyan, half magenta, all yellow, a quarter black.
const std::string kInks = bytesOf(
    "ffd8ffee000e41646f626500640000000000ffdb0043000302020302020303030304030304050805050404050a070706080c0a0c0c0b0a"
    "0b0b0d0e12100d0e110e0b0b1016101113141515150c0f171816141812141514ffc000140800080008044311004d11005911004b1100ff"
    "c400160001010100000000000000000000000000090208ffc40014100100000000000000000000000000000000ffda000e0443004d0059"
    "004b00003f0054d02a9aa1ffd9");
// 32 x 16, progressive: red grows with x, green with y, blue is 100.
const std::string kPasses = bytesOf(
    "ffd8ffe000104a46494600010100000100010000ffdb004300020101010101020101010202020202040302020202050404030406050606"
    "0605060606070908060709070606080b08090a0a0a0a0a06080b0c0b0a0c090a0a0affdb004301020202020202050303050a0706070a0a"
    "0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0affc20011080010"
    "002003011100021101031101ffc4001500010100000000000000000000000000000608ffc4001701010101010000000000000000000000"
    "0005070609ffda000c030100021003100000019a36b9b4c5505393404c4d01197cd34e5501313404c5503fffc400161000030000000000"
    "000000000000000000000406ffda000801010001050256545254525452545254525452545654ffc4001711010003000000000000000000"
    "0000000005002131ffda0008010301013f0135ecb86bd970d7b2e1af65c35ecb86bd970d7b2e1af65cffc4001711000301000000000000"
    "0000000000000000030561ffda0008010201013f01758d1d634758d1d634758d1d634758d1d634ffc40015100101000000000000000000"
    "00000000000033ffda0008010100063f029a69a69a69a6ffc4001610000300000000000000000000000000000031c1ffda000801010001"
    "3f215c8991322644c8991322e4ffda000c03010002000300000010f12e5dffc40014110100000000000000000000000000000030ffda00"
    "08010301013f100ddddddddfffc4001511010100000000000000000000000000000031ffda0008010201013f10a942854a942a50ffc400"
    "161000030000000000000000000000000000002041ffda0008010100013f107ca5294a5330ff00ffd9");

struct Picture {
  bool whole = false;
  int width = 0, height = 0;
  std::vector<uint8_t> texels;
  std::string defect;

  explicit Picture(const std::string& bytes) {
    const auto* data = reinterpret_cast<const uint8_t*>(bytes.data());
    if (!sizeOfJpeg(data, bytes.size(), width, height, defect)) return;
    texels.assign(4 * size_t(width) * size_t(height), 77);
    whole = readJpeg(data, bytes.size(), width, height, texels.data(), defect);
  }
  std::array<int, 4> at(int x, int y) const {
    const uint8_t* t = texels.data() + 4 * (size_t(y) * size_t(width) + size_t(x));
    return {t[0], t[1], t[2], t[3]};
  }
};

/// Without its segments of that marker.
std::string without(std::string bytes, uint8_t marker) {
  for (size_t at; (at = bytes.find(std::string{'\xff', char(marker)})) != bytes.npos;)
    bytes.erase(at, 2 + 256 * size_t(uint8_t(bytes[at + 2])) + size_t(uint8_t(bytes[at + 3])));
  return bytes;
}

TEST(Jpeg, IsDecoded) {
  const Picture grey(kGrey), inks(kInks), passes(kPasses);
  ASSERT_TRUE(grey.whole) << grey.defect;
  EXPECT_EQ(grey.at(3, 5), (std::array{200, 200, 200, 255}));
  ASSERT_TRUE(inks.whole) << inks.defect;
  const auto [r, g, b, a] = inks.at(2, 2);
  EXPECT_NEAR(r, 191, 3);
  EXPECT_NEAR(g, 95, 3);
  EXPECT_NEAR(b, 0, 3);
  EXPECT_EQ(a, 255);
  ASSERT_TRUE(passes.whole) << passes.defect;
  EXPECT_EQ(passes.width, 32);
  EXPECT_EQ(passes.height, 16);
  for (const int x : {4, 27})
    for (const int y : {3, 12}) {
      EXPECT_NEAR(passes.at(x, y)[0], 8 * x, 12);
      EXPECT_NEAR(passes.at(x, y)[1], 16 * y, 12);
      EXPECT_NEAR(passes.at(x, y)[2], 100, 12);
    }
}

/// stb_image decoded such by memory that it never wrote: other colours each time, or the end of the program.
TEST(Jpeg, TablesThatItLacksAreNotMadeUp) {
  constexpr uint8_t kQuantization = 0xdb, kHuffman = 0xc4;
  for (const std::string& bytes : {kGrey, kInks, kPasses}) {
    const Picture noSteps(without(bytes, kQuantization));
    EXPECT_FALSE(noSteps.whole);
    EXPECT_NE(noSteps.defect.find("uantization table"), std::string::npos) << noSteps.defect;
    const Picture noCodes(without(bytes, kHuffman)), again(without(bytes, kHuffman)); // the standard's ones instead
    EXPECT_EQ(noCodes.whole, again.whole);
    if (noCodes.whole) {
      EXPECT_EQ(noCodes.texels, again.texels);
    }
  }
}

TEST(Jpeg, WhatIsCutOffIsDamaged) {
  for (const std::string& bytes : {kGrey, kInks, kPasses})
    for (size_t size = 0; size + 4 < bytes.size(); ++size) {
      const Picture cut(bytes.substr(0, size));
      EXPECT_FALSE(cut.whole) << size;
      EXPECT_FALSE(cut.defect.empty()) << size;
    }
}

TEST(Jpeg, AnyByteMayBeAnother) {
  for (const std::string& bytes : {kGrey, kInks, kPasses})
    for (size_t i = 2; i < bytes.size(); ++i)
      for (const int other : {0, 1, 0x7f, 0xff}) {
        std::string changed = bytes;
        changed[i] = char(other);
        int width = 0, height = 0;
        std::string defect;
        const auto* data = reinterpret_cast<const uint8_t*>(changed.data());
        if (!sizeOfJpeg(data, changed.size(), width, height, defect) || width * height > 1 << 20) continue;
        std::vector<uint8_t> texels(4 * size_t(width) * size_t(height), 77), again = texels;
        const bool whole = readJpeg(data, changed.size(), width, height, texels.data(), defect);
        EXPECT_EQ(readJpeg(data, changed.size(), width, height, again.data(), defect), whole);
        if (whole) {
          EXPECT_EQ(texels, again) << i;
        }
      }
}

} // namespace

} // namespace lambent::test

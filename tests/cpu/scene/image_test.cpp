// Pictures on disk, texture lookup, nearest names.

#include "engine/core/files.h"
#include "engine/core/text.h"
#include "engine/image/image.h"
#include "engine/view/surface_point.h"
#include "tests/cpu/scene/support.h"

#include <bit>
#include <cstring>
#include <functional>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <stb/stb_image.h>

namespace lambent::test::image_test {

Image gradient(int width, int height) {
  Image image(width, height);
  for (const auto [x, y] : Pixels(width, height)) image.at(x, y) = vec3(x * 0.1f, y * 1e5f, -1.0f / float(1 + x + y));
  return image;
}

TEST(Exr, RoundTripIsExact) {
  TemporaryFolder folder;
  Image image = gradient(37, 21);
  image.at(3, 4) = vec3(kInfinity, 1e-42f, 0);
  writeExr(folder / "a.exr", image);
  const Image back = readExr(folder / "a.exr");
  EXPECT_EQ(back.width, 37);
  EXPECT_EQ(back.height, 21);
  EXPECT_EQ(back.pixels, image.pixels);
}

TEST(Exr, LayersAndShiftedWindowsAreRead) {
  TemporaryFolder folder;
  const Image image = gradient(4, 3);
  const Imath::Box2i window({-2, 5}, {1, 7});
  Imf::Header header(window, window);
  Imf::FrameBuffer frame;
  const char* base = reinterpret_cast<const char*>(image.pixels.data()) - (5 * 4 - 2) * int(sizeof(vec3));
  for (int c = 0; c < 3; ++c) {
    const std::string name = std::string("direct.") + "RGB"[c];
    header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    frame.insert(name,
                 Imf::Slice(Imf::FLOAT, const_cast<char*>(base) + c * sizeof(float), sizeof(vec3), 4 * sizeof(vec3)));
  }
  {
    Imf::OutputFile out((folder / "layers.exr").c_str(), header);
    out.setFrameBuffer(frame);
    out.writePixels(3);
  }
  EXPECT_EQ(readExr(folder / "layers.exr", "direct").pixels, image.pixels);
  const std::string error = inputErrorOf([&] { readExr(folder / "layers.exr"); });
  EXPECT_NE(error.find("has no channel R (it has: direct.B, direct.G, direct.R)"), std::string::npos) << error;
}

TEST(Exr, BadFilesAreInputErrors) {
  TemporaryFolder folder;
  EXPECT_NE(inputErrorOf([&] { readExr(folder / "no.exr"); }).find("no such file"), std::string::npos);
  writeBytes(folder / "words.exr", "words");
  EXPECT_NE(inputErrorOf([&] { readExr(folder / "words.exr"); }).find("words.exr: "), std::string::npos);
  writeExr(folder / "whole.exr", gradient(16, 16));
  const std::string whole = readBytes(folder / "whole.exr");
  for (size_t size = 5; size < whole.size(); size += 97) {
    writeBytes(folder / "cut.exr", whole.substr(0, size));
    inputErrorOf([&] { readExr(folder / "cut.exr"); });
  }
}

/// All channels are unpacked, whoever asks for three of them.
TEST(Exr, OfVeryManyChannelsIsRefused) {
  const TemporaryFolder folder;
  const fs::path file = folder / "many.exr";
  {
    Imf::Header header(8192, 16);
    for (int i = 0; i < 1100; ++i) header.channels().insert("c" + std::to_string(i), Imf::Channel(Imf::HALF));
    for (const char* name : {"R", "G", "B"}) header.channels().insert(name, Imf::Channel(Imf::HALF));
    Imf::OutputFile out(file.c_str(), header); // without rows
  }
  EXPECT_NE(inputErrorOf([&] { readExr(file); }).find("has 1103 channels"), std::string::npos);
}

/// Half floats are packed to fewer bytes than floats.
TEST(Exr, FlatPicturesOfHalfFloatsAreWhole) {
  const TemporaryFolder folder;
  const fs::path file = folder / "flat.exr";
  constexpr int kWidth = 4096, kHeight = 4096;
  {
    Imf::Header header(kWidth, kHeight, 1, {0, 0}, 1, Imf::INCREASING_Y, Imf::ZIP_COMPRESSION);
    for (const char* name : {"R", "G", "B"}) header.channels().insert(name, Imf::Channel(Imf::HALF));
    Imf::OutputFile out(file.c_str(), header);
    std::vector<uint16_t> row(kWidth, 0x3c00); // 1
    Imf::FrameBuffer frame;
    for (const char* name : {"R", "G", "B"})
      frame.insert(name, Imf::Slice(Imf::HALF, reinterpret_cast<char*>(row.data()), sizeof(uint16_t), 0));
    out.setFrameBuffer(frame);
    out.writePixels(kHeight);
  }
  EXPECT_LT(fs::file_size(file), 150'000u);
  EXPECT_EQ(readExr(file).at(77, 4000), vec3(1));
}

TEST(Exr, NamesSomeOfItsChannels) {
  const TemporaryFolder folder;
  {
    Imf::Header header(4, 4);
    for (int i = 0; i < 3000; ++i) header.channels().insert("c" + std::to_string(i), Imf::Channel(Imf::HALF));
    Imf::OutputFile out((folder / "many.exr").c_str(), header);
  }
  const std::string error = inputErrorOf([&] { readExr(folder / "many.exr"); });
  EXPECT_NE(error.find("and 2984 more)"), std::string::npos) << error;
  EXPECT_LT(error.size(), 400u);
}

TEST(Png, RoundTripIsExact) {
  TemporaryFolder folder;
  Image8 image{3, 2, {0, 1, 2, 3, 4, 5, 250, 251, 252, 9, 9, 9, 8, 8, 8, 7, 0, 7}};
  writePng(folder / "a.png", image);
  int width = 0, height = 0, channels = 0;
  stbi_uc* back = stbi_load((folder / "a.png").c_str(), &width, &height, &channels, 3);
  ASSERT_NE(back, nullptr);
  EXPECT_EQ(width, 3);
  EXPECT_EQ(height, 2);
  EXPECT_EQ(std::vector<uint8_t>(back, back + 18), image.rgb);
  stbi_image_free(back);
}

TEST(Png, DamageOfAnyByteIsSeen) {
  TemporaryFolder folder;
  const fs::path file = folder / "a.png";
  writePng(file, {3, 2, {0, 1, 2, 3, 4, 5, 250, 251, 252, 9, 9, 9, 8, 8, 8, 7, 0, 7}});
  std::ifstream in(file, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), {}};
  EXPECT_TRUE(isWholePng(file, 3, 2));
  EXPECT_FALSE(isWholePng(file, 2, 3));
  for (size_t i = 0; i < whole.size(); ++i) {
    std::string bytes = whole;
    bytes[i] = char(bytes[i] ^ 4);
    std::ofstream(file, std::ios::binary) << bytes;
    EXPECT_FALSE(isWholePng(file, 3, 2)) << "byte " << i;
    std::ofstream(file, std::ios::binary) << whole.substr(0, i);
    EXPECT_FALSE(isWholePng(file, 3, 2)) << "cut at " << i;
  }
  std::ofstream(file, std::ios::binary) << whole << '\n';
  EXPECT_FALSE(isWholePng(file, 3, 2)) << "more than it";
}

TEST(Pfm, BothByteOrdersAndGreyAreRead) {
  TemporaryFolder folder;
  const auto floats = [](std::vector<float> values, bool big) {
    std::string bytes;
    for (const float v : values)
      for (int i = 0; i < 4; ++i) bytes += char(std::bit_cast<uint32_t>(v) >> (8 * (big ? 3 - i : i)) & 255);
    return bytes;
  };
  // Two rows of one pixel; the file begins with the bottom one.
  for (const bool big : {false, true}) {
    writeBytes(folder / "a.pfm",
               std::string("PF\n1 2\n") + (big ? "1.0" : "-1.0") + "\n" + floats({4, 5, 6, 1, 2, 3}, big));
    const Image image = readPfm(folder / "a.pfm");
    EXPECT_EQ(image.at(0, 0), vec3(1, 2, 3));
    EXPECT_EQ(image.at(0, 1), vec3(4, 5, 6));
  }
  writeBytes(folder / "grey.pfm", "Pf\n2 1\n-1\n" + floats({7, 8}, false));
  EXPECT_EQ(readPfm(folder / "grey.pfm").at(1, 0), vec3(8));
  writeBytes(folder / "short.pfm", "PF\n2 2\n-1\n" + floats({1, 2, 3}, false));
  EXPECT_NE(inputErrorOf([&] { readPfm(folder / "short.pfm"); }).find("ends before"), std::string::npos);
  writeBytes(folder / "huge.pfm", "PF\n999999 999999\n-1\n");
  EXPECT_NE(inputErrorOf([&] { readPfm(folder / "huge.pfm"); }).find("size"), std::string::npos);
}

TEST(WriteAtomically, LeavesNothingBehindOnFailureAndKeepsTheOldFile) {
  TemporaryFolder folder;
  writeBytes(folder / "old.txt", "old");
  EXPECT_THROW(writeAtomically(folder / "old.txt",
                               [](const std::filesystem::path& temporary) {
                                 writeBytes(temporary, "half");
                                 throw RunError("no more paper");
                               }),
               RunError);
  EXPECT_EQ(readBytes(folder / "old.txt"), "old");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
  const std::filesystem::path target = folder / "becomes-a-folder.txt";
  EXPECT_THROW(writeAtomically(target,
                               [&](const std::filesystem::path& temporary) {
                                 writeBytes(temporary, "whole");
                                 std::filesystem::create_directory(target);
                               }),
               RunError);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 2) << "old.txt and the folder";
  EXPECT_THROW(writeExr(folder / "no/such/folder.exr", Image(1, 1)), RunError);
  EXPECT_THROW(writePng(folder / "no/such/folder.png", Image8{1, 1, {1, 2, 3}}), RunError);
}

TEST(WriteAtomically, AFullDiskIsSaidAndKeepsTheOldFile) {
  EXPECT_THROW(writePng("/dev/full", Image8{1, 1, {1, 2, 3}}), RunError);
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full")) << "a file was put in the place of the device";
}

TEST(WriteAtomically, WhoMayReadStaysAsItWas) {
  const TemporaryFolder folder;
  writeBytes(folder / "private.txt", "old");
  fs::permissions(folder / "private.txt", fs::perms(0640));
  writeAtomically(folder / "private.txt", "new");
  EXPECT_EQ(readBytes(folder / "private.txt"), "new");
  EXPECT_EQ(fs::status(folder / "private.txt").permissions(), fs::perms(0640));
}

TEST(WriteAtomically, ReplacesNothingThatIsKept) {
  TemporaryFolder folder;
  writeBytes(folder / "texture.png", "old");
  std::filesystem::create_symlink("texture.png", folder / "link.png");
  keepFromReplacing(folder / "link.png");
  for (const auto& file : {folder / "texture.png", folder / "link.png", folder / "." / "texture.png"})
    EXPECT_THROW(writePng(file, Image8{1, 1, {1, 2, 3}}), InputError) << file;
  EXPECT_EQ(readBytes(folder / "texture.png"), "old");
  writePng(folder / "other.png", Image8{1, 1, {1, 2, 3}});
}

TEST(WriteAtomically, ALinkStaysOne) {
  TemporaryFolder folder;
  writeBytes(folder / "target.png", "old");
  std::filesystem::create_symlink("target.png", folder / "link.png");
  writePng(folder / "link.png", Image8{1, 1, {1, 2, 3}});
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.png"));
  EXPECT_EQ(readBytes(folder / "target.png").substr(1, 3), "PNG");
  fs::create_directory(folder / "there");
  fs::create_symlink("there/new.png", folder / "new.png"); // nothing is there yet
  fs::create_symlink("new.png", folder / "again.png");
  writePng(folder / "again.png", Image8{1, 1, {1, 2, 3}});
  EXPECT_TRUE(fs::is_symlink(folder / "new.png") && fs::is_symlink(folder / "again.png"));
  EXPECT_EQ(readBytes(folder / "there/new.png").substr(1, 3), "PNG");
  fs::create_symlink("b.png", folder / "a.png");
  fs::create_symlink("a.png", folder / "b.png");
  for (const auto& write : {std::function<void()>([&] {
                              writePng(folder / "a.png", Image8{1, 1, {1, 2, 3}});
                            }),
                            std::function<void()>([&] { checkWritable(folder / "a.png"); }),
                            std::function<void()>([&] { checkWritable(folder / std::string(256, 'n')); })})
    EXPECT_NE(messageOf<RunError>(write).find("cannot be written: its"), std::string::npos);
  EXPECT_TRUE(fs::is_symlink(folder / "a.png"));
}

/// Names of what goes into a folder of results are the program's: nobody meant what a link there leads to.
TEST(WriteAtomically, WritesThroughNoLinkInAFolderOfResults) {
  TemporaryFolder folder;
  writeBytes(folder / "outside.png", "old");
  fs::create_directory(folder / "results");
  fs::create_symlink("../outside.png", folder / "results/000000.png");
  fs::create_directory_symlink("results", folder / "again");
  refuseLinksIn(folder / "results");
  for (const char* name : {"results/000000.png", "again/000000.png"})
    EXPECT_NE(inputErrorOf([&] {
                writePng(folder / name, Image8{1, 1, {1, 2, 3}});
              }).find("it is a link"),
              std::string::npos);
  EXPECT_EQ(readBytes(folder / "outside.png"), "old");
  writePng(folder / "again/000001.png", Image8{1, 1, {1, 2, 3}});
}

/// Nor below it.
TEST(WriteAtomically, WritesThroughNoLinkedFolderInAFolderOfResults) {
  TemporaryFolder folder;
  fs::create_directory(folder / "outside");
  fs::create_directory(folder / "results");
  fs::create_directory_symlink("../outside", folder / "results/door");
  refuseLinksIn(folder / "results");
  EXPECT_NE(inputErrorOf([&] { writeAtomically(folder / "results/door/door.bin", "new"); }).find("door is a link"),
            std::string::npos);
  fs::create_directories(folder / "results/deep/er");
  fs::create_directory_symlink("../../../outside", folder / "results/deep/er/door");
  EXPECT_THROW(writeAtomically(folder / "results/deep/er/door/door.bin", "new"), InputError);
  EXPECT_TRUE(fs::is_empty(folder / "outside"));
}

/// What lies in a report's folder and is not its own is somebody's, in this run of the program and in later ones.
TEST(WriteAtomically, ReplacesOnlyItsOwnInAFolderOfReports) {
  TemporaryFolder folder;
  const fs::path report = folder / "report";
  fs::create_directory(report);
  writeBytes(report / "mine.csv", "mine");
  replaceOnlyOwnIn(report);
  for (int run = 0; run < 2; ++run) {
    EXPECT_NE(inputErrorOf([&] { checkWritable(report / "mine.csv"); }).find("is not replaced"), std::string::npos);
    EXPECT_THROW(writeAtomically(report / "mine.csv", "new"), InputError);
    writeAtomically(report / "own.csv", std::to_string(run));
    writeAtomically(report / "own.csv", "again " + std::to_string(run));
    listAsOwn(report / "log.jsonl");
    writeBytes(report / "log.jsonl", "x");
    EXPECT_NO_THROW(checkWritable(report / "log.jsonl"));
    replaceOnlyOwnIn(report); // as the next run of the program does
  }
  writeBytes(report / "other.csv", "x");
  EXPECT_THROW(checkWritable(report / "other.csv"), InputError);
  writeBytes(report / ".lambent-results", readBytes(report / ".lambent-results") + "\nother.csv");
  EXPECT_NO_THROW(checkWritable(report / "other.csv")) << "another program wrote it meanwhile";
  writeBytes(report / ".lambent-results", "\nown.csv\nlog.jsonl");
  EXPECT_EQ(readBytes(report / "mine.csv"), "mine");
  EXPECT_EQ(readBytes(report / "own.csv"), "again 1");
  EXPECT_EQ(readBytes(report / ".lambent-results"), "\nown.csv\nlog.jsonl") << "each once";
  writeAtomically(folder / "elsewhere.csv", "x");
  writeAtomically(folder / "elsewhere.csv", "y");
  fs::remove(report / ".lambent-results");
  ASSERT_EQ(mkfifo((report / ".lambent-results").c_str(), 0600), 0);
  EXPECT_NE(inputErrorOf([&] { replaceOnlyOwnIn(report); }).find("is not a file"), std::string::npos);
}

TEST(WriteAtomically, APipeNeedsAReaderBeforeTheWork) {
  TemporaryFolder folder;
  const fs::path pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_NE(messageOf<RunError>([&] { checkWritable(pipe); }).find("nobody reads this pipe"), std::string::npos);
  const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  ASSERT_GE(reader, 0);
  checkWritable(pipe);
  char text[8] = {};
  EXPECT_EQ(read(reader, text, sizeof text), -1) << "not yet at its end";
  writeAtomically(pipe, "figures");
  EXPECT_EQ(read(reader, text, sizeof text), 7);
  close(reader);
}

TEST(Srgb, CodesAndLinearValuesAreInverse) {
  EXPECT_FLOAT_EQ(linearFromSrgb(1), 1);
  EXPECT_NEAR(linearFromSrgb(0.5f), 0.21404f, 1e-5f);
  for (int i = 0; i <= 100; ++i) EXPECT_NEAR(srgbFromLinear(linearFromSrgb(float(i) / 100)), float(i) / 100, 1e-5f);
}

class TextureLookup : public ::testing::Test {
 protected:
  TextureLookup() { // black, white / red, transparent green; linear codes for easy numbers
    TextureImage image;
    image.width = image.height = 2;
    image.srgb = false;
    image.texels = {{0, 0, 0, 255}, {255, 255, 255, 255}, {255, 0, 0, 255}, {0, 255, 0, 0}};
    assets.images.push_back(image);
    ref.image = 0;
  }
  void expectColor(vec2 uv, vec4 expected) {
    const vec4 c = sampleTexture(assets, ref, uv);
    for (int i = 0; i < 4; ++i)
      EXPECT_NEAR(c[i], expected[i], 1e-5f) << "uv " << uv.x << ", " << uv.y << ", component " << i;
  }
  SceneAssets assets;
  TextureRef ref;
};

TEST_F(TextureLookup, TexelCentresAreExactAndBetweenIsMixed) {
  expectColor({0.25f, 0.25f}, {0, 0, 0, 1}); // row 0 is at v = 0
  expectColor({0.75f, 0.25f}, {1, 1, 1, 1});
  expectColor({0.25f, 0.75f}, {1, 0, 0, 1});
  expectColor({0.5f, 0.25f}, {0.5f, 0.5f, 0.5f, 1});
  expectColor({0.5f, 0.5f}, {0.5f, 0.5f, 0.25f, 0.75f});
  ref.nearest = true;
  expectColor({0.45f, 0.45f}, {0, 0, 0, 1});
}

TEST_F(TextureLookup, WrapModes) {
  expectColor({0, 0.25f}, {0.5f, 0.5f, 0.5f, 1}); // the border mixes with the other end
  expectColor({-3.25f, 5.25f}, {1, 1, 1, 1});
  ref.wrapU = ref.wrapV = Wrap::ClampToEdge;
  expectColor({0, 0.25f}, {0, 0, 0, 1});
  expectColor({1e30f, -1e30f}, {1, 1, 1, 1});
  ref.wrapU = ref.wrapV = Wrap::MirroredRepeat;
  expectColor({0, 0.25f}, {0, 0, 0, 1});
  expectColor({1.25f, 0.25f}, {1, 1, 1, 1});
  expectColor({1.75f, 0.25f}, {0, 0, 0, 1});
  expectColor({-0.75f, 0.25f}, {1, 1, 1, 1});
}

TEST_F(TextureLookup, TransformSrgbAndStrangeCoordinates) {
  ref.uvTransform = mat3(2, 0, 0, 0, 2, 0, 0.25f, 0, 1); // scale 2, then offset (0.25, 0)
  expectColor({0.25f, 0.125f}, {1, 1, 1, 1});
  ref.uvTransform = mat3(1);
  assets.images[0].srgb = true;
  assets.images[0].texels[0] = {188, 188, 188, 128};
  expectColor({0.25f, 0.25f}, vec4(vec3(linearFromSrgb(188 / 255.0f)), 128 / 255.0f));
  for (const float strange : {std::nanf(""), kInfinity, -kInfinity, 3e38f}) // any answer, but an answer
    EXPECT_TRUE(isFinite(vec3(sampleTexture(assets, ref, {strange, 0.5f}))));
  ref.image = kNone;
  expectColor({0.3f, 0.3f}, vec4(1));
}

/// Rays ask for the alpha alone.
TEST_F(TextureLookup, AlphaIsThatOfTheWholeLookup) {
  Rng random(1, Stream::RayWork, 0);
  assets.images[0] = {};
  assets.images[0].width = 5, assets.images[0].height = 3;
  for (int i = 0; i < 15; ++i) assets.images[0].texels.push_back(u8vec4(255.0f * vec4(random.next3(), random.next())));
  Mesh mesh;
  mesh.colors = {vec4(1, 1, 1, 0.3f), vec4(0.9f), vec4(0.7f)};
  mesh.uv0.resize(3);
  for (const Wrap wrapU : {Wrap::Repeat, Wrap::MirroredRepeat, Wrap::ClampToEdge})
    for (const Wrap wrapV : {Wrap::Repeat, Wrap::MirroredRepeat, Wrap::ClampToEdge})
      for (int i = 0; i < 200; ++i) {
        ref.wrapU = wrapU, ref.wrapV = wrapV, ref.nearest = i % 2 == 0;
        for (vec2& uv : mesh.uv0) uv = 8.0f * (random.next2() - 0.5f);
        mesh.uv0[0] = vec2(i % 3 - 1, i % 5 - 2); // edges
        EXPECT_EQ(sampleAlpha(assets, ref, mesh.uv0[0]), sampleTexture(assets, ref, mesh.uv0[0]).w);
        Material material;
        material.alpha = 0.8f, material.baseColorTexture = ref;
        const TrianglePlace place{{0, 1, 2}, 0.5f, 0.25f, 0.25f};
        EXPECT_EQ(alphaAt(assets, mesh, material, place), baseColourAt(assets, mesh, material, place).w);
      }
}

TEST(Pictures, AHeaderAloneAsksForNoMemory) {
  TemporaryFolder folder;
  const auto refused = [](const std::function<void()>& read) {
    struct rusage before, after;
    getrusage(RUSAGE_SELF, &before);
    const std::string message = inputErrorOf(read);
    EXPECT_NE(message.find("ends before the last"), std::string::npos) << message;
    getrusage(RUSAGE_SELF, &after);
    EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 100 << 10) << "KiB, of 3 GiB that the header tells of";
  };
  writeBytes(folder / "a.pfm", "PF 16384 16384 -1\n");
  refused([&] { readPfm(folder / "a.pfm"); });
  writeExr(folder / "a.exr", gradient(3, 2));
  std::string exr = readBytes(folder / "a.exr");
  const int32_t corner[] = {16383, 16383};
  std::memcpy(exr.data() + exr.find("dataWindow") + sizeof "dataWindow" + sizeof "box2i" + 3 * sizeof(int32_t), corner,
              sizeof corner);
  writeBytes(folder / "a.exr", exr + std::string(64 << 10, '\0')); // of its rows, where they are in the file
  refused([&] { readExr(folder / "a.exr"); });
}

TEST(Pictures, NamesMayBeAsLongAsTheDiskTakes) {
  TemporaryFolder folder;
  const std::string name = std::string(250, 'n') + ".exr";
  writeExr(folder / name, gradient(3, 2));
  EXPECT_EQ(readExr(folder / name).pixels, gradient(3, 2).pixels);
  EXPECT_THROW(writeExr(folder / (std::string(300, 'n') + ".exr"), gradient(3, 2)), RunError);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1) << "temporaries are left";
}

TEST(Pictures, FoldersAreAskedBeforeTheWork) {
  TemporaryFolder folder;
  EXPECT_NO_THROW(checkWritable(folder / "a.exr"));
  EXPECT_NO_THROW(checkWritable("/dev/null"));
  EXPECT_THROW(checkWritable(folder / "none/a.exr"), RunError);
  EXPECT_THROW(checkWritable(folder.path()), RunError);
}

TEST(Printable, ShowsControlCharactersAsNumbers) {
  EXPECT_EQ(printable("a\nb\t\x7f"), "a\\x0ab\\x09\\x7f");
  EXPECT_EQ(printable("\xc2\x9b"
                      "31m"),
            "\\x9b31m")
      << "a terminal's own language in UTF-8";
  EXPECT_EQ(printable("\xc3\xa4 \xe2\x82\xac \\"), "\xc3\xa4 \xe2\x82\xac \\");
  EXPECT_EQ(printable("\xff\xc3(\xe2\x82\xf0\x9f\x98\x80\xc3"), "\\xff\\xc3(\\xe2\\x82\xf0\x9f\x98\x80\\xc3")
      << "no UTF-8";
  EXPECT_EQ(printable("a\xe2\x80\xaegnp.\xe2\x81\xa9z"), "a\\xe2\\x80\\xaegnp.\\xe2\\x81\\xa9z") << "turned around";
  EXPECT_EQ(printable("\xd8\x9c\xe2\x80\x94"), "\\xd8\\x9c\xe2\x80\x94") << "a dash turns nothing";
}

TEST(NearestName, FindsTyposAndRefusesToGuess) {
  const std::vector<std::string> names = {"smc.vpls", "smc.seed", "gather.tile"};
  EXPECT_EQ(nearestName("smc.vpl", names), "smc.vpls");
  EXPECT_EQ(nearestName("SMC.SEED", names), "smc.seed");
  EXPECT_EQ(nearestName("xyzzy", names), "");
  EXPECT_EQ(nearestName("anything", std::vector<std::string>{}), "");
}

} // namespace lambent::test::image_test

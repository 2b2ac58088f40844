// How far a recording got, as a file that anybody may have changed says it.
#include "tools/kept/recording_folder.h"

#include "tests/support/files.h"
#include "tools/kept/value.h"

#include <optional>

#include <sys/stat.h>

namespace lambent::test::recording_folder_test {

class RecordingFolderTest : public testing::Test {
 protected:
  int keptOf(const std::string& text) const {
    writeBytes(folder_ / "recording.json", text);
    return mark_->kept();
  }

  TemporaryFolder folder_;
  std::optional<RecordingFolder> mark_{std::in_place, folder_.path(), "these", "png"};
};

TEST_F(RecordingFolderTest, SaysHowManyPicturesAreWhole) {
  EXPECT_EQ(mark_->kept(), 0) << "there is none";
  mark_->write(17);
  EXPECT_EQ(mark_->kept(), 17);
  mark_.reset();
  const RecordingFolder other(folder_.path(), "others", "png");
  EXPECT_NE(inputErrorOf([&] { other.kept(); }).find("another shot"), std::string::npos);
}

TEST_F(RecordingFolderTest, WhatCountsNoFramesKeepsNone) {
  for (const char* frames :
       {"-1", "\"17\"", "null", "[17]", "2147483647", "4294967313", "18446744073709551615", "1e39"})
    EXPECT_EQ(keptOf(std::string(R"({"conditions": "these", "frames": )") + frames + "}"), 0) << frames;
  for (const char* text : {"", "{", "[]", "17", R"({"frames": 17})"}) EXPECT_EQ(keptOf(text), 0) << text;
}

TEST_F(RecordingFolderTest, OneProgramRecordsIntoAFolder) {
  EXPECT_THROW(RecordingFolder(folder_.path(), "these", "png"), RunError);
  mark_.reset();
  EXPECT_NO_THROW(RecordingFolder(folder_.path(), "these", "png"));
}

TEST_F(RecordingFolderTest, LeavesNoPicturesOfALongerOneBehindItsOwn) {
  mark_->write(6);
  mark_.emplace(folder_.path(), "these", "png");
  mark_->write(0);
  mark_.emplace(folder_.path(), "these", "png"); // the one between was cut short
  fs::create_directory(folder_ / "000004.png");
  for (const char* name :
       {"000001.png", "000002.exr", "000005.png", "000006.png", "00005.png", "0000005.png", "frames.csv"})
    writeBytes(folder_ / name, "x");
  mark_->end(2);
  EXPECT_FALSE(fs::exists(folder_ / "000005.png"));
  for (const char* name :
       {"000001.png", "000002.exr", "000004.png", "000006.png", "00005.png", "0000005.png", "frames.csv"})
    EXPECT_TRUE(fs::exists(folder_ / name)) << name;
  EXPECT_EQ(mark_->kept(), 2);
}

TEST_F(RecordingFolderTest, KeepsPicturesOfAnotherFormat) {
  mark_->write(6);
  for (const char* name : {"000000.exr", "000005.exr", "000005.png"}) writeBytes(folder_ / name, "x");
  mark_.emplace(folder_.path(), "these", "none");
  mark_->write(0);
  mark_.emplace(folder_.path(), "these", "exr");
  EXPECT_EQ(mark_->picture(7), folder_ / "000007.exr");
  mark_->write(6);
  mark_->end(1);
  EXPECT_TRUE(fs::exists(folder_ / "000005.exr")) << "nobody recorded it";
  mark_.emplace(folder_.path(), "these", "png");
  mark_->end(1);
  EXPECT_FALSE(fs::exists(folder_ / "000005.png")) << "recorded before the other formats";
}

/// Somebody else's files are theirs, whatever they are called; a recording of before may be replaced.
TEST_F(RecordingFolderTest, ReplacesNothingThatNoRecordingWrote) {
  mark_.reset();
  const auto refusal = [&](const char* format) {
    return inputErrorOf([&] { RecordingFolder(folder_.path(), "these", format, {13, {"frames.csv"}}); });
  };
  for (const char* name : {"frames.csv", "000012.png", "recording.json"}) {
    writeBytes(folder_ / name, "{}");
    EXPECT_NE(refusal("png").find("was not recorded here"), std::string::npos) << name;
    fs::remove(folder_ / name);
  }
  for (const char* name : {"notes.csv", "000012.exr", "12.png", "000013.png"}) writeBytes(folder_ / name, "x");
  RecordingFolder(folder_.path(), "these", "none", {0, {"frames.csv"}}).write(0);
  writeBytes(folder_ / "frames.csv", "x");
  EXPECT_NO_THROW(RecordingFolder(folder_.path(), "others", "png", {13, {"frames.csv"}}));
  EXPECT_EQ(RecordingFolder(folder_.path(), "others", "png").kept(), 0) << "of no pictures";
  fs::create_symlink("elsewhere", folder_ / "000001.png");
  EXPECT_NE(refusal("png").find("is a link"), std::string::npos);
}

/// A folder that recordings know is not theirs: what they wrote in it is.
TEST_F(RecordingFolderTest, ReplacesInAKnownFolderWhatRecordingsWrote) {
  const std::vector<std::string> log = {"frames.csv"}, more = {"frames.csv", "frames-ir.csv", "contact-sheet.png"};
  const auto refused = [&](const char* name, const char* format, const std::vector<std::string>& names) {
    writeBytes(folder_ / name, "mine");
    bool thrown = false;
    try {
      RecordingFolder(folder_.path(), "these", format, {10, names});
    } catch (const InputError&) {
      thrown = true;
    }
    fs::remove(folder_ / name);
    return thrown;
  };
  mark_.reset();
  RecordingFolder(folder_.path(), "these", "none", {10, log}).write(0);
  EXPECT_FALSE(refused("frames.csv", "png", log));
  EXPECT_TRUE(refused("000000.png", "png", log)) << "no pictures were written";
  EXPECT_TRUE(refused("frames-ir.csv", "png", more));
  RecordingFolder(folder_.path(), "these", "png", {10, log}).write(4);
  EXPECT_FALSE(refused("000003.png", "png", log));
  EXPECT_FALSE(refused("000004.png", "png", log)) << "a kill may have come before its count";
  EXPECT_TRUE(refused("000005.png", "png", log));
  EXPECT_FALSE(refused("000010.png", "png", log)) << "is not written";
  EXPECT_TRUE(refused("000002.exr", "exr", log));
  RecordingFolder(folder_.path(), "these", "none", {10, more}).write(0);
  EXPECT_FALSE(refused("contact-sheet.png", "png", more));
  EXPECT_FALSE(refused("000003.png", "png", log)) << "the pictures' mark stays";
  EXPECT_EQ(RecordingFolder(folder_.path(), "these", "png").kept(), 4);
  RecordingFolder(folder_.path(), "these", "png", {2, log}).end(2);
  EXPECT_TRUE(refused("000003.png", "png", log)) << "the longer one's rest is gone";
}

TEST_F(RecordingFolderTest, WaitsForNoPipe) {
  mark_.reset();
  ASSERT_EQ(mkfifo((folder_ / "recording.json").c_str(), 0600), 0);
  EXPECT_NE(inputErrorOf([&] { RecordingFolder(folder_.path(), "these", "png"); }).find("is not a file"),
            std::string::npos);
}

TEST_F(RecordingFolderTest, RemovesWhatAKillLeft) {
  mark_.reset();
  const char* left[] = {".recording.lambent-17.json", ".000003.lambent-4711.png"};
  const char* others[] = {".000003.lambent-4711.exr", ".000003.lambent-x.png", ".notes.lambent-17.png",
                          ".000003.4711.png"};
  for (const char* name : left) writeBytes(folder_ / name, "x");
  for (const char* name : others) writeBytes(folder_ / name, "x");
  mark_.emplace(folder_.path(), "these", "png");
  for (const char* name : left) EXPECT_FALSE(fs::exists(folder_ / name)) << name;
  for (const char* name : others) EXPECT_TRUE(fs::exists(folder_ / name)) << name;
}

/// Text is nested as deeply as somebody likes, a stack is not.
TEST_F(RecordingFolderTest, DeeplyNestedTextIsNoValue) {
  const auto nested = [](size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); };
  EXPECT_EQ(Value::parsed(nested(100)).json(-1), nested(100));
  EXPECT_TRUE(Value::parsed(nested(200000)).isNothing());
  EXPECT_EQ(keptOf(R"({"conditions": )" + nested(200000) + "}"), 0);
}

} // namespace lambent::test::recording_folder_test

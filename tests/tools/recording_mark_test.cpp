// How far a recording got, as a file that anybody may have changed says it.
#include "tools/kept/recording_mark.h"

#include "tests/support/files.h"
#include "tools/kept/value.h"

#include <optional>

namespace lambent::test::recording_mark_test {

class RecordingMarkTest : public testing::Test {
 protected:
  int keptOf(const std::string& text) const {
    writeBytes(folder_ / "recording.json", text);
    return mark_->kept();
  }

  TemporaryFolder folder_;
  std::optional<RecordingMark> mark_{std::in_place, folder_.path(), "these"};
};

TEST_F(RecordingMarkTest, SaysHowManyPicturesAreWhole) {
  EXPECT_EQ(mark_->kept(), 0) << "there is none";
  mark_->write(17);
  EXPECT_EQ(mark_->kept(), 17);
  mark_.reset();
  const RecordingMark other(folder_.path(), "others");
  EXPECT_NE(inputErrorOf([&] { other.kept(); }).find("another shot"), std::string::npos);
}

TEST_F(RecordingMarkTest, WhatCountsNoFramesKeepsNone) {
  for (const char* frames :
       {"-1", "\"17\"", "null", "[17]", "2147483647", "4294967313", "18446744073709551615", "1e39"})
    EXPECT_EQ(keptOf(std::string(R"({"conditions": "these", "frames": )") + frames + "}"), 0) << frames;
  for (const char* text : {"", "{", "[]", "17", R"({"frames": 17})"}) EXPECT_EQ(keptOf(text), 0) << text;
}

TEST_F(RecordingMarkTest, OneProgramRecordsIntoAFolder) {
  EXPECT_THROW(RecordingMark(folder_.path(), "these"), RunError);
  mark_.reset();
  EXPECT_NO_THROW(RecordingMark(folder_.path(), "these"));
}

TEST_F(RecordingMarkTest, LeavesNoPicturesOfALongerOneBehindItsOwn) {
  mark_->write(6);
  mark_.emplace(folder_.path(), "these");
  mark_->write(0);
  mark_.emplace(folder_.path(), "these"); // the one between was cut short
  fs::create_directory(folder_ / "000004.png");
  for (const char* name : {"000001.png", "000002.exr", "000005.png", "000006.png", "00005.png", "frames.csv"})
    writeBytes(folder_ / name, "x");
  mark_->end(2);
  for (const char* name : {"000002.exr", "000005.png"}) EXPECT_FALSE(fs::exists(folder_ / name)) << name;
  for (const char* name : {"000001.png", "000004.png", "000006.png", "00005.png", "frames.csv"})
    EXPECT_TRUE(fs::exists(folder_ / name)) << name;
  EXPECT_EQ(mark_->kept(), 2);
}

/// Text is nested as deeply as somebody likes, a stack is not.
TEST_F(RecordingMarkTest, DeeplyNestedTextIsNoValue) {
  const auto nested = [](size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); };
  EXPECT_EQ(Value::parsed(nested(100)).json(-1), nested(100));
  EXPECT_TRUE(Value::parsed(nested(200000)).isNothing());
  EXPECT_EQ(keptOf(R"({"conditions": )" + nested(200000) + "}"), 0);
}

} // namespace lambent::test::recording_mark_test

// What the window keeps from one run to the next: a round trip, files that are something else, and who wins.
#include "game/rules/preferences.h"

#include "engine/core/files.h"
#include "gi/plan/presets.h"

#include "tests/support/files.h"

#include <thread>

namespace lambent::test::preferences_test {

class PreferencesTest : public testing::Test {
 protected:
  void write(const std::string& text) const { writeBytes(file_, text); }
  std::string text() const { return readBytes(file_); }

  TemporaryFolder folder_;
  const fs::path file_ = folder_ / "a/b.json";
};

Preferences some() {
  Preferences p;
  p.preset = "low";
  p.technique = "ir";
  p.set = {{"image.toneMapper", "filmic"}, {"smc.vpls", "64"}};
  p.exposure = -1.25;
  p.panel = false;
  p.folded = true;
  p.speed = 2.5;
  p.window = {800, 600};
  return p;
}

void noTechnique(Settings&, const std::string&) {}

TEST_F(PreferencesTest, ComeBackAsTheyWereSaved) {
  savePreferences(some(), file_);
  EXPECT_EQ(loadPreferences(file_), some());
  savePreferences({}, file_);
  EXPECT_EQ(loadPreferences(file_), Preferences());
}

TEST_F(PreferencesTest, NoFileGivesTheDefaultsAndNothingToSay) {
  KeptPreferences kept(file_);
  EXPECT_EQ(kept.now, Preferences());
  EXPECT_EQ(kept.takeComplaint(), "");
  kept.save();
  EXPECT_FALSE(fs::exists(folder_ / "a")) << "nothing was changed";
}

TEST_F(PreferencesTest, AFileThatIsSomethingElseStaysUntilSomethingChanges) {
  const std::string valid = R"({"kind": "lambent walkthrough", )";
  for (const std::string& bad :
       {std::string(), std::string("{"), std::string("[]"), std::string("null"), std::string("\xff\xfe\0", 3),
        std::string(R"({"kind": "another", "speed": 2})"), valid + R"("speed": "fast"})", valid + R"("speed": 1e9})",
        valid + R"("window": [1]})", valid + R"("set": {"smc.vpls": 3}})", valid + R"("speed": 2, "speed": 3})",
        std::string(2 << 20, ' '), std::string(100000, '[')}) {
    write(bad);
    KeptPreferences kept(file_);
    EXPECT_EQ(kept.now, Preferences()) << bad.substr(0, 80);
    const std::string complaint = kept.takeComplaint();
    EXPECT_NE(complaint.find(file_.string()), std::string::npos) << complaint;
    EXPECT_EQ(complaint.find('\n'), std::string::npos) << complaint;
    EXPECT_EQ(complaint.find("json.exception"), std::string::npos) << "words of a parser: " << complaint;
    kept.save();
    EXPECT_EQ(text(), bad) << "left alone";
    kept.now.speed = 3;
    kept.save();
    EXPECT_EQ(loadPreferences(file_).speed, 3);
  }
  fs::remove(file_);
  fs::create_directories(file_);
  KeptPreferences kept(file_);
  EXPECT_NE(kept.takeComplaint(), "") << "a folder";
  kept.now.speed = 3;
  kept.save();
  EXPECT_NE(kept.takeComplaint(), "") << "cannot be replaced";
  kept.save();
  EXPECT_EQ(kept.takeComplaint(), "") << "said once";
}

TEST_F(PreferencesTest, AreSavedOnceTheyHaveSettled) {
  KeptPreferences kept(file_);
  for (int i = 0; i < 30; ++i) {
    kept.now.speed = 1 + 0.1 * i; // a slider being moved
    kept.passed(0.1);
  }
  EXPECT_FALSE(fs::exists(file_));
  for (int i = 0; i < 25; ++i) kept.passed(0.1);
  EXPECT_NEAR(loadPreferences(file_).speed, 3.9, 1e-9);
}

TEST_F(PreferencesTest, TwoWindowsKeepEachOthersChanges) {
  savePreferences(some(), file_);
  KeptPreferences one(file_), other(file_);
  one.now.speed = 4;
  one.now.set["smc.vpls"] = "128";
  one.now.set.erase("image.toneMapper");
  other.now.panel = true;
  other.now.set["gather.mode"] = "full";
  one.save();
  other.save();
  Preferences both = some();
  both.speed = 4;
  both.panel = true;
  both.set = {{"smc.vpls", "128"}, {"gather.mode", "full"}};
  EXPECT_EQ(loadPreferences(file_), both);
  other.now.speed = 7;
  other.save();
  one.now.exposure = 2; // and again: only this
  one.save();
  both.speed = 7;
  both.exposure = 2;
  EXPECT_EQ(loadPreferences(file_), both);
}

TEST_F(PreferencesTest, WhatCouldNotBeWrittenComesWithTheNextChange) {
  savePreferences({}, file_);
  KeptPreferences kept(file_);
  kept.now.speed = 3;
  fs::rename(file_, folder_ / "aside");
  fs::create_directory(file_); // a folder by its name
  kept.save();
  EXPECT_NE(kept.takeComplaint(), "");
  fs::remove(file_);
  fs::rename(folder_ / "aside", file_);
  kept.now.panel = false;
  kept.save();
  EXPECT_EQ(loadPreferences(file_).speed, 3);
}

TEST_F(PreferencesTest, ManyWindowsAtOnceLoseNothing) { // not of the first ones either: there is no folder yet
  std::vector<std::thread> windows;
  for (int w = 0; w < 4; ++w)
    windows.emplace_back([&, w] {
      KeptPreferences kept(file_);
      for (int i = 0; i < 25; ++i) {
        kept.now.set["name." + std::to_string(w) + "." + std::to_string(i)] = "on";
        kept.save();
      }
      EXPECT_EQ(kept.takeComplaint(), "");
    });
  for (std::thread& w : windows) w.join();
  EXPECT_EQ(loadPreferences(file_).set.size(), 100);
}

// A program that is stopped while it saves must not stop the others.
TEST_F(PreferencesTest, WaitForNobodyForLong) {
  savePreferences({}, file_);
  const FolderLock stopped(file_.parent_path());
  KeptPreferences kept(file_);
  kept.now.speed = 3;
  kept.save();
  EXPECT_EQ(loadPreferences(file_).speed, 3);
}

// One of many that save in turn is no such program.
TEST_F(PreferencesTest, WaitAsLongAsOthersWrite) {
  savePreferences({}, file_);
  std::optional<FolderLock> busy(file_.parent_path());
  std::thread other([&] {
    for (int i = 0; i < 16; ++i) {
      writeBytes(file_.parent_path() / std::to_string(i), "");
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    busy.reset();
  });
  const FolderLock next(file_.parent_path(), true);
  EXPECT_TRUE(next.held());
  other.join();
}

TEST_F(PreferencesTest, WithoutAPlaceNothingIsKept) {
  KeptPreferences kept({});
  kept.now.speed = 3;
  kept.save();
  EXPECT_EQ(kept.takeComplaint(), "");
  EXPECT_EQ(preferencesFile("/x", "/home/i"), "/x/lambent/walkthrough.json");
  EXPECT_EQ(preferencesFile("relative", "/home/i"), "/home/i/.config/lambent/walkthrough.json");
  EXPECT_EQ(preferencesFile(nullptr, "/home/i"), "/home/i/.config/lambent/walkthrough.json");
  EXPECT_EQ(preferencesFile("", nullptr), "");
}

TEST_F(PreferencesTest, SingleSettingsThatAPersonChangedAndNoOthers) {
  Preferences p;
  Settings before, after;
  before.smc.vpls = 100; // the shot's
  after = before;
  after.smc.bounces = 1;
  after.image.exposure = 4; // Preferences::exposure
  p.changed(before, after);
  EXPECT_EQ(p.set, (std::map<std::string, std::string>{{"smc.bounces", "1"}}));
  std::string complaint;
  Settings own;
  own.smc.vpls = 300;
  const Settings over = p.over(own, {}, noTechnique, complaint);
  EXPECT_EQ(over.smc.vpls, 300);
  EXPECT_EQ(over.smc.bounces, 1);
  EXPECT_EQ(complaint, "");
}

TEST_F(PreferencesTest, APresetTakesThePlaceOfWhatItSets) {
  Preferences p;
  p.set = {{"smc.vpls", "7"}, {"shadow.resolution", "128"}, {"smc.bounces", "1"}};
  EXPECT_TRUE(p.chooseQuality());
  Settings before, after;
  applyPreset(after, "medium");
  p.chosePreset("medium", before, after);
  EXPECT_EQ(p.set, (std::map<std::string, std::string>{{"smc.bounces", "1"}})) << "also where it was so already";
  EXPECT_EQ(p.preset, "medium");
  p.set = {{"image.toneMapper", "filmic"}};
  EXPECT_TRUE(p.chooseQuality());
  p.preset.clear();
  EXPECT_FALSE(p.chooseQuality()) << "how it is shown is another thing";
}

TEST_F(PreferencesTest, GiveWayToTheCommandLine) {
  const Preferences p = some();
  std::string complaint;
  int techniques = 0;
  const auto technique = [&](Settings&, const std::string& name) { techniques += name == "ir"; };
  Settings own;
  EXPECT_EQ(p.over(own, {}, technique, complaint).smc.vpls, 64) << "after the preset";
  EXPECT_EQ(p.over(own, {}, technique, complaint).smc.points, 1024) << "the preset";
  EXPECT_EQ(techniques, 2);
  own.smc.points = 5;
  own.smc.vpls = 6;
  EXPECT_EQ(p.over(own, {false, {"smc.points", "smc.vpls"}}, technique, complaint).smc.points, 5);
  EXPECT_EQ(p.over(own, {false, {"smc.points", "smc.vpls"}}, technique, complaint).smc.vpls, 6);
  const Settings asked = p.over(own, {true, {}}, technique, complaint);
  EXPECT_EQ(asked.smc.vpls, 6);
  EXPECT_EQ(asked.image.toneMapper, ToneMapper::Filmic);
  EXPECT_EQ(techniques, 4);
  EXPECT_EQ(complaint, "");
}

TEST_F(PreferencesTest, AreLeftOutWithAReasonWhereTheyNoLongerFit) {
  Preferences p;
  p.set = {{"smc.bounces", "1"}, {"smc.gone", "3"}};
  std::string complaint;
  EXPECT_EQ(p.over({}, {}, noTechnique, complaint), Settings());
  EXPECT_NE(complaint.find("smc.gone"), std::string::npos);
  p.set = {{"smc.vpls", "-3"}};
  complaint.clear();
  EXPECT_EQ(p.over({}, {}, noTechnique, complaint), Settings());
  EXPECT_NE(complaint, "");
}

TEST_F(PreferencesTest, SettingsOfATechniqueThatIsLeftGoWithIt) {
  Preferences p;
  p.set = {{"glow.strength", "2"}, {"smc.vpls", "64"}, {"image.toneMapper", "filmic"}};
  Settings before, after;
  before.ownValues = {{"glow.strength", 2}};
  before.smc.vpls = 64;
  after.smc.vpls = 128; // the technique sets it
  p.choseTechnique("ir", before, after);
  EXPECT_EQ(p.technique, "ir");
  EXPECT_EQ(p.set, (std::map<std::string, std::string>{{"image.toneMapper", "filmic"}}));
}

TEST_F(PreferencesTest, AWindowIsOneThatCanBeOpened) {
  write(R"({"kind": "lambent walkthrough", "window": [1, 99999]})");
  EXPECT_EQ(loadPreferences(file_).window, std::pair(160, 16384));
  write(R"({"kind": "lambent walkthrough", "exposure": 1e9})");
  EXPECT_THROW(loadPreferences(file_), InputError) << "all white";
}

} // namespace lambent::test::preferences_test

// Settings as typed rows, presets, and what goes together on the four axes.
#include "gi/plan/settings.h"

#include "gi/plan/asked_work.h"
#include "gi/plan/presets.h"

#include "tests/support/files.h"

namespace lambent::test::settings_test {

TEST(Settings, TextsAndValuesOfEveryRowAgree) {
  for (const SettingRow& row : settingsTable()) {
    Settings s;
    EXPECT_EQ(row.get(s), row.standard) << row.name;
    for (const double value : {row.low, row.standard, std::min(row.high, 3e4)}) {
      applySetting(s, row.name, row.text(value));
      EXPECT_EQ(row.get(s), value) << row.name << " = " << row.text(value);
      EXPECT_EQ(settingText(s, row.name), row.text(value));
    }
    EXPECT_LE(row.low, row.standard) << row.name;
    EXPECT_LE(row.standard, row.high) << row.name;
    EXPECT_FALSE(row.help.empty()) << row.name;
    for (const char* wrong : {"", "x", "nan", "inf", "1e39", "-1e30", "1 "})
      EXPECT_THROW(applySetting(s, row.name, wrong), InputError) << row.name << " = '" << wrong << "'";
    if (row.kind == SettingKind::Whole) {
      EXPECT_THROW(applySetting(s, row.name, std::to_string(int64_t(row.high) + 1)), InputError) << row.name;
      EXPECT_THROW(applySetting(s, row.name, "1.5"), InputError) << row.name;
    }
  }
  EXPECT_THROW(settingRow("smc.vlps"), InputError);
  EXPECT_EQ(settingRow("gather").name, "gather.mode");
  EXPECT_EQ(settingRow("cube.sights").name, "cube.visibility") << "a name of before";
}

TEST(Settings, RangesReadAsTheyAreTyped) {
  EXPECT_EQ(settingRow("smc.vpls").range(), "1..65536");
  EXPECT_EQ(settingRow("gather.clamp").range(), "0..1e+30");
  EXPECT_EQ(settingRow("smc.cache").range(), "on|off");
  Settings s;
  applySetting(s, "gather.clamp", "1e+30");
  EXPECT_EQ(s.gather.clamp, 1e30f) << "both ends of a range can be set";
  const std::string said = inputErrorOf([&] { applySetting(s, "gather.clamp", "3e38"); });
  EXPECT_NE(said.find("(0..1e+30)"), std::string::npos) << said;
  EXPECT_EQ(settingRow("vpl.visibility").range(), "maps|rays|none");
  EXPECT_EQ(settingRow("filter.distance").range(), "1e-06..10");
  EXPECT_EQ(settingText({}, "multires.depth"), "0.02");
  EXPECT_EQ(settingRow("multires.finest").range(), "1..1024");
  EXPECT_EQ(settingText({}, "multires.finest"), "1");
  EXPECT_EQ(settingText({}, "multires.criterion"), "plane");
  EXPECT_EQ(settingText({}, "multires.upsample"), "bilateral");
}

TEST(Settings, PresetsSetWhatTheySayAndNoMore) {
  Settings odd; // no preset's values
  odd.smc = {.vpls = 77, .moves = 3, .paths = 79, .points = 78, .warmup = 4};
  odd.shadow.resolution = 80;
  odd.gather.mode = GatherMode::SplatPerVpl;
  odd.gather.near = 5;
  odd.filter.normalPower = 7;
  for (const Preset& preset : presetTable()) {
    Settings set = odd;
    applyPreset(set, preset.name);
    std::set<std::string> changed, said;
    for (const SettingRow& row : settingsTable())
      if (row.get(set) != row.get(odd)) changed.insert(row.name);
    for (const auto& [setting, value] : preset.set) said.insert(setting);
    EXPECT_EQ(changed, said) << preset.name;
    EXPECT_EQ(said, (std::set<std::string>{"smc.vpls", "smc.points", "smc.paths", "shadow.resolution", "gather.near",
                                           "gather.mode"}));
  }
  Settings back;
  applyPreset(back, "low");
  EXPECT_NE(back, Settings());
  applyPreset(back, "default");
  EXPECT_EQ(back, Settings());
  // A technique with a gather of its own keeps it.
  Settings isr;
  isr.vpl.source = VplSource::Isr;
  isr.gather.mode = GatherMode::Multires;
  applyPreset(isr, "low");
  EXPECT_EQ(isr.gather.mode, GatherMode::Multires);
  EXPECT_EQ(isr.smc.vpls, 256);
  EXPECT_THROW(applyPreset(isr, "lowest"), InputError);
}

TEST(Axes, WhyNotIsEmptyJustForWhatMakesSense) {
  int fine = 0, refused = 0;
  for (int source = 0; source <= int(VplSource::None); ++source)
    for (int visibility = 0; visibility <= int(VplVisibility::None); ++visibility)
      for (int gather = 0; gather <= int(GatherMode::Own); ++gather)
        for (int reconstruction = 0; reconstruction <= int(Reconstruction::UpsampleFilter); ++reconstruction) {
          const Axes axes{VplSource(source), VplVisibility(visibility), GatherMode(gather),
                          Reconstruction(reconstruction)};
          const std::string reason = whyNot(axes);
          (reason.empty() ? fine : refused)++;
          using enum GatherMode;
          const auto is = [&](std::initializer_list<GatherMode> modes) {
            return std::ranges::find(modes, axes.gather) != modes.end();
          };
          const bool patches = is({Multires, MultiresInterleaved, Splat, SplatPerVpl});
          const bool subsets = is({Interleaved, Lists, MultiresInterleaved});
          const bool splats = is({Splat, SplatPerVpl}), volume = is({Volume}), stored = is({Cube});
          const bool upsampled = reconstruction >= int(Reconstruction::Upsample);
          const bool filtered = reconstruction % 2 == 1;
          const bool lights = axes.source != VplSource::None;
          bool sense = upsampled == patches && (!filtered || subsets) &&
                       (lights || (axes.gather == Own && axes.visibility == VplVisibility::None));
          if (axes.source == VplSource::Hisr) sense = sense && !splats && !volume;
          const bool onGpu =
              axes.source == VplSource::Rsm || axes.source == VplSource::Isr || axes.source == VplSource::Hisr;
          if (onGpu && is({Lists}) && axes.visibility != VplVisibility::Rays) sense = false;
          const bool anyView = axes.source == VplSource::Ir || axes.source == VplSource::Poisson;
          if (stored) sense = sense && anyView && axes.visibility == VplVisibility::None;
          if (axes.source == VplSource::Hisr || volume) sense = sense && axes.visibility == VplVisibility::None;
          EXPECT_EQ(reason.empty(), sense) << source << visibility << gather << reconstruction << ' ' << reason;
        }
  EXPECT_GT(fine, 100);
  EXPECT_GT(refused, 100);
}

TEST(Axes, SettingsSayTheirAxes) {
  Settings s;
  EXPECT_EQ(axesOf(s).reconstruction, Reconstruction::Filter);
  s.filter.on = false;
  EXPECT_EQ(axesOf(s).reconstruction, Reconstruction::None);
  s.gather.mode = GatherMode::MultiresInterleaved;
  EXPECT_EQ(axesOf(s).reconstruction, Reconstruction::Upsample);
  s.filter.on = true;
  EXPECT_EQ(axesOf(s).reconstruction, Reconstruction::UpsampleFilter);
  s.gather.mode = GatherMode::Own;
  EXPECT_FALSE(whyNot(s).empty()) << "no technique has given a stage";
}

TEST(Settings, AFirstFrameDoesLessWhereRaysAreSlow) {
  for (const auto& [rayWork, step] : {std::pair(0.0f, 1), {12.0f, 1}, {12.1f, 2}, {24.0f, 2}, {24.1f, 4}}) {
    EXPECT_EQ(firstMapStep(FirstMaps::Auto, rayWork), step) << rayWork;
    EXPECT_EQ(firstMapStep(FirstMaps::Whole, rayWork), 1);
    EXPECT_EQ(firstMapStep(FirstMaps::Half, rayWork), 2);
    EXPECT_EQ(firstMapStep(FirstMaps::Quarter, rayWork), 4);
  }
  for (const auto& [asked, rayWork, iterations] : {std::tuple(100, 24.0f, 100),
                                                   {100, 48.0f, 50},
                                                   {100, 1e6f, 12},
                                                   {5, 1e6f, 5},
                                                   {400, 48.0f, 200},
                                                   {0, 48.0f, 0}}) {
    EXPECT_EQ(warmupOf({.warmup = asked}, rayWork), iterations) << asked << " at " << rayWork;
    EXPECT_EQ(warmupOf({.warmup = asked, .shortWarmup = false}, rayWork), asked);
  }
}

/// What is asked for beside the defaults, by stage: what presets and a large picture take is not much, and two stages
/// do not multiply each other.
TEST(AskedWork, IsThatOfTheStageThatAsksForMost) {
  const auto of = [](std::initializer_list<std::pair<const char*, const char*>> set) {
    Settings settings;
    for (const auto& [name, value] : set) applySetting(settings, name, value);
    return workOf(settings);
  };
  EXPECT_EQ(of({}).times, 1);
  EXPECT_EQ(of({{"smc.vpls", "256"}, {"smc.paths", "1"}}).times, 1) << "less";
  for (const std::string& preset : presetNames()) {
    Settings settings;
    applyPreset(settings, preset);
    EXPECT_LE(workOf(settings).times, 16) << preset;
  }
  EXPECT_EQ(of({{"shadow.sunResolution", "8192"}, {"shadow.spotResolution", "4096"}}).times, 1);
  EXPECT_LE(of({{"direct.frames", "512"}, {"history.frames", "256"}, {"gather.tile", "64"}}).times, 1);
  const AskedWork maps = of({{"smc.vpls", "8192"}, {"shadow.resolution", "512"}, {"gather.lights", "96"}});
  EXPECT_DOUBLE_EQ(maps.times, 64);
  EXPECT_EQ(maps.names, "smc.vpls, shadow.resolution");
  EXPECT_DOUBLE_EQ(of({{"vpl.source", "mir"}, {"vpl.mirCandidates", "1024"}, {"smc.vpls", "8192"}}).times, 32);
  EXPECT_DOUBLE_EQ(of({{"lpv.cells", "64"}}).times, 64);
}

} // namespace lambent::test::settings_test

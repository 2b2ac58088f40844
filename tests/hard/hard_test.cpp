// Every hard case: all that can be read is finite, and not negative but for estimates of irradiance; energy lies
// between bounds, and so does that of path tracing; where a case says so frames follow each other, or another world has
// the same picture; positions, normals and light of the virtual lights are whole, and GL has nothing to say.
#include "gi/measure/runs/runs.h"
#include "gi/plan/presets.h"
#include "gi/reference/traced_image.h"
#include "tests/gl/gl_fixture.h"
#include "tests/hard/hard_case.h"
#include "tests/support/files.h"

#include <iomanip>

namespace lambent::test::hard_test {

class HardTest : public GlTest, public ::testing::WithParamInterface<HardCase> {};

/// What other techniques that sample their lights must find of what smc must. (Reflective maps show one bounce, and
/// neither emissive surfaces nor the sky.)
constexpr double kLeastOfOthers = 0.3;

double meanOf(const Image& image) {
  double sum = 0;
  for (const vec3& p : image.pixels) sum += (double(p.x) + p.y + p.z) / 3;
  return image.pixels.empty() ? 0 : sum / double(image.pixels.size());
}

double changeOf(const Image& a, const Image& b) {
  double sum = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i)
    sum += glm::length(dvec3(a.pixels[i]) - dvec3(b.pixels[i])) / std::sqrt(3.0);
  return sum / double(a.pixels.size());
}

/// The next frame of a world. Valid while the world stands.
SceneView next(HardWorld& w, int frame) {
  w.addedOrRemoved.clear();
  for (InstanceView& i : w.scene.instances) {
    i.moved = i.reshaped = false;
    i.worldFromObjectBefore = i.worldFromObject;
    i.boundsWorldBefore = i.boundsWorld;
  }
  if (frame > 0 && w.step) w.step(frame);
  SceneView view = w.scene.view();
  const bool all = frame == 0 || w.step;
  view.changes = {frame == 0, all, all, all, frame == 0 || !w.addedOrRemoved.empty()};
  view.addedOrRemoved = w.addedOrRemoved;
  for (LightView& l : w.scene.lights) l.changed = all;
  return view;
}

/// Draws it.
void step(HardWorld& w, Viewer& gi, int frame) { gi.run(next(w, frame)); }

/// What reflective maps can show of a case: by smc, light of one bounce without emissive surfaces and sky.
double oneBounceOf(const HardCase& c) {
  HardWorld w;
  c.make(w);
  w.settings.smc.bounces = std::min(w.settings.smc.bounces, 1);
  w.settings.effects[EffectId::Emissive] = w.settings.effects[EffectId::Sky] = EffectMode::Off;
  Viewer gi(w.settings);
  for (int frame = 0; frame < w.frames; ++frame) step(w, gi, frame);
  return meanOf(gi.read(Buffer::Irradiance));
}

void run(const HardCase& c, const char* technique, const char* preset = nullptr) {
  SCOPED_TRACE(std::string(c.name) + ", " + technique + (preset ? std::string(", ") + preset : "") + ": " + c.reason);
  HardWorld w(preset);
  c.make(w);
  applyTechnique(w.settings, technique);
  if (const std::string why = whyNot(w.settings); !why.empty()) { // what the case asks for, with this technique
    ASSERT_STRNE(technique, "smc") << why;
    return;
  }
  Viewer gi(w.settings);
  Image last, before;
  for (int frame = 0; frame < w.frames; ++frame) {
    step(w, gi, frame);
    if (frame % 1000 >= 100 && frame + 2 < w.frames) continue; // of very many, some
    ASSERT_EQ(defectOf(gi, w.settings), "") << "frame " << frame;
    before = std::move(last);
    last = gi.read(Buffer::Irradiance);
  }
  const double mean = meanOf(last);
  const bool smc = std::string(technique) == "smc";
  const Needs needs = needsOf(w.settings);
  const bool volume = axesOf(w.settings).gather == GatherMode::Volume, seen = needs.maps || needs.rayPerPair;
  const std::string name = c.name;
  // A volume's cells are seen by halves: at the edges of a room what is behind its walls shines in, in strips of about
  // an eighth of a cell. Beside the lamp in that wall it is so bright that the room has 0.05 W/m² of it.
  const bool stripsShow = volume && name == "LampInAWall";
  if ((!c.bounds.leak || seen || needs.stored) && !stripsShow) {
    const bool exact = smc || (c.bounds.leak && !volume);
    const double most = (exact ? 1 : 2) * (preset ? c.mostOfPresets : 1) * c.bounds.most;
    EXPECT_LE(std::abs(mean), most * (1 + 1e-6)) << "too much light";
  }
  if (stripsShow) {
    EXPECT_LE(mean, 0.1) << "more than in strips";
  }
  if (!smc) {
    // tcas has one bounce; what comes through the gaps beside that wall has two. Samples spread over all surfaces
    // seldom meet a narrow spot, and neither a slit nor the way along a corridor is as wide as a cell.
    const bool tooFine = (volume && c.tooFineForVolumes) || (needs.stored && c.tooFineForCubes);
    const bool tooDark = technique == std::string("tcas") ? name == "PaperWall"
                         : needs.lights == LightSupply::Fixed
                             ? name == "AllLightsRide" || name == "Slit" || name == "LongCorridor"
                             : false;
    if (needs.sampled() && !tooDark && !tooFine) {
      EXPECT_GE(mean, kLeastOfOthers * c.bounds.least) << "too little light";
    }
    // One map for a light, and few lights for many maps; along a corridor its few texels see little.
    if (needs.reflective() && !preset && !c.tooFineForMaps && name != "LongCorridor" && w.frames < 100) {
      const double expected = oneBounceOf(c);
      EXPECT_GE(mean, 0.25 * expected) << "too little light";
      if (!c.bounds.leak) { // they ask nothing between
        EXPECT_LE(mean, 3.5 * expected + 1e-6 * std::min(c.bounds.most, 1.0) + (gl::drawnByCpu() ? 0 : 1e-8))
            << "too much light";
      }
    }
    return;
  }
  for (const auto& [name, value] : {std::pair("least", c.bounds.least), {"most", c.bounds.most}, {"irradiance", mean}})
    ::testing::Test::RecordProperty(name, (std::ostringstream() << std::setprecision(2) << value).str());
  EXPECT_GE(mean, (preset ? c.leastOfPresets : 1) * c.bounds.least) << "too little light";
  if (before.pixels.size() == last.pixels.size() && mean > 0) {
    EXPECT_LE(changeOf(last, before), c.bounds.change * mean);
  }
}

/// How lights are found: followed from frame to frame, sent out by lamps, seen by lamps, spread over all surfaces.
constexpr std::string_view kOneOfEachKind[] = {"smc", "ir", "rsm", "lpv"};

TEST_P(HardTest, StaysWhole) {
  const bool all = isLong() || GetParam().shownBy == ShownBy::All;
  for (const Technique& t : techniqueTable()) {
    if (!all && std::ranges::find(kOneOfEachKind, t.name) == std::end(kOneOfEachKind)) continue;
    run(GetParam(), t.name);
    if (HasFatalFailure()) return;
  }
}

/// Bounds that path tracing breaks would be those of a picture that is wrong.
TEST_P(HardTest, HasTheTruthWithinItsBounds) {
  const HardCase& c = GetParam();
  HardWorld w;
  c.make(w);
  SceneView view;
  for (int frame = 0; frame < w.frames; ++frame) view = next(w, frame);
  const ReferenceImage truth =
      traceImage(view, w.settings, {.buffer = ReferenceBuffer::Irradiance, .samples = isLong() ? 1024u : 16u}).image;
  const double mean = meanOf(truth.mean), error = mean > 0 ? mean * truth.relativeErrorOfMean : 0;
  for (const auto& [name, value] : {std::pair("paths", mean), {"pathsError", error}})
    RecordProperty(name, (std::ostringstream() << std::setprecision(3) << value).str());
  EXPECT_GE(mean + 4 * error, c.bounds.least * (1 - 1e-6));
  EXPECT_LE(mean - 4 * error, c.bounds.most * (1 + 1e-6));
}

/// Of pictures that ought to show the same.
struct Shown {
  double halves[2] = {}, direct = 0; // of the last frame: irradiance left and right, radiance
  Image albedo, depth;
};

Shown shown(const std::function<void(HardWorld&)>& make, bool mirrored) {
  Shown s;
  constexpr uint32_t kSeeds = 3;
  for (uint32_t seed = 1; seed <= kSeeds; ++seed) {
    HardWorld w;
    make(w);
    Viewer gi(w.settings, seed);
    for (int frame = 0; frame < w.frames; ++frame) step(w, gi, frame);
    const auto flipped = [&](Image image) {
      for (int y = 0; mirrored && y < image.height; ++y)
        std::reverse(image.pixels.begin() + y * image.width, image.pixels.begin() + (y + 1) * image.width);
      return image;
    };
    const Image light = flipped(gi.read(Buffer::Irradiance));
    for (int y = 0; y < light.height; ++y)
      for (int x = 0; x < light.width; ++x)
        s.halves[2 * x / light.width] += luminance(light.at(x, y)) * 2 / (light.width * light.height * double(kSeeds));
    s.direct += meanOf(gi.read(Buffer::Direct)) / kSeeds;
    s.albedo = flipped(gi.read(Buffer::Albedo)), s.depth = flipped(gi.read(Buffer::Depth));
  }
  return s;
}

class HardTwinTest : public HardTest {};

TEST_P(HardTwinTest, ShowsTheSamePicture) {
  const HardCase& c = GetParam();
  SCOPED_TRACE(c.name);
  const Shown of = shown(c.make, c.twin.mirrored), twin = shown(c.twin.make, false);
  EXPECT_LE(changeOf(of.albedo, twin.albedo), 0.01 * meanOf(twin.albedo));
  EXPECT_LE(changeOf(of.depth, twin.depth), 0.01 * meanOf(twin.depth));
  EXPECT_NEAR(of.direct, twin.direct, 0.03 * twin.direct);
  for (int half = 0; half < 2; ++half)
    EXPECT_NEAR(of.halves[half], twin.halves[half], c.twin.apart * twin.halves[half]) << half;
}

/// What takes minutes.
class LongHardTest : public GlTest {
 protected:
  void SetUp() override {
    if (!isLong()) GTEST_SKIP() << "takes minutes: LAMBENT_LONG=1 runs it (tools/test --long)";
    GlTest::SetUp();
  }
};

TEST_F(LongHardTest, StaysWholeWithEveryPreset) {
  for (const HardCase& c : hardCases())
    for (const std::string& preset : presetNames()) run(c, "smc", preset.c_str());
}

TEST_F(LongHardTest, StaysWhole) {
  for (const HardCase& c : longCases()) run(c, "smc");
}

TEST(HardCases, AreInTheDocument) {
  const std::string text = readBytes("docs/measurements/hard-cases.md");
  ASSERT_FALSE(text.empty()) << "run from the root of the source tree";
  for (const auto* cases : {&hardCases(), &longCases()})
    for (const HardCase& c : *cases) EXPECT_NE(text.find(std::string("| ") + c.name + " |"), text.npos) << c.name;
}

std::string nameOf(const ::testing::TestParamInfo<HardCase>& info) {
  std::string name;
  for (char c : std::string(info.param.name)) name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(Cases, HardTest, ::testing::ValuesIn(hardCases()), nameOf);

std::vector<HardCase> withTwins() {
  std::vector<HardCase> cases;
  std::ranges::copy_if(hardCases(), std::back_inserter(cases), [](const HardCase& c) { return bool(c.twin.make); });
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Cases, HardTwinTest, ::testing::ValuesIn(withTwins()), nameOf);

class WalkIn : public GlTest {};

/// The set that a camera brings along gives the light of one that begins where it arrives.
TEST_F(WalkIn, GivesTheLightOfAFreshStart) {
  HardWorld w;
  w.room({-1, -1, -6}, {1, 1, 1}); // its far end is not seen at first
  w.lamp({0, 0.6f, -5}, 4);
  w.lamp({0, 0.6f, 0.5f}, 1);
  w.settings.smc.vpls = 512;
  w.settings.smc.points = 512;
  w.settings.smc.moves = 64;
  const CameraView there = lookAt({0.1f, 0, -3}, {0, -0.1f, -6}, 1.2f);
  const auto meanAfter = [&](bool walks, uint32_t seed) {
    Viewer gi(w.settings, seed);
    double mean = 0;
    for (int frame = 0; frame < 60; ++frame) {
      const float way = walks ? std::min(1.0f, float(frame) / 30) : 1;
      w.scene.camera =
          lookAt(glm::mix(vec3(0.1f, 0, 0.9f), there.position(), way), {0, -0.1f, walks && way < 0.2f ? 6 : -6}, 1.2f);
      w.scene.camera.width = 32, w.scene.camera.height = 18;
      SceneView view = w.scene.view();
      const bool moves = walks && frame <= 31;
      view.changes = {frame == 0, frame == 0 || moves, frame == 0, frame == 0, frame == 0};
      for (LightView& l : w.scene.lights) l.changed = frame == 0;
      gi.run(view);
      EXPECT_EQ(defectOf(gi, w.settings), "");
      if (frame >= 50) mean += meanOf(gi.read(Buffer::Irradiance)) / 10;
    }
    return mean;
  };
  double walked = 0, fresh = 0;
  for (uint32_t seed = 1; seed <= 4; ++seed) walked += meanAfter(true, seed), fresh += meanAfter(false, seed);
  EXPECT_NEAR(walked, fresh, 0.05 * fresh);
}

} // namespace lambent::test::hard_test

// The truth that is traced beside a window is the truth, of the present view, and says when it starts anew.
#include "engine/trace/embree_query.h"
#include "gi/measure/image_error.h"
#include "gi/reference/live_reference.h"
#include "tests/support/hand_scene.h"
#include "tests/support/images.h"

namespace lambent::test::live_reference_test {

/// A box with a lamp in it, seen from within.
class LiveReferenceTest : public ::testing::Test {
 protected:
  LiveReferenceTest() {
    scene_.box(vec3(-1), vec3(1), scene_.material({0.7f, 0.5f, 0.3f}), true);
    block_ = scene_.quad({-0.5f, -0.5f, -0.8f}, {1, 0, 0}, {0, 0.4f, 0}, scene_.material(vec3(0.5f)));
    scene_.lamp({0.2f, 0.8f, -0.1f});
    scene_.camera.worldFromView[3].z = 0.9f;
    scene_.size(24, 16);
    settings_.smc.bounces = 2;
  }

  /// As extracted; by default nothing has changed.
  SceneView seen(SceneChanges changes = kStill) const { return scene_.view(changes); }

  /// A view that has changed and then stands still. Returns what the first of the two was answered.
  std::string begin(LiveReference& live, ReferenceBuffer buffer, const SceneChanges& changes = {}) const {
    const std::string why = live.follow(seen(changes), settings_, buffer);
    EXPECT_EQ(live.take(true), nullptr) << "it may move on";
    EXPECT_EQ(live.follow(seen(), settings_, buffer), "");
    return why;
  }

  /// Truths as they come until one has so many samples.
  std::shared_ptr<const LiveTruth> after(LiveReference& live, uint32_t samples) const {
    for (;;) {
      std::shared_ptr<const LiveTruth> truth = live.take(true);
      if (!truth || truth->samples >= samples) return truth;
    }
  }

  TracedImage traced(ReferenceBuffer buffer, uint32_t samples) const {
    return traceImage(scene_.view(), settings_, {.buffer = buffer, .samples = samples, .seed = kSeed});
  }

  void expectTruth(const LiveTruth& live, ReferenceBuffer buffer) const {
    EXPECT_EQ(live.buffer, buffer);
    const TracedImage once = traced(buffer, live.samples);
    EXPECT_TRUE(sameBits(live.image.mean, once.image.mean));
    EXPECT_TRUE(sameBits(live.image.error, once.image.error));
    EXPECT_EQ(live.image.relativeError, once.image.relativeError);
    EXPECT_EQ(live.bounces, once.bounces);
    EXPECT_GT(live.ms, 0);
  }

  static constexpr uint32_t kSeed = 5;
  HandScene scene_;
  uint32_t block_ = 0;
  Settings settings_;
};

/// Another scene at the address of the last one, whose tracing has come to its end.
TEST_F(LiveReferenceTest, TracesTheSceneThatIsThereNow) {
  scene_.camera.width = scene_.camera.height = 1;
  LiveReference live(kSeed);
  begin(live, ReferenceBuffer::Direct);
  while (live.take(true)) {
  }
  scene_.assets = SceneAssets(scene_.assets);
  for (Material& material : scene_.assets.materials) material.baseColor = vec3(0.1f, 0.2f, 0.9f);
  begin(live, ReferenceBuffer::Direct);
  const auto truth = after(live, 1);
  ASSERT_TRUE(truth);
  expectTruth(*truth, ReferenceBuffer::Direct);
}

TEST_F(LiveReferenceTest, AccumulatesWhatOneRunTraces) {
  LiveReference live(kSeed);
  EXPECT_EQ(live.take(true), nullptr) << "nothing was asked for";
  EXPECT_EQ(begin(live, ReferenceBuffer::Indirect), "it begins");
  uint32_t before = 0;
  while (before < 8) {
    const auto truth = live.take(true);
    ASSERT_TRUE(truth);
    EXPECT_GT(truth->samples, before) << "each is of more samples";
    before = truth->samples;
    expectTruth(*truth, ReferenceBuffer::Indirect);
    EXPECT_EQ(live.follow(seen(), settings_, ReferenceBuffer::Indirect), "") << "nothing changed";
  }
}

TEST_F(LiveReferenceTest, AnotherBufferIsReadFromTheSameSamples) {
  LiveReference live(kSeed);
  begin(live, ReferenceBuffer::Indirect);
  const uint32_t before = after(live, 4)->samples;
  for (const ReferenceBuffer buffer : {ReferenceBuffer::Beauty, ReferenceBuffer::Irradiance}) {
    EXPECT_EQ(live.follow(seen(), settings_, buffer), "");
    const auto truth = live.take(true);
    EXPECT_GE(truth->samples, before) << "none is lost";
    expectTruth(*truth, buffer);
  }
}

TEST_F(LiveReferenceTest, StartsAnewWhereSamplesAreOfSomethingElse) {
  LiveReference live(kSeed);
  const ReferenceBuffer buffer = ReferenceBuffer::Beauty;
  begin(live, buffer);
  const auto anew = [&](const SceneChanges& changes, const std::string& why) {
    after(live, 4);
    EXPECT_EQ(begin(live, buffer, changes), why);
    const auto truth = live.take(true);
    ASSERT_TRUE(truth);
    expectTruth(*truth, buffer); // of the view as it is now
  };
  scene_.camera.worldFromView[3].x = 0.2f;
  anew(kCameraChanged, "the camera changed");
  scene_.camera.width = 32;
  anew(kCameraChanged, "the camera changed");
  scene_.lights[0].intensity = {1, 2, 3};
  anew(kLightsChanged, "the light changed");
  scene_.instances[block_].worldFromObject[3].x = 0.4f;
  anew(kGeometryChanged, "objects moved");
  scene_.instances.pop_back();
  anew(kInstancesChanged, "objects moved");
  settings_.smc.bounces = 1;
  anew(kStill, "smc.bounces changed");
  settings_.gather.glossy = false;
  EXPECT_EQ(live.follow(seen(), settings_, buffer), "") << "all is matt";
  scene_.assets.materials[0].roughness = 0.4f;
  settings_.gather.glossy = true;
  anew(kStill, "surfaces reflect in another way");
  settings_.image.exposure = 3;
  settings_.smc.vpls = 64;
  EXPECT_EQ(live.follow(seen(), settings_, buffer), "") << "no sample depends on it";
}

TEST_F(LiveReferenceTest, ViewsInBetweenAreNotMissed) {
  LiveReference live(kSeed);
  begin(live, ReferenceBuffer::Beauty);
  const SceneChanges moved = kGeometryChanged, turned = kCameraChanged;
  for (int i = 0; i < 20; ++i) { // most of them are overtaken before a sample is taken
    scene_.instances[block_].worldFromObject[3].x = 0.02f * float(i);
    scene_.instances[block_].moved = true;
    begin(live, ReferenceBuffer::Beauty, moved);
    scene_.instances[block_].moved = false;
    scene_.camera.worldFromView[3].y = 0.01f * float(i);
    live.follow(seen(turned), settings_, ReferenceBuffer::Beauty);
  }
  EXPECT_EQ(live.take(true), nullptr) << "a truth of a view that is no more";
  live.follow(seen(), settings_, ReferenceBuffer::Beauty);
  expectTruth(*live.take(true), ReferenceBuffer::Beauty);
}

TEST_F(LiveReferenceTest, EndsInTheMiddleOfAPass) {
  scene_.size(640, 480);
  settings_.smc.bounces = 8;
  const auto start = std::chrono::steady_clock::now();
  double pass = 0;
  {
    LiveReference live(kSeed);
    begin(live, ReferenceBuffer::Beauty);
    live.take(true);
    pass = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  const auto again = std::chrono::steady_clock::now();
  {
    LiveReference live(kSeed);
    begin(live, ReferenceBuffer::Beauty);
    std::this_thread::sleep_for(std::chrono::duration<double>(0.05 * pass));
  }
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - again).count(), 0.7 * pass);
}

TEST_F(LiveReferenceTest, ErrorsAreThoseOfThePicturesAndKnowTheTruthsOwn) {
  const ReferenceBuffer buffer = ReferenceBuffer::Indirect;
  LiveReference live(kSeed);
  begin(live, buffer);
  const auto truth = after(live, 64);
  const TracedImage exact = traceImage(scene_.view(), settings_, {.buffer = buffer, .samples = 4096, .seed = 77});
  Image darker = exact.image.mean;
  for (vec3& p : darker.pixels) p *= 0.5f;
  const AgainstTruth far = againstTruth(darker, truth->image);
  const ImageError plain = imageError(darker, traced(buffer, truth->samples).image.mean);
  EXPECT_EQ(far.error.rmse, plain.rmse);
  EXPECT_EQ(far.error.relMse, plain.relMse);
  EXPECT_EQ(far.error.bias, plain.bias);
  EXPECT_NEAR(far.error.bias, -0.5, 0.02);
  ASSERT_TRUE(far.known());
  const double alone = imageError(darker, exact.image.mean).rmse;
  EXPECT_NEAR(*far.imageRmse(), alone, 0.05 * alone) << "without the noise of the truth";
  EXPECT_GT(std::abs(far.error.rmse - alone), 0) << "or the test shows nothing";
  EXPECT_LT(*pathTracingMs(far.error.relMse, far.truthRelMse, 1000), 1000) << "the truth is nearer than that already";

  const AgainstTruth near = againstTruth(exact.image.mean, truth->image);
  EXPECT_FALSE(near.known()) << "all that is left is the truth's own noise";
  EXPECT_FALSE(near.imageRmse() || pathTracingMs(near.error.relMse, near.truthRelMse, 1000));
  EXPECT_NEAR(near.truthRmse, near.error.rmse, 0.25 * near.error.rmse) << "which it expects";
  EXPECT_NEAR(near.truthRelMse, near.error.relMse, 0.5 * near.error.relMse);
  EXPECT_FALSE(againstTruth(darker, traced(buffer, 1).image).known()) << "one sample does not know its error";
}

} // namespace lambent::test::live_reference_test

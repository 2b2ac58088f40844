// The reference is the same however it is run, and honest about its own error.
#include "engine/core/parallel.h"
#include "gi/reference/state_file.h"
#include "gi/reference/traced_image.h"
#include "tests/support/checked.h"
#include "tests/support/files.h"
#include "tests/support/reference.h"

#include <cmath>
#include <cstring>

#include <sys/stat.h>

namespace lambent::test::repeat_test {

/// A room with a lamp, a glowing panel and a window, small.
class Room : public ::testing::Test {
 protected:
  Room() {
    const uint32_t white = scene_.material(vec3(0.7f, 0.6f, 0.5f));
    scene_.quad({0, 0, 0}, {0, 0, 3}, {2, 0, 0}, white);
    scene_.quad({0, 0, 0}, {0, 1, 0}, {0, 0, 3}, white);
    scene_.quad({0, 0, 3}, {0, 1, 0}, {2, 0, 0}, white);
    scene_.quad({1.5f, 0.2f, 2.9f}, {0, 0.5f, 0}, {0.3f, 0, 0}, scene_.material(vec3(0.2f), vec3(3, 4, 5), true));
    scene_.sky = vec3(0.2f, 0.3f, 0.4f);
    scene_.lamp({1, 0.9f, 1.5f});
    scene_.camera = cameraAt({1, 0.5f, 0.1f}, {1, 0.5f, 3}, 1, 24, 16);
    traced_.emplace(scene_);
  }
  ~Room() override { setThreadCount(0); }

  ReferenceInputs inputs(uint32_t seed = 1) const {
    return {traced_->rays, traced_->lights, traced_->view.camera, 3, 0, seed};
  }

  ReferenceSums sumsOf(std::initializer_list<uint32_t> passes, uint32_t seed = 1) const {
    ReferenceSums sums(24, 16);
    for (uint32_t count : passes) addSamples(sums, inputs(seed), count, counts_);
    return sums;
  }

  static bool same(const ReferenceSums& a, const ReferenceSums& b) {
    return a.samples == b.samples &&
           std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(PixelSums)) == 0;
  }

  /// The one line that says why the file is refused.
  std::string refusal(const ReferenceInputs& in) const {
    try {
      loadReference(file_, in, referenceKey(traced_->view, in));
    } catch (const InputError& e) {
      return e.what();
    }
    return "accepted";
  }

  HandScene scene_;
  std::optional<TracedScene> traced_;
  TemporaryFolder folder_;
  const fs::path file_ = folder_ / "reference.state";
  mutable RayCounts counts_;
};

TEST_F(Room, PassesAndThreadsDoNotMatter) {
  setThreadCount(1);
  const ReferenceSums one = sumsOf({12});
  EXPECT_TRUE(same(one, sumsOf({5, 1, 6})));
  for (int threads : {2, 5}) {
    setThreadCount(threads);
    EXPECT_TRUE(same(one, sumsOf({12}))) << threads << " threads";
  }
  EXPECT_FALSE(same(one, sumsOf({12}, 2)));
}

/// Another program takes more samples into the same file meanwhile: they stay.
TEST_F(Room, AStateOfMoreSamplesIsLeft) {
  Settings settings;
  settings.smc.bounces = 3;
  TracePlan plan;
  plan.samples = 64;
  plan.state = file_;
  uint64_t key = 0;
  plan.progress = [&](int, int) {
    if (key != 0) return;
    const ReferenceInputs in = inputs();
    key = referenceKey(traced_->view, in);
    saveReference(file_, sumsOf({200}), key);
  };
  const TracedImage image = traceImage(traced_->view, settings, plan);
  EXPECT_EQ(image.samples, 64);
  EXPECT_EQ(samplesIn(file_, inputs(), key), 200u);
  EXPECT_EQ(samplesIn(file_, inputs(), key + 1), 0u);
}

TEST_F(Room, ResumedEqualsOneRun) {
  const uint64_t key = referenceKey(traced_->view, inputs());
  saveReference(file_, sumsOf({12}), key);
  const std::string whole = readBytes(file_);
  saveReference(file_, sumsOf({5}), key);
  EXPECT_NE(readBytes(file_), whole);
  ReferenceSums sums = loadReference(file_, inputs(), key);
  addSamples(sums, inputs(), 7, counts_);
  saveReference(file_, sums, key);
  EXPECT_EQ(readBytes(file_), whole);
}

TEST_F(Room, StateOfAnotherPictureIsRefused) {
  const ReferenceInputs in = inputs();
  const auto& [view, rays, lights] = *traced_;
  saveReference(file_, sumsOf({2}), referenceKey(view, in));
  EXPECT_EQ(refusal(in), "accepted");
  const auto refused = [&](const ReferenceInputs& other, const std::string& why) {
    EXPECT_NE(refusal(other).find(why), std::string::npos) << refusal(other);
  };
  refused(inputs(2), "another picture");
  refused({rays, lights, view.camera, 2}, "another picture");
  refused({rays, lights, view.camera, 3, 5.0f}, "another picture");
  CameraView camera = view.camera;
  camera.worldFromView[3].x += 0.1f;
  refused({rays, lights, camera}, "another picture");
  camera.width = 32;
  refused({rays, lights, camera}, "24x16");
  camera = view.camera;
  camera.fovY *= 1.1f;
  refused({rays, lights, camera}, "another picture");
  scene_.lights[0].intensity.y = 2;
  refused(in, "another picture");
  scene_.lights[0].intensity.y = 1;
  using Change = void (*)(LightView&);
  for (const Change change :
       {Change([](LightView& l) { l.type = LightType::Spot; }), Change([](LightView& l) { l.position.y += 0.01f; }),
        Change([](LightView& l) { l.direction = vec3(1, 0, 0); }), Change([](LightView& l) { l.range = 3; }),
        Change([](LightView& l) { l.innerConeCos = 0.9f; }), Change([](LightView& l) { l.outerConeCos = 0.6f; }),
        Change([](LightView& l) { l.angularRadius = 0.1f; })}) {
    const LightView before = scene_.lights[0];
    change(scene_.lights[0]);
    refused(in, "another picture");
    scene_.lights[0] = before;
    EXPECT_EQ(refusal(in), "accepted");
  }
  scene_.assets.meshes[0].positions[0].x += 0.25f;
  refused(in, "another picture");
  scene_.assets.meshes[0].positions[0].x -= 0.25f;
  std::vector<vec3> posed = scene_.assets.meshes[0].positions;
  posed[0].x += 0.25f;
  scene_.reshape(0, posed);
  refused(in, "another picture");
  scene_.instances[0].deformed = nullptr;
  EXPECT_EQ(refusal(in), "accepted");
}

TEST_F(Room, DamagedStateIsRefused) {
  const ReferenceInputs in = inputs();
  saveReference(file_, sumsOf({2}), referenceKey(traced_->view, in));
  const std::string whole = readBytes(file_);
  const auto refused = [&](std::string bytes, const std::string& why) {
    writeBytes(file_, bytes);
    EXPECT_NE(refusal(in).find(why), std::string::npos) << refusal(in);
  };
  refused("", "is not the state");
  refused("PNG or whatever else people name this way", "is not the state");
  refused(whole.substr(0, whole.size() - 20), "damaged");
  std::string flipped = whole;
  flipped[whole.size() / 2] ^= 1;
  refused(flipped, "damaged");
  flipped = whole;
  flipped[32] ^= 1; // the number of samples
  refused(flipped, "damaged");
  flipped = whole;
  flipped[8] ^= 64; // the version
  refused(flipped, "another version");
  // Values that no run writes, behind a checksum that is right: samples, then sums and squares of the first pixel.
  writeBytes(file_, mended(whole));
  EXPECT_EQ(refusal(in), "accepted");
  constexpr size_t kSamples = 24 + 8, kSums = kSamples + 4;
  const auto altered = [&](size_t at, auto value) {
    std::string bytes = whole;
    std::memcpy(&bytes[at], &value, sizeof value);
    refused(mended(bytes), "damaged");
  };
  altered(kSamples, ~0u);
  for (const double sum : {std::nan(""), 1e300, -1.0, double(kInfinity)})
    for (int value = 0; value < 5; ++value) altered(kSums + size_t(value) * 3 * sizeof(double), sum);
  { // sums and squares that agree, whose mean no picture holds
    std::string bytes = whole;
    const double sum = 1e100, squares = sum * sum / 2;
    std::memcpy(&bytes[kSums], &sum, sizeof sum);
    std::memcpy(&bytes[kSums + 3 * sizeof sum], &squares, sizeof squares);
    refused(mended(bytes), "damaged");
  }
  fs::remove(file_);
  ASSERT_EQ(mkfifo(file_.c_str(), 0600), 0);
  EXPECT_NE(refusal(in).find("is not the state"), std::string::npos) << "a pipe that nobody writes";
}

TEST_F(Room, SeedsAgreeWithinTheirErrors) {
  const ReferenceImage a = readReference(sumsOf({400}, 1), inputs(1), ReferenceBuffer::Beauty);
  const ReferenceImage b = readReference(sumsOf({400}, 2), inputs(2), ReferenceBuffer::Beauty);
  double chi2 = 0, sum = 0;
  size_t n = 0, far = 0;
  for (size_t i = 0; i < a.mean.pixels.size(); ++i) {
    if (!a.surface[i]) continue;
    const double z = (a.mean.pixels[i].y - b.mean.pixels[i].y) /
                     std::hypot(double(a.error.pixels[i].y), double(b.error.pixels[i].y));
    chi2 += z * z;
    sum += z;
    far += std::abs(z) > kDeviateLimit;
    ++n;
  }
  ASSERT_GT(n, 200u);
  // Means of 400 samples are nearly normal, so Σz is N(0, n) and Σz² chi-square with n degrees: 6e-5 each by chance.
  EXPECT_LT(std::abs(sum) / std::sqrt(double(n)), kDeviateLimit);
  EXPECT_LT(chiSquareDeviate(chi2, double(n)), kDeviateLimit);
  EXPECT_GT(chiSquareDeviate(chi2, double(n)), -kDeviateLimit) << "errors stated too large";
  EXPECT_LE(far, 1u) << "of " << n << " pixels; 6e-5 of them by chance, a few more for the tails of paths";
}

TEST_F(Room, StatedErrorIsTheScatterOfRuns) {
  const ReferenceImage truth = readReference(sumsOf({4000}, 99), inputs(99), ReferenceBuffer::Indirect);
  std::vector<double> ratios;
  for (uint32_t seed = 1; seed <= 10; ++seed) {
    const ReferenceImage p = readReference(sumsOf({64}, seed), inputs(seed), ReferenceBuffer::Indirect);
    double squares = 0, total = 0;
    for (size_t i = 0; i < p.mean.pixels.size(); ++i) {
      const vec3 d = p.mean.pixels[i] - truth.mean.pixels[i];
      squares += double(glm::dot(d, d));
      total += double(truth.mean.pixels[i].x + truth.mean.pixels[i].y + truth.mean.pixels[i].z);
    }
    const double n = 3.0 * double(p.mean.pixels.size());
    ratios.push_back(std::sqrt(squares / n) / (total / n) / p.relativeError);
  }
  // The truth's own 64/4000 adds 0.8 %.
  EXPECT_NEAR(meanOf(ratios).mean, 1.008, 0.03 + kDeviateLimit * meanOf(ratios).error);
}

TEST_F(Room, SingleSampleHasNoError) {
  const ReferenceImage p = readReference(sumsOf({1}), inputs(), ReferenceBuffer::Beauty);
  EXPECT_TRUE(std::isinf(p.relativeError));
  for (const vec3& pixel : p.mean.pixels) EXPECT_TRUE(isFinite(pixel));
}

} // namespace lambent::test::repeat_test

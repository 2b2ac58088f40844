#include "gi/measure/runs/runs.h"
#include "gi/vpl/sources.h"

#include <algorithm>

namespace lambent {

namespace {

class WholeFrames final : public Runner {
 public:
  explicit WholeFrames(const Variant& v)
      : gi_(v.settings, v.seed), watched_(watchesDirect(v.settings) ? Buffer::Direct : Buffer::Indirect) {}

  const FrameStats& run(const SceneView& view) override { return gi_.run(view); }
  Image image(Buffer buffer) const override { return gi_.read(buffer); }
  float exposure() const override { return gi_.exposure(); }

  std::vector<TrackedValue> at(std::span<const vec2> points) const override {
    const Image picture = gi_.read(watched_);
    std::vector<TrackedValue> out;
    for (const vec2& p : points) {
      const int x = std::min(int(p.x * float(picture.width)), picture.width - 1);
      const int y = std::min(int(p.y * float(picture.height)), picture.height - 1);
      out.push_back({picture.at(x, y), {}});
    }
    return out;
  }

 private:
  Viewer gi_;
  const Buffer watched_;
};

/// What those that look at the watched points alone share: the points cannot be others.
class AtPoints : public Runner {
 public:
  AtPoints(const Variant& v, const WatchedScene& watched) : variant_(v), watched_(watched) {}
  std::vector<TrackedValue> at(std::span<const vec2>) const override { return values_; }

 protected:
  const Variant variant_;
  const WatchedScene& watched_;
  FrameStats stats_;
  std::vector<TrackedValue> values_;
};

class RaysAtPoints final : public AtPoints {
 public:
  using AtPoints::AtPoints;

  const FrameStats& run(const SceneView& view) override {
    const Settings& s = variant_.settings;
    VplUpdateLog log;
    placeVpls(s.vpl.source, set_, {view, watched_.rays(), watched_.lights(), s.smc, variant_.seed, s.vpl}, log);
    stats_.stages = log.stages;
    RayCounts counts;
    const std::span<const SurfaceHit> surfaces = watched_.surfaces();
    const std::vector<vec3> irradiance = irradianceByRays(watched_.rays(), surfaces, lightsOf(set_), s.gather, counts);
    values_.assign(irradiance.size(), {});
    for (size_t i = 0; i < irradiance.size(); ++i) values_[i].radiance = irradiance[i] * (surfaces[i].albedo / kPi);
    return stats_;
  }

 private:
  VplSet set_;
};

class PathsAtPoints final : public AtPoints {
 public:
  PathsAtPoints(const Variant& v, const WatchedScene& watched, uint32_t samples, bool clamped)
      : AtPoints(v, watched), samples_(samples), clamp_(clamped ? v.settings.gather.clamp : 0) {}

  const FrameStats& run(const SceneView& view) override {
    const SceneChanges& c = view.changes;
    if (!values_.empty() && !(c.first || c.camera || c.lights || c.geometry || c.instances)) return stats_;
    RayCounts counts;
    const std::vector<PixelSums> sums = sampleSurfaces(watched_.surfaces(),
                                                       {.rays = watched_.rays(),
                                                        .lights = watched_.lights(),
                                                        .camera = view.camera,
                                                        .bounces = variant_.settings.smc.bounces,
                                                        .clamp = clamp_,
                                                        .seed = variant_.seed,
                                                        .blended = view.assets->blends() ? &view : nullptr},
                                                       samples_, counts);
    const bool direct = watchesDirect(variant_.settings);
    values_.clear();
    for (size_t i = 0; i < sums.size(); ++i)
      values_.push_back(trackedValue(sums[i], watched_.surfaces()[i], samples_, direct));
    return stats_;
  }

 private:
  const uint32_t samples_;
  const float clamp_;
};

} // namespace

std::unique_ptr<Runner> wholeFrames(const Variant& variant) { return std::make_unique<WholeFrames>(variant); }

MakeRunner raysAtPoints(const WatchedScene& watched) {
  return [&watched](const Variant& v) { return std::make_unique<RaysAtPoints>(v, watched); };
}

MakeRunner pathsAtPoints(const WatchedScene& watched, uint32_t samples, bool clamped) {
  return [&watched, samples, clamped](const Variant& v) {
    return std::make_unique<PathsAtPoints>(v, watched, samples, clamped);
  };
}

} // namespace lambent

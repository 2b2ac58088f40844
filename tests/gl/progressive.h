// A throw-away technique: two-bounce path tracing of textured surfaces, a few paths per pixel in every frame, until a
// still view has enough. All that it needs is in this file; its row is kProgressive.
#pragma once

#include "gi/contract/light_provider.h"
#include "gi/contract/pass_context.h"
#include "gi/gather/add_pixels.h"
#include "gi/plan/techniques.h"
#include "gi/reference/path_tracer.h"

namespace lambent::test {

inline constexpr OwnSetting kProgressiveSettings[] = {
    {.name = "progressive.paths", .help = "per pixel, until it stops", .standard = 16, .low = 1, .high = 65536},
    {.name = "progressive.atOnce", .help = "per pixel and frame", .standard = 4, .low = 1, .high = 256},
};

class Progressive : public LightProvider {
 public:
  ProviderStatus status() const override {
    return {.pending =
                done_ < wanted_ ? std::to_string(done_) + " of " + std::to_string(wanted_) + " paths per pixel" : ""};
  }
  void forget() override { sums_ = {}; }

  SurfaceLighting run(const Frame& frame, FrameStats&) override {
    const CameraView& camera = frame.world.view.camera;
    if (frame.restart || sums_.width != camera.width || sums_.height != camera.height)
      sums_ = ReferenceSums(camera.width, camera.height);
    wanted_ = uint32_t(kProgressiveSettings[0](frame.settings));
    const uint32_t count =
        std::min(uint32_t(kProgressiveSettings[1](frame.settings)), wanted_ - std::min(wanted_, sums_.samples));
    RayCounts rays;
    addSamples(sums_,
               {.rays = frame.world.rays,
                .lights = frame.world.lights,
                .camera = camera,
                .bounces = std::min(2, frame.bounces),
                .seed = frame.seed},
               count, rays);
    done_ = sums_.samples;
    std::vector<vec3> irradiance;
    for (const PixelSums& pixel : sums_.pixels)
      irradiance.push_back(vec3(pixel.indirect * (double(kPi) / std::max(1u, sums_.samples))));
    target_.fit(frame.surfaces);
    uploadPixels(*target_.light().irradiance, irradiance, frame.surfaces, 1);
    return target_.light();
  }

 private:
  ReferenceSums sums_;
  uint32_t done_ = 0, wanted_ = 1;
  LightTarget target_{"progressive"};
};

inline std::unique_ptr<LightProvider> makeProgressive(PassContext) { return std::make_unique<Progressive>(); }

constexpr Technique kProgressive{
    .name = "progressive",
    .help = "path tracing, a few paths per frame",
    .axes = {VplSource::None, VplVisibility::None, GatherMode::Own, Reconstruction::None},
    .make = makeProgressive,
    .needs = {.bounces = true, .textures = true},
    .settings = kProgressiveSettings,
};

} // namespace lambent::test

// Gather on the CPU with a ray for every pixel and light: the measure of shadow maps and subsets (paper 1, fig. 8).
#include "gi/gather/stages.h"
#include "gi/vpl/smc.h"

#include <algorithm>

namespace lambent {

namespace {

class RayGather : public IndirectStage {
 public:
  explicit RayGather(PassContext context) : context_(context) {}

  LightOnSurfaces run(const IndirectInputs& in, FrameStats& stats) override {
    const CameraView& camera = in.world.view.camera;
    GlossyGather glossy{in.world.view, {}};
    const bool lobes = in.surfaces.finish != nullptr;
    std::vector<vec3> irradiance;
    {
      CpuScope scope(stats.stages, key(StageId::GatherByRays));
      irradiance = gatherByRays(in.world.rays, camera, in.seen.lights.slots, in.settings.gather, stats.raysGather,
                                lobes ? &glossy : nullptr);
    }
    const gl::PassScope scope = context_.scope(StageId::IrradianceUpload);
    target_.fit(in.surfaces);
    const LightOnSurfaces light = target_.light();
    upload(*light.irradiance, irradiance);
    if (lobes) upload(*light.glossy, glossy.radiance);
    return light;
  }

 private:
  /// Rows of the picture count from the top, GL's from the bottom.
  static void upload(const gl::Texture& texture, const std::vector<vec3>& pixels) {
    const int width = texture.width(), height = texture.height();
    std::vector<vec3> bottomUp(pixels.size());
    for (int y = 0; y < height; ++y)
      std::copy_n(&pixels[size_t(y) * width], width, &bottomUp[size_t(height - 1 - y) * width]);
    glTextureSubImage2D(texture.name(), 0, 0, 0, width, height, GL_RGB, GL_FLOAT, bottomUp.data());
  }

  PassContext context_;
  LightTarget target_{"irradiance upload"};
};

} // namespace

std::unique_ptr<IndirectStage> makeRayGather(PassContext context) { return std::make_unique<RayGather>(context); }

} // namespace lambent

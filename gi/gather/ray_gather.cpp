// Gather on the CPU with a ray for every pixel and light: the measure of shadow maps and subsets (paper 1, fig. 8).
#include "gi/gather/gathers.h"
#include "gi/gather/near_light_pass.h"
#include "gi/vpl/smc.h"

namespace lambent {

namespace {

class RayGather : public Gather {
 public:
  explicit RayGather(PassContext context) : context_(context) {}

  SurfaceLighting run(const GatherInputs& in, FrameStats& stats) override {
    const CameraView& camera = in.frame.world.view.camera;
    GlossyGather glossy{in.frame.world.view, {}};
    const bool lobes = in.frame.surfaces.finish != nullptr;
    std::vector<vec3> irradiance;
    {
      CpuScope scope(stats.stages, key(StageId::GatherByRays));
      irradiance = gatherByRays(in.frame.world.rays, camera, in.lights.list.slots, in.frame.settings.gather,
                                stats.raysGather, lobes ? &glossy : nullptr,
                                in.frame.surfaces.mappedNormal ? &in.frame.world.view : nullptr);
    }
    {
      const gl::PassScope scope = context_.scope(StageId::IrradianceUpload);
      target_.fit(in.frame.surfaces);
      const SurfaceLighting light = target_.light();
      uploadPixels(*light.irradiance, irradiance, in.frame.surfaces, 1);
      if (lobes) uploadPixels(*light.glossy, glossy.radiance, in.frame.surfaces, 1);
    }
    near_.add(in, target_, 1, stats);
    return target_.light();
  }

 private:
  PassContext context_;
  NearLightPass near_{context_};
  LightTarget target_{"irradiance upload"};
};

} // namespace

std::unique_ptr<Gather> makeRayGather(PassContext context) { return std::make_unique<RayGather>(context); }

} // namespace lambent

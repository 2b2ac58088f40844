// One headless context for all GL tests of the process, and what they share. Every test fails on a high-severity
// message of the driver.
#pragma once

#include "engine/gl/profiler.h"
#include "engine/gl/program.h"
#include "engine/platform/gl_context.h"
#include "engine/trace/analytic_query.h"
#include "gi/frame/composed_technique.h"
#include "gi/lighting/dirty_region.h"
#include "gi/sources/packed_lights.h"
#include "gi/surfaces/surfaces.h"
#include "gi/viewer/viewer.h"
#include "gi/viewer/viewer_stages.h"
#include "shaders/shared/paraboloid.h"
#include "tests/support/hand_scene.h"
#include "tests/support/images.h"

#include <cstdlib>

namespace lambent::test {

/// How far apart values may be that went through half floats: Mesa on the CPU rounds these to the nearest, GPUs may
/// round them towards zero (an H100 does; directions are off by 0.0005 then, and narrow lobes by a few per cent).
inline float byHalfFloats(float nearest, float towardsZero) { return gl::drawnByCpu() ? nearest : towardsZero; }

class GlTest : public ::testing::Test {
  uint64_t errorsBefore_; // first: it makes the context, which the others need

 protected:
  GlTest() : errorsBefore_((context(), glDebugErrors())) {} // fixtures make GL objects in their constructors
  void TearDown() override {
    glFinish();
    EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
    EXPECT_EQ(glDebugErrors(), errorsBefore_) << "the driver reported errors (logged above)";
  }
  static GlContext& context() {
    static GlContext shared = [] {
      if (const char* folder = std::getenv("LAMBENT_SHADERS")) gl::setShaderFolder(folder); // in place of built-in ones
      return GlContext::headless(DebugOutput::AtOnce);
    }();
    return shared;
  }

  gl::ProgramCache programs;
  gl::GpuProfiler profiler;
  PassContext passes{programs, profiler};
};

/// Of a float texture with as many texels, row 0 at the bottom.
inline gl::Texture textureOf(int width, int height, std::span<const vec4> texels) {
  gl::Texture texture("given", {.format = GL_RGBA32F, .width = width, .height = height});
  glTextureSubImage2D(texture.name(), 0, 0, 0, width, height, GL_RGBA, GL_FLOAT, texels.data());
  return texture;
}

/// Of an image, whose row 0 is at the top.
inline gl::Texture textureOf(const Image& image) {
  std::vector<vec4> texels;
  for (int y = image.height - 1; y >= 0; --y)
    for (int x = 0; x < image.width; ++x) texels.push_back(vec4(image.at(x, y), 1));
  return textureOf(image.width, image.height, texels);
}

/// RGBA values of a float texture, row 0 at the bottom.
inline std::vector<vec4> readTexture(const gl::Texture& texture) {
  std::vector<vec4> texels(size_t(texture.width()) * texture.height());
  glGetTextureImage(texture.name(), 0, GL_RGBA, GL_FLOAT, GLsizei(texels.size() * sizeof(vec4)), texels.data());
  return texels;
}

/// A room [-1,1]³ with a red left and a green right wall and a block in it, as triangles and in closed form.
struct Room {
  HandScene scene;
  AnalyticQuery rays;
  vec3 blockLo{-0.5f, -1, -0.6f}, blockHi{0, 0.2f, -0.1f};
  static constexpr uint32_t kBlock = 6; // the first of its instances

  Room() {
    const vec3 white(0.7f), red(0.6f, 0.1f, 0.1f), green(0.1f, 0.6f, 0.1f);
    const vec3 x(2, 0, 0), y(0, 2, 0), z(0, 0, 2), lo(-1);
    const uint32_t whiteMaterial = scene.material(white);
    scene.quad(lo, y, z, scene.material(red));
    scene.quad(lo + x, z, y, scene.material(green));
    scene.quad(lo, z, x, whiteMaterial);
    scene.quad(lo + y, x, z, whiteMaterial);
    scene.quad(lo, x, y, whiteMaterial);
    scene.quad(lo + z, y, x, whiteMaterial);
    scene.box(blockLo, blockHi, whiteMaterial, false);
    rays.addBox(vec3(-1), vec3(1), {.albedo = white});
    rays.addBox(blockLo, blockHi, {.albedo = white});
    scene.camera = cameraAt(vec3(0.1f, 0.1f, 0.95f), vec3(0, -0.1f, -1), 1.4f);
  }
};

/// A virtual light that faces one way.
inline VirtualLight lightAt(const vec3& position, const vec3& normal, const vec3& radiance, float area) {
  return {position, normal, normal, radiance, area, true};
}

/// Light of one emissive triangle around `centre` that faces `normal`, and the single sample that stands for it.
inline LightSet emitterAt(const vec3& centre, const vec3& normal, const vec3& radiance, float area) {
  vec3 tangent, bitangent;
  basisAround(normal, tangent, bitangent);
  const float side = std::sqrt(2 * area);
  const vec3 corner = centre - side / 3 * (tangent + bitangent);
  LightSet lights;
  addEmitter(lights, 0, 0, {makeEmitterTriangle(corner, corner + side * tangent, corner + side * bitangent, radiance)},
             false);
  return lights;
}

/// A scene as the stages of a frame see it when nothing moves.
class PlacedScene {
 public:
  PlacedScene(const PassContext& context, const HandScene& scene)
      : gpu_(context, scene.assets), rays_(scene.assets), view_(scene.view()) {
    gpu_.place(scene.instances);
    rays_.update(view_, true);
  }
  const GpuScene& gpu() const { return gpu_; }
  World world(const LightSet& lights = {}) {
    lights_ = lights;
    return {view_, gpu_, rays_, kNothingMoved, lights_, view_.boundsWorld.diameter()};
  }

 private:
  GpuScene gpu_;
  EmbreeQuery rays_;
  SceneView view_;
  LightSet lights_;
};

/// Light of a provider on surfaces, as in the first frame of the world.
inline SurfaceLighting lightOf(LightProvider& provider, const World& world, const GBuffer& surfaces, Patches& patches,
                               const Settings& settings, FrameStats& stats) {
  const EffectPlan plan = planEffects(world.view, settings, {.needs = needsOf(settings), .status = {}});
  return provider.run({{.world = world, .plan = plan, .settings = settings}, surfaces, patches}, stats);
}

/// The gathers that settings ask for, each made when it is first asked for.
class Gathers {
 public:
  explicit Gathers(PassContext context) : context_(context) {}

  SurfaceLighting run(const World& world, const GBuffer& surfaces, Patches& patches, const ShadowedLights& lights,
                      const Settings& settings, FrameStats& stats) {
    const Axes axes = axesOf(settings);
    auto made = std::ranges::find_if(made_, [&](const auto& m) { return sameGather(m.first, axes); });
    if (made == made_.end()) made = made_.insert(made, {axes, makeGather(axes, context_)});
    static const EffectPlan plan;
    const Frame frame{{.world = world, .plan = plan, .settings = settings}, surfaces, patches};
    return made->second->run({.frame = frame, .lights = lights}, stats);
  }

 private:
  PassContext context_;
  std::vector<std::pair<Axes, std::unique_ptr<Gather>>> made_;
};

/// Of the surfaces alone.
inline Image surfaceBuffer(Buffer buffer, const GBuffer& gbuffer) {
  FrameResults results;
  results.surfaces = gbuffer;
  return readBuffer(buffer, results);
}

/// Surfaces of a scene, and light gathered on them from virtual lights by the stage that settings ask for.
class GatherTest : public GlTest {
 protected:
  GBuffer surfaces(const HandScene& scene, bool glossy = false) {
    placed = std::make_unique<PlacedScene>(passes, scene);
    return surfacePass.run({placed->gpu(), scene.camera, glossy, scene.normalMapped()});
  }
  SurfaceLighting gathered(const GBuffer& gbuffer, const VirtualLights& lights, const Settings& settings,
                           const ParaboloidMaps* maps = nullptr) {
    Patches pyramid([&] { return patchPass.run(gbuffer, settings.multires); });
    const SurfaceLighting light = gathers.run(placed->world(), gbuffer, pyramid, {lights, maps}, settings, stats);
    patches = pyramid.made();
    return light;
  }
  SurfaceLighting gathered(const GBuffer& gbuffer, std::span<const VirtualLight> lights, const Settings& settings,
                           const ParaboloidMaps* maps = nullptr) {
    return gathered(gbuffer, VirtualLights{.packed = lightBuffer.run(lights), .slots = lights}, settings, maps);
  }
  static Settings with(GatherMode mode) {
    Settings settings;
    settings.gather.mode = mode;
    settings.gather.mirrors = 0; // no part of a gather
    return settings;
  }
  static Image read(Buffer buffer, const GBuffer& gbuffer, const SurfaceLighting& gathered,
                    const SurfaceLighting& indirect = {}) {
    FrameResults results;
    results.surfaces = gbuffer;
    results.inside.gathered = gathered;
    results.indirect = indirect;
    return readBuffer(buffer, results);
  }

  std::unique_ptr<PlacedScene> placed;
  SurfacePass surfacePass{passes};
  PackedLightBuffer lightBuffer{passes, StageId::Vpls};
  PatchPass patchPass{passes, StageId::Patches};
  Gathers gathers{passes};
  FilterPass filterPass{passes};
  FrameStats stats;
  std::optional<PatchPyramid> patches; // of the last gather
};

/// A horizontal plane y = 0 of 20 m × 20 m seen from straight above at 4 m.
struct Floor {
  HandScene scene;

  explicit Floor(const vec3& albedo = vec3(0.5f), float roughness = 1, float metalness = 0) {
    scene.quad(vec3(-10, 0, 10), vec3(20, 0, 0), vec3(0, 0, -20), scene.glossyMaterial(albedo, roughness, metalness));
    scene.camera = cameraAt(vec3(0, 4, 0), vec3(0), 1.0f);
  }
  /// World position of the plane at the centre of pixel (x, y), y from the top.
  vec3 at(int x, int y) const {
    const CameraRay ray = cameraRay(scene.camera, (float(x) + 0.5f) / float(scene.camera.width),
                                    (float(y) + 0.5f) / float(scene.camera.height));
    return ray.origin - ray.direction * (ray.origin.y / ray.direction.y);
  }
};

} // namespace lambent::test

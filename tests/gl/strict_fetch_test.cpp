// What texelFetch gives outside a texture is undefined. Here it gives a number, and pictures must not depend on which.
#include "gi/reflective/reflective_maps.h"
#include "gl_fixture.h"
#include "shader_copy.h"

namespace lambent::test::strict_fetch_test {

/// Makes shaders fetch `outside` outside the mip level that they ask for.
void makeStrict(const ShaderCopy& shaders, float outside) {
  std::string fetches = R"(
vec4 strictFetch(sampler2D s, ivec2 p, int level) {
  ivec2 size = textureSize(s, 0) >> level; // software Mesa takes one fragment's level for all of them
  return any(lessThan(p, ivec2(0))) || any(greaterThanEqual(p, size)) ? BEYOND : texelFetch(s, p, level);
}
vec4 strictFetch(sampler2DArray s, ivec3 p, int level) {
  ivec3 size = textureSize(s, 0); // no levels
  return any(lessThan(p, ivec3(0))) || any(greaterThanEqual(p, size)) ? BEYOND : texelFetch(s, p, level);
}
vec4 strictFetch(samplerBuffer s, int p) { return p < 0 || p >= textureSize(s) ? BEYOND : texelFetch(s, p); }
#define texelFetch strictFetch
)";
  for (size_t at = 0; (at = fetches.find("BEYOND", at)) != std::string::npos;)
    fetches.replace(at, 6, "vec4(" + std::to_string(outside) + ")");
  for (const auto& entry : fs::directory_iterator(shaders.path)) {
    const std::string file = entry.path().filename().string(), version = "#version 450\n";
    if (entry.is_regular_file() && shaders.read(file).starts_with(version))
      shaders.replace(file, version, version + fetches);
  }
}

class StrictFetchTest : public GlTest {
 protected:
  /// Indirect irradiance by every gather from reflective maps, whose passes read most textures.
  std::vector<std::vector<vec4>> pictures(float outside) {
    const ShaderCopy shaders;
    makeStrict(shaders, outside);
    gl::ProgramCache strict(shaders.path);
    const PassContext context{strict, profiler};
    std::vector<std::vector<vec4>> images;
    for (const glm::ivec2 size : {glm::ivec2(64, 32), glm::ivec2(67, 39)}) { // patches fit, or reach beyond the picture
      room.scene.size(size.x, size.y);
      PlacedScene placed(context, room.scene);
      const World world = placed.world();
      SurfacePass surfacePass{context};
      const GBuffer gbuffer = surfacePass.run({world.gpu, room.scene.camera});
      const ReflectiveNeeds grid, clusters{true, true}, trees{true, false};
      for (const ReflectiveNeeds needs : {grid, clusters, trees}) {
        ReflectiveMapPass mapPass{context};
        ReflectiveLightPass lightPass{context};
        const ReflectiveMaps maps =
            mapPass.run({world.gpu, lights, world.view.boundsWorld, false, {}, settings.rsm, needs});
        const LightTrees tree{maps, settings.rsm};
        VirtualLights vpls;
        if (needs == trees) vpls.trees = &tree;
        if (needs == grid) vpls.packed = lightPass.runGrid(maps, settings.rsm);
        if (needs == clusters) vpls.packed = lightPass.runClusters(maps, settings.rsm);
        std::vector<GatherMode> modes{GatherMode::Interleaved, GatherMode::Multires, GatherMode::MultiresInterleaved};
        if (needs == grid) modes.insert(modes.end(), {GatherMode::Splat, GatherMode::SplatPerVpl});
        for (const GatherMode mode : modes) {
          settings.gather.mode = mode;
          settings.multires.finest = mode == GatherMode::Multires ? 4 : 1;
          settings.multires.upsample =
              mode == GatherMode::MultiresInterleaved ? PatchUpsample::Bilinear : PatchUpsample::Bilateral;
          Gathers gathers{context};
          PatchPass patchPass{context, StageId::Patches};
          FilterPass filterPass{context};
          FrameStats stats;
          Patches pyramid([&] { return patchPass.run(gbuffer, settings.multires); });
          const SurfaceLighting raw = gathers.run(world, gbuffer, pyramid, {vpls}, settings, stats);
          images.push_back(readTexture(*filterPass.run({gbuffer, raw, FilterSettings{}}).irradiance));
        }
      }
    }
    return images;
  }

  Room room;
  std::vector<LightView> lights;
  Settings settings = [] {
    Settings s;
    s.rsm = {.resolution = 32, .vpls = 14, .coarsest = 8, .finest = 32};
    s.multires.coarsest = 4;
    return s;
  }();
};

TEST_F(StrictFetchTest, NoPictureDependsOnWhatLiesOutsideATexture) {
  lights = {{.position = vec3(0.3f, 0.5f, 0.4f), .intensity = vec3(1, 2, 3)},
            {.type = LightType::Directional, .direction = glm::normalize(vec3(0.3f, -1, 0.2f)), .intensity = vec3(4)}};
  const std::vector<std::vector<vec4>> zeros = pictures(0), large = pictures(1e6f);
  ASSERT_EQ(zeros.size(), 22u);
  for (size_t i = 0; i < zeros.size(); ++i) EXPECT_TRUE(zeros[i] == large[i]) << "picture " << i;
}

} // namespace lambent::test::strict_fetch_test

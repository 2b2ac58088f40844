// Deformed instances on the GPU: the G-buffer and depth maps show the vertices that rays meet.
#include "engine/trace/embree_query.h"
#include "gl_fixture.h"

#include <glm/gtc/matrix_transform.hpp>

namespace lambent::test::deformed_test {

class DeformedDraw : public GlTest {
 protected:
  HandScene scene;

  DeformedDraw() {
    const uint32_t red = scene.material({0.8f, 0.2f, 0.1f}), grey = scene.material(vec3(0.5f));
    scene.assets.materials[red].baseColorTexture = // texture coordinates and colours must stay with their vertices
        scene.texture(2, {{255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}, {255, 255, 255, 255}});
    scene.quad(vec3(-4, -4, -2), vec3(8, 0, 0), vec3(0, 8, 0), grey);
    scene.assets.meshes.push_back(sheet(20, red));
    scene.assets.meshes.push_back(sheet(9, grey));
    Mesh& coloured = scene.assets.meshes.back();
    for (size_t i = 0; i < coloured.positions.size(); ++i) coloured.colors.emplace_back(i % 2, 0.5f, 0.25f, 1);
    scene.instance(1, glm::rotate(mat4(1), 0.5f, vec3(0, 1, 0)));
    scene.instance(2, glm::translate(glm::scale(mat4(1), vec3(-0.55f, 0.55f, 0.55f)), vec3(-2, 2, 1)));
    scene.instance(1, glm::translate(glm::scale(mat4(1), vec3(0.4f)), vec3(3, -2, 1))); // stays rigid
    scene.camera = cameraAt(vec3(0.3f, 0.2f, 4), vec3(0), 0.9f, 96, 72);
  }
  void reshape(float phase) {
    scene.reshape(1, waves(scene.assets.meshes[1], 0.35f, phase));
    scene.reshape(2, waves(scene.assets.meshes[2], 0.25f, 2 * phase));
  }
  void expectAgreesWithRays(SurfacePass& pass, GpuScene& gpu) {
    EmbreeQuery rays(scene.assets);
    rays.update(scene.view());
    gpu.place(scene.instances);
    FrameResults results;
    results.surfaces = pass.run({gpu, scene.camera});
    const Image depth = readBuffer(Buffer::Depth, results), normal = readBuffer(Buffer::Normal, results),
                albedo = readBuffer(Buffer::Albedo, results);
    const vec3 forward = -vec3(scene.camera.worldFromView[2]);
    int differing = 0, deformed = 0;
    for (const auto [x, y] : Pixels(depth)) {
      const CameraRay ray = pixelRay(scene.camera, x, y);
      const SurfaceHit hit = rays.closest(Ray{ray.origin, ray.direction});
      if (!hit.valid()) {
        differing += depth.at(x, y).x != 0;
        continue;
      }
      deformed += hit.instance == 1 || hit.instance == 2;
      const float wanted = glm::dot(hit.position - scene.camera.position(), forward);
      differing += std::abs(depth.at(x, y).x - wanted) > 1e-3f || glm::length(normal.at(x, y) - hit.normal) > 4e-3f ||
                   glm::length(albedo.at(x, y) - hit.albedo) > 4e-3f;
    }
    EXPECT_GT(deformed, 1500);
    // Silhouettes and texel borders: a pixel centre on an edge may fall to either side.
    EXPECT_LE(differing, 10);
  }
};

TEST_F(DeformedDraw, GBufferAgreesWithRaysAsTheShapeChanges) {
  GpuScene gpu(passes, scene.assets);
  SurfacePass pass(passes);
  for (const float phase : {0.0f, 1.0f, 2.5f}) {
    reshape(phase);
    expectAgreesWithRays(pass, gpu);
  }
  // One of them alone changes, and becomes rigid; then the other changes.
  scene.reshape(2, waves(scene.assets.meshes[2], 0.4f, 4));
  expectAgreesWithRays(pass, gpu);
  scene.instances[2].deformed = nullptr;
  expectAgreesWithRays(pass, gpu);
  scene.reshape(1, waves(scene.assets.meshes[1], 0.2f, 5));
  expectAgreesWithRays(pass, gpu);
  const uint32_t triangles = gpu.triangleCount();
  EXPECT_EQ(triangles, 2u + 800 + 162 + 800);
}

TEST_F(DeformedDraw, DepthMapsShowTheSameShape) {
  GpuScene gpu(passes, scene.assets);
  SurfacePass pass(passes);
  reshape(1.5f);
  gpu.place(scene.instances);
  const GBuffer gbuffer = pass.run({gpu, scene.camera});
  gl::Texture depth("test/depth", {.format = GL_DEPTH_COMPONENT32F, .width = 96, .height = 72});
  gl::Framebuffer framebuffer("test/depth", {}, &depth);
  framebuffer.bind();
  gl::PipelineState{.depthTest = true, .depthWrite = true, .width = 96, .height = 72}.apply();
  const float nothing = 0;
  glClearNamedFramebufferfv(framebuffer.name(), GL_DEPTH, 0, &nothing);
  gpu.draw(DrawKind::Depth, gbuffer.block.clipFromWorld);
  std::vector<float> a(96 * 72), b(96 * 72);
  glGetTextureImage(depth.name(), 0, GL_DEPTH_COMPONENT, GL_FLOAT, GLsizei(a.size() * sizeof(float)), a.data());
  glGetTextureImage(gbuffer.depth->name(), 0, GL_DEPTH_COMPONENT, GL_FLOAT, GLsizei(b.size() * sizeof(float)),
                    b.data());
  for (size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 1e-6f) << i;
  EXPECT_GT(*std::max_element(a.begin(), a.end()), 0);
}

TEST_F(DeformedDraw, PicturesOfRigidScenesDoNotDependOnThem) {
  GpuScene gpu(passes, scene.assets), fresh(passes, scene.assets);
  SurfacePass pass(passes);
  const auto normals = [&](GpuScene& on) {
    on.place(scene.instances);
    return readTexture(*pass.run({on, scene.camera}).normal);
  };
  const auto rigid = normals(fresh);
  reshape(1);
  EXPECT_NE(normals(gpu), rigid);
  for (InstanceView& i : scene.instances) i.deformed = nullptr;
  EXPECT_EQ(normals(gpu), rigid);
}

} // namespace lambent::test::deformed_test

// Every glTF file under $LAMBENT_EXTRA_CONTENT (a folder of models that are not part of this repository) loads.

#include "tests/cpu/scene/support.h"

namespace lambent::test::extra_content_test {

void expectSound(const Scene& scene) {
  for (const Mesh& mesh : scene.assets.meshes) {
    ASSERT_FALSE(mesh.triangles.empty());
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    ASSERT_TRUE(mesh.uv0.empty() || mesh.uv0.size() == mesh.positions.size());
    ASSERT_TRUE(mesh.uv1.empty() || mesh.uv1.size() == mesh.positions.size());
    ASSERT_TRUE(mesh.colors.empty() || mesh.colors.size() == mesh.positions.size());
    uint32_t next = 0;
    for (const Primitive& p : mesh.primitives) {
      ASSERT_EQ(p.firstTriangle, next);
      ASSERT_LT(p.material, scene.assets.materials.size());
      next += p.triangleCount;
    }
    ASSERT_EQ(next, mesh.triangles.size());
    for (const uvec3& t : mesh.triangles) ASSERT_TRUE(glm::max(t.x, glm::max(t.y, t.z)) < mesh.positions.size());
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
      ASSERT_TRUE(isFinite(mesh.positions[i]));
      ASSERT_NEAR(glm::length(mesh.normals[i]), 1, 1e-4f);
    }
  }
  for (const Material& m : scene.assets.materials)
    for (const TextureRef& ref : {m.baseColorTexture, m.emissiveTexture})
      ASSERT_TRUE(ref.image == kNone || ref.image < scene.assets.images.size());
  for (const TextureImage& image : scene.assets.images)
    ASSERT_EQ(image.texels.size(), size_t(image.width) * size_t(image.height));
}

/// Deformed vertices are finite, and figures stay together: no animation in these files flings parts away.
void expectSound(const SceneView& view) {
  for (const InstanceView& i : view.instances) {
    if (!i.deformed) continue;
    const Mesh& mesh = view.assets->meshes[i.mesh];
    ASSERT_EQ(i.deformed->positions.size(), mesh.positions.size());
    ASSERT_EQ(i.deformed->primitiveBoundsObject.size(), mesh.primitives.size());
    for (const vec3& p : i.deformed->positions) ASSERT_TRUE(isFinite(p));
    for (const vec3& n : i.deformed->normals) ASSERT_NEAR(glm::length(n), 1, 1e-4f);
    EXPECT_LT(i.boundsWorld.diameter(), 3 * i.boundsWorldBefore.diameter());
    EXPECT_GT(i.boundsWorld.diameter(), i.boundsWorldBefore.diameter() / 3);
  }
}

TEST(ExtraContent, Loads) {
  const char* root = std::getenv("LAMBENT_EXTRA_CONTENT");
  if (!root) GTEST_SKIP() << "LAMBENT_EXTRA_CONTENT is not set";
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(root))
    if (entry.path().extension() == ".gltf" || entry.path().extension() == ".glb") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  ASSERT_FALSE(files.empty());
  for (const fs::path& file : files) {
    SCOPED_TRACE(file.string());
    const auto begin = std::chrono::steady_clock::now();
    try {
      Scene scene = loadScene(file);
      const std::chrono::duration<double, std::milli> loading = std::chrono::steady_clock::now() - begin;
      expectSound(scene);
      SceneExtractor extractor;
      const SceneView view = extractor.extract(scene, defaultView(scene), 0);
      size_t triangles = 0;
      for (const InstanceView& i : view.instances) triangles += scene.assets.meshes[i.mesh].triangles.size();
      for (int frame = 1; frame < 4; ++frame) {
        animate(scene, frame * 0.37);
        expectSound(extractor.extract(scene, view.camera, frame * 0.37));
      }
      std::cout << file.filename().string() << ": " << triangles << " triangles, " << scene.assets.images.size()
                << " images, " << view.lights.size() << " lights, loaded in " << std::lround(loading.count())
                << " ms\n";
      for (const std::string& w : scene.warnings) std::cout << "  warning: " << w << "\n";
    } catch (const InputError& e) {
      ADD_FAILURE() << e.what();
    }
  }
}

} // namespace lambent::test::extra_content_test

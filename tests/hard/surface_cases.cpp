#include "tests/hard/hard_worlds.h"

namespace lambent::test {

void addSurfaceCases(const Add& add, const Add& some) {
  add("Degenerate", "triangles without area, and every triangle twice", kRoom, [](HardWorld& w) {
    roomOf(w, 1);
    for (Mesh& mesh : w.scene.assets.meshes) {
      mesh.triangles.insert(mesh.triangles.end(), {{0, 1, 2}, {0, 2, 3}, {0, 0, 1}, {2, 2, 2}});
      mesh.primitives[0].triangleCount = 6;
    }
  });
  add("NoExtent", "every corner of every triangle is one point: a scene of no size", {0, 0}, [](HardWorld& w) {
    const uint32_t quad = w.scene.quad({0, 0, -1}, {1, 0, 0}, {0, 1, 0}, w.scene.material(vec3(0.7f)));
    Mesh& mesh = w.scene.assets.meshes[0];
    mesh.positions.assign(4, vec3(0, 0, -1));
    mesh.boundsObject = mesh.primitives[0].boundsObject = {vec3(0, 0, -1), vec3(0, 0, -1)};
    w.scene.place(quad, mat4(1));
    w.lamp({0, 0, -1});
    w.step = [&w, quad](int) { w.scene.place(quad, mat4(1)); };
  });
  add("OddNormals", "shading normals of length 0 and 10, and away from the front", {0.65, 1.05}, [](HardWorld& w) {
    roomOf(w, 1);
    w.scene.assets.meshes[0].normals.assign(4, vec3(0));
    w.scene.assets.meshes[2].normals.assign(4, vec3(0, 10, 0));
    w.scene.assets.meshes[4].normals.assign(4, vec3(0, 0, -1));
  });
  add("Mirrored", "instances of negative scale: the front is still the front", kRoom, [](HardWorld& w) {
    roomOf(w, 1);
    for (uint32_t i = 0; i < 6; ++i) w.scene.place(i, glm::scale(mat4(1), vec3(-1, 1, 1)));
  });
  add("Flattened", "an object scaled to nothing and to a sheet in turn", {0.55, 1.1}, [](HardWorld& w) {
    roomOf(w, 1);
    w.scene.box(vec3(-0.2f), vec3(0.2f), w.scene.material(vec3(0.5f)), false);
    w.step = [&w](int frame) {
      for (uint32_t i = 6; i < 12; ++i) w.scene.place(i, glm::scale(mat4(1), vec3(1, frame % 2 ? 1e-6f : 1, 1)));
    };
  });
  some("WallsOfNeedles", "triangles of 2 m by 2 mm", kRoom, [](HardWorld& w) {
    const uint32_t white = w.scene.material(vec3(0.7f));
    for (int side = 0; side < 6; ++side) {
      const int a = side / 2;
      vec3 out(0), s(0);
      out[a] = side % 2 ? 1.0f : -1.0f;
      s[(a + 1) % 3] = 1;
      const vec3 t = glm::cross(s, out); // the front faces in
      Mesh mesh;
      for (int i = 0; i <= 1000; ++i)
        for (const float end : {-1.0f, 1.0f}) mesh.positions.push_back(out + (0.002f * float(i) - 1) * s + end * t);
      mesh.normals.assign(mesh.positions.size(), -out);
      for (uint32_t i = 0; i < 2000; i += 2)
        mesh.triangles.insert(mesh.triangles.end(), {{i, i + 2, i + 3}, {i, i + 3, i + 1}});
      mesh.boundsObject = {out - glm::abs(s) - glm::abs(t), out + glm::abs(s) + glm::abs(t)};
      mesh.primitives.push_back({0, 2000, white, mesh.boundsObject});
      w.scene.add(std::move(mesh));
    }
    w.lamp({0.1f, 0.3f, 0.2f});
  });
  some("BackToBack", "every wall twice in one plane, its front in and its front out", kRoom, [](HardWorld& w) {
    roomOf(w, 1);
    w.scene.box(vec3(-1), vec3(1), w.scene.material(vec3(0.7f)), false);
  });
  some("TwoFloorsInOnePlane", "of albedo 0.7 and 0.1: which is met is chance", {0.45, 0.85}, [](HardWorld& w) {
    roomOf(w, 1);
    w.scene.quad({-1, -1, 1}, {2, 0, 0}, {0, 0, -2}, w.scene.material(vec3(0.1f)));
  });
  // As LampBehindAGrille: 0.14 of 0.225.
  some("MaskedGrille", "a wall's mask cuts out one texel in 25", {0.08, 0.3, kInfinity, true}, [](HardWorld& w) {
    w.room({-1, -1, -1}, {1, 1, 3});
    const uint32_t mask = w.scene.material(vec3(0.7f), vec3(0), true);
    std::vector<u8vec4> texels(25, {255, 255, 255, 255});
    texels[12].w = 0;
    w.scene.quad({-1, -1, 1}, {2, 0, 0}, {0, 2, 0}, mask);
    w.scene.assets.meshes.back().uv0 = {{0, 0}, {10, 0}, {10, 10}, {0, 10}};
    w.scene.assets.materials[mask].baseColorTexture = w.scene.texture(5, texels);
    w.scene.assets.materials[mask].alphaMode = AlphaMode::Mask;
    w.lamp({0.1f, 0.2f, 2.5f}, 20);
    w.scene.camera = look({0, 0, 0.9f}, {0, 0, -1});
  });
  some("AllCutOut", "a block whose mask asks for more than full alpha is not there", kRoom, [](HardWorld& w) {
    roomOf(w, 1);
    const uint32_t mask = w.scene.material(vec3(0.7f));
    w.scene.box({-0.5f, -0.5f, -0.5f}, vec3(0.25f), mask, false);
    w.scene.assets.materials[mask].alphaMode = AlphaMode::Mask;
    w.scene.assets.materials[mask].alphaCutoff = 2;
  });
  some("HallOfMirrors", "metal of roughness 0: its lobe has no width, and is divided by", kRoom, [](HardWorld& w) {
    roomOf(w, 1);
    for (Material& m : w.scene.assets.materials) m.roughness = 0, m.metalness = 1;
    w.settings.gather.glossy = true;
  });
  some("HallOfAlmostMirrors", "roughness 1e-4: α² is 1e-16", kRoom, [](HardWorld& w) {
    roomOf(w, 1);
    for (Material& m : w.scene.assets.materials) m.roughness = 1e-4f, m.metalness = 0.5f;
    w.settings.gather.glossy = true;
    w.settings.gather.spread = 0;
  });
  some("TextureFarFromItsOrigin", "coordinates of 1e30 times 1e30", kRoom, [](HardWorld& w) {
    roomOf(w, 1);
    for (Mesh& mesh : w.scene.assets.meshes)
      for (vec2& uv : mesh.uv0) uv *= 1e30f;
    Material& material = w.scene.assets.materials[0];
    material.baseColor = vec3(1);
    material.baseColorTexture = w.scene.texture(2, std::vector<u8vec4>(4, {218, 218, 218, 255})); // 0.70
    material.baseColorTexture.uvTransform = mat3(1e30f);
  });
  some("VertexColoursBeyondShares", "1e30, taken as 1: every reflection would add light", {1.2, 2}, [](HardWorld& w) {
    w.room(vec3(-1), vec3(1), vec3(1));
    for (Mesh& mesh : w.scene.assets.meshes) mesh.colors.assign(4, vec4(1e30f));
    w.lamp({0.1f, 0.3f, 0.2f});
  });
  some("VertexColoursBelowZero", "-1, taken as 0: light would be taken away", {0, 0}, [](HardWorld& w) {
    roomOf(w, 1);
    for (Mesh& mesh : w.scene.assets.meshes) mesh.colors.assign(4, vec4(-1, -1, -1, 1));
  });
  some("Sheared", "walls of a millimetre by a kilometre that a transform makes square", kRoom, [](HardWorld& w) {
    roomOf(w, 1);
    mat4 shear = glm::scale(mat4(1), vec3(1e3f, 1, 1e-3f));
    shear[1][0] = 0.5f, shear[2][1] = 5e-4f;
    const mat4 back = glm::inverse(shear);
    for (uint32_t i = 0; i < 6; ++i) {
      Mesh& mesh = w.scene.assets.meshes[i];
      mesh.boundsObject = {};
      for (vec3& p : mesh.positions) p = vec3(back * vec4(p, 1)), mesh.boundsObject.add(p);
      for (vec3& n : mesh.normals) n = glm::normalize(glm::transpose(mat3(shear)) * n);
      mesh.primitives[0].boundsObject = mesh.boundsObject;
      w.scene.place(i, shear);
      w.scene.instances[i].worldFromObjectBefore = shear;
    }
  });
}

} // namespace lambent::test

#include "game/rules/shapes.h"

namespace lambent {

uint32_t addBoxesMesh(SceneAssets& assets, const std::string& name, std::span<const BoxPart> parts,
                      const vec3& albedo) {
  Material material;
  material.name = name;
  material.baseColor = albedo;
  assets.materials.push_back(material);
  Mesh mesh;
  mesh.name = name;
  for (const BoxPart& part : parts) {
    const vec3 centre = 0.5f * (part.lo + part.hi), half = 0.5f * (part.hi - part.lo);
    for (int face = 0; face < 6; ++face) {
      vec3 out(0), s(0);
      const int axis = face / 2;
      out[axis] = face % 2 ? 1.0f : -1.0f;
      s[(axis + 1) % 3] = 1;
      const vec3 t = glm::cross(out, s);
      const uint32_t first = uint32_t(mesh.positions.size());
      for (const vec3& corner : {out - s - t, out + s - t, out + s + t, out - s + t})
        mesh.positions.push_back(centre + half * corner);
      mesh.normals.insert(mesh.normals.end(), 4, out);
      mesh.triangles.push_back({first, first + 1, first + 2});
      mesh.triangles.push_back({first, first + 2, first + 3});
    }
    mesh.boundsObject.add(part.lo);
    mesh.boundsObject.add(part.hi);
  }
  mesh.primitives.push_back(
      {0, uint32_t(mesh.triangles.size()), uint32_t(assets.materials.size() - 1), mesh.boundsObject, true});
  assets.meshes.push_back(std::move(mesh));
  return uint32_t(assets.meshes.size() - 1);
}

uint32_t addBoxMesh(SceneAssets& assets, const std::string& name, const vec3& halfSize, const vec3& albedo) {
  const BoxPart part{-halfSize, halfSize};
  return addBoxesMesh(assets, name, {&part, 1}, albedo);
}

Entity addInstance(Scene& scene, const std::string& name, uint32_t mesh, const Transform& place) {
  Registry& registry = scene.registry;
  const Entity e = registry.create();
  registry.emplace<Name>(e, name);
  registry.emplace<Transform>(e, place);
  registry.emplace<WorldTransform>(e, place.local());
  registry.emplace<MeshInstance>(e, mesh);
  return e;
}

} // namespace lambent

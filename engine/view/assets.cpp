#include "engine/view/assets.h"

#include <glm/gtc/matrix_transform.hpp>

namespace lambent {

namespace {

template <class T> uint64_t sizeOf(const std::vector<T>& v) { return v.size() * sizeof(T); }

} // namespace

void countFromMiddle(Mesh& mesh) {
  const vec3 middle = mesh.boundsObject.centre();
  for (vec3& p : mesh.positions) p -= middle;
  const auto move = [&](Aabb& box) {
    if (!box.empty()) box = {box.lo - middle, box.hi - middle};
  };
  move(mesh.boundsObject);
  for (Primitive& p : mesh.primitives) move(p.boundsObject);
  mesh.centre += dvec3(middle);
}

dmat4 placeFor(const Mesh& mesh, const dmat4& transform) {
  return mesh.centre == dvec3(0) ? transform : glm::translate(transform, mesh.centre);
}

uint64_t bytesOf(const SceneAssets& assets) {
  uint64_t sum = 0;
  for (const Mesh& m : assets.meshes) {
    sum += sizeOf(m.positions) + sizeOf(m.normals) + sizeOf(m.uv0) + sizeOf(m.uv1) + sizeOf(m.colors) +
           sizeOf(m.tangents) + sizeOf(m.triangles) + sizeOf(m.primitives);
    for (const JointSet& s : m.jointSets) sum += sizeOf(s.joints) + sizeOf(s.weights);
    for (const MorphTarget& t : m.morphTargets) sum += sizeOf(t.positions) + sizeOf(t.normals);
  }
  for (const TextureImage& i : assets.images) sum += sizeOf(i.texels);
  return sum;
}

} // namespace lambent

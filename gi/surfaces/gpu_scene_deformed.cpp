// Vertices of skinned and morphed instances. Each has a run of its own behind a second vertex array of the same form,
// so that programs, indices and draws do not know the difference; a run is written again only when its shape changed.
#include "engine/core/error.h"
#include "gi/surfaces/gpu_scene.h"

#include <glm/gtc/packing.hpp>

namespace lambent {

namespace {

/// Room for `count` vertices that `from` has an attribute of; nothing where it has none.
gl::Buffer roomFor(const char* label, const gl::Buffer& from, uint64_t count, uint64_t stride) {
  return from ? gl::Buffer(label, count * stride, nullptr) : gl::Buffer();
}

} // namespace

/// Gives every deformed instance its run. Done again only when instances come or go, change their mesh, or start or
/// stop being deformed.
void GpuScene::layOutDeformed(std::span<const InstanceView> instances) {
  std::vector<uint32_t> baseVertex(instances.size(), kNone);
  uint64_t total = 0;
  bool same = instances.size() == placed_.size();
  for (size_t i = 0; i < instances.size(); ++i) {
    same = same && placed_[i].mesh == instances[i].mesh &&
           (placed_[i].revision != 0) == (instances[i].deformed != nullptr);
    if (!instances[i].deformed) continue;
    baseVertex[i] = uint32_t(total);
    total += meshes_[instances[i].mesh].vertexCount;
  }
  if (same) return;
  placed_.clear(); // all runs are to be written
  deformed_ = {};
  deformed_.baseVertex = std::move(baseVertex);
  if (total == 0) return;
  changes_.reserve(total * (sizeof(vec3) + 2 * sizeof(uint64_t)) + instances.size() * 3 * sizeof(vec4));
  deformed_.positions = roomFor("scene/deformed positions", positions_, total, sizeof(vec3));
  deformed_.normals = roomFor("scene/deformed normals", normals_, total, sizeof(uint64_t));
  deformed_.uvs = roomFor("scene/deformed uvs", uvs_, total, sizeof(vec4));
  deformed_.colors = roomFor("scene/deformed colors", colors_, total, sizeof(uint64_t));
  deformed_.tangents = roomFor("scene/deformed tangents", tangents_, total, sizeof(uint64_t));
  for (size_t i = 0; i < instances.size(); ++i) {
    if (!instances[i].deformed) continue;
    const MeshRange& mesh = meshes_[instances[i].mesh];
    const auto copy = [&](const gl::Buffer& from, const gl::Buffer& to, GLsizeiptr stride) {
      if (from && mesh.vertexCount > 0)
        glCopyNamedBufferSubData(from.name(), to.name(), mesh.baseVertex * stride, deformed_.baseVertex[i] * stride,
                                 mesh.vertexCount * stride);
    };
    copy(uvs_, deformed_.uvs, sizeof(vec4));
    copy(colors_, deformed_.colors, sizeof(uint64_t));
    copy(tangents_, deformed_.tangents, sizeof(uint64_t)); // zeros of meshes that have none stay
  }
  deformed_.array = vertexArrayOf("scene/deformed vertices", deformed_.positions, deformed_.normals, deformed_.uvs,
                                  deformed_.colors, deformed_.tangents);
}

void GpuScene::uploadDeformed(std::span<const InstanceView> instances) {
  std::vector<uint64_t> normals, tangents;
  for (size_t i = 0; i < instances.size(); ++i) {
    const DeformedMesh* shape = instances[i].deformed.get();
    if (!shape || (i < placed_.size() && placed_[i].revision == shape->revision)) continue;
    CHECK_EQ(shape->positions.size(), size_t(meshes_[instances[i].mesh].vertexCount));
    normals.clear();
    for (const vec3& n : shape->normals) normals.push_back(glm::packSnorm4x16(vec4(n, 0)));
    const uint64_t base = deformed_.baseVertex[i];
    changes_.upload(deformed_.positions, base * sizeof(vec3), shape->positions.size() * sizeof(vec3),
                    shape->positions.data());
    changes_.upload(deformed_.normals, base * sizeof(uint64_t), normals.size() * sizeof(uint64_t), normals.data());
    if (shape->tangents.empty()) continue;
    tangents.clear();
    for (const vec4& t : shape->tangents) tangents.push_back(glm::packSnorm4x16(t));
    changes_.upload(deformed_.tangents, base * sizeof(uint64_t), tangents.size() * sizeof(uint64_t), tangents.data());
  }
}

} // namespace lambent

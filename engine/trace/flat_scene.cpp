#include "engine/trace/flat_scene.h"

#include <algorithm>

namespace lambent {

namespace {

constexpr uint32_t kLeafTriangles = 4;

Aabb boxOf(const Mesh& mesh, uint32_t triangle, std::span<const vec3> positions) {
  Aabb box;
  for (int c = 0; c < 3; ++c) {
    const vec3& p = positions[mesh.triangles[triangle][c]];
    if (!isFinite(p)) return {};
    box.add(p);
  }
  return box;
}

std::vector<Aabb> boxesOf(const Mesh& mesh, std::span<const vec3> positions) {
  std::vector<Aabb> boxes(mesh.triangles.size());
  for (uint32_t t = 0; t < boxes.size(); ++t) boxes[t] = boxOf(mesh, t, positions);
  return boxes;
}

/// Sum over the nodes, on which the cost of a ray depends.
double areaOf(const Bvh& bvh) {
  double sum = 0;
  for (const BvhNode& n : bvh.nodes) {
    const glm::dvec3 s = glm::dvec3(n.hi) - glm::dvec3(n.lo);
    sum += s.x * s.y + s.y * s.z + s.z * s.x;
  }
  return sum;
}

/// As RayMask::modes, whose wraps have the numbers of ours.
uint32_t modesOf(const TextureRef& ref) {
  return uint32_t(ref.wrapU) | uint32_t(ref.wrapV) << 2 | uint32_t(ref.nearest) << 4;
}

} // namespace

FlatScene::FlatScene(const SceneAssets& assets) : assets_(assets) {
  firstTexels_.assign(assets.images.size(), kNone);
  for (const Mesh& mesh : assets.meshes) {
    std::vector<uint32_t>& masks = masksOfMeshes_.emplace_back();
    for (const Primitive& p : mesh.primitives) {
      if (assets.materials[p.material].alphaMode == AlphaMode::Opaque) continue;
      masks.resize(mesh.triangles.size(), kNone);
      for (uint32_t t = 0; t < p.triangleCount; ++t) masks[p.firstTriangle + t] = maskOf(mesh, p, p.firstTriangle + t);
    }
    const std::vector<Aabb> boxes = boxesOf(mesh, mesh.positions);
    Shape& shape = meshes_.emplace_back();
    shape.bvh = builder_.build(boxes, kLeafTriangles);
    place(shape, uint32_t(meshes_.size() - 1), mesh.positions);
  }
  staticNodes_ = nodes_.size();
  staticTriangles_ = triangles_.size();
}

/// Alpha of an image, once.
void FlatScene::addTexels(uint32_t index) {
  if (firstTexels_[index] != kNone) return;
  const TextureImage& image = assets_.images[index];
  const size_t first = firstTexels_[index] = uint32_t(texels_.size() * 4);
  texels_.resize(texels_.size() + (image.texels.size() + 3) / 4);
  for (size_t i = 0; i < image.texels.size(); ++i)
    texels_[(first + i) / 4] |= uint32_t(image.texels[i].w) << (8 * (i % 4));
}

uint32_t FlatScene::maskOf(const Mesh& mesh, const Primitive& primitive, uint32_t triangle) {
  const Material& material = assets_.materials[primitive.material];
  const TextureRef& ref = material.baseColorTexture;
  const std::vector<vec2>& uv = ref.uvSet == 0 ? mesh.uv0 : mesh.uv1;
  RayMask mask{};
  if (ref.image != kNone) {
    addTexels(ref.image);
    const TextureImage& image = assets_.images[ref.image];
    mask.firstTexel = firstTexels_[ref.image];
    mask.width = image.width;
    mask.height = image.height;
    mask.modes = modesOf(ref);
  }
  for (int c = 0; c < 3; ++c) {
    const uint32_t vertex = mesh.triangles[triangle][c];
    const vec3 at = ref.uvTransform * vec3(uv.empty() ? vec2(0) : uv[vertex], 1);
    mask.corners[c] = vec4(at.x, at.y, material.alpha * (mesh.colors.empty() ? 1 : mesh.colors[vertex].w), 0);
  }
  const bool blended = material.alphaMode == AlphaMode::Blend;
  mask.corners[0].w = blended ? -1 : material.alphaCutoff;
  mask.corners[1].w = float(triangle - primitive.firstTriangle);
  masks_.push_back(mask);
  return uint32_t(masks_.size() - 1);
}

/// Appends a shape's nodes and triangles to the arrays.
void FlatScene::place(Shape& shape, uint32_t meshIndex, std::span<const vec3> positions) {
  const Mesh& mesh = assets_.meshes[meshIndex];
  const std::vector<uint32_t>& masks = masksOfMeshes_[meshIndex];
  shape.firstNode = uint32_t(nodes_.size());
  shape.firstTriangle = uint32_t(triangles_.size());
  nodes_.insert(nodes_.end(), shape.bvh.nodes.begin(), shape.bvh.nodes.end());
  for (const uint32_t t : shape.bvh.order) {
    const uvec3& corners = mesh.triangles[t];
    triangles_.push_back(
        {positions[corners.x], t, positions[corners.y], masks.empty() ? kNone : masks[t], positions[corners.z], 0});
  }
}

/// Lays out again what lies behind the static arrays.
void FlatScene::reshape(const SceneView& view, Changed& changed) {
  const size_t count = view.instances.size();
  bool any = meshOf_.size() != count;
  for (size_t i = 0; i < count && !any; ++i) {
    const InstanceView& in = view.instances[i];
    any = meshOf_[i] != in.mesh || revisions_[i] != (in.deformed ? in.deformed->revision : 0);
  }
  if (!any) return;
  changed.shapes =
      std::any_of(view.instances.begin(), view.instances.end(), [](const auto& i) { return i.deformed; }) ||
      nodes_.size() > staticNodes_;
  deformed_.resize(count);
  meshOf_.resize(count, kNone);
  revisions_.resize(count, 0);
  nodes_.resize(staticNodes_);
  triangles_.resize(staticTriangles_);
  for (size_t i = 0; i < count; ++i) {
    const InstanceView& in = view.instances[i];
    const bool same = meshOf_[i] == in.mesh;
    meshOf_[i] = in.mesh;
    revisions_[i] = in.deformed ? in.deformed->revision : 0;
    if (!in.deformed) {
      deformed_[i] = {};
      continue;
    }
    const std::vector<Aabb> boxes = boxesOf(assets_.meshes[in.mesh], in.deformed->positions);
    Shape& shape = deformed_[i];
    if (same && !shape.bvh.nodes.empty())
      refit(shape.bvh, boxes);
    else
      shape.bvh = builder_.build(boxes, kLeafTriangles);
    place(shape, in.mesh, in.deformed->positions);
  }
}

FlatScene::Changed FlatScene::update(const SceneView& view) {
  Changed changed;
  const bool others = view.instances.size() != meshOf_.size() || view.changes.first || view.changes.instances;
  reshape(view, changed);
  changed.top = others || view.changes.geometry || changed.shapes;
  if (!changed.top) return changed;

  std::vector<Aabb> boxes;
  size_t held = 0;
  for (const InstanceView& in : view.instances) {
    const Shape& shape = in.deformed ? deformed_[boxes.size()] : meshes_[in.mesh];
    Aabb box;
    if (!shape.bvh.nodes.empty()) {
      box = transformed({shape.bvh.nodes[0].lo, shape.bvh.nodes[0].hi}, in.worldFromObject);
      const vec3 rounding = 1e-6f * glm::max(glm::abs(box.lo), glm::abs(box.hi));
      box.lo -= rounding;
      box.hi += rounding;
      ++held;
    }
    boxes.push_back(box);
  }
  bool build = others || top_.order.size() != held;
  if (!build) {
    refit(top_, boxes);
    build = areaOf(top_) > kStrayed * topArea_;
  }
  if (build) {
    top_ = builder_.build(boxes, 1);
    topArea_ = areaOf(top_);
  }
  instances_.clear();
  for (const uint32_t i : top_.order) {
    const InstanceView& in = view.instances[i];
    const Shape& shape = in.deformed ? deformed_[i] : meshes_[in.mesh];
    const mat4 rows = glm::transpose(glm::inverse(in.worldFromObject));
    instances_.push_back(
        {{rows[0], rows[1], rows[2]}, shape.firstNode, uint32_t(shape.bvh.nodes.size()), shape.firstTriangle, i});
  }
  return changed;
}

} // namespace lambent

// Drawing of the scene's instances: culling, sorting, binding.
#include "gi/surfaces/gpu_scene.h"

#include <algorithm>
#include <atomic>
#include <numeric>

namespace lambent {

Frustum Frustum::ofClip(const mat4& clipFromWorld) {
  const mat4 rows = glm::transpose(clipFromWorld);
  // z ≥ 0 and z ≤ w bound both conventions of depth; with an infinite far plane one of them is open by itself.
  return {{rows[3] + rows[0], rows[3] - rows[0], rows[3] + rows[1], rows[3] - rows[1], rows[2], rows[3] - rows[2]}};
}

bool Frustum::mayShow(const Aabb& box) const {
  for (const vec4& plane : planes) {
    const vec3 n(plane);
    const vec3 farthest(n.x > 0 ? box.hi.x : box.lo.x, n.y > 0 ? box.hi.y : box.lo.y, n.z > 0 ? box.hi.z : box.lo.z);
    if (glm::dot(n, farthest) + plane.w < 0) return false;
  }
  return true;
}

uint64_t GpuScene::nextVersion() {
  static std::atomic<uint64_t> last = 0;
  return ++last;
}

void GpuScene::place(std::span<const InstanceView> instances) {
  std::vector<Placed> placed;
  placed.reserve(instances.size());
  for (const InstanceView& i : instances)
    placed.push_back({i.mesh, i.worldFromObject, i.deformed ? i.deformed->revision : 0});
  noteMoves(placed);
  if (placed == placed_) return;
  layOutDeformed(instances);
  uploadDeformed(instances);
  placed_ = std::move(placed);

  std::vector<vec4> rows;
  rows.reserve(instances.size() * 3);
  items_.clear();
  bounds_ = {};
  triangleCount_ = 0;
  for (uint32_t i = 0; i < instances.size(); ++i) {
    const InstanceView& instance = instances[i];
    const mat4 transposed = glm::transpose(instance.worldFromObject);
    rows.insert(rows.end(), {transposed[0], transposed[1], transposed[2]});
    const bool mirrored = glm::determinant(glm::dmat3(instance.worldFromObject)) < 0;
    for (PrimitiveRange range : meshes_[instance.mesh].primitives) {
      if (instance.deformed) {
        range.baseVertex = deformed_.baseVertex[i];
        range.boundsObject = instance.deformed->primitiveBoundsObject[range.primitive];
      }
      items_.push_back({i, range, transformed(range.boundsObject, instance.worldFromObject),
                        instance.deformed != nullptr, mirrored});
      bounds_.add(items_.back().boundsWorld);
      triangleCount_ += range.indexCount / 3;
    }
  }
  // Sorted once here, not per draw: by material, since binding one costs more than anything else of a draw.
  std::stable_sort(items_.begin(), items_.end(), [](const Item& a, const Item& b) {
    return std::pair(a.range.material, a.mirrored) < std::pair(b.range.material, b.mirrored);
  });

  // Room for a G-buffer and the maps of a few lights per frame; of more, the ring waits for the oldest.
  commands_.reserve(std::min<uint64_t>(16 * items_.size() * sizeof(gl::IndexedDraw), kMostCommandBytes));
  const uint64_t bytes = std::max<size_t>(1, rows.size()) * sizeof(vec4);
  if (!instanceRows_ || instanceRows_.bytes() < bytes)
    instanceRows_ = gl::Buffer("scene/instances", bytes + bytes / 2, nullptr);
  if (const size_t count = instanceRows_.bytes() / (3 * sizeof(vec4));
      blends_ && (!instanceIndices_ || instanceIndices_.bytes() < count * sizeof(uint32_t))) {
    std::vector<uint32_t> indices(count);
    std::iota(indices.begin(), indices.end(), 0u);
    instanceIndices_ = gl::Buffer::of<uint32_t>("scene/instance indices", indices);
  }
  for (const gl::VertexArray* array : {&vertexArray_, &deformed_.array}) {
    if (!*array) continue;
    glVertexArrayVertexBuffer(array->name(), kInstanceBinding, instanceRows_.name(), 0, 3 * sizeof(vec4));
    if (!blends_) continue;
    glEnableVertexArrayAttrib(array->name(), kIndexBinding);
    glVertexArrayAttribIFormat(array->name(), kIndexBinding, 1, GL_UNSIGNED_INT, 0);
    glVertexArrayAttribBinding(array->name(), kIndexBinding, kIndexBinding);
    glVertexArrayVertexBuffer(array->name(), kIndexBinding, instanceIndices_.name(), 0, sizeof(uint32_t));
    glVertexArrayBindingDivisor(array->name(), kIndexBinding, 1);
  }
  changes_.upload(instanceRows_, 0, rows.size() * sizeof(vec4), rows.data());
}

/// Who stands still, and whether these are others than before.
void GpuScene::noteMoves(const std::vector<Placed>& placed) {
  if (placed.size() != placed_.size()) {
    rest_.assign(placed.size(), kRested);
    stillVersion_ = nextVersion();
    return;
  }
  bool others = false;
  for (size_t i = 0; i < placed.size(); ++i) {
    const bool stood = rest_[i] == kRested;
    rest_[i] = placed[i] == placed_[i] ? uint8_t(std::min<int>(rest_[i] + 1, kRested)) : uint8_t(0);
    others |= stood != (rest_[i] == kRested);
  }
  if (others) stillVersion_ = nextVersion();
}

namespace {

/// Whether it shows materials, and not only where their masks are cut out.
bool showsMaterials(DrawKind kind) { return kind <= DrawKind::GlossyMappedGBuffer; }
bool isDepth(DrawKind kind) {
  return kind == DrawKind::Depth || kind == DrawKind::CheckeredDepth || kind == DrawKind::SolidDepth;
}
bool showsFinish(DrawKind kind) { return kind == DrawKind::GlossyGBuffer || kind == DrawKind::GlossyMappedGBuffer; }
bool showsNormalMaps(DrawKind kind) { return kind == DrawKind::MappedGBuffer || kind == DrawKind::GlossyMappedGBuffer; }

} // namespace

const gl::Program& GpuScene::programFor(DrawKind kind, const MaterialDraw& material) const {
  gl::ProgramDesc desc{"scene.vert", isDepth(kind)                      ? "depth.frag"
                                     : kind == DrawKind::DistanceNormal ? "distance_normal.frag"
                                     : kind == DrawKind::Blended        ? "blended.frag"
                                                                        : "gbuffer.frag"};
  const bool shows = showsMaterials(kind);
  if (!shows) desc.defines.push_back("DEPTH_ONLY");
  if (kind == DrawKind::DistanceNormal) desc.defines.push_back("POSITION");
  if (material.alphaMode == AlphaMode::Blend && tested(material))
    desc.defines.push_back(kind == DrawKind::CheckeredDepth ? "CHECKERED"
                           : kind == DrawKind::SolidDepth   ? "SOLID"
                                                            : "ALPHA_BLEND");
  if (tested(material))
    desc.defines.push_back("ALPHA_MASK");
  else if (shows && context_.drawnByCpu)
    desc.defines.push_back("KEEPS_MODE");
  if (material.baseTexture && (shows || tested(material))) desc.defines.push_back("BASE_TEXTURE");
  if (material.emissiveTexture && shows) desc.defines.push_back("EMISSIVE_TEXTURE");
  if (showsFinish(kind)) desc.defines.push_back("GLOSSY");
  if (material.roughnessMetalnessTexture && (showsFinish(kind) || showsNormalMaps(kind)))
    desc.defines.push_back("FINISH_TEXTURE");
  if (showsNormalMaps(kind)) desc.defines.push_back("MAPPED_NORMALS");
  if (material.normalTexture && tangents_ && showsNormalMaps(kind)) desc.defines.push_back("NORMAL_TEXTURE");
  return context_.programs.get(desc);
}

void GpuScene::bindMaterial(uint32_t index) const {
  const MaterialDraw& material = materialDraws_[index];
  materials_.bindUniform(1, index * materialStride_, sizeof(MaterialBlock));
  gl::bindTexture(2, material.baseTexture);
  gl::bindSampler(2, material.baseSampler);
  gl::bindTexture(3, material.emissiveTexture);
  gl::bindSampler(3, material.emissiveSampler);
  gl::bindTexture(4, material.roughnessMetalnessTexture);
  gl::bindSampler(4, material.finishSampler);
  gl::bindTexture(5, material.normalTexture);
  gl::bindSampler(5, material.normalSampler);
}

uint32_t GpuScene::draw(DrawKind kind, const mat4& clipFromWorld, const vec3& eye, Instances which,
                        const mat3& wayFromPixel, bool seen) const {
  const Frustum frustum = Frustum::ofClip(clipFromWorld);
  std::vector<const Item*> shown;
  for (const Item& item : items_) {
    const Instances is = rest_[item.instance] == kRested ? Instances::Still : Instances::Moving;
    if (which != Instances::All && which != is) continue;
    if (kind == DrawKind::Blended && materialDraws_[item.range.material].alphaMode != AlphaMode::Blend) continue;
    if (frustum.mayShow(item.boundsWorld)) shown.push_back(&item);
  }
  if (shown.empty()) return 0;
  // Depth and distance look the same in any order, and without alpha test whatever the material: those go first, as one
  // call per vertex array.
  const bool shows = showsMaterials(kind);
  const auto plain = [&](const Item& item) { return !shows && !tested(materialDraws_[item.range.material]); };
  const auto culls = [&](const Item& item) { return seen && materialDraws_[item.range.material].backHidden; };
  const auto place = [&](const Item* item) { return plain(*item) ? int(item->deformed) + 2 * int(culls(*item)) : 4; };
  if (!shows)
    std::stable_sort(shown.begin(), shown.end(), [&](const Item* a, const Item* b) { return place(a) < place(b); });

  std::vector<gl::IndexedDraw> commands;
  for (const Item* item : shown)
    commands.push_back({.count = item->range.indexCount,
                        .firstIndex = item->range.firstIndex,
                        .baseVertex = int32_t(item->range.baseVertex),
                        .baseInstance = item->instance});
  const gl::BufferSlice slice = commands_.write(commands.size() * sizeof(gl::IndexedDraw), commands.data());

  glVertexAttrib4f(3, 1, 1, 1, 1); // the colour of vertices without colour (context state, not the array's)
  const gl::Program* program = nullptr;
  uint32_t draws = 0;
  for (size_t first = 0, end = 0; first < shown.size(); first = end) {
    const Item& item = *shown[first];
    const MaterialDraw& material = materialDraws_[item.range.material];
    const bool anyMaterial = plain(item), culled = culls(item);
    const auto sameRun = [&](const Item& other) {
      return other.deformed == item.deformed && plain(other) == anyMaterial &&
             (anyMaterial || other.range.material == item.range.material) && culls(other) == culled &&
             (!culled || other.mirrored == item.mirrored);
    };
    for (end = first + 1; end < shown.size() && sameRun(*shown[end]);) ++end;
    const gl::Program& wanted = programFor(kind, material);
    if (&wanted != program) {
      program = &wanted;
      program->use();
      program->set("clipFromWorld", clipFromWorld);
      program->set("eye", eye);
      if (kind == DrawKind::DistanceNormal) program->set("wayFromPixel", mat4(wayFromPixel));
    }
    if (!anyMaterial) bindMaterial(item.range.material);
    culled ? glEnable(GL_CULL_FACE) : glDisable(GL_CULL_FACE);
    if (culled) glCullFace(item.mirrored ? GL_FRONT : GL_BACK);
    glBindVertexArray(item.deformed ? deformed_.array.name() : vertexArray_.name());
    gl::drawIndexed(slice, first, end - first);
    ++draws;
    testedDraws_ += tested(material);
  }
  glDisable(GL_CULL_FACE);
  for (const GLuint unit : {2, 3, 4, 5}) gl::bindSampler(unit, 0);
  glBindVertexArray(0);
  return draws;
}

} // namespace lambent

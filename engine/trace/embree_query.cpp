#include "engine/trace/embree_query.h"

#include "engine/core/error.h"
#include "engine/core/memory.h"
#include "engine/trace/embree_filters.h"
#include "engine/trace/surface_hit.h"
#include "shaders/shared/coverage.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <new>
#include <utility>

namespace lambent {

namespace {

uint32_t keyOf(const Ray& r, bool blends) { return r.key != 0 || !blends ? r.key : rayKey(r.origin, r.direction); }

void fillRay(RTCRay& out, const Ray& r, bool blends) {
  out.org_x = r.origin.x;
  out.org_y = r.origin.y;
  out.org_z = r.origin.z;
  out.tnear = 0;
  out.dir_x = r.direction.x;
  out.dir_y = r.direction.y;
  out.dir_z = r.direction.z;
  out.time = 0;
  out.tfar = r.tMax;
  out.mask = ~0u;
  out.id = keyOf(r, blends);
  out.flags = 0;
}

bool noteMemory(void* account, ssize_t bytes, bool after) {
  MemoryAccount& a = *static_cast<MemoryAccount*>(account);
  if (!after && bytes > 0 && !a.mayGrow(bytes)) return false;
  if (bytes < 0) a.mayGrow(bytes);
  a.enter("rays", false, bytes);
  return true;
}

/// Throws where Embree had no memory for what it was asked for.
void requireMemory(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (error != RTC_ERROR_NONE) throw RunError("Embree: error " + std::to_string(int(error)));
}

void writeVertices(RTCBuffer vertices, const std::vector<vec3>& positions) {
  std::memcpy(rtcGetBufferData(vertices), positions.data(), positions.size() * sizeof(vec3));
}

} // namespace

/// Beyond 1.8e18 in an instance's space a ray is not valid to Embree, whose builds with assertions then end.
constexpr float kFarthestInEmbree = 4e17f;
constexpr float kMostGrowth = 1e12f;

struct EmbreeQuery::State {
  /// The triangles of one mesh, or of one deformed instance.
  struct BottomLevel {
    RTCScene scene = nullptr;     // null: no triangles
    RTCBuffer vertices = nullptr; // of a deformed instance, to be written again
  };

  struct Instance {
    uint32_t mesh = kNone;
    RTCGeometry geometry = nullptr; // owned by the top level
    mat3 normalFromObject{1};
    float growth = 0; // of a ray that is brought into its space
    // Only of a deformed instance; the positions and normals are copies, since the view's live no longer than it.
    BottomLevel own;
    uint64_t revision = 0;
    std::vector<vec3> positions, normals;

    bool deformed() const { return revision != 0; }
  };

  bool traces(const Ray& r) const {
    const float farthest = kFarthestInEmbree / growth; // what is not finite is farther, too
    return std::abs(r.origin.x) <= farthest && std::abs(r.origin.y) <= farthest && std::abs(r.origin.z) <= farthest &&
           isFinite(r.direction) && r.tMax > 0;
  }

  const SceneAssets& assets;
  float growth = 1; // the largest of all instances
  RTCDevice device = nullptr;
  std::vector<RTCScene> meshes;                        // null for a mesh without triangles
  std::vector<std::vector<GeometryData>> geometryData; // by mesh and primitive; addresses are handed to Embree
  RTCScene top = nullptr;
  std::vector<Instance> instances; // index = Embree instance id = index into SceneView::instances

  AlphaTest alphaTest = AlphaTest::Needed;
  bool textures = true;
  bool blends = false; // a material of the assets
  mutable std::atomic<uint64_t> alphaTests{0}, textureLookups{0};

  explicit State(const SceneAssets& a) : assets(a) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State();

  void applyAlphaTest(RTCGeometry g, uint32_t mesh, uint32_t primitive);
  void countAlphaTests() const {
    if (lambent::alphaTests > 0) alphaTests += std::exchange(lambent::alphaTests, 0);
  }
  BottomLevel build(uint32_t mesh, const std::vector<vec3>& positions, bool refits);
  void place(uint32_t index, const InstanceView& in);
  void remove(uint32_t index);
  void reshape(Instance& out, const DeformedMesh& deformed);
  /// Calls fn(geometry, primitive) for the geometries of a mesh's bottom level, and commits what it changed.
  template <class Fn> void change(RTCScene bottom, uint32_t mesh, Fn&& fn) const {
    for (uint32_t p = 0; p < assets.meshes[mesh].primitives.size(); ++p) {
      if (assets.meshes[mesh].primitives[p].triangleCount == 0) continue;
      RTCGeometry g = rtcGetGeometry(bottom, p);
      fn(g, p);
      rtcCommitGeometry(g);
    }
    rtcCommitScene(bottom);
  }
};

void EmbreeQuery::State::applyAlphaTest(RTCGeometry g, uint32_t mesh, uint32_t p) {
  const Material& material = assets.materials[assets.meshes[mesh].primitives[p].material];
  const bool tested =
      alphaTest == AlphaTest::All || (alphaTest == AlphaTest::Needed && material.alphaMode != AlphaMode::Opaque);
  rtcSetGeometryUserData(g, &geometryData[mesh][p]);
  rtcSetGeometryIntersectFilterFunction(g, tested ? alphaFilter : nullptr);
  rtcSetGeometryOccludedFilterFunction(g, tested ? alphaFilter : nullptr);
}

/// `refits`: the vertices will move. The hierarchy is then built once and only its boxes follow, which costs about a
/// tenth of building it; it stays exact, but gets slower to trace the farther the shape departs from the one it was
/// built for.
EmbreeQuery::State::BottomLevel EmbreeQuery::State::build(uint32_t meshIndex, const std::vector<vec3>& positions,
                                                          bool refits) {
  const Mesh& mesh = assets.meshes[meshIndex];
  if (mesh.triangles.empty()) return {};
  BottomLevel out{rtcNewScene(device)};
  // Without it one ray of 700 at the joints of a closed box slips out. Path tracing takes 4 to 8 % longer.
  rtcSetSceneFlags(out.scene, RTC_SCENE_FLAG_ROBUST | kFilteredByRay);
  if (refits) { // without these two Embree rebuilds, whatever the geometries ask for
    rtcSetSceneFlags(out.scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC | kFilteredByRay);
    rtcSetSceneBuildQuality(out.scene, RTC_BUILD_QUALITY_LOW);
  }
  // Embree reads four floats per vertex, so one more follows the last: our own copies, shared by the primitives.
  RTCBuffer vertices = rtcNewBuffer(device, positions.size() * sizeof(vec3) + sizeof(float));
  RTCBuffer indices = rtcNewBuffer(device, mesh.triangles.size() * sizeof(uvec3));
  if (!vertices || !indices) {
    if (vertices) rtcReleaseBuffer(vertices);
    if (indices) rtcReleaseBuffer(indices);
    rtcReleaseScene(out.scene);
    throw std::bad_alloc();
  }
  writeVertices(vertices, positions);
  std::memcpy(rtcGetBufferData(indices), mesh.triangles.data(), mesh.triangles.size() * sizeof(uvec3));
  for (uint32_t p = 0; p < mesh.primitives.size(); ++p) {
    const Primitive& primitive = mesh.primitives[p];
    if (primitive.triangleCount == 0) continue;
    RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    if (refits) rtcSetGeometryBuildQuality(g, RTC_BUILD_QUALITY_REFIT);
    rtcSetGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices, 0, sizeof(vec3), positions.size());
    rtcSetGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices,
                         primitive.firstTriangle * sizeof(uvec3), sizeof(uvec3), primitive.triangleCount);
    applyAlphaTest(g, meshIndex, p);
    rtcCommitGeometry(g);
    rtcAttachGeometryByID(out.scene, g, p);
    rtcReleaseGeometry(g);
  }
  if (refits)
    out.vertices = vertices;
  else
    rtcReleaseBuffer(vertices);
  rtcReleaseBuffer(indices);
  rtcCommitScene(out.scene);
  return out;
}

/// Takes over the vertices of a deformed instance.
void EmbreeQuery::State::reshape(Instance& out, const DeformedMesh& deformed) {
  out.positions = deformed.positions;
  out.normals = deformed.normals;
  if (!out.own.scene) {
    out.own = build(out.mesh, deformed.positions, true);
    out.revision = deformed.revision;
    return;
  }
  out.revision = deformed.revision;
  writeVertices(out.own.vertices, deformed.positions);
  change(out.own.scene, out.mesh,
         [](RTCGeometry g, uint32_t) { rtcUpdateGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0); });
}

void EmbreeQuery::State::remove(uint32_t index) {
  Instance& instance = instances[index];
  if (instance.geometry) rtcDetachGeometry(top, index);
  if (instance.own.scene) rtcReleaseScene(instance.own.scene);
  if (instance.own.vertices) rtcReleaseBuffer(instance.own.vertices);
  instance = {};
}

/// Makes Embree's instance `index` what the view's is. What has no size is met by no ray.
void EmbreeQuery::State::place(uint32_t index, const InstanceView& in) {
  Instance& out = instances[index];
  if (out.mesh != in.mesh || out.deformed() != (in.deformed != nullptr)) {
    remove(index);
    out.mesh = in.mesh;
  }
  if (in.deformed && in.deformed->revision != out.revision) reshape(out, *in.deformed);
  const mat4 objectFromWorld = glm::inverse(in.worldFromObject);
  out.growth = 0;
  for (int c = 0; c < 4; ++c) out.growth = std::max(out.growth, maxComponent(glm::abs(vec3(objectFromWorld[c]))));
  if (!isFinite(objectFromWorld) || out.growth > kMostGrowth) {
    if (out.geometry) rtcDetachGeometry(top, index);
    out.geometry = nullptr;
    out.growth = 0;
    return;
  }
  if (RTCScene bottom = in.deformed ? out.own.scene : meshes[in.mesh]; bottom && !out.geometry) {
    out.geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(out.geometry, bottom);
    rtcAttachGeometryByID(top, out.geometry, index);
    rtcReleaseGeometry(out.geometry); // the top level holds it now
  }
  out.normalFromObject = glm::transpose(glm::inverse(mat3(in.worldFromObject)));
  if (!out.geometry) return;
  rtcSetGeometryTransform(out.geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &in.worldFromObject[0][0]);
  rtcCommitGeometry(out.geometry);
}

EmbreeQuery::EmbreeQuery(const SceneAssets& assets) : state_(std::make_unique<State>(assets)) {
  State& s = *state_;
  s.device = rtcNewDevice(nullptr);
  if (!s.device) throw RunError("Embree: no device (error " + std::to_string(int(rtcGetDeviceError(nullptr))) + ")");
  rtcSetDeviceMemoryMonitorFunction(s.device, noteMemory, &MemoryAccount::current());
  takeAssets();
  s.top = rtcNewScene(s.device);
  rtcSetSceneFlags(s.top, RTC_SCENE_FLAG_ROBUST | kFilteredByRay);
  rtcCommitScene(s.top);
  requireMemory(s.device);
}

void EmbreeQuery::takeAssets() {
  State& s = *state_;
  s.blends = s.assets.blends();
  for (uint32_t m = 0; m < s.assets.meshes.size(); ++m) {
    const Mesh& mesh = s.assets.meshes[m];
    if (m < s.meshes.size()) {
      if (RTCScene& gone = s.meshes[m]; gone && mesh.triangles.empty()) rtcReleaseScene(std::exchange(gone, nullptr));
      continue;
    }
    std::vector<GeometryData>& data = s.geometryData.emplace_back();
    for (uint32_t p = 0; p < mesh.primitives.size(); ++p) data.push_back({&s.assets, m, p});
    s.meshes.push_back(s.build(m, mesh.positions, false).scene);
  }
  requireMemory(s.device);
}

EmbreeQuery::~EmbreeQuery() = default;
EmbreeQuery::State::~State() {
  for (uint32_t i = 0; i < instances.size(); ++i) remove(i);
  if (top) rtcReleaseScene(top);
  for (RTCScene m : meshes)
    if (m) rtcReleaseScene(m);
  if (device) rtcReleaseDevice(device);
}

uint32_t EmbreeQuery::update(const SceneView& view, bool all) {
  State& s = *state_;
  const size_t before = s.instances.size(), now = view.instances.size();
  uint32_t placed = 0;
  measure(view.boundsWorld);
  for (size_t i = now; i < before; ++i) s.remove(uint32_t(i));
  s.instances.resize(now);
  for (uint32_t i = 0; i < now; ++i) {
    const InstanceView& in = view.instances[i];
    const State::Instance& out = s.instances[i];
    const bool other = out.mesh != in.mesh || out.revision != (in.deformed ? in.deformed->revision : 0);
    if (!other && !in.moved && !view.changes.instances && !view.changes.first && !all) continue;
    s.place(i, in);
    ++placed;
  }
  if (placed > 0 || before != now) {
    s.growth = 1;
    for (const State::Instance& i : s.instances) s.growth = std::max(s.growth, i.growth);
    rtcCommitScene(s.top);
    requireMemory(s.device);
  }
  return placed;
}

void EmbreeQuery::setAlphaTest(AlphaTest test) {
  State& s = *state_;
  if (s.alphaTest == test) return;
  s.alphaTest = test;
  const auto apply = [&](RTCScene scene, uint32_t mesh) {
    if (scene) s.change(scene, mesh, [&](RTCGeometry g, uint32_t p) { s.applyAlphaTest(g, mesh, p); });
  };
  for (uint32_t m = 0; m < s.meshes.size(); ++m) apply(s.meshes[m], m);
  for (const State::Instance& i : s.instances) apply(i.own.scene, i.mesh);
  for (const State::Instance& i : s.instances)
    if (i.geometry) rtcCommitGeometry(i.geometry);
  rtcCommitScene(s.top);
}

void EmbreeQuery::setTextures(bool on) { state_->textures = on; }

EmbreeQuery::Work EmbreeQuery::takeWork() const {
  return {state_->alphaTests.exchange(0), state_->textureLookups.exchange(0)};
}

void EmbreeQuery::closest(std::span<const Ray> rays, std::span<SurfaceHit> hits) const { trace(rays, hits, false); }

void EmbreeQuery::seen(std::span<const Ray> rays, std::span<SurfaceHit> hits) const { trace(rays, hits, true); }

void EmbreeQuery::trace(std::span<const Ray> rays, std::span<SurfaceHit> hits, bool eye) const {
  CHECK_EQ(rays.size(), hits.size());
  const State& s = *state_;
  TraceArguments arguments;
  if (eye) arguments.hideBacks();
  uint64_t lookups = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    SurfaceHit& hit = hits[i] = {};
    if (!s.traces(rays[i])) continue;
    RTCRayHit rh;
    fillRay(rh.ray, rays[i], s.blends);
    rh.hit.geomID = rh.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    if (s.blends && !eye) arguments.context.from = blendedFrom() / glm::length(rays[i].direction);
    intersect1(s.top, arguments, &rh);
    if (rh.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;

    const State::Instance& instance = s.instances[rh.hit.instID[0]];
    const Mesh& mesh = s.assets.meshes[instance.mesh];
    const bool deformed = instance.deformed();
    hit = surfaceAt(s.assets,
                    {mesh, deformed ? instance.positions : mesh.positions, deformed ? instance.normals : mesh.normals,
                     instance.normalFromObject},
                    {rh.ray.tfar, rh.hit.instID[0], rh.hit.geomID, rh.hit.primID, {rh.hit.u, rh.hit.v}}, rays[i],
                    s.textures, lookups);
    if (s.alphaTest == AlphaTest::None) hit.share = 1;
  }
  if (lookups > 0) s.textureLookups += lookups;
  s.countAlphaTests();
}

void EmbreeQuery::distances(std::span<const Ray> rays, std::span<float> t) const {
  CHECK_EQ(rays.size(), t.size());
  // 16-wide packets: callers pass map texels in row order, which are coherent.
  TraceArguments arguments;
  for (size_t first = 0; first < rays.size(); first += 16) {
    alignas(64) RTCRayHit16 packet;
    alignas(64) std::array<int, 16> valid;
    const size_t count = std::min<size_t>(16, rays.size() - first);
    for (size_t j = 0; j < 16; ++j) {
      const bool traced = j < count && state_->traces(rays[first + j]);
      const Ray ray = traced ? rays[first + j] : Ray{}; // Embree looks at masked lanes too (AVX2, assertions on)
      valid[j] = traced ? -1 : 0;
      packet.ray.org_x[j] = ray.origin.x;
      packet.ray.org_y[j] = ray.origin.y;
      packet.ray.org_z[j] = ray.origin.z;
      packet.ray.dir_x[j] = ray.direction.x;
      packet.ray.dir_y[j] = ray.direction.y;
      packet.ray.dir_z[j] = ray.direction.z;
      packet.ray.tnear[j] = packet.ray.time[j] = 0;
      packet.ray.tfar[j] = ray.tMax;
      packet.ray.mask[j] = ~0u;
      packet.ray.id[j] = ray.key;
      packet.ray.flags[j] = 0;
      packet.hit.geomID[j] = packet.hit.instID[0][j] = RTC_INVALID_GEOMETRY_ID;
    }
    if (state_->blends) {
      for (size_t j = 0; j < count; ++j) packet.ray.id[j] = keyOf(rays[first + j], true);
      arguments.context.from = blendedFrom() / glm::length(rays[first].direction); // all are of one length
    }
    intersect16(valid.data(), state_->top, arguments, &packet);
    for (size_t j = 0; j < count; ++j)
      t[first + j] = valid[j] && packet.hit.geomID[j] != RTC_INVALID_GEOMETRY_ID ? packet.ray.tfar[j] : kInfinity;
  }
  state_->countAlphaTests();
}

void EmbreeQuery::occluded(std::span<const Ray> rays, std::span<uint8_t> blocked) const {
  CHECK_EQ(rays.size(), blocked.size());
  TraceArguments arguments;
  for (size_t i = 0; i < rays.size(); ++i) {
    blocked[i] = 0;
    if (!state_->traces(rays[i])) continue;
    RTCRay ray;
    fillRay(ray, rays[i], state_->blends);
    if (state_->blends) arguments.context.from = blendedFrom() / glm::length(rays[i].direction);
    occluded1(state_->top, arguments, &ray);
    blocked[i] = ray.tfar < 0;
  }
  state_->countAlphaTests();
}

void EmbreeQuery::transmittance(std::span<const Ray> rays, std::span<float> passes) const {
  if (!state_->blends) return RayQuery::transmittance(rays, passes);
  CHECK_EQ(rays.size(), passes.size());
  TraceArguments arguments;
  for (size_t i = 0; i < rays.size(); ++i) {
    passes[i] = 1;
    if (!state_->traces(rays[i])) continue;
    arguments.context.passes = &passes[i];
    arguments.context.from = blendedFrom() / glm::length(rays[i].direction);
    RTCRay ray;
    fillRay(ray, rays[i], false);
    occluded1(state_->top, arguments, &ray);
    if (ray.tfar < 0) passes[i] = 0;
  }
  state_->countAlphaTests();
}

std::string EmbreeQuery::version() { return RTC_VERSION_STRING; }

} // namespace lambent

#include "engine/trace/embree_query.h"

#include "engine/core/error.h"

#if EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <array>
#include <cstring>

namespace lambent {

namespace {

/// What the alpha filter and hit shading need to know about a geometry of a bottom-level scene.
struct GeometryData {
  const SceneAssets* assets;
  uint32_t mesh, primitive;
};

struct Corner {
  uvec3 vertices;
  float w0, u, v;

  template <class T> T interpolate(const std::vector<T>& a) const {
    return a[vertices.x] * w0 + a[vertices.y] * u + a[vertices.z] * v;
  }
};

Corner cornerOf(const Mesh& mesh, const Primitive& primitive, uint32_t triangle, float u, float v) {
  return {mesh.triangles[primitive.firstTriangle + triangle], 1 - u - v, u, v};
}

vec2 uvOf(const Mesh& mesh, const Corner& c, const TextureRef& ref) {
  const auto& uv = ref.uvSet == 0 ? mesh.uv0 : mesh.uv1;
  return uv.empty() ? vec2(0) : c.interpolate(uv);
}

vec4 baseColourAt(const SceneAssets& assets, const Mesh& mesh, const Material& material, const Corner& c) {
  vec4 colour(material.baseColor, material.alpha);
  if (material.baseColorTexture.image != kNone)
    colour *= sampleTexture(assets, material.baseColorTexture, uvOf(mesh, c, material.baseColorTexture));
  if (!mesh.colors.empty()) colour *= c.interpolate(mesh.colors);
  return colour;
}

/// Lets rays through where an alpha-masked material is cut out.
void alphaFilter(const RTCFilterFunctionNArguments* args) {
  const auto& data = *static_cast<const GeometryData*>(args->geometryUserPtr);
  const Mesh& mesh = data.assets->meshes[data.mesh];
  const Primitive& primitive = mesh.primitives[data.primitive];
  const Material& material = data.assets->materials[primitive.material];
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] != -1) continue;
    const Corner c = cornerOf(mesh, primitive, RTCHitN_primID(args->hit, args->N, i), RTCHitN_u(args->hit, args->N, i),
                              RTCHitN_v(args->hit, args->N, i));
    if (baseColourAt(*data.assets, mesh, material, c).w < material.alphaCutoff) args->valid[i] = 0;
  }
}

bool traceable(const Ray& r) { return isFinite(r.origin) && isFinite(r.direction) && r.tMax > 0; }

#if EMBREE_MAJOR >= 4
struct TraceArguments {
  RTCIntersectArguments intersect;
  RTCOccludedArguments occluded;
  TraceArguments() {
    rtcInitIntersectArguments(&intersect);
    rtcInitOccludedArguments(&occluded);
  }
};
void intersect1(RTCScene s, TraceArguments& a, RTCRayHit* r) { rtcIntersect1(s, r, &a.intersect); }
void occluded1(RTCScene s, TraceArguments& a, RTCRay* r) { rtcOccluded1(s, r, &a.occluded); }
void intersect16(const int* valid, RTCScene s, TraceArguments& a, RTCRayHit16* r) {
  a.intersect.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcIntersect16(valid, s, r, &a.intersect);
}
#else
struct TraceArguments {
  RTCIntersectContext context;
  TraceArguments() { rtcInitIntersectContext(&context); }
};
void intersect1(RTCScene s, TraceArguments& a, RTCRayHit* r) { rtcIntersect1(s, &a.context, r); }
void occluded1(RTCScene s, TraceArguments& a, RTCRay* r) { rtcOccluded1(s, &a.context, r); }
void intersect16(const int* valid, RTCScene s, TraceArguments& a, RTCRayHit16* r) {
  a.context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect16(valid, s, &a.context, r);
}
#endif

void fillRay(RTCRay& out, const Ray& r) {
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
  out.id = 0;
  out.flags = 0;
}

} // namespace

struct EmbreeQuery::State {
  struct Instance {
    uint32_t mesh = kNone;
    RTCGeometry geometry = nullptr; // owned by the top level
    mat3 normalFromObject{1};
  };

  const SceneAssets& assets;
  RTCDevice device = nullptr;
  std::vector<RTCScene> meshes; // null for a mesh without triangles
  std::vector<GeometryData> geometryData;
  RTCScene top = nullptr;
  std::vector<Instance> instances; // index = Embree instance id = index into SceneView::instances

  explicit State(const SceneAssets& a) : assets(a) {}
};

EmbreeQuery::EmbreeQuery(const SceneAssets& assets) : state_(std::make_unique<State>(assets)) {
  State& s = *state_;
  s.device = rtcNewDevice(nullptr);
  if (!s.device) throw RunError("Embree: no device (error " + std::to_string(int(rtcGetDeviceError(nullptr))) + ")");
  size_t geometries = 0;
  for (const Mesh& mesh : assets.meshes) geometries += mesh.primitives.size();
  s.geometryData.reserve(geometries); // addresses are handed to Embree
  for (uint32_t m = 0; m < assets.meshes.size(); ++m) {
    const Mesh& mesh = assets.meshes[m];
    if (mesh.triangles.empty()) {
      s.meshes.push_back(nullptr);
      continue;
    }
    RTCScene scene = rtcNewScene(s.device);
    // Embree reads four floats per vertex, so one more follows the last: our own copies, shared by the primitives.
    RTCBuffer vertices = rtcNewBuffer(s.device, mesh.positions.size() * sizeof(vec3) + sizeof(float));
    std::memcpy(rtcGetBufferData(vertices), mesh.positions.data(), mesh.positions.size() * sizeof(vec3));
    RTCBuffer indices = rtcNewBuffer(s.device, mesh.triangles.size() * sizeof(uvec3));
    std::memcpy(rtcGetBufferData(indices), mesh.triangles.data(), mesh.triangles.size() * sizeof(uvec3));
    for (uint32_t p = 0; p < mesh.primitives.size(); ++p) {
      const Primitive& primitive = mesh.primitives[p];
      if (primitive.triangleCount == 0) continue;
      RTCGeometry g = rtcNewGeometry(s.device, RTC_GEOMETRY_TYPE_TRIANGLE);
      rtcSetGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices, 0, sizeof(vec3),
                           mesh.positions.size());
      rtcSetGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices,
                           primitive.firstTriangle * sizeof(uvec3), sizeof(uvec3), primitive.triangleCount);
      if (assets.materials[primitive.material].alphaMode == AlphaMode::Mask) {
        s.geometryData.push_back({&assets, m, p});
        rtcSetGeometryUserData(g, &s.geometryData.back());
        rtcSetGeometryIntersectFilterFunction(g, alphaFilter);
        rtcSetGeometryOccludedFilterFunction(g, alphaFilter);
      }
      rtcCommitGeometry(g);
      rtcAttachGeometryByID(scene, g, p);
      rtcReleaseGeometry(g);
    }
    rtcReleaseBuffer(vertices);
    rtcReleaseBuffer(indices);
    rtcCommitScene(scene);
    s.meshes.push_back(scene);
  }
  s.top = rtcNewScene(s.device);
  rtcCommitScene(s.top);
}

EmbreeQuery::~EmbreeQuery() {
  rtcReleaseScene(state_->top);
  for (RTCScene m : state_->meshes)
    if (m) rtcReleaseScene(m);
  rtcReleaseDevice(state_->device);
}

void EmbreeQuery::update(const SceneView& view) {
  State& s = *state_;
  bool dirty = s.instances.size() != view.instances.size();
  for (uint32_t i = uint32_t(view.instances.size()); i < s.instances.size(); ++i)
    if (s.instances[i].geometry) rtcDetachGeometry(s.top, i);
  const size_t before = s.instances.size();
  s.instances.resize(view.instances.size());
  for (uint32_t i = 0; i < view.instances.size(); ++i) {
    const InstanceView& in = view.instances[i];
    State::Instance& out = s.instances[i];
    const bool isNew = i >= before || out.mesh != in.mesh;
    if (!isNew && !in.moved && !view.changes.instances && !view.changes.first) continue;
    dirty = true;
    if (isNew) {
      if (out.geometry) rtcDetachGeometry(s.top, i);
      out = {in.mesh, nullptr, mat3(1)};
      if (RTCScene mesh = s.meshes[in.mesh]) {
        out.geometry = rtcNewGeometry(s.device, RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(out.geometry, mesh);
        rtcAttachGeometryByID(s.top, out.geometry, i);
        rtcReleaseGeometry(out.geometry); // the top level holds it now
      }
    }
    out.normalFromObject = glm::transpose(glm::inverse(mat3(in.worldFromObject)));
    if (!out.geometry) continue;
    rtcSetGeometryTransform(out.geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &in.worldFromObject[0][0]);
    rtcCommitGeometry(out.geometry);
  }
  if (dirty) rtcCommitScene(s.top);
}

void EmbreeQuery::closest(std::span<const Ray> rays, std::span<SurfaceHit> hits) const {
  CHECK_EQ(rays.size(), hits.size());
  const State& s = *state_;
  TraceArguments arguments;
  for (size_t i = 0; i < rays.size(); ++i) {
    SurfaceHit& hit = hits[i] = {};
    if (!traceable(rays[i])) continue;
    RTCRayHit rh;
    fillRay(rh.ray, rays[i]);
    rh.hit.geomID = rh.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    intersect1(s.top, arguments, &rh);
    if (rh.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;

    const State::Instance& instance = s.instances[rh.hit.instID[0]];
    const Mesh& mesh = s.assets.meshes[instance.mesh];
    const Primitive& primitive = mesh.primitives[rh.hit.geomID];
    const Material& material = s.assets.materials[primitive.material];
    const Corner c = cornerOf(mesh, primitive, rh.hit.primID, rh.hit.u, rh.hit.v);
    const vec3 p0 = mesh.positions[c.vertices.x];
    const vec3 front =
        instance.normalFromObject * glm::cross(mesh.positions[c.vertices.y] - p0, mesh.positions[c.vertices.z] - p0);
    const float length = glm::length(front);
    if (!(length > 0)) continue; // squashed to nothing by the instance's scale
    const bool fromFront = glm::dot(front, rays[i].direction) < 0;
    hit.t = rh.ray.tfar;
    hit.position = rays[i].origin + rays[i].direction * hit.t;
    hit.geometricNormal = front * ((fromFront ? 1.0f : -1.0f) / length);
    const vec3 shading = instance.normalFromObject * c.interpolate(mesh.normals) * (fromFront ? 1.0f : -1.0f);
    const float shadingLength = glm::length(shading);
    // A shading normal that looks away from the ray would light the surface from behind.
    hit.normal =
        shadingLength > 0 && glm::dot(shading, rays[i].direction) < 0 ? shading / shadingLength : hit.geometricNormal;
    hit.albedo = glm::clamp(vec3(baseColourAt(s.assets, mesh, material, c)), 0.0f, 1.0f);
    if (material.emits() && (fromFront || material.doubleSided))
      hit.emission = material.emission *
                     vec3(sampleTexture(s.assets, material.emissiveTexture, uvOf(mesh, c, material.emissiveTexture)));
    hit.instance = rh.hit.instID[0];
    hit.primitive = rh.hit.geomID;
    hit.triangle = rh.hit.primID;
    hit.barycentric = {rh.hit.u, rh.hit.v};
  }
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
      const Ray ray = rays[first + std::min(j, count - 1)];
      valid[j] = j < count && traceable(ray) ? -1 : 0;
      packet.ray.org_x[j] = ray.origin.x;
      packet.ray.org_y[j] = ray.origin.y;
      packet.ray.org_z[j] = ray.origin.z;
      packet.ray.dir_x[j] = ray.direction.x;
      packet.ray.dir_y[j] = ray.direction.y;
      packet.ray.dir_z[j] = ray.direction.z;
      packet.ray.tnear[j] = packet.ray.time[j] = 0;
      packet.ray.tfar[j] = ray.tMax;
      packet.ray.mask[j] = ~0u;
      packet.ray.id[j] = packet.ray.flags[j] = 0;
      packet.hit.geomID[j] = packet.hit.instID[0][j] = RTC_INVALID_GEOMETRY_ID;
    }
    intersect16(valid.data(), state_->top, arguments, &packet);
    for (size_t j = 0; j < count; ++j)
      t[first + j] = valid[j] && packet.hit.geomID[j] != RTC_INVALID_GEOMETRY_ID ? packet.ray.tfar[j] : kInfinity;
  }
}

void EmbreeQuery::occluded(std::span<const Ray> rays, std::span<uint8_t> blocked) const {
  CHECK_EQ(rays.size(), blocked.size());
  TraceArguments arguments;
  for (size_t i = 0; i < rays.size(); ++i) {
    blocked[i] = 0;
    if (!traceable(rays[i])) continue;
    RTCRay ray;
    fillRay(ray, rays[i]);
    occluded1(state_->top, arguments, &ray);
    blocked[i] = ray.tfar < 0;
  }
}

std::string EmbreeQuery::version() { return RTC_VERSION_STRING; }

} // namespace lambent

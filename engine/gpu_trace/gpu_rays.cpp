#include "engine/gpu_trace/gpu_rays.h"

#include "engine/core/error.h"
#include "engine/trace/surface_hit.h"

#include <algorithm>
#include <bit>

namespace lambent {

namespace {

/// As rays.comp reads it.
struct ListedRay {
  vec3 origin;
  float tMax;
  vec3 direction;
  uint32_t key = 0;
};

constexpr size_t kMostAtOnce = 1 << 20; // rays of one dispatch: 32 MiB

template <class T> gl::Buffer bufferOf(const char* label, std::span<const T> data) {
  static const T kNothing[1] = {}; // a buffer has at least one element
  return gl::Buffer::of<T>(label, data.empty() ? std::span<const T>(kNothing) : data);
}

/// Primitive of a mesh's triangle.
uint32_t primitiveOf(const Mesh& mesh, uint32_t triangle) {
  const auto after = std::find_if(mesh.primitives.begin(), mesh.primitives.end(),
                                  [&](const Primitive& p) { return triangle < p.firstTriangle + p.triangleCount; });
  CHECK(after != mesh.primitives.end());
  return uint32_t(after - mesh.primitives.begin());
}

} // namespace

struct GpuRays::Hit {
  float t;
  uint32_t instance, triangle;
  vec2 barycentric;
};

GpuRays::GpuRays(gl::ProgramCache& programs, const SceneAssets& assets)
    : programs_(programs), assets_(assets), scene_(assets), masks_(bufferOf("rays/masks", scene_.masks())),
      texels_(bufferOf("rays/alpha texels", scene_.texels())) {}

/// Bytes from `offset` on; all of them into a new buffer where the old one is too small.
void GpuRays::upload(gl::Buffer& buffer, const char* label, uint64_t offset, uint64_t bytes, const void* all) {
  if (!buffer || buffer.bytes() < bytes) {
    buffer = gl::Buffer(label, std::bit_ceil(std::max<uint64_t>(bytes, 64)), nullptr);
    offset = 0;
  }
  if (bytes == offset) return;
  changes_.reserve(bytes - offset);
  changes_.upload(buffer, offset, bytes - offset, static_cast<const std::byte*>(all) + offset);
}

void GpuRays::update(const SceneView& view) {
  measure(view.boundsWorld);
  const FlatScene::Changed changed = scene_.update(view);
  if (changed.shapes || !nodes_) {
    const bool all = !nodes_;
    const auto nodes = scene_.nodes();
    const auto triangles = scene_.triangles();
    upload(nodes_, "rays/nodes", all ? 0 : scene_.staticNodes() * sizeof(BvhNode), nodes.size_bytes(), nodes.data());
    upload(triangles_, "rays/triangles", all ? 0 : scene_.staticTriangles() * sizeof(RayTriangle),
           triangles.size_bytes(), triangles.data());
  }
  if (!changed.top && top_) return;
  upload(top_, "rays/upper nodes", 0, scene_.top().size_bytes(), scene_.top().data());
  upload(instances_, "rays/instances", 0, scene_.instances().size_bytes(), scene_.instances().data());
  placed_.assign(view.instances.begin(), view.instances.end());
}

void GpuRays::bind(const gl::Program& program) const {
  int binding = 1;
  for (const gl::Buffer* buffer : {&top_, &instances_, &nodes_, &triangles_, &masks_, &texels_})
    buffer->bindStorage(binding++);
  program.set("topNodeCount", int(scene_.top().size()));
  program.set("testAlpha", alphaTest_ != AlphaTest::None ? 1 : 0);
  program.set("blendedFrom", blendedFrom());
}

/// What rays.comp says of each ray. Those that are not to be traced are sent nowhere.
template <class T> std::vector<T> GpuRays::trace(std::span<const Ray> rays, bool any) const {
  const gl::Program& program = programs_.get(
      {.defines = any ? std::vector<std::string>{"ANY"} : std::vector<std::string>{}, .compute = "rays.comp"});
  std::vector<T> out(rays.size());
  for (size_t first = 0; first < rays.size(); first += kMostAtOnce) {
    const size_t count = std::min(kMostAtOnce, rays.size() - first);
    std::vector<ListedRay> listed;
    for (const Ray& r : rays.subspan(first, count))
      listed.push_back(traceable(r) ? ListedRay{r.origin, r.tMax, r.direction, r.key}
                                    : ListedRay{vec3(0), -1, vec3(0, 0, 1)});
    const gl::Buffer in = gl::Buffer::of<ListedRay>("rays/list", listed);
    const gl::Buffer answers("rays/answers", count * sizeof(T), nullptr);
    program.use();
    program.set("count", int(count));
    bind(program);
    in.bindStorage(0);
    answers.bindStorage(7);
    gl::dispatch(int((count + 63) / 64));
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    answers.read(0, std::span(out).subspan(first, count));
  }
  return out;
}

void GpuRays::seen(std::span<const Ray>, std::span<SurfaceHit>) const {
  CHECK(!"asked: what an eye sees is Embree's alone");
}

void GpuRays::closest(std::span<const Ray> rays, std::span<SurfaceHit> hits) const {
  CHECK_EQ(rays.size(), hits.size());
  const std::vector<Hit> met = trace<Hit>(rays, false);
  uint64_t lookups = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    hits[i] = {};
    if (met[i].instance == kNone) continue;
    const InstanceView& in = placed_[met[i].instance];
    const Mesh& mesh = assets_.meshes[in.mesh];
    const uint32_t primitive = primitiveOf(mesh, met[i].triangle);
    hits[i] = surfaceAt(assets_,
                        {mesh, in.deformed ? in.deformed->positions : mesh.positions,
                         in.deformed ? in.deformed->normals : mesh.normals,
                         glm::transpose(glm::inverse(mat3(in.worldFromObject)))},
                        {met[i].t, met[i].instance, primitive,
                         met[i].triangle - mesh.primitives[primitive].firstTriangle, met[i].barycentric},
                        rays[i], true, lookups);
    if (alphaTest_ == AlphaTest::None) hits[i].share = 1;
  }
}

void GpuRays::distances(std::span<const Ray> rays, std::span<float> t) const {
  CHECK_EQ(rays.size(), t.size());
  const std::vector<Hit> met = trace<Hit>(rays, false);
  for (size_t i = 0; i < rays.size(); ++i) t[i] = met[i].t;
}

void GpuRays::occluded(std::span<const Ray> rays, std::span<uint8_t> blocked) const {
  CHECK_EQ(rays.size(), blocked.size());
  const std::vector<uint32_t> met = trace<uint32_t>(rays, true);
  for (size_t i = 0; i < rays.size(); ++i) blocked[i] = uint8_t(met[i]);
}

} // namespace lambent

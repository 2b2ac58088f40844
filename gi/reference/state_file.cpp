// Layout, little-endian as the machine's own: Header, then the pixels' sums in row order, then a checksum of them.
#include "gi/reference/state_file.h"

#include "engine/core/error.h"
#include "engine/core/rng.h"

#include <cstring>
#include <fstream>

namespace lambent {

namespace {

constexpr char kMagic[8] = {'L', 'A', 'M', 'B', 'R', 'E', 'F', '\n'};
// Counts up when the file or the meaning of the sums (the sampling included) changes.
constexpr uint32_t kVersion = 1;

struct Header {
  char magic[8];
  uint32_t version, width, height, samples;
  uint64_t key;
};
static_assert(sizeof(Header) == 32 && sizeof(PixelSums) == 15 * sizeof(double));

class Hash {
 public:
  void bytes(const void* data, size_t size) {
    const char* at = static_cast<const char*>(data);
    for (; size >= 8; at += 8, size -= 8) word(at, 8);
    if (size > 0) word(at, size);
  }
  template <class T> void value(const T& v) {
    static_assert(std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>);
    bytes(&v, sizeof v);
  }
  template <int N> void value(const glm::vec<N, float>& v) {
    for (int i = 0; i < N; ++i) value(v[i]);
  }
  template <class T> void values(const std::vector<T>& v) {
    value(v.size());
    bytes(v.data(), v.size() * sizeof(T));
  }
  uint64_t result() const { return state_; }

 private:
  void word(const char* at, size_t size) {
    uint64_t w = 0;
    std::memcpy(&w, at, size);
    state_ = mix64(state_ ^ w) + 0x9e3779b97f4a7c15ull;
  }
  uint64_t state_ = kVersion;
};

void add(Hash& hash, const TextureRef& t) {
  hash.value(t.image);
  hash.value(t.uvSet);
  hash.value(t.wrapU);
  hash.value(t.wrapV);
  hash.value(t.nearest);
  hash.bytes(&t.uvTransform, sizeof t.uvTransform);
}

/// What only glossy receivers depend on stays out of the others' hashes.
void add(Hash& hash, const SceneAssets& assets, bool glossy) {
  for (const Mesh& mesh : assets.meshes) {
    hash.values(mesh.positions);
    hash.values(mesh.normals);
    hash.values(mesh.uv0);
    hash.values(mesh.uv1);
    hash.values(mesh.colors);
    hash.values(mesh.triangles);
    for (const Primitive& p : mesh.primitives) hash.value(p.firstTriangle), hash.value(p.material);
  }
  for (const Material& m : assets.materials) {
    hash.value(m.baseColor);
    hash.value(m.alpha);
    add(hash, m.baseColorTexture);
    hash.value(m.emission);
    add(hash, m.emissiveTexture);
    hash.value(m.alphaMode);
    hash.value(m.alphaCutoff);
    hash.value(m.doubleSided);
    if (!glossy) continue;
    hash.value(m.roughness);
    hash.value(m.metalness);
    add(hash, m.finishTexture);
  }
  for (const TextureImage& image : assets.images) {
    if (!image.srgb && !glossy) continue;
    hash.value(image.width);
    hash.value(image.srgb);
    hash.values(image.texels);
  }
}

void add(Hash& hash, const LightView& light) {
  hash.value(light.type);
  hash.value(light.position);
  hash.value(light.direction);
  hash.value(light.intensity);
  hash.value(light.range);
  hash.value(light.innerConeCos);
  hash.value(light.outerConeCos);
}

uint64_t checksumOf(const ReferenceSums& sums) {
  Hash hash;
  hash.value(sums.samples);
  hash.bytes(sums.pixels.data(), sums.pixels.size() * sizeof(PixelSums));
  return hash.result();
}

} // namespace

uint64_t referenceKey(const SceneView& view, const ReferenceInputs& in) {
  Hash hash;
  if (view.assets) add(hash, *view.assets, in.glossy != nullptr);
  for (const InstanceView& i : view.instances) {
    hash.value(i.mesh);
    hash.bytes(&i.worldFromObject, sizeof i.worldFromObject);
    if (!i.deformed) continue;
    hash.values(i.deformed->positions);
    hash.values(i.deformed->normals);
  }
  for (const LightView& light : view.lights) add(hash, light);
  for (const float number : view.sky.numbers()) hash.value(number);
  hash.bytes(&in.camera.worldFromView, sizeof in.camera.worldFromView);
  hash.value(in.camera.fovY);
  hash.value(in.camera.orthoHalfHeight);
  hash.value(in.camera.near);
  hash.value(in.camera.width);
  hash.value(in.camera.height);
  hash.value(in.bounces);
  hash.value(in.clamp);
  hash.value(in.seed);
  if (in.glossy) hash.value(true);
  return hash.result();
}

void saveReference(const std::filesystem::path& file, const ReferenceSums& sums, uint64_t key) {
  Header header{{}, kVersion, uint32_t(sums.width), uint32_t(sums.height), sums.samples, key};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  const uint64_t checksum = checksumOf(sums);
  writeAtomically(file, [&](const std::filesystem::path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out.write(reinterpret_cast<const char*>(&header), sizeof header);
    out.write(reinterpret_cast<const char*>(sums.pixels.data()),
              std::streamsize(sums.pixels.size() * sizeof(PixelSums)));
    out.write(reinterpret_cast<const char*>(&checksum), sizeof checksum);
    if (!out.flush()) throw RunError(file.string() + ": cannot be written (is the folder writable, the disk full?)");
  });
}

ReferenceSums loadReference(const std::filesystem::path& file, const ReferenceInputs& in, uint64_t key) {
  std::ifstream stream(file, std::ios::binary);
  Header header;
  if (!stream.read(reinterpret_cast<char*>(&header), sizeof header) || std::memcmp(header.magic, kMagic, sizeof kMagic))
    throw InputError(file.string(), "is not the state of a reference (a file written by --state)");
  if (header.version != kVersion)
    throw InputError(file.string(), "was written by another version of the reference (" +
                                        std::to_string(header.version) + ", while this is " + std::to_string(kVersion) +
                                        ")");
  if (header.width != uint32_t(in.camera.width) || header.height != uint32_t(in.camera.height))
    throw InputError(file.string(), "holds a picture of " + std::to_string(header.width) + "x" +
                                        std::to_string(header.height) + " (this run's is " +
                                        std::to_string(in.camera.width) + "x" + std::to_string(in.camera.height) + ")");
  if (header.key != key)
    throw InputError(file.string(), "belongs to another picture (same scene, lights, camera, bounces, clamp and seed "
                                    "expected)");
  ReferenceSums sums(in.camera.width, in.camera.height);
  sums.samples = header.samples;
  uint64_t checksum = 0;
  stream.read(reinterpret_cast<char*>(sums.pixels.data()), std::streamsize(sums.pixels.size() * sizeof(PixelSums)));
  stream.read(reinterpret_cast<char*>(&checksum), sizeof checksum);
  if (!stream || stream.peek() != std::ifstream::traits_type::eof() || checksum != checksumOf(sums))
    throw InputError(file.string(), "is damaged (begin again without it)");
  return sums;
}

} // namespace lambent

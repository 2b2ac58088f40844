// Layout, little-endian as the machine's own: Header, then the pixels' sums in row order, then a checksum of them.
#include "gi/reference/state_file.h"

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/view/scene_hash.h"

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

void add(Hash& hash, const LightView& light) {
  hash.value(light.type);
  hash.value(light.position);
  hash.value(light.direction);
  hash.value(light.intensity);
  hash.value(light.range);
  hash.value(light.innerConeCos);
  hash.value(light.outerConeCos);
  hash.value(light.angularRadius);
}

uint64_t checksumOf(const ReferenceSums& sums) {
  Hash hash(kVersion);
  hash.value(sums.samples);
  hash.bytes(sums.pixels.data(), sums.pixels.size() * sizeof(PixelSums));
  return hash.result();
}

} // namespace

uint64_t referenceKey(const SceneView& view, const ReferenceInputs& in) {
  Hash hash(kVersion);
  addGeometry(hash, view, in.glossy != nullptr);
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
    throw InputError(file.string(), "holds an image of " + std::to_string(header.width) + "x" +
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

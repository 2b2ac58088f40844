// Layout, little-endian as the machine's own: Header, then counts and members in the order of CubeFile::each, then a
// checksum of all of that.
#include "gi/cube/cube_file.h"

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/view/scene_hash.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <fstream>

namespace lambent {

namespace {

constexpr char kMagic[8] = {'L', 'A', 'M', 'B', 'C', 'U', 'B', '\n'};
// Counts up when the file or the meaning of its numbers changes.
constexpr uint32_t kVersion = 3;

struct Header {
  char magic[8];
  uint32_t version, entryBytes; // of an entry, a light and settings: another build's may differ
  uint64_t key;
};
static_assert(sizeof(Header) == 24);
constexpr uint32_t kBytes = uint32_t((sizeof(CubeEntry) * 1000 + sizeof(VirtualLight)) * 1000 + sizeof(GatherSettings));

/// Bytes of a type between its members, which hold whatever memory held. Zero in the file, so that the same cube has
/// the same bytes.
struct Padding {
  size_t begin = 0, end = 0;
};
constexpr Padding kOfGather{offsetof(GatherSettings, glossy) + 1, offsetof(GatherSettings, spread)};
constexpr Padding kOfLight{offsetof(VirtualLight, alive) + 1, sizeof(VirtualLight)};

struct Writer {
  std::ofstream& out;
  Hash hash{kVersion};
  void bytes(void* data, size_t size) {
    out.write(static_cast<const char*>(data), std::streamsize(size));
    hash.bytes(data, size);
  }
  template <class T> void padded(const T* first, Padding padding, size_t count = 1) {
    std::vector<std::byte> copy(count * sizeof(T));
    if (count > 0) std::memcpy(copy.data(), first, copy.size());
    for (size_t at = 0; at < copy.size(); at += sizeof(T))
      std::memset(copy.data() + at + padding.begin, 0, padding.end - padding.begin);
    bytes(copy.data(), copy.size());
  }
  template <class T> void vector(std::vector<T>& v, Padding padding = {}) {
    uint64_t count = v.size();
    bytes(&count, sizeof count);
    padding.end == 0 ? bytes(v.data(), v.size() * sizeof(T)) : padded(v.data(), padding, v.size());
  }
};

struct Reader {
  std::ifstream& in;
  uint64_t left; // bytes of the file
  Hash hash{kVersion};
  void bytes(void* data, size_t size) {
    if (size > left || !in.read(static_cast<char*>(data), std::streamsize(size))) throw std::ios_base::failure("short");
    left -= size;
    hash.bytes(data, size);
  }
  template <class T> void padded(T* value, Padding) { bytes(value, sizeof *value); }
  template <class T> void vector(std::vector<T>& v, Padding = {}) {
    uint64_t count = 0;
    bytes(&count, sizeof count);
    if (count > left / sizeof(T)) throw std::ios_base::failure("short");
    v.resize(count);
    bytes(v.data(), v.size() * sizeof(T));
  }
};

} // namespace

/// The members of a cube, in the order in which they lie in the file.
struct CubeFile {
  template <class Stream> static void each(Stream& stream, LayeredCube& cube) {
    CubeSurfaces& s = cube.surfaces_;
    stream.bytes(&s.lo_, sizeof s.lo_);
    stream.bytes(&s.edge_, sizeof s.edge_);
    stream.bytes(&s.resolution_, sizeof s.resolution_);
    stream.bytes(&s.levels_, sizeof s.levels_);
    stream.bytes(&s.split_, sizeof s.split_);
    stream.bytes(&s.cut_, sizeof s.cut_);
    stream.bytes(&cube.settings_, sizeof cube.settings_);
    stream.padded(&cube.gather_, kOfGather);
    stream.vector(s.nodes_);
    stream.vector(s.cubes_);
    stream.vector(s.firsts_);
    stream.vector(s.entries_);
    stream.vector(cube.in_, kOfLight);
    stream.vector(cube.seen_);
    stream.vector(cube.sums_);
  }
  /// Whether the parts of what was read fit together.
  static bool whole(const LayeredCube& cube) {
    const CubeSurfaces& s = cube.surfaces_;
    if (s.resolution_ < 8 || s.resolution_ % 8 != 0 || s.nodes_.empty()) return false;
    if (s.firsts_.size() != s.cubes_.size() * s.columns() + 1) return false;
    if (s.firsts_.front() != 0 || s.firsts_.back() != s.entries_.size()) return false;
    if (!std::is_sorted(s.firsts_.begin(), s.firsts_.end())) return false;
    for (const CubeGrid& grid : s.cubes_)
      if (grid.resolution != s.resolution_) return false;
    for (size_t n = 0; n < s.nodes_.size(); ++n) {
      const CubeNode& node = s.nodes_[n];
      if (node.children != 0 ? node.children <= n || size_t(node.children) + 8 > s.nodes_.size()
                             : node.firstColumn % s.columns() != 0 || node.firstColumn / s.columns() >= s.cubes_.size())
        return false;
    }
    return cube.sums_.size() == s.entries_.size() && cube.seen_.size() == s.entries_.size() * cube.words();
  }
};

uint64_t cubeKey(const SceneView& view) {
  Hash hash(kVersion);
  addGeometry(hash, view, false);
  return hash.result();
}

void saveCube(const std::filesystem::path& file, const LayeredCube& cube, uint64_t key) {
  writeAtomically(file, [&](const std::filesystem::path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    Header header{{}, kVersion, kBytes, key};
    std::memcpy(header.magic, kMagic, sizeof kMagic);
    out.write(reinterpret_cast<const char*>(&header), sizeof header);
    Writer writer{out};
    CubeFile::each(writer, const_cast<LayeredCube&>(cube)); // is only read
    const uint64_t checksum = writer.hash.result();
    out.write(reinterpret_cast<const char*>(&checksum), sizeof checksum);
    if (!out.flush()) throw RunError(file.string() + ": cannot be written (is the folder writable, the disk full?)");
  });
}

bool isCube(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  char magic[sizeof kMagic];
  return in.read(magic, sizeof magic) && std::memcmp(magic, kMagic, sizeof magic) == 0;
}

LayeredCube loadCube(const std::filesystem::path& file, uint64_t key) {
  std::ifstream in(file, std::ios::binary);
  Header header;
  if (!in.read(reinterpret_cast<char*>(&header), sizeof header) || std::memcmp(header.magic, kMagic, sizeof kMagic))
    throw InputError(file.string(),
                     "is not a layered depth cube (--cube-file wants a new name, or what it wrote before)");
  if (header.version != kVersion || header.entryBytes != kBytes)
    throw InputError(file.string(), "is a layered depth cube of another version of the program");
  if (header.key != key)
    throw InputError(file.string(), "is a layered depth cube of another scene, or its objects stood elsewhere");
  const std::string damaged = "is a damaged layered depth cube";
  LayeredCube cube;
  try {
    std::error_code ignored;
    Reader reader{in, std::filesystem::file_size(file, ignored)};
    CubeFile::each(reader, cube);
    uint64_t checksum = 0;
    in.read(reinterpret_cast<char*>(&checksum), sizeof checksum);
    if (!in || in.peek() != std::ifstream::traits_type::eof() || checksum != reader.hash.result())
      throw InputError(file.string(), damaged);
  } catch (const InputError&) {
    throw;
  } catch (const std::exception&) { // short, or counts that no memory holds
    throw InputError(file.string(), damaged);
  }
  if (!CubeFile::whole(cube)) throw InputError(file.string(), damaged);
  return cube;
}

} // namespace lambent

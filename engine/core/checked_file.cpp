#include "engine/core/checked_file.h"

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/free_memory.h"
#include "engine/core/memory.h"

#include <algorithm>

namespace lambent {

namespace {

struct Header {
  char magic[8];
  uint32_t version, layout;
  uint64_t key;
};
static_assert(sizeof(Header) == 24);

} // namespace

void Checksum::bytes(const void* data, size_t size) {
  const char* at = static_cast<const char*>(data);
  while (size > 0) {
    if (begun_ == 0 && size >= sizeof word_) {
      const size_t whole = size / sizeof word_ * sizeof word_;
      hash_.bytes(at, whole);
      at += whole, size -= whole;
      continue;
    }
    const size_t part = std::min(size, sizeof word_ - begun_);
    std::memcpy(word_ + begun_, at, part);
    at += part, size -= part;
    if ((begun_ += part) < sizeof word_) continue;
    hash_.bytes(word_, sizeof word_);
    begun_ = 0;
  }
}

uint64_t Checksum::result() const {
  Hash whole = hash_;
  whole.bytes(word_, begun_);
  return whole.result();
}

CheckedWriter::CheckedWriter(std::ostream& out, const FileKind& kind, uint64_t key)
    : out_(out), checksum_(kind.version) {
  Header header{{}, kind.version, kind.layout, key};
  std::memcpy(header.magic, kind.magic, sizeof header.magic);
  bytes(&header, sizeof header);
}

void CheckedWriter::bytes(const void* data, size_t size) {
  out_.write(static_cast<const char*>(data), std::streamsize(size));
  checksum_.bytes(data, size);
}

void CheckedWriter::strided(const void* first, size_t each, size_t count, const ByteLayout& layout) {
  if (layout.paddingEnd == 0) return bytes(first, each * count);
  std::vector<std::byte> copy(each * count);
  if (count > 0) std::memcpy(copy.data(), first, copy.size());
  for (size_t at = 0; at < copy.size(); at += each)
    std::fill(&copy[at] + layout.paddingBegin, &copy[at] + layout.paddingEnd, std::byte(0));
  bytes(copy.data(), copy.size());
}

void writeChecked(const std::filesystem::path& file, const FileKind& kind, uint64_t key,
                  const std::function<void(CheckedWriter&)>& write) {
  writeAtomically(file, [&](const std::filesystem::path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    CheckedWriter writer(out, kind, key);
    write(writer);
    const uint64_t checksum = writer.checksum();
    out.write(reinterpret_cast<const char*>(&checksum), sizeof checksum);
    out.close(); // some disks say only then that they are full
    if (!out) throw RunError(file.string() + ": cannot be written (is the folder writable, the disk full?)");
  });
}

bool isChecked(const std::filesystem::path& file, const FileKind& kind) {
  std::error_code none;
  char magic[sizeof kind.magic];
  return std::filesystem::is_regular_file(file, none) && // a pipe would wait for ever
         std::ifstream(file, std::ios::binary).read(magic, sizeof magic) &&
         std::memcmp(magic, kind.magic, sizeof magic) == 0;
}

CheckedReader::CheckedReader(const std::filesystem::path& file, const FileKind& kind)
    : file_(file), name_(kind.name), checksum_(kind.version) {
  std::error_code none;
  if (std::filesystem::is_regular_file(file, none) && !std::ifstream(file))
    refuse("cannot be read (has this user the right to?)");
  if (!isChecked(file, kind)) refuse("is not " + kind.name + " (" + kind.instead + ")");
  Header header;
  in_.open(file, std::ios::binary);
  if (!in_.read(reinterpret_cast<char*>(&header), sizeof header)) damaged();
  if (header.version != kind.version || header.layout != kind.layout)
    refuse("is " + kind.name + " of another version of the program");
  const uint64_t size = std::filesystem::file_size(file, none);
  if (none || size < sizeof header + sizeof(uint64_t)) damaged();
  left_ = size - sizeof header - sizeof(uint64_t);
  key_ = header.key;
  checksum_.bytes(&header, sizeof header);
}

void CheckedReader::bytes(void* data, size_t size) {
  if (size > left_ || !in_.read(static_cast<char*>(data), std::streamsize(size))) damaged();
  left_ -= size;
  checksum_.bytes(data, size);
}

void CheckedReader::strided(void* first, size_t each, size_t count, const ByteLayout& layout) {
  bytes(first, each * count);
  for (size_t i = 0; i < count && !layout.bools.empty(); ++i)
    for (const size_t at : layout.bools) {
      uint8_t byte = 0;
      std::memcpy(&byte, static_cast<const char*>(first) + i * each + at, 1);
      if (byte > 1) damaged();
    }
}

void CheckedReader::refuseBeyondMemory(uint64_t bytes) const { // a file with holes may be larger than memory
  if (bytes > freeMemory())
    throw RunError(file_.string() + ": needs " +
                   moreThanIsLeft(double(bytes), name_ + "; end other programs, or begin again without it"));
}

void CheckedReader::end() {
  uint64_t checksum = 0;
  in_.read(reinterpret_cast<char*>(&checksum), sizeof checksum);
  if (left_ != 0 || !in_ || in_.peek() != std::ifstream::traits_type::eof() || checksum != checksum_.result())
    damaged();
}

void CheckedReader::refuse(const std::string& reason) const { throw InputError(file_.string(), reason); }
void CheckedReader::damaged() const { refuse("is damaged (" + name_ + "; begin again without it)"); }

} // namespace lambent

// Binary files of our own: a header, values as memory holds them (little-endian), a checksum of both. A checksum tells
// accidents from what was written; whoever reads still holds every value to what it may be.
#pragma once

#include "engine/core/hash.h"

#include <filesystem>
#include <fstream>
#include <functional>
#include <span>
#include <string>

namespace lambent {

struct FileKind {
  char magic[8];
  uint32_t version;    // counts up when the file or the meaning of its numbers changes
  uint32_t layout;     // of values that hold several: another build's may differ
  std::string name;    // "a layered depth cube"
  std::string instead; // what is expected in place of another file
};

/// Bytes of a type that say nothing, and those that are a bool. The first are zero in the file, so that the same values
/// make the same bytes; the others are 0 or 1 when read.
struct ByteLayout {
  size_t paddingBegin = 0, paddingEnd = 0;
  std::vector<size_t> bools = {};
};

/// The same however bytes are cut into pieces.
class Checksum {
 public:
  explicit Checksum(uint32_t version) : hash_(version) {}
  void bytes(const void* data, size_t size);
  uint64_t result() const;

 private:
  Hash hash_;
  char word_[8] = {};
  size_t begun_ = 0; // bytes of the word
};

class CheckedWriter {
 public:
  CheckedWriter(std::ostream& out, const FileKind& kind, uint64_t key);
  void bytes(const void* data, size_t size);
  template <class T> void values(std::span<const T> values, const ByteLayout& layout = {}) {
    static_assert(std::is_trivially_copyable_v<T>);
    strided(values.data(), sizeof(T), values.size(), layout);
  }
  template <class T> void value(const T& v, const ByteLayout& layout = {}) { values(std::span(&v, 1), layout); }
  /// With its size in front.
  template <class T> void vector(const std::vector<T>& v, const ByteLayout& layout = {}) {
    value(uint64_t(v.size()));
    values(std::span(v), layout);
  }
  uint64_t checksum() const { return checksum_.result(); }

 private:
  void strided(const void* first, size_t each, size_t count, const ByteLayout& layout);

  std::ostream& out_;
  Checksum checksum_;
};

/// Writes a file whole or not at all. Throws RunError where it cannot be written.
void writeChecked(const std::filesystem::path& file, const FileKind& kind, uint64_t key,
                  const std::function<void(CheckedWriter&)>& write);

/// Says whether a file claims to be of a kind, of any version.
bool isChecked(const std::filesystem::path& file, const FileKind& kind);

/// Asks for no more memory than the file has bytes. All throw InputError, "damaged" where the file is not as written;
/// where memory is short, which says nothing of the file, RunError.
class CheckedReader {
 public:
  /// Opens a file. Refuses what is no regular file, and what is of another kind or version.
  CheckedReader(const std::filesystem::path& file, const FileKind& kind);
  uint64_t key() const { return key_; }

  void bytes(void* data, size_t size);
  template <class T> void values(std::span<T> values, const ByteLayout& layout = {}) {
    static_assert(std::is_trivially_copyable_v<T>);
    strided(values.data(), sizeof(T), values.size(), layout);
  }
  template <class T> void value(T& v, const ByteLayout& layout = {}) { values(std::span(&v, 1), layout); }
  template <class T> void vector(std::vector<T>& v, const ByteLayout& layout = {}) {
    uint64_t count = 0;
    value(count);
    if (count > left_ / sizeof(T)) damaged();
    refuseBeyondMemory(count * sizeof(T));
    v.resize(count);
    values(std::span(v), layout);
  }
  /// Ends it: nothing follows but the checksum, and that is right.
  void end();

  [[noreturn]] void refuse(const std::string& reason) const;
  [[noreturn]] void damaged() const;

 private:
  void strided(void* first, size_t each, size_t count, const ByteLayout& layout);
  void refuseBeyondMemory(uint64_t bytes) const;

  const std::filesystem::path file_;
  const std::string name_;
  std::ifstream in_;
  uint64_t left_ = 0; // bytes of the file, without the checksum
  uint64_t key_ = 0;
  Checksum checksum_;
};

} // namespace lambent

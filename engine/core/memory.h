// What large memory is held, by owner: textures and buffers of the GPU, hierarchies of the ray tracer, scenes, virtual
// lights, cubes.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace lambent {

/// An account must outlive what is entered in it. Any thread may enter.
class MemoryAccount {
 public:
  struct Row {
    std::string owner;
    bool gpu;
    uint64_t bytes;
  };

  MemoryAccount() = default;
  /// `mayGrow` is asked before memory of the ray tracer grows by so many bytes, and told, with a number below 0, when
  /// it has shrunk.
  explicit MemoryAccount(std::function<bool(int64_t)> mayGrow) : mayGrow_(std::move(mayGrow)) {}

  void enter(const std::string& owner, bool gpu, int64_t bytes);
  bool mayGrow(int64_t bytes) const { return !mayGrow_ || mayGrow_(bytes); }
  std::vector<Row> rows() const; // that hold anything, ascending by owner

  /// That of what this thread does: of the innermost Scope, else the process's.
  static MemoryAccount& current();
  class Scope {
   public:
    explicit Scope(MemoryAccount& account);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    MemoryAccount* before_;
  };

 private:
  mutable std::mutex mutex_;
  std::map<std::pair<std::string, bool>, uint64_t> bytes_;
  std::function<bool(int64_t)> mayGrow_;
};

/// What one owner holds of the program's memory, in the account of the thread that says so first. The account must
/// outlive it.
class HeldMemory {
 public:
  explicit HeldMemory(std::string owner) : owner_(std::move(owner)) {}
  ~HeldMemory() { now(0); }
  HeldMemory(const HeldMemory&) = delete;
  void now(uint64_t bytes);

 private:
  std::string owner_;
  MemoryAccount* account_ = nullptr;
  uint64_t bytes_ = 0;
};

/// "N GB of memory, more than is left (CURE)" for an error, with who holds most of what is taken.
std::string moreThanIsLeft(double bytes, const std::string& cure);

} // namespace lambent

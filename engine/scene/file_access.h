// What a scene of somebody else's may read and ask for.
#pragma once

#include <filesystem>
#include <string>

namespace lambent {

/// What a scene's file is trusted with.
struct FileTrust {
  bool outside = false; // it may read files outside of its folder
  bool large = false;   // it may ask for more memory and time than its size explains
};

/// Says whether a scene in `folder` may read a file: a regular one, and unless it may lie `outside` one in that folder
/// or below, wherever links on the way lead. What lies elsewhere is as if it were not there.
bool mayRead(const std::filesystem::path& folder, const std::filesystem::path& file, bool outside);

/// A file that a scene may read (mayRead), held open: what is read is what was checked, whatever others put into its
/// place meanwhile.
class HeldFile {
 public:
  HeldFile(const std::filesystem::path& folder, const std::filesystem::path& file, bool outside);
  ~HeldFile();
  HeldFile(const HeldFile&) = delete;
  HeldFile& operator=(const HeldFile&) = delete;

  explicit operator bool() const { return descriptor_ >= 0; }
  /// Why it is not held.
  const std::string& why() const { return why_; }
  /// Returns a name that leads to it as long as this lives.
  std::filesystem::path opened() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
  std::string why_ = "no such file";
};

/// Says whether the way to a file leads out of a folder, by what it says or by a link on it, whether there is anything
/// or not.
bool leadsOutside(const std::filesystem::path& folder, const std::filesystem::path& file);

/// What an address in a file names: %XX are bytes (RFC 3986).
std::string pathOfUri(const std::string& uri);

} // namespace lambent

// Files of a test, and the errors that they lead to.
#pragma once

#include "tests/support/test.h"

#include <filesystem>

namespace lambent::test {

namespace fs = std::filesystem;

/// Exists while the test runs.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  fs::path operator/(const std::string& name) const { return path_ / name; }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Makes the folders that it needs.
void writeBytes(const fs::path& file, const std::string& bytes);
std::string readBytes(const fs::path& file);

/// Message of the Error that `run` throws; fails the test and returns "" when it throws none.
template <class Error, class Fn> std::string messageOf(Fn&& run) {
  try {
    run();
  } catch (const Error& e) {
    return e.what();
  } catch (const std::exception& e) {
    ADD_FAILURE() << "another exception: " << e.what();
    return "";
  }
  ADD_FAILURE() << "no exception";
  return "";
}
template <class Fn> std::string inputErrorOf(Fn&& run) { return messageOf<InputError>(run); }

} // namespace lambent::test

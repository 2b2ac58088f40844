// Measured runs as lines of JSON that are kept as they come: what ends the program loses none.
#pragma once

#include "tools/kept/value.h"

#include <filesystem>
#include <string>

namespace lambent {

class RunLog {
 public:
  /// Holds the file's runs of these conditions; lines that are cut, changed or without a checksum are skipped.
  RunLog(std::filesystem::path file, std::string conditions);

  bool has(const std::string& key) const;
  /// Appends a run, with its key, conditions and session (1 for the first program that wrote to the file, then counted
  /// up). Throws RunError where it cannot be written.
  void add(const std::string& key, Value run);
  const Value::List& runs() const { return runs_; }

 private:
  const std::filesystem::path file_;
  const std::string conditions_;
  Value::List runs_;
  int session_ = 1;
  bool begun_ = false;
};

/// A run as its line, with a checksum.
std::string lineOf(Value run);

} // namespace lambent

// Measured runs as lines of JSON that are kept as they come: what ends the program loses none.
#pragma once

#include "tools/kept/value.h"

#include <filesystem>
#include <string>

namespace lambent {

class RunLog {
 public:
  /// Holds the runs of this file that were measured under these conditions. Lines that were cut or changed are left
  /// out.
  RunLog(std::filesystem::path file, std::string conditions);

  bool has(const std::string& key) const;
  /// Appends a run, with its key, conditions and session: how often a program has opened the file. Throws RunError
  /// where it cannot be written.
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

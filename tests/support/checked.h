// Files with a checksum whose values are not what was written.
#pragma once

#include "engine/core/checked_file.h"

#include <string>

namespace lambent::test {

/// Bytes of a file of ours (engine/core/checked_file.h) with the checksum that they should have.
inline std::string mended(std::string bytes) {
  uint32_t version = 0;
  uint64_t checksum = 0;
  if (bytes.size() < 24 + sizeof checksum) return bytes;
  std::memcpy(&version, &bytes[8], sizeof version);
  Checksum sum(version);
  sum.bytes(bytes.data(), bytes.size() - sizeof checksum);
  checksum = sum.result();
  std::memcpy(&bytes[bytes.size() - sizeof checksum], &checksum, sizeof checksum);
  return bytes;
}

} // namespace lambent::test

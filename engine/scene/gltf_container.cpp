// The outside of a glTF file: its bytes, the chunks of a .glb.

#include "engine/scene/gltf_document.h"

#include <cstring>
#include <fstream>

namespace lambent::gltf {

namespace fs = std::filesystem;

std::vector<uint8_t> readFileBytes(const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error)) throw InputError(file.string(), "no such file");
  if (!fs::is_regular_file(file, error)) throw InputError(file.string(), "is not a file (a .gltf or .glb expected)");
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  if (!in) throw InputError(file.string(), "cannot be opened for reading");
  std::vector<uint8_t> bytes(size_t(std::streamoff(in.tellg())));
  in.seekg(0);
  in.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(bytes.size()));
  if (!in) throw InputError(file.string(), "cannot be read to its end");
  return bytes;
}

namespace {

uint32_t littleEndian32(const uint8_t* p) {
  return uint32_t(p[0]) | uint32_t(p[1]) << 8 | uint32_t(p[2]) << 16 | uint32_t(p[3]) << 24;
}

} // namespace

Container checkContainer(const fs::path& file, const std::vector<uint8_t>& bytes) {
  const auto fail = [&](const std::string& reason) { throw InputError(file.string(), reason); };
  if (bytes.size() < 4) fail("is empty (glTF JSON or a .glb expected)");
  if (std::memcmp(bytes.data(), "glTF", 4) != 0) {
    return {false, checkJson(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()})};
  }

  constexpr size_t kHeader = 12, kChunkHeader = 8;
  if (bytes.size() < kHeader + kChunkHeader) fail("the .glb is cut off within its header");
  const uint32_t version = littleEndian32(&bytes[4]), length = littleEndian32(&bytes[8]);
  if (version != 2) fail("is binary glTF version " + std::to_string(version) + " (2 expected)");
  if (length > bytes.size())
    fail("the .glb is cut off: its header says " + std::to_string(length) + " bytes, the file has " +
         std::to_string(bytes.size()));
  Container out{true, {}};
  for (size_t at = kHeader, chunk = 0; at < length; ++chunk) {
    if (length - at < kChunkHeader) fail("the .glb is cut off within the header of chunk " + std::to_string(chunk));
    const size_t size = littleEndian32(&bytes[at]);
    if (size > length - at - kChunkHeader)
      fail("chunk " + std::to_string(chunk) + " of the .glb says " + std::to_string(size) + " bytes, but only " +
           std::to_string(length - at - kChunkHeader) + " follow");
    if (chunk == 0) {
      if (std::memcmp(&bytes[at + 4], "JSON", 4) != 0) fail("the first chunk of the .glb is not JSON");
      out.json = checkJson(file, {reinterpret_cast<const char*>(&bytes[at + kChunkHeader]), size});
    }
    at += kChunkHeader + size;
  }
  return out;
}

void Document::fail(const std::string& place, const std::string& reason) const {
  throw InputError(file.string(), place + ": " + reason);
}

void Document::spend(size_t count, size_t each, const std::string& place) const {
  if (!budget.take(count, each))
    fail(place, "needs more memory than a file of " + std::to_string(budget.read) + " bytes may ask for (" +
                    std::to_string(budget.limit() >> 20) + " MiB in all)");
}

void Document::checkIndex(int index, size_t size, const char* what, const std::string& place) const {
  if (index < 0 || size_t(index) >= size)
    fail(place, std::string("refers to ") + what + " " + std::to_string(index) + ", but the file has " +
                    (size == 0 ? "none" : std::to_string(size) + " (0 to " + std::to_string(size - 1) + ")"));
}

std::string label(const char* what, size_t index, const std::string& name) {
  return std::string(what) + " " + std::to_string(index) + (name.empty() ? "" : " '" + name + "'");
}

} // namespace lambent::gltf

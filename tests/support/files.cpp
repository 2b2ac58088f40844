#include "tests/support/files.h"

namespace lambent::test {

TemporaryFolder::TemporaryFolder() {
  std::string name = (fs::temp_directory_path() / "lambent-test-XXXXXX").string();
  if (!mkdtemp(name.data())) throw RunError("cannot make a folder for the test");
  path_ = name;
}
TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void writeBytes(const fs::path& file, const std::string& bytes) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << bytes;
}

std::string readBytes(const fs::path& file) {
  std::ostringstream out;
  out << std::ifstream(file, std::ios::binary).rdbuf();
  return out.str();
}

} // namespace lambent::test

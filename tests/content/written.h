// A recipe's output in a temporary folder that goes away again.
#pragma once

#include "tools/content/content.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

namespace lambent {

inline std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream out;
  out << in.rdbuf();
  return out.str();
}

/// A recipe's name with only the letters that a test's name may have.
inline std::string testName(const ContentRecipe& recipe) {
  std::string name = recipe.name;
  for (char& c : name) c = c == '-' ? '_' : c;
  return name;
}
/// More than some 30 000 triangles: each ray against all of them takes too long for every run of the tests.
inline bool isLarge(const ContentRecipe& r) {
  return !r.bundled && !r.name.ends_with("-small") && r.name != "museum-15k" && r.name != "museum-26k";
}
inline void PrintTo(const ContentRecipe& recipe, std::ostream* out) { *out << recipe.name; }

struct WrittenScene {
  std::filesystem::path folder;
  GeneratedScene scene;

  explicit WrittenScene(const ContentRecipe& recipe, const std::string& tag = "") {
    // Tests may run at the same time, each in a process of its own.
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    std::string name = "lambent-" + std::string(test->name()) + "-" + recipe.name + tag;
    for (char& c : name) c = c == '/' ? '-' : c;
    folder = std::filesystem::path(testing::TempDir()) / name;
    scene = recipe.write(folder);
  }
  ~WrittenScene() {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }
  WrittenScene(const WrittenScene&) = delete;
  WrittenScene& operator=(const WrittenScene&) = delete;
};

} // namespace lambent

// Recipes' output in temporary folders that go away again.
#pragma once

#include "tests/support/effort.h"
#include "tests/support/files.h"
#include "tools/content/content.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace lambent {

/// A name with only the letters that a test's name may have.
inline std::string testName(std::string name) {
  std::ranges::replace(name, '-', '_');
  return name;
}
/// More than some 30 000 triangles: each ray against all of them takes too long for every run of the tests.
inline bool tooLarge(const ContentRecipe& r) {
  return !r.bundled && !r.name.ends_with("-small") && r.name != "museum-15k" && r.name != "museum-26k" &&
         !test::isLong();
}
#define SKIP_WHERE_TOO_LARGE(recipe)                                                                                   \
  if (tooLarge(recipe)) GTEST_SKIP() << "takes minutes: LAMBENT_LONG=1 runs it (tools/test --long)"

inline void PrintTo(const ContentRecipe& recipe, std::ostream* out) { *out << recipe.name; }

struct WrittenScene {
  test::TemporaryFolder folder;
  GeneratedScene scene;

  explicit WrittenScene(const ContentRecipe& recipe) : scene(recipe.write(folder.path())) {}
};

/// All recipes; where sanitizers look at them, without the two that take most of the time: they have smaller sisters.
inline std::vector<ContentRecipe> testedRecipes() {
  std::vector<ContentRecipe> all = contentRecipes();
  if (test::kSanitized)
    std::erase_if(all, [](const ContentRecipe& r) { return r.name == "gallery" || r.name == "museum-97k"; });
  return all;
}

/// What tests only read is written once for all of them: making a scene takes longer than most of what is asked of it.
inline const WrittenScene& written(const ContentRecipe& recipe) {
  static std::map<std::string, std::unique_ptr<WrittenScene>> all;
  std::unique_ptr<WrittenScene>& found = all[recipe.name];
  if (!found) found = std::make_unique<WrittenScene>(recipe);
  return *found;
}

} // namespace lambent

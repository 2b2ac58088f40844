#include "tools/content/recipes.h"

namespace lambent {

const std::vector<ContentRecipe>& contentRecipes() {
  static const std::vector<ContentRecipe> recipes{
      {"hall", "two-storey arcaded hall: sun through an open roof, cloth, a moving lamp and a rolling ball",
       content::writeHall},
      {"cornell", "Cornell box with two blocks and a ceiling emitter", content::writeCornell},
  };
  return recipes;
}

} // namespace lambent

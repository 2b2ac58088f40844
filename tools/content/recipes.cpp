#include "tools/content/recipes.h"

namespace lambent {

namespace {

using Write = GeneratedScene (*)(const std::filesystem::path&, content::SceneSize);

/// NAME and NAME-small, both made on demand.
void addSizes(std::vector<ContentRecipe>& recipes, const std::string& name, const std::string& description,
              Write write) {
  using content::SceneSize;
  const auto sized = [write](SceneSize size) {
    return [write, size](const std::filesystem::path& folder) { return write(folder, size); };
  };
  recipes.push_back({name, description, false, sized(SceneSize::Full)});
  recipes.push_back({name + "-small", "the same with fewer parts, for tests", false, sized(SceneSize::Small)});
}

} // namespace

const std::vector<ContentRecipe>& contentRecipes() {
  static const std::vector<ContentRecipe> recipes = [] {
    std::vector<ContentRecipe> all{
        {"hall", "two-storey arcaded hall: sun through an open roof, cloth, a moving lamp and a rolling ball", true,
         content::writeHall},
        {"cornell", "Cornell box with two blocks and a ceiling emitter", true, content::writeCornell},
        {"cornell-spot", "the same room lit by one spot of 90° below the ceiling", true, content::writeCornellSpot},
        {"door", "a dark room beside a bright one, and the door leaf between them", true, content::writeDoor},
        {"red-box", "white corridor, and a red box to be carried along it", true, content::writeRedBox},
        {"lift", "hall of three storeys with a lift in front of lit rooms", true, content::writeLift},
        {"lamps", "gallery with fifty lamps of unlike size, thin poles, a fence, small trees", true,
         content::writeLamps},
        {"shrine", "sunlit court, dark passage around a corner, and an altar that waits for light", true,
         content::writeShrine},
    };
    addSizes(all, "office", "office building: corridors, rooms with open doors, 14 lights", content::writeOffice);
    addSizes(all, "citadel", "town street under one sun: houses, arches, clothes lines, stairs", content::writeCitadel);
    addSizes(all, "maze", "maze under a ceiling with 13 static lamps", content::writeMaze);
    addSizes(all, "atrium", "galleries around a court with one moving lantern", content::writeAtrium);
    addSizes(all, "knot", "carved knot on a plinth in a plain room under one spot", content::writeKnot);
    addSizes(all, "garden", "glasshouse with thin-leaved plants in beds under one spot", content::writeGarden);
    addSizes(all, "gallery", "three rooms of finely meshed organic sculptures under barred roof lights",
             content::writeGallery);
    addSizes(all, "street", "street at night after rain: street lamps, shops, signs, lit windows, cars, a moon",
             content::writeStreet);
    const auto museum = [](content::MuseumSize size) {
      return [size](const std::filesystem::path& folder) { return content::writeMuseum(folder, size); };
    };
    all.push_back({"museum-15k", "two rooms of sculptures parted by a board of 2 cm, 15 000 triangles", false,
                   museum(content::MuseumSize::Of15k)});
    all.push_back({"museum-26k", "the same with 26 000 triangles", false, museum(content::MuseumSize::Of26k)});
    all.push_back({"museum-97k", "the same with 97 000 triangles", false, museum(content::MuseumSize::Of97k)});
    return all;
  }();
  return recipes;
}

} // namespace lambent

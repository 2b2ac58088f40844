#include "tools/content/recipes.h"

namespace lambent {

const std::vector<ContentRecipe>& contentRecipes() {
  static const std::vector<ContentRecipe> recipes = [] {
    using namespace content;
    using Write = GeneratedScene (*)(const Order&);
    constexpr bool kBundled = true;
    std::vector<ContentRecipe> all;
    const auto add = [&](const std::string& name, const std::string& description, Write write, bool bundled = false,
                         SceneSize size = SceneSize::Full) {
      all.push_back({name, description, bundled, [=](const auto& folder) { return write({folder, name, size}); }});
    };
    const auto addSizes = [&](const std::string& name, const char* description, Write write) {
      add(name, description, write);
      add(name + "-small", "the same with fewer parts, for tests", write, false, SceneSize::Small);
    };
    add("hall", "two-storey arcaded hall: sun through an open roof, cloth, a moving lamp and a rolling ball", writeHall,
        kBundled);
    add("cornell", "Cornell box with two blocks and a ceiling emitter", writeCornell, kBundled);
    add("cornell-spot", "the same room lit by one spot of 90° below the ceiling", writeCornellSpot, kBundled);
    add("door", "a dark room beside a bright one, and the door leaf between them", writeDoor, kBundled);
    add("red-box", "white corridor, and a red box to be carried along it", writeRedBox, kBundled);
    add("lift", "hall of three storeys with a lift in front of lit rooms", writeLift, kBundled);
    add("lamps", "gallery with fifty lamps of unlike size, thin poles, a fence, small trees", writeLamps, kBundled);
    add("shrine", "sunlit court, dark passage around a corner, and an altar that waits for light", writeShrine,
        kBundled);
    addSizes("office", "office building: corridors, rooms with open doors, 14 lights", writeOffice);
    addSizes("citadel", "town street under one sun: houses, arches, clothes lines, stairs", writeCitadel);
    addSizes("maze", "maze under a ceiling with 13 static lamps", writeMaze);
    addSizes("atrium", "galleries around a court with one moving lantern", writeAtrium);
    addSizes("knot", "carved knot on a plinth in a plain room under one spot", writeKnot);
    addSizes("garden", "glasshouse with thin-leaved plants in beds under one spot", writeGarden);
    addSizes("gallery", "three rooms of finely meshed organic sculptures under barred roof lights", writeGallery);
    addSizes("street", "street at night after rain: street lamps, shops, signs, lit windows, cars, a moon",
             writeStreet);
    add("museum-15k", "two rooms of sculptures parted by a board of 2 cm, 15 000 triangles", writeMuseum);
    add("museum-26k", "the same with 26 000 triangles", writeMuseum);
    add("museum-97k", "the same with 97 000 triangles", writeMuseum);
    return all;
  }();
  return recipes;
}

} // namespace lambent

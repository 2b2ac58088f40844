// The recipes one by one; contentRecipes() lists them.
#pragma once

#include "tools/content/content.h"
#include "tools/content/scene_builder.h"

namespace lambent::content {

GeneratedScene writeAtrium(const std::filesystem::path& folder, SceneSize size);
GeneratedScene writeCitadel(const std::filesystem::path& folder, SceneSize size);
GeneratedScene writeCornell(const std::filesystem::path& folder);
GeneratedScene writeCornellSpot(const std::filesystem::path& folder);
GeneratedScene writeDoor(const std::filesystem::path& folder);
GeneratedScene writeGallery(const std::filesystem::path& folder, SceneSize size);
GeneratedScene writeGarden(const std::filesystem::path& folder, SceneSize size);
GeneratedScene writeHall(const std::filesystem::path& folder);
GeneratedScene writeKnot(const std::filesystem::path& folder, SceneSize size);
GeneratedScene writeLamps(const std::filesystem::path& folder);
GeneratedScene writeLift(const std::filesystem::path& folder);
GeneratedScene writeMaze(const std::filesystem::path& folder, SceneSize size);
/// One museum at three tessellations, of 15, 26 and 97 thousand triangles.
enum class MuseumSize { Of15k, Of26k, Of97k };
GeneratedScene writeMuseum(const std::filesystem::path& folder, MuseumSize size);
GeneratedScene writeOffice(const std::filesystem::path& folder, SceneSize size);
GeneratedScene writeRedBox(const std::filesystem::path& folder);
GeneratedScene writeShrine(const std::filesystem::path& folder);
GeneratedScene writeStreet(const std::filesystem::path& folder, SceneSize size);

} // namespace lambent::content

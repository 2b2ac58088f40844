// The recipes one by one; contentRecipes() lists them.
#pragma once

#include "tools/content/scene_builder.h"

namespace lambent::content {

GeneratedScene writeAtrium(const Order& order);
GeneratedScene writeCitadel(const Order& order);
GeneratedScene writeCornell(const Order& order);
GeneratedScene writeCornellSpot(const Order& order);
GeneratedScene writeDoor(const Order& order);
GeneratedScene writeGallery(const Order& order);
GeneratedScene writeGarden(const Order& order);
GeneratedScene writeHall(const Order& order);
GeneratedScene writeKnot(const Order& order);
GeneratedScene writeLamps(const Order& order);
GeneratedScene writeLift(const Order& order);
GeneratedScene writeMaze(const Order& order);
GeneratedScene writeMuseum(const Order& order);
GeneratedScene writeOffice(const Order& order);
GeneratedScene writeRedBox(const Order& order);
GeneratedScene writeShrine(const Order& order);
GeneratedScene writeStreet(const Order& order);

} // namespace lambent::content

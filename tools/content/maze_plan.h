// The mazes, drawn: + a junction, - and | a wall between two junctions, * a cell with a lamp. A square of cells; a text
// row of junctions and one of cells take turns. Columns go east, rows go south.
#pragma once

#include "tools/content/scene_builder.h"

#include <string_view>
#include <vector>

namespace lambent::content {

using MazePlan = std::vector<std::string_view>;

const MazePlan& mazePlan(SceneSize size);

} // namespace lambent::content

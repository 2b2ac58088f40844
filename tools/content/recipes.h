// The recipes one by one; contentRecipes() lists them.
#pragma once

#include "tools/content/content.h"

namespace lambent::content {

GeneratedScene writeCornell(const std::filesystem::path& folder);
GeneratedScene writeHall(const std::filesystem::path& folder);

} // namespace lambent::content

// Targets of the files that our programs write and read again.
#pragma once

#include "tests/fuzz/targets.h"

namespace lambent::fuzz {

std::vector<Target> ownFiles();

} // namespace lambent::fuzz

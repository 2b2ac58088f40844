// Seeds of what a glTF file holds compressed: .glb files whose second chunk is what meshopt, Draco or WebP wrote, so
// that mutations meet the decoders.
#pragma once

#include <string>
#include <vector>

namespace lambent::fuzz {

std::vector<std::string> compressedSeeds();

} // namespace lambent::fuzz

// Small textures computed from formulas; no picture files are taken from elsewhere.
#pragma once

#include "tools/content/gltf_writer.h"

namespace lambent::content {

/// Stone slabs in running bond with joints and a fine grain; tiles in both directions. Mean albedo about 0.45.
Texture stoneSlabs(const std::string& name);

/// One cell of a diagonal lattice: bars are opaque, the rest is cut away (alpha 0). Tiles in both directions.
Texture lattice(const std::string& name);

} // namespace lambent::content

// Small textures computed from formulas; no picture files are taken from elsewhere.
#pragma once

#include "tools/content/scene_builder.h"

namespace lambent::content {

/// Stone slabs in running bond with joints and a fine grain; tiles in both directions. Mean albedo about 0.45.
Texture stoneSlabs(const std::string& name);

/// One cell of a diagonal lattice: bars are opaque, the rest is cut away (alpha 0). Tiles in both directions.
Texture lattice(const std::string& name);

/// Bricks in running bond, 16 courses of four; mean albedo about 0.25.
Texture bricks(const std::string& name);

/// Dark grit with brighter grains, partly wet, and the roughness that goes with it: small where it is wet.
Texture asphalt(const std::string& name);
Texture asphaltFinish(const std::string& name);

/// Nearly even, with faint clouds and trowel marks; to be tinted. Mean albedo about 0.75.
Texture plaster(const std::string& name);

/// Eight boards side by side along u, each with a grain of its own and a joint; mean albedo about 0.3.
Texture planks(const std::string& name);

/// White stone with grey veins; mean albedo about 0.7.
Texture marble(const std::string& name);

} // namespace lambent::content

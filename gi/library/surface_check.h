// Whether a host's surfaces are those of the scene that it told.
#pragma once

#include "engine/trace/ray_query.h"
#include "gi/contract/surfaces.h"

#include <string>

namespace lambent::library {

/// Compares surfaces, as converted, with rays through some pixels of the camera. Returns what looks wrong in one line,
/// and what may cause it; empty: nothing. Reads them back, which waits for the GPU.
std::string checkSurfaces(const GBuffer& surfaces, CameraView camera, const RayQuery& rays);

} // namespace lambent::library

// What must hold after every frame, whatever the scene is.
#pragma once

#include "gi/viewer/viewer.h"

#include <string>

namespace lambent {

/// The first thing that does not hold; empty: light is finite and not negative at every pixel, albedo in [0, 1],
/// normals and depths finite. Indirect light by itself is an estimate with differences that rays add
/// (gi/gather/map_checks.h), and may be less than nothing. Virtual lights are no more than there
/// may be, and each that is alive has a place, a unit normal, and finite radiance and area that are not negative.
std::string defectOf(const Viewer& gi, const Settings& settings);

} // namespace lambent

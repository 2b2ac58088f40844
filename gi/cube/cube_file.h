// The layered depth cube on disk: what was built, or is being built, for a scene's geometry.
#pragma once

#include "gi/cube/layered_cube.h"

#include <filesystem>

namespace lambent {

/// Hash of what entries and sights depend on: where surfaces are and what they are made of. The cube itself
/// knows which lights are in it.
uint64_t cubeKey(const SceneView& view);

/// Saves the cube, replacing the file in one step. Throws RunError where it cannot be written.
void saveCube(const std::filesystem::path& file, const LayeredCube& cube, uint64_t key);
/// Says whether a file claims to be a cube, of any version.
bool isCube(const std::filesystem::path& file);
/// Loads a cube. Throws InputError for a file that is no cube, is damaged, of another version, or of other geometry.
LayeredCube loadCube(const std::filesystem::path& file, uint64_t key);

} // namespace lambent

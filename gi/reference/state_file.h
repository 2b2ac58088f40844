// Sums of a reference on disk, so that a run can go on later. The file is bound to what it is an image of.
#pragma once

#include "engine/view/scene_view.h"
#include "gi/reference/path_tracer.h"

#include <filesystem>

namespace lambent {

/// Hash of everything that the samples depend on: geometry, materials, textures, lights, camera, size, bounces, clamp,
/// seed, roughness and metalness where they count. Where the scene's file lies does not matter.
uint64_t referenceKey(const SceneView& view, const ReferenceInputs& in);

/// Saves the sums, replacing the file in one step.
void saveReference(const std::filesystem::path& file, const ReferenceSums& sums, uint64_t key);
/// Returns how many samples a file holds of the same image, by its head alone; 0: none.
uint32_t samplesIn(const std::filesystem::path& file, const ReferenceInputs& in, uint64_t key);
/// Loads sums. Throws InputError for a file that is no state, is damaged, or belongs to another image.
ReferenceSums loadReference(const std::filesystem::path& file, const ReferenceInputs& in, uint64_t key);

} // namespace lambent

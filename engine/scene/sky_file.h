// Pictures of the sky on disk.
#pragma once

#include "engine/view/sky.h"

#include <filesystem>
#include <string>
#include <vector>

namespace lambent {

inline constexpr uint64_t kMostSkyTexels = 8192 * 4096; // of a file

/// Says whether a name is that of a picture that readSky reads (.hdr or .exr, in any case).
bool namesSky(const std::filesystem::path& file);

/// Reads a picture by longitude and latitude. Ones longer than 4096 are halved until they are not. Adds to `notes` what
/// is shown differently: what is not a number, or negative, is black; what is more than a half float holds is the most
/// it holds. `opened`: another name of the file, by which it is read. Throws InputError.
std::shared_ptr<const SkyImage> readSky(const std::filesystem::path& file, std::vector<std::string>& notes,
                                        uint64_t mostTexels = kMostSkyTexels, const std::filesystem::path& opened = {});

} // namespace lambent

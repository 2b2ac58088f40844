// JPEG pictures to texels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace lambent {

/// Reads a picture's size from its header. Returns false where that is damaged, and why.
bool sizeOfJpeg(const uint8_t* bytes, size_t size, int& width, int& height, std::string& defect);
/// Decodes it into width · height texels of RGBA8, rows from the top. Returns false where it is damaged, also when only
/// in part, and why.
bool readJpeg(const uint8_t* bytes, size_t size, int width, int height, uint8_t* texels, std::string& defect);

} // namespace lambent

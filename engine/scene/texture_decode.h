// Texels to linear values, shared by the lookup and the importer.
#pragma once

#include "engine/scene/assets.h"

#include <array>

namespace lambent {

/// Linear value of each 8-bit sRGB code.
const std::array<float, 256>& srgbDecodeTable();

/// Linear RGBA of one texel; alpha is never encoded.
vec4 decodeTexel(const u8vec4& texel, bool srgb);

} // namespace lambent

// Whether a picture fits into this machine, before hours are spent on finding out.
#pragma once

#include "engine/scene/scene_view.h"

namespace lambent {

/// Throws RunError with the largest picture of the same shape that fits, where a frame of this size would not. Of a GPU
/// the memory is not known; a driver that draws on the CPU takes the machine's.
void checkPictureFits(const CameraView& camera);

} // namespace lambent

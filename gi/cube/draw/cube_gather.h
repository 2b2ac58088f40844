// Light of pixels from the layered depth cube (paper 5).
#pragma once

#include "gi/contract/gather.h"
#include "gi/contract/pass_context.h"

#include <memory>

namespace lambent {

/// Makes the gather of the cube. Its lights must be the same for every view (Needs::anyView), listed on the CPU.
std::unique_ptr<Gather> makeCubeGather(PassContext context);

} // namespace lambent

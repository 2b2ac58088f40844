// Who places the virtual lights: the sequential Monte Carlo set, or one of the techniques that paper 1 compares it with
// (section 5.1). All fill the same VplSet, so that visibility, gathering and filtering are the same for each.
#pragma once

#include "gi/vpl/smc.h"

namespace lambent {

/// The set of this frame by `source`. Slots whose light now stands elsewhere are listed as moved.
VplChanges placeVpls(VplSource source, VplSet& set, const VplUpdate& in, VplUpdateLog& log,
                     const std::function<void(int, int)>& progress = {});

} // namespace lambent

// What virtual lights take of memory: before it is taken, and once it is.
#pragma once

#include "gi/plan/settings.h"
#include "gi/vpl/vpl_set.h"

#include <cstddef>

namespace lambent {

/// Throws InputError, naming the settings, where the lights that they ask for need more than `free` bytes.
void refuseBeyondMemory(const SmcSettings& smc, const VplSettings& vpl, size_t free);

/// Bytes that they need at most.
double bytesOfVpls(const SmcSettings& smc, const VplSettings& vpl);

/// Bytes that a set holds, with its paths.
uint64_t bytesHeld(const VplSet& set);

} // namespace lambent

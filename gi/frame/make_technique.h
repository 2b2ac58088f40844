// The provider of light that settings choose.
#pragma once

#include "gi/contract/light_provider.h"
#include "gi/contract/pass_context.h"

#include <memory>

namespace lambent {

/// Makes the row's own provider, or one that is composed of the axes and serves all settings without a row of its own.
std::unique_ptr<LightProvider> makeTechnique(const Settings& settings, PassContext context);

} // namespace lambent

// What both context routes do once a context is current.
#pragma once

#include "engine/platform/gl_context.h"

namespace lambent {

/// Checks version and limits (RunError), installs the debug callback, and sets the conventions that every pass relies
/// on.
void setUpContext(DebugOutput debug);

} // namespace lambent

// Over the view of virtual lights: the one at the crosshair, with all that the sampler knows of it.
#pragma once

#include "engine/scene/scene_view.h"

namespace lambent {

class Viewer;

/// Draws, behind the panel: which light it is; the link to its mailbox, the point from which it is known to be seen;
/// the points of its cell, the surface that it stands for; its light paths; and what its shadow map shows. `scale`: of
/// the display's pixels.
void drawVplAtCrosshair(const Viewer& gi, const CameraView& camera, float scale);

} // namespace lambent

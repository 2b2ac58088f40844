// Gathers of virtual lights. Contents of this folder in data-flow order:
//   draw_gather     the draw that all of them share
//   list_pass       which lights it takes, for the GPU
//   pixel_gather    at pixels: every light at each, or the 4×4 subsets of interleaved sampling
//   ray_gather      at pixels, on the CPU, with a ray for every pair
//   add_pixels      what the CPU found at pixels, added to what was gathered
//   patch_atlas     the multiresolution buffer of papers 2 and 3, flattened; from its patches to pixels
//   patch_gather    at the patches that it marks
//   splat, splat_gather  lights into patches
//   tree_gather     the draw of light trees
//   map_checks      rays that check what maps say at pixels
//   near_light_pass what bounds take from near lights, added to any of these
// Those that bring a store of their own: gi/volume/volume_gather, gi/cube/draw/cube_gather.
#pragma once

#include "gi/contract/figures.h"
#include "gi/contract/gather.h"
#include "gi/contract/pass_context.h"

namespace lambent {

/// `subsets`: each pixel of 4×4 gathers a sixteenth of the lights.
std::unique_ptr<Gather> makePixelGather(PassContext context, bool subsets);
std::unique_ptr<Gather> makePatchGather(PassContext context, bool subsets);
std::unique_ptr<Gather> makeRayGather(PassContext context);
/// `perLight`: each light has patches of its own.
std::unique_ptr<Gather> makeSplatGather(PassContext context, bool perLight);
/// From a grid that light propagates through (`lpv`).
std::unique_ptr<Gather> makeVolumeGather(PassContext context);
/// From the layered depth cube (paper 5). Its lights must be the same for every view (Needs::anyView), listed on the
/// CPU.
std::unique_ptr<Gather> makeCubeGather(PassContext context);

} // namespace lambent

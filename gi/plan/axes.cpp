#include "gi/plan/axes.h"

#include "gi/plan/needs.h"

#include <iterator>

namespace lambent {

static_assert(std::size(kSources) == size_t(VplSource::None) + 1);
static_assert(std::size(kVisibilities) == size_t(VplVisibility::None) + 1);
static_assert(std::size(kGathers) == size_t(GatherMode::Own) + 1);
static_assert(std::size(kReconstructions) == size_t(Reconstruction::UpsampleFilter) + 1);

Needs needsOf(const Axes& axes) {
  const SourceRow& source = rowOf(axes.source);
  const GatherRow& gather = rowOf(axes.gather);
  const bool rays = axes.visibility == VplVisibility::Rays;
  Needs needs{.lights = source.lights, .anyView = source.anyView, .tree = source.tree};
  needs.bounces = needs.textures = needs.sampled();
  needs.maps = axes.visibility == VplVisibility::Maps && !source.tree;
  needs.lightsOnGpu = !rays;
  needs.lightsOnCpu = needs.sampled() || axes.visibility != VplVisibility::None || gather.volume;
  needs.subsets = gather.subsets && !rays;
  needs.lists = gather.lists && !rays;
  needs.nearRays = needs.sampled() && !gather.volume && !gather.stored;
  needs.stored = gather.stored;
  needs.freeGather = needs.sampled() && source.lights != LightSupply::Fixed && !gather.stored;
  needs.rayPerPair = rays;
  return needs;
}

Reconstruction reconstructionOf(GatherMode mode, bool filter) {
  const GatherRow& gather = rowOf(mode);
  const bool filtered = gather.subsets && filter;
  if (gather.patches) return filtered ? Reconstruction::UpsampleFilter : Reconstruction::Upsample;
  return filtered ? Reconstruction::Filter : Reconstruction::None;
}

std::string whyNot(const Axes& axes) {
  const SourceRow& source = rowOf(axes.source);
  const GatherRow& gather = rowOf(axes.gather);
  const std::string name = source.name;
  const std::string visibility = "vpl.visibility " + std::string(rowOf(axes.visibility).name) + ": ";
  const std::string mode = "gather.mode " + std::string(gather.name);
  const bool lights = source.lights != LightSupply::None, seen = axes.visibility != VplVisibility::None;
  if (!lights && axes.gather != GatherMode::Own)
    return "vpl.source none: " + mode + " needs virtual lights (smc, rsm, ...)";
  if (!lights && seen) return visibility + "there are no virtual lights to see (none)";
  if (source.tree && seen) return visibility + name + " has clusters of all sizes, and no shadow maps of them (none)";
  if (gather.volume && seen) return visibility + "light of a volume goes around corners by itself (none)";
  if (gather.stored && seen)
    return visibility + "what is stored was looked at by lights themselves, as cube.visibility says (none)";
  if (gather.stored && !source.anyView) return mode + ": the lights of " + name + " follow the view (ir, poisson)";
  if (source.tree && gather.volume)
    return "gather.mode volume: " + name + " has clusters of all sizes, and no list of them (smc, rsm, poisson, ...)";
  if (source.tree && gather.splats)
    return mode + ": " + name +
           "'s clusters are chosen by who gathers (multires, multires-interleaved, interleaved or full)";
  if (gather.lists && source.lights == LightSupply::Reflective && axes.visibility != VplVisibility::Rays)
    return mode + ": " + name + "'s lights are on the GPU alone (interleaved or full)";
  const auto is = [&](Reconstruction r) { return axes.reconstruction == r; };
  if (gather.patches != (is(Reconstruction::Upsample) || is(Reconstruction::UpsampleFilter)))
    return mode + (gather.patches ? ": light at patches is upsampled" : ": there are no patches to upsample");
  if (!gather.subsets && (is(Reconstruction::Filter) || is(Reconstruction::UpsampleFilter)))
    return mode + ": every pixel has seen every light, so nothing is filtered";
  return {};
}

} // namespace lambent

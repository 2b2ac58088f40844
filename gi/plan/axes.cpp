#include "gi/plan/axes.h"

#include <iterator>

namespace lambent {

static_assert(std::size(kSources) == size_t(VplSource::None) + 1);
static_assert(std::size(kVisibilities) == size_t(VplVisibility::None) + 1);
static_assert(std::size(kGathers) == size_t(GatherMode::Own) + 1);
static_assert(std::size(kReconstructions) == size_t(Reconstruction::UpsampleFilter) + 1);

std::string whyNot(const Axes& axes) {
  const SourceRow& source = rowOf(axes.source);
  const GatherRow& gather = rowOf(axes.gather);
  const std::string name = source.name;
  const bool lights = source.sampled || source.reflective;
  if (!lights && axes.gather != GatherMode::Own)
    return "vpl.source none: gather.mode " + std::string(gather.name) + " needs virtual lights (smc, rsm, ...)";
  if (!lights && axes.visibility != VplVisibility::None)
    return "vpl.visibility " + std::string(rowOf(axes.visibility).name) + ": there are no virtual lights to see (none)";
  if (source.tree && axes.visibility != VplVisibility::None)
    return "vpl.visibility " + std::string(rowOf(axes.visibility).name) + ": " + name +
           " has clusters of all sizes, and no shadow maps of them (none)";
  if (gather.volume && axes.visibility != VplVisibility::None)
    return "vpl.visibility " + std::string(rowOf(axes.visibility).name) +
           ": light of a volume goes around corners by itself (none)";
  if (gather.stored && axes.visibility != VplVisibility::None)
    return "vpl.visibility " + std::string(rowOf(axes.visibility).name) +
           ": what is stored was looked at by lights themselves, as cube.sights says (none)";
  if (gather.stored && !source.anyView)
    return "gather.mode " + std::string(gather.name) + ": the lights of " + name + " follow the view (ir, poisson)";
  if (source.tree && gather.volume)
    return "gather.mode volume: " + name + " has clusters of all sizes, and no list of them (smc, rsm, poisson, ...)";
  if (source.tree && gather.splats)
    return "gather.mode " + std::string(gather.name) + ": " + name +
           "'s clusters are chosen by who gathers (multires, multires-interleaved, interleaved or full)";
  const auto is = [&](Reconstruction r) { return axes.reconstruction == r; };
  if (gather.patches != (is(Reconstruction::Upsample) || is(Reconstruction::UpsampleFilter)))
    return "gather.mode " + std::string(gather.name) +
           (gather.patches ? ": light at patches is upsampled" : ": there are no patches to upsample");
  if (!gather.subsets && (is(Reconstruction::Filter) || is(Reconstruction::UpsampleFilter)))
    return "gather.mode " + std::string(gather.name) + ": every pixel has seen every light, so nothing is filtered";
  return {};
}

} // namespace lambent

// The factory of composed techniques: what each value of an axis is made of.
#include "engine/core/error.h"
#include "gi/frame/composed_technique.h"
#include "gi/gather/gathers.h"
#include "gi/reflective/reflective_source.h"
#include "gi/sources/sampled_source.h"

namespace lambent {

namespace {

bool byRays(const Axes& axes) { return axes.visibility == VplVisibility::Rays; }

} // namespace

/// One sampled source serves all samplers: gi/vpl/sources.h.
std::unique_ptr<LightSource> makeSource(const Axes& axes, PassContext context) {
  if (needsOf(axes).sampled()) return std::make_unique<SampledSource>(context);
  switch (axes.source) {
  case VplSource::Rsm:
    return std::make_unique<ReflectiveSource>(context, ReflectiveLights::Grid);
  case VplSource::Isr:
    return std::make_unique<ReflectiveSource>(context, ReflectiveLights::Clusters);
  case VplSource::Hisr:
    return std::make_unique<ReflectiveSource>(context, ReflectiveLights::Trees);
  default:
    return nullptr;
  }
}

bool sameSource(const Axes& a, const Axes& b) {
  return a.source == b.source || (needsOf(a).sampled() && needsOf(b).sampled());
}

std::unique_ptr<Gather> makeGather(const Axes& axes, PassContext context) {
  if (byRays(axes)) return makeRayGather(context);
  switch (axes.gather) {
  case GatherMode::Lists:
  case GatherMode::Interleaved:
    return makePixelGather(context, true);
  case GatherMode::Full:
    return makePixelGather(context, false);
  case GatherMode::Multires:
    return makePatchGather(context, false);
  case GatherMode::MultiresInterleaved:
    return makePatchGather(context, true);
  case GatherMode::Splat:
    return makeSplatGather(context, false);
  case GatherMode::SplatPerVpl:
    return makeSplatGather(context, true);
  case GatherMode::Volume:
    return makeVolumeGather(context);
  case GatherMode::Cube:
    return makeCubeGather(context);
  case GatherMode::Own:
    break;
  }
  CHECK(!"whyNot refuses it");
  return nullptr;
}

bool sameGather(const Axes& a, const Axes& b) { return byRays(a) == byRays(b) && (byRays(a) || a.gather == b.gather); }

} // namespace lambent

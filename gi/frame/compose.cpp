// The factory of composed techniques: what each value of an axis is made of.
#include "engine/core/error.h"
#include "gi/cube/draw/cube_gather.h"
#include "gi/frame/composed_technique.h"
#include "gi/gather/gathers.h"
#include "gi/reflective/reflective_source.h"
#include "gi/sources/sampled_source.h"
#include "gi/volume/light_volume.h"

namespace lambent {

namespace {

enum class SourceKind { None, Sampled, Grid, Clusters, Trees };

/// One sampled source serves all samplers: gi/vpl/sources.h.
SourceKind kindOf(VplSource source) {
  switch (source) {
  case VplSource::Smc:
  case VplSource::Ir:
  case VplSource::Mir:
  case VplSource::Tcas:
  case VplSource::Poisson:
    return SourceKind::Sampled;
  case VplSource::Rsm:
    return SourceKind::Grid;
  case VplSource::Isr:
    return SourceKind::Clusters;
  case VplSource::Hisr:
    return SourceKind::Trees;
  case VplSource::None:
    break;
  }
  return SourceKind::None;
}

bool byRays(const Axes& axes) { return axes.visibility == VplVisibility::Rays; }

} // namespace

std::unique_ptr<LightSource> makeSource(const Axes& axes, PassContext context) {
  switch (kindOf(axes.source)) {
  case SourceKind::Sampled:
    return std::make_unique<SampledSource>(context);
  case SourceKind::Grid:
    return std::make_unique<ReflectiveSource>(context, ReflectiveLights::Grid);
  case SourceKind::Clusters:
    return std::make_unique<ReflectiveSource>(context, ReflectiveLights::Clusters);
  case SourceKind::Trees:
    return std::make_unique<ReflectiveSource>(context, ReflectiveLights::Trees);
  case SourceKind::None:
    break;
  }
  return nullptr;
}

bool sameSource(const Axes& a, const Axes& b) { return kindOf(a.source) == kindOf(b.source); }

std::unique_ptr<Gather> makeGather(const Axes& axes, PassContext context) {
  if (byRays(axes)) return makeRayGather(context);
  switch (axes.gather) {
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

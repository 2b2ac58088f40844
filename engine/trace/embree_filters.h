// What Embree asks of a query while a ray is on its way, and what differs between its versions 3 and 4.
#pragma once

#include "engine/view/surface_point.h"

#if EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace lambent {

namespace { // of embree_query.cpp

/// What the alpha filter and hit shading need to know about a geometry of a bottom-level scene.
struct GeometryData {
  const SceneAssets* assets;
  uint32_t mesh, primitive;
};

/// Of this thread, since they were last added up.
thread_local uint64_t alphaTests = 0;

#if EMBREE_MAJOR >= 4
using EmbreeContext = RTCRayQueryContext;
void beginContext(EmbreeContext& c) { rtcInitRayQueryContext(&c); }
#else
using EmbreeContext = RTCIntersectContext;
void beginContext(EmbreeContext& c) { rtcInitIntersectContext(&c); }
#endif

/// Of every query; filters know it by its first member.
struct QueryContext {
  EmbreeContext embree;
  float* passes = nullptr; // of one ray: multiplied by what blended surfaces let through, which then stop nothing
  float from = 0;          // of a ray, in units of its direction: what blends is not met before
  QueryContext() { beginContext(embree); }
};

/// Lets rays through where an alpha-masked material is cut out, or a blended one not there for them.
void alphaFilter(const RTCFilterFunctionNArguments* args) {
  const auto& data = *static_cast<const GeometryData*>(args->geometryUserPtr);
  const Mesh& mesh = data.assets->meshes[data.mesh];
  const Primitive& primitive = mesh.primitives[data.primitive];
  const Material& material = data.assets->materials[primitive.material];
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] != -1) continue;
    ++alphaTests;
    if (material.alphaMode == AlphaMode::Opaque) continue;
    const QueryContext& context = *reinterpret_cast<const QueryContext*>(args->context);
    if (material.blends() && RTCRayN_tfar(args->ray, args->N, i) < context.from) {
      args->valid[i] = 0;
      continue;
    }
    const vec2 barycentric(RTCHitN_u(args->hit, args->N, i), RTCHitN_v(args->hit, args->N, i));
    const TrianglePlace place = trianglePlace(mesh, primitive, RTCHitN_primID(args->hit, args->N, i), barycentric);
    const float alpha = alphaAt(*data.assets, mesh, material, place);
    if (context.passes && material.blends()) {
      *context.passes *= 1 - shareThere(material, alpha);
      args->valid[i] = 0;
      continue;
    }
    if (!isThere(material, alpha, RTCRayN_id(args->ray, args->N, i), RTCHitN_instID(args->hit, args->N, i, 0),
                 RTCHitN_primID(args->hit, args->N, i)))
      args->valid[i] = 0;
  }
}

/// Lets rays of an eye through backs that are hidden.
void backFilter(const RTCFilterFunctionNArguments* args) {
  const auto& data = *static_cast<const GeometryData*>(args->geometryUserPtr);
  const Material& material = data.assets->materials[data.assets->meshes[data.mesh].primitives[data.primitive].material];
  if (!material.backHidden) return;
  for (unsigned i = 0; i < args->N; ++i) {
    const vec3 front(RTCHitN_Ng_x(args->hit, args->N, i), RTCHitN_Ng_y(args->hit, args->N, i),
                     RTCHitN_Ng_z(args->hit, args->N, i));
    const vec3 direction(RTCRayN_dir_x(args->ray, args->N, i), RTCRayN_dir_y(args->ray, args->N, i),
                         RTCRayN_dir_z(args->ray, args->N, i));
    if (args->valid[i] == -1 && !(glm::dot(front, direction) < 0)) args->valid[i] = 0;
  }
}

#if EMBREE_MAJOR >= 4
constexpr RTCSceneFlags kFilteredByRay = RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;
struct TraceArguments {
  QueryContext context;
  RTCIntersectArguments intersect;
  RTCOccludedArguments occluded;
  TraceArguments() {
    rtcInitIntersectArguments(&intersect);
    rtcInitOccludedArguments(&occluded);
    intersect.context = occluded.context = &context.embree;
  }
  TraceArguments(const TraceArguments&) = delete;
  void hideBacks() {
    intersect.filter = backFilter;
    intersect.flags = RTCRayQueryFlags(intersect.flags | RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER);
  }
};
void intersect1(RTCScene s, TraceArguments& a, RTCRayHit* r) { rtcIntersect1(s, r, &a.intersect); }
void occluded1(RTCScene s, TraceArguments& a, RTCRay* r) { rtcOccluded1(s, r, &a.occluded); }
void intersect16(const int* valid, RTCScene s, TraceArguments& a, RTCRayHit16* r) {
  a.intersect.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcIntersect16(valid, s, r, &a.intersect);
}
#else
constexpr RTCSceneFlags kFilteredByRay = RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;
struct TraceArguments {
  QueryContext context;
  void hideBacks() { context.embree.filter = backFilter; }
};
void intersect1(RTCScene s, TraceArguments& a, RTCRayHit* r) { rtcIntersect1(s, &a.context.embree, r); }
void occluded1(RTCScene s, TraceArguments& a, RTCRay* r) { rtcOccluded1(s, &a.context.embree, r); }
void intersect16(const int* valid, RTCScene s, TraceArguments& a, RTCRayHit16* r) {
  a.context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect16(valid, s, &a.context.embree, r);
}
#endif

} // namespace

} // namespace lambent

// lambent bench SCENE --rays: the scene's rays on the GPU against Embree's, ray by ray, and how many a second either
// traces.
#include "engine/core/parallel.h"
#include "engine/core/rng.h"
#include "engine/core/sampling.h"
#include "engine/gpu_trace/gpu_rays.h"
#include "engine/platform/gl_context.h"
#include "engine/trace/embree_query.h"
#include "tools/lambent/bench.h"

#include <chrono>
#include <cstdio>

namespace lambent {

namespace {

/// From places all over the scene's box, and between surfaces that such rays meet, as shadow rays go: half each.
std::vector<Ray> randomRays(const RayQuery& rays, const Aabb& bounds, size_t count, uint32_t seed) {
  std::vector<Ray> out(count / 2);
  for (size_t i = 0; i < out.size(); ++i) {
    Rng rng(seed, Stream::Test, uint32_t(i));
    out[i] = {bounds.lo + bounds.size() * rng.next3(), sampleSphere(rng.next2())};
  }
  std::vector<SurfaceHit> hits(out.size());
  rays.closest(out, hits);
  std::erase_if(hits, [](const SurfaceHit& h) { return !h.valid(); });
  const auto off = [&](const SurfaceHit& h) { return offsetPoint(h.position, h.geometricNormal, rays.rayEpsilon()); };
  for (size_t i = 0; out.size() < count; ++i)
    out.push_back(hits.empty() ? out[i] : segment(off(hits[i % hits.size()]), off(hits[(i * 7919 + 1) % hits.size()])));
  return out;
}

/// Why two answers may differ, or that nothing excuses it.
enum class Difference { None, SamePlace, End, Edge, Grazing, Alpha, Other, Count };
constexpr const char* kDifferences[] = {"the same",
                                        "two surfaces at the same place (each to the query's ray epsilon)",
                                        "at an end of the segment (as near)",
                                        "at an edge (a thousandth of the triangle)",
                                        "grazing (a thousandth of a right angle)",
                                        "at the border of a mask, or on what is blended",
                                        "other"};

Difference differenceOf(const SceneView& view, float rayEpsilon, const Ray& ray, const SurfaceHit& a,
                        const SurfaceHit& b) {
  // Metres between two places on the ray, across the surface that lies there.
  const auto apart = [&](const SurfaceHit& h, float t) {
    return std::abs((h.t - t) * glm::dot(h.geometricNormal, ray.direction));
  };
  const bool one = a.instance == b.instance && a.primitive == b.primitive && a.triangle == b.triangle;
  if (!a.valid() && !b.valid()) return Difference::None;
  if (a.valid() && b.valid() && apart(a, b.t) <= 2 * rayEpsilon) return one ? Difference::None : Difference::SamePlace;
  for (const SurfaceHit* h : {&a, &b}) {
    if (!h->valid()) continue;
    if (apart(*h, 0) <= 2 * rayEpsilon || apart(*h, ray.tMax) <= 2 * rayEpsilon) return Difference::End;
    const float least = std::min({h->barycentric.x, h->barycentric.y, 1 - h->barycentric.x - h->barycentric.y});
    if (least < 1e-3f) return Difference::Edge;
    if (std::abs(glm::dot(h->geometricNormal, glm::normalize(ray.direction))) < 1.6e-3f) return Difference::Grazing;
    const Mesh& mesh = view.assets->meshes[view.instances[h->instance].mesh];
    if (view.assets->materials[mesh.primitives[h->primitive].material].alphaMode != AlphaMode::Opaque)
      return Difference::Alpha;
  }
  return Difference::Other;
}

double secondsOf(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

} // namespace

void benchRays(const BenchOptions& options) {
  const Study study(options, options.launch.scene, {});
  const std::string machine = machineText(study.context);
  const SceneView view = study.opened->at(0);
  EmbreeQuery embree(*view.assets);
  embree.update(view);
  gl::ProgramCache programs;
  GpuRays gpu(programs, *view.assets);
  gpu.update(view);

  const std::vector<Ray> rays =
      randomRays(embree, view.boundsWorld, options.quick ? 10000 : 1000000, study.opened->seed);
  std::vector<SurfaceHit> a(rays.size()), b(rays.size());
  std::vector<uint8_t> blockedA(rays.size()), blockedB(rays.size());
  const auto parallel = [&](auto&& trace) {
    parallelFor(rays.size(), 4096, [&](size_t begin, size_t end) { trace(begin, end - begin); });
  };
  gpu.occluded(std::span(rays).first(64), std::span(blockedB).first(64)); // compiles
  std::vector<float> t(rays.size());
  gpu.distances(std::span(rays).first(64), std::span(t).first(64));
  struct Row {
    const char* name;
    double closest, any; // seconds
  };
  const std::span all(rays);
  const Row rows[] = {
      {"Embree", secondsOf([&] {
         parallel([&](size_t at, size_t n) { embree.closest(all.subspan(at, n), std::span(a).subspan(at, n)); });
       }),
       secondsOf([&] {
         parallel(
             [&](size_t at, size_t n) { embree.occluded(all.subspan(at, n), std::span(blockedA).subspan(at, n)); });
       })},
      {"GPU", secondsOf([&] { gpu.distances(rays, t); }), secondsOf([&] { gpu.occluded(rays, blockedB); })}};
  gpu.closest(rays, b);

  std::array<size_t, size_t(Difference::Count)> counts{};
  size_t blockedOnly[2] = {};
  for (size_t i = 0; i < rays.size(); ++i) {
    ++counts[size_t(differenceOf(view, embree.rayEpsilon(), rays[i], a[i], b[i]))];
    if (blockedA[i] != blockedB[i]) ++blockedOnly[blockedB[i]];
  }
  const double count = double(rays.size());
  Value figures = Value::of("scene", options.launch.scene, "rays", rays.size(), "machine", machine, "blocked_only",
                            Value::of("Embree", blockedOnly[0], "GPU", blockedOnly[1]));
  for (const Row& r : rows)
    figures["rays_per_second"][r.name] = Value::of("closest", count / r.closest, "any", count / r.any);
  for (size_t i = 0; i < counts.size(); ++i) figures["differences"][kDifferences[i]] = counts[i];
  writeJson(options.output.json, figures);
  if (options.output.quiet) return;
  std::printf("%zu rays, half of them all over the scene, half between surfaces; %s\n", rays.size(), machine.c_str());
  for (const Row& r : rows)
    std::printf("  %-8s %8.2f million closest hits a second, %8.2f million answers whether anything is met\n", r.name,
                1e-6 * count / r.closest, 1e-6 * count / r.any);
  for (size_t i = 0; i < counts.size(); ++i) std::printf("  %8zu %s\n", counts[i], kDifferences[i]);
  std::printf("  %8zu blocked to Embree alone, %zu to the GPU alone\n", blockedOnly[0], blockedOnly[1]);
}

} // namespace lambent

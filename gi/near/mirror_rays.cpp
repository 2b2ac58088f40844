#include "gi/near/mirror_rays.h"

#include "engine/core/parallel.h"
#include "engine/core/rng.h"
#include "engine/core/sampling.h"
#include "gi/lighting/receivers.h"
#include "gi/plan/effects.h"
#include "gi/vpl/smc.h"

#include <algorithm>

namespace lambent {

namespace {

constexpr int kPaths = 256; // light paths whose numbers take turns

struct Mirrored {
  uint32_t pixel;
  vec3 weight; // glossy light per radiance met
  int path;
};

bool hasMirror(const SceneAssets& assets, const Mesh& mesh) {
  return std::ranges::any_of(mesh.primitives,
                             [&](const Primitive& p) { return mirrors(assets, assets.materials[p.material]); });
}

} // namespace

PixelBox mirrorsOf(const SceneView& view) {
  const vec2 size(view.camera.width, view.camera.height);
  const mat4 clipFromWorld = clipFromView(view.camera) * glm::inverse(view.camera.worldFromView);
  vec2 lo(kInfinity), hi(-kInfinity);
  for (const InstanceView& i : view.instances) {
    if (!hasMirror(*view.assets, view.assets->meshes[i.mesh])) continue;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::bvec3 upper(corner & 1, corner & 2, corner & 4);
      const vec4 clip = clipFromWorld * vec4(glm::mix(i.boundsWorld.lo, i.boundsWorld.hi, upper), 1);
      if (!(clip.w > 1e-6f)) return {{0, 0}, glm::ivec2(size)}; // reaches behind the camera
      const vec2 at = (vec2(clip.x, -clip.y) / clip.w * 0.5f + 0.5f) * size;
      lo = glm::min(lo, at);
      hi = glm::max(hi, at);
    }
  }
  lo = glm::clamp(lo, vec2(0), size);
  hi = glm::clamp(hi, vec2(0), size);
  return {glm::ivec2(glm::floor(lo)), glm::ivec2(glm::ceil(hi))};
}

std::vector<vec3> traceMirrors(const MirrorInputs& in, RayCounts& counts) {
  const CameraView& camera = in.view.camera;
  const float epsilon = in.rays.rayEpsilon();
  std::vector<vec3> glossy(size_t(camera.width) * camera.height, vec3(0));
  const RadianceUpdate update{.paths = kPaths, .bounces = in.bounces, .seed = in.seed};
  const glm::ivec2 lo = glm::max(in.pixels.lo, glm::ivec2(0)),
                   hi = glm::min(in.pixels.hi, glm::ivec2(camera.width, camera.height));
  if (PixelBox{lo, hi}.empty()) return glossy;
  const size_t across = size_t(hi.x - lo.x);
  const auto pixelOf = [&](size_t k) {
    return (size_t(lo.y) + k / across) * size_t(camera.width) + size_t(lo.x) + k % across;
  };
  constexpr size_t kGrain = 512; // pixels
  parallelCount(across * size_t(hi.y - lo.y), kGrain, counts, [&](size_t begin, size_t end, RayCounts& count) {
    std::vector<vec2> centres;
    for (size_t k = begin; k < end; ++k) centres.push_back(pixelCentre(camera, pixelOf(k)));
    const std::vector<SurfaceHit> surfaces = surfacesAt(in.rays, camera, centres, in.normalMaps ? &in.view : nullptr);
    count.closest += centres.size();
    std::vector<Ray> rays;
    std::vector<Mirrored> mirrored;
    for (size_t n = begin; n < end; ++n) {
      const SurfaceHit& h = surfaces[n - begin];
      if (!h.valid()) continue;
      const size_t i = pixelOf(n);
      const size_t row = i / size_t(camera.width), column = i % size_t(camera.width);
      const Receiver receiver =
          in.finish.empty()
              ? receiverOf(in.view, h)
              : receiverOf(in.view, h, in.finish[(size_t(camera.height) - 1 - row) * size_t(camera.width) + column]);
      const float share = mirrorShare(receiver) / float(in.samples);
      if (!(share > 0)) continue;
      const vec3 shift = Rng(in.seed, Stream::Mirrors, uint32_t(i)).next3();
      for (int k = 0; k < in.samples; ++k) {
        const uint32_t sample = in.sample * uint32_t(in.samples) + uint32_t(k);
        const vec3 u = additiveRecurrence3(sample, shift);
        const vec3 direction = sampleLobe(receiver, {u.x, u.y});
        const float cosine = glm::dot(direction, h.normal);
        if (!(cosine > 0) || glm::dot(direction, h.geometricNormal) <= 0) continue;
        rays.push_back({offsetPoint(h.position, h.geometricNormal, epsilon), direction});
        mirrored.push_back({uint32_t(i),
                            glossyReflectance(receiver, direction, 0) / glossyTint(receiver) *
                                (share * cosine / pdfLobe(receiver, direction)),
                            int(sample % kPaths)});
      }
    }
    std::vector<SurfaceHit> hits(rays.size());
    in.rays.closest(rays, hits);
    count.closest += rays.size();
    std::vector<Vpl> met;
    size_t kept = 0;
    for (size_t k = 0; k < hits.size(); ++k) {
      const SurfaceHit& h = hits[k];
      if (!h.valid() || maxComponent(h.albedo) <= 0) continue;
      met.push_back(patchOf(h, 1 + mirrored[k].pixel)); // numbers of its own
      mirrored[kept++] = mirrored[k];
    }
    std::vector<RadianceJob> jobs;
    for (size_t k = 0; k < kept; ++k) jobs.push_back({.vpl = &met[k], .path = mirrored[k].path});
    count += estimateRadiance(jobs, in.rays, in.lights, update).rays;
    for (size_t k = 0; k < kept; ++k) glossy[mirrored[k].pixel] += mirrored[k].weight * met[k].radiance;
  });
  return glossy;
}

} // namespace lambent

#include "gi/direct/area_light_pass.h"

#include "engine/gl/profiler.h"
#include "gi/gather/draw_gather.h"
#include "gi/lighting/area_lobe.h"

#include <algorithm>

namespace lambent {

namespace {

/// A layer for each member of AreaLobe.
gl::Texture lobeTexture() {
  constexpr int kLayers = sizeof(AreaLobe) / sizeof(vec4);
  gl::Texture texture("area lights/lobes", {.kind = gl::TextureKind::Array,
                                            .format = GL_RGBA32F,
                                            .width = kLobeRoughnesses,
                                            .height = kLobeAngles,
                                            .layers = kLayers,
                                            .linear = true});
  std::vector<vec4> layer;
  for (int i = 0; i < kLayers; ++i) {
    layer.clear();
    for (const AreaLobe& lobe : lobeTable()) layer.push_back(i == 0 ? lobe.white : i == 1 ? lobe.schlick : lobe.share);
    glTextureSubImage3D(texture.name(), 0, 0, 0, i, kLobeRoughnesses, kLobeAngles, 1, GL_RGBA, GL_FLOAT, layer.data());
  }
  return texture;
}

} // namespace

void AreaLightPass::add(const World& world, const GBuffer& surfaces, SurfaceReader& reader, Patches& patches,
                        const Settings& settings, const LightTarget& target, FrameStats& stats) {
  const SceneChanges& changes = world.view.changes;
  if (changes.first || changes.lights || changes.geometry || changes.instances || lights_.lights.empty()) {
    const CpuScope scope(stats.stages, key(StageId::AreaRays));
    collect(world);
  }
  fragments_ = {};
  if (lights_.lights.empty()) return;
  const PatchPyramid& pyramid = patches.pyramid();
  GBuffer plain = surfaces; // shares have no lobes
  plain.finish = nullptr;
  atlas_.fit(plain, pyramid, false);
  const FrameSurfaces seen = reader.read(surfaces);
  readLevels(seen, pyramid);
  const RayQuery& rays = tracerFor(world, seen, settings.area);
  stats.areaTracer = tracer_.report();
  std::vector<AreaLights> groups;
  {
    const CpuScope scope(stats.stages, key(StageId::AreaRays));
    groups = groups_.of(lights_, rays, seen, stats.raysArea);
  }
  blocks_.reserve((lights_.pieces.size() + 2 * groups.size() * kPiecesPerBlock) * sizeof(AreaPiece));
  const glm::ivec2 size(surfaces.width, surfaces.height);
  std::vector<uint8_t> smallest(size_t(size.x) * size_t(size.y), 0);
  for (const AreaLights& group : groups) {
    FragmentCounts counts;
    {
      const CpuScope scope(stats.stages, key(StageId::AreaRays));
      counts = shareVisible(rays, group, seen, settings.area, levels_);
    }
    stats.areaFragments += counts.fragments;
    stats.raysArea += counts.rays;
    noteFragments(size, smallest);
    if (counts.dark == counts.fragments) continue; // nothing of it arrives
    const gl::PassScope scope = context_.scope(StageId::AreaLight);
    for (size_t level = 0; level < levels_.size(); ++level) atlas_.put(int(level), levels_[level].visible);
    shade(surfaces, group.pieces, upsample(plain, settings), target);
  }
  fragments_ = gl::Texture("area lights/fragments", {.format = GL_R8, .width = size.x, .height = size.y});
  glTextureSubImage2D(fragments_.name(), 0, 0, 0, size.x, size.y, GL_RED, GL_UNSIGNED_BYTE, smallest.data());
}

void AreaLightPass::noteFragments(const glm::ivec2& size, std::vector<uint8_t>& smallest) const {
  for (int level = int(levels_.size()) - 1; level >= 0; --level) {
    const FragmentLevel& at = levels_[size_t(level)];
    const int side = 1 << level;
    for (int i = 0; i < int(at.visible.size()); ++i) {
      if (at.visible[size_t(i)].w == 0) continue;
      const glm::ivec2 lo = glm::ivec2(i % at.size.x, i / at.size.x) * side, hi = glm::min(lo + side, size);
      for (int y = lo.y; y < hi.y; ++y)
        for (int x = lo.x; x < hi.x; ++x) {
          uint8_t& here = smallest[size_t(y) * size_t(size.x) + size_t(x)];
          here = here == 0 ? uint8_t(level + 1) : std::min(here, uint8_t(level + 1));
        }
    }
  }
}

/// Collects the lights again where emitters changed: what else moves does not change them.
void AreaLightPass::collect(const World& world) {
  const std::vector<EmitterTriangle>& now = world.lights.triangles;
  const bool same = now.size() == triangles_.size() &&
                    std::ranges::equal(now, triangles_, [](const EmitterTriangle& a, const EmitterTriangle& b) {
                      return a.p0 == b.p0 && a.e1 == b.e1 && a.e2 == b.e2 && a.radiance == b.radiance;
                    });
  if (same && !world.view.changes.first && !lights_.lights.empty()) return;
  if (world.view.changes.first || now.size() != triangles_.size()) groups_.forget(); // other lamps
  lights_ = areaLights(world.lights);
  triangles_ = now;
}

/// Embree or the GPU.
const RayQuery& AreaLightPass::tracerFor(const World& world, const FrameSurfaces& surfaces,
                                         const AreaSettings& settings) {
  tracer_.take(settings.tracer == AreaTracer::Auto ? std::nullopt : std::optional(settings.tracer == AreaTracer::Gpu),
               [&] { return timesOf(world, surfaces); });
  if (tracer_.gpu()) return gpuRays(world);
  gpuRays_.reset();
  return world.rays;
}

const RayQuery& AreaLightPass::gpuRays(const World& world) {
  if (!gpuRays_ || world.view.changes.first || traced_ != world.view.assets->meshRevision)
    gpuRays_ = std::make_unique<GpuRays>(context_.programs, *world.view.assets);
  traced_ = world.view.assets->meshRevision;
  gpuRays_->update(world.view);
  return *gpuRays_;
}

/// None where no light reaches the frame: another one decides.
std::optional<MakerTimes> AreaLightPass::timesOf(const World& world, const FrameSurfaces& surfaces) {
  const std::vector<glm::ivec2> pixels = surfaces.some(256); // with 64 rays each
  const auto msPerMillion = [&](const RayQuery& rays) {
    uint64_t count = 0;
    const double seconds = gl::secondsOf([&] {
      for (const AreaSeen& seen : AreaVisibility(rays, lights_, surfaces, 16).ofPixels(pixels, true))
        count += seen.rays;
    });
    return count > 0 ? seconds * 1e9 / double(count) : 0;
  };
  const RayQuery& gpu = gpuRays(world);
  msPerMillion(gpu); // compiles
  const double onGpu = msPerMillion(gpu), onCpu = msPerMillion(world.rays);
  if (!(onCpu > 0)) return {};
  return MakerTimes{onCpu, onGpu, "a million rays"};
}

/// What the CPU has to know of the image. Waits for the GPU.
void AreaLightPass::readLevels(const FrameSurfaces& seen, const PatchPyramid& pyramid) {
  levels_.resize(size_t(pyramid.levels) + 1);
  std::vector<float> split, plane;
  for (int level = 0; level <= pyramid.levels; ++level) {
    FragmentLevel& at = levels_[size_t(level)];
    at.size = pyramid.padded / (1 << level);
    at.smooth.assign(size_t(at.size.x) * size_t(at.size.y), 0);
    if (level == 0) {
      for (int y = 0; y < seen.height; ++y)
        for (int x = 0; x < seen.width; ++x) at.smooth[size_t(y) * size_t(at.size.x) + size_t(x)] = seen.seen({x, y});
      continue;
    }
    split.resize(at.smooth.size());
    plane.resize(at.smooth.size());
    pyramid.normalLo->read(std::span(split), GL_ALPHA, GL_FLOAT, level - 1);
    pyramid.plane->read(std::span(plane), GL_RED, GL_FLOAT, level - 1);
    for (size_t i = 0; i < split.size(); ++i) at.smooth[i] = split[i] <= 0.5f && plane[i] > 0;
  }
}

const gl::Texture& AreaLightPass::upsample(const GBuffer& surfaces, const Settings& settings) {
  if (!fitsBasisFunctions(settings.area.upsample)) {
    Settings between = settings;
    between.multires.upsample =
        settings.area.upsample == AreaUpsample::Bilinear ? PatchUpsample::Bilinear : PatchUpsample::Bilateral;
    between.multires.detail = 0;
    atlas_.upsample(surfaces, between);
    return *atlas_.light().irradiance;
  }
  const glm::ivec2 size(surfaces.width, surfaces.height);
  if (!share_ || share_.width() != size.x || share_.height() != size.y) {
    share_ = gl::Texture("area lights/share", {.format = GL_RGBA32F, .width = size.x, .height = size.y});
    stencil_ = gl::Texture("area lights/stencil", {.format = GL_DEPTH24_STENCIL8, .width = size.x, .height = size.y});
    framebuffer_ = gl::Framebuffer("area lights", {&share_}, &stencil_);
  }
  framebuffer_.bind();
  bindSurfaces(surfaces);
  atlas_.bind(2);
  // What quarters say that were compared: shares alone, or answers one by one.
  const AreaSettings& area = settings.area;
  const bool byAnswers = area.refinement == AreaRefinement::SubFragments && area.threshold == 1;
  const bool centres = area.upsample == AreaUpsample::RbfCentres || area.refinement == AreaRefinement::Neighbours;
  const int stable = centres ? 0 : byAnswers ? 2 : 1;
  const auto draw = [&](const char* variant, gl::PipelineState state) {
    std::vector<std::string> defines;
    if (*variant) defines.push_back(variant);
    const gl::Program& program =
        context_.programs.get({.fragment = "area_upsample.frag", .defines = std::move(defines)});
    program.use();
    program.set("base", atlas_.shape().base);
    program.set("coarsest", atlas_.shape().coarsest);
    program.set("normalPower", settings.filter.normalPower);
    program.set("distanceSigma", settings.filter.distance);
    program.set("stable", stable);
    state.width = size.x;
    state.height = size.y;
    state.apply();
    gl::drawFullscreen();
  };
  // Software Mesa runs a shader's costly half for every pixel, whichever way it branches: 67 ms in place of 20.
  draw("", {});
  const GLint zero = 0;
  glClearNamedFramebufferiv(framebuffer_.name(), GL_STENCIL, 0, &zero);
  draw("MARK", {.stencil = gl::Stencil::Mark, .colors = false});
  draw("BETWEEN", {.stencil = gl::Stencil::Marked});
  return share_;
}

void AreaLightPass::shade(const GBuffer& surfaces, std::vector<AreaPiece> pieces, const gl::Texture& share,
                          const LightTarget& target) {
  share.bind(2);
  if (surfaces.finish) {
    if (!lobes_) lobes_ = lobeTexture();
    lobes_.bind(3);
  }
  target.bind();
  gl::PipelineState{.add = true, .width = surfaces.width, .height = surfaces.height}.apply();
  const auto disks = std::ranges::stable_partition(pieces, [](const AreaPiece& p) { return p.corners[0].w > 0; });
  shadePieces(surfaces, std::span(pieces).first(pieces.size() - disks.size()), false);
  shadePieces(surfaces, disks, true);
}

void AreaLightPass::shadePieces(const GBuffer& surfaces, std::span<const AreaPiece> pieces, bool disks) {
  std::vector<std::string> defines = bindSurfaces(surfaces);
  if (disks) defines.push_back("DISKS");
  const gl::Program& program = context_.programs.get({.fragment = "area_light.frag", .defines = std::move(defines)});
  program.use();
  if (surfaces.finish) program.set("spread", GatherSettings{}.spread); // as DirectLight
  for (size_t first = 0; first < pieces.size(); first += kPiecesPerBlock) {
    const std::span some = pieces.subspan(first, std::min(pieces.size() - first, size_t(kPiecesPerBlock)));
    std::vector<AreaPiece> block(some.begin(), some.end());
    program.set("pieceCount", int(block.size()));
    block.resize(kPiecesPerBlock);
    blocks_.write(kPiecesPerBlock * sizeof(AreaPiece), block.data()).bindUniform(1);
    gl::drawFullscreen();
  }
}

} // namespace lambent

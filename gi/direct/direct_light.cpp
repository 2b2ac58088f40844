#include "gi/direct/direct_light.h"

#include "gi/gather/add_pixels.h"
#include "gi/gather/draw_gather.h"
#include "gi/lighting/dirty_region.h"
#include "gi/vpl/smc.h"

#include <algorithm>
#include <array>
#include <bit>

namespace lambent {

namespace {

/// The surfaces that the camera sees, at a fixed grid of rays, so that they are the same every time.
std::vector<vec3> visiblePlaces(const World& world, RayCounts& counts) {
  std::vector<vec3> places;
  for (const VisiblePoint& p : findVisiblePoints(world.rays, world.view.camera, 1024, 0, 0, counts))
    places.push_back(p.position);
  return places;
}

/// Their box, grown by a tenth for what lies between the rays.
Aabb boxOf(std::span<const vec3> places, const Aabb& scene) {
  Aabb box;
  for (const vec3& p : places) box.add(p);
  if (box.empty()) return scene;
  const vec3 margin = 0.05f * box.size() + 0.02f * box.diameter();
  box.lo = glm::max(box.lo - margin, scene.lo);
  box.hi = glm::min(box.hi + margin, scene.hi);
  return box;
}

/// With the resolutions that follow the frame filled in.
ShadowSettings resolved(ShadowSettings shadow, int frameWidth) {
  const int width = int(std::bit_ceil(unsigned(frameWidth)));
  if (shadow.sunResolution == 0) shadow.sunResolution = 2 * width;
  if (shadow.pointResolution == 0) shadow.pointResolution = std::max(1, width / 2);
  if (shadow.spotResolution == 0) shadow.spotResolution = width;
  return shadow;
}

const char* defineOf(MapKind kind) {
  return kind == MapKind::Cube      ? "CUBE_MAPS"
         : kind == MapKind::Spot    ? "SPOT_MAPS"
         : kind == MapKind::Emitter ? "EMITTER_MAPS"
                                    : "SUN_MAPS";
}

std::array<DirectLight::Area, 2> halves(const DirectLight::Area& a) {
  if (a.width > a.height)
    return {{{a.x, a.y, a.width / 2, a.height}, {a.x + a.width / 2, a.y, a.width - a.width / 2, a.height}}};
  return {{{a.x, a.y, a.width, a.height / 2}, {a.x, a.y + a.height / 2, a.width, a.height - a.height / 2}}};
}

gl::Sampler samplerOf(const std::string& label, GLenum filter, GLenum compareMode) {
  gl::Sampler sampler(label);
  const GLuint name = sampler.name();
  glSamplerParameteri(name, GL_TEXTURE_MIN_FILTER, GLint(filter));
  glSamplerParameteri(name, GL_TEXTURE_MAG_FILTER, GLint(filter));
  glSamplerParameteri(name, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glSamplerParameteri(name, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glSamplerParameteri(name, GL_TEXTURE_COMPARE_MODE, GLint(compareMode));
  glSamplerParameteri(name, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL); // lit where reference ≤ stored
  return sampler;
}

} // namespace

DirectLight::DirectLight(PassContext context, uint32_t mostDoubts)
    : context_(context), shadows_(context), emitters_(context), areas_(context), soft_(context),
      doubts_(std::min(mostDoubts, gl::mostBufferTexels())), depths_(samplerOf("direct/depths", GL_NEAREST, GL_NONE)),
      smoothDistances_(samplerOf("direct/smooth distances", GL_LINEAR, GL_COMPARE_REF_TO_TEXTURE)) {}

SurfaceLighting DirectLight::run(const Frame& in, FrameStats& stats) {
  const bool changed = in.plan.seenChanges() || stale_ || unfinished_;
  if (!changed && !pending()) return light_;
  const bool first = std::exchange(unfinished_, true);
  stale_ |= first;
  if (changed) lightByMaps(in, stats);
  light_ = mapped_.light();
  const Emitters emitters = emittersBy(in);
  if (emitters == Emitters::Patches && changed) {
    areas_.add(in.world, in.surfaces, reader_, in.patches, in.settings, mapped_, stats);
    stats.of(EffectId::Emissive) += stats.areaFragments;
    stats.of(EffectId::SoftShadows) += stats.areaFragments;
  }
  if (emitters != Emitters::Patches) areas_.forget();
  if (softByRays(in) && (emitters == Emitters::Rays || hasSkyOrSuns(in))) {
    target_.fit(in.surfaces);
    target_.clear();
    {
      const gl::PassScope scope = context_.scope(StageId::SoftLight);
      addLight(context_, mapped_.light(), target_);
    }
    soft_.add(in, reader_, emitters == Emitters::Rays ? SoftParts::All : SoftParts::SkyAndSuns, target_, stats);
    light_ = target_.light();
  } else {
    soft_.forget();
  }
  light_.fragments = emitters == Emitters::Patches ? areas_.fragments() : nullptr;
  stale_ = unfinished_ = false;
  return light_;
}

/// Who brings the light of emissive surfaces. As one sample they are as good as points.
DirectLight::Emitters DirectLight::emittersBy(const Frame& in) {
  if (!in.plan.on(EffectId::Emissive)) return Emitters::None;
  if (!in.plan.on(EffectId::SoftShadows)) return Emitters::Maps;
  if (in.settings.shadow.emitters == EmitterShadows::Patches) return Emitters::Patches;
  return softByRays(in) ? Emitters::Rays : Emitters::Maps;
}

bool DirectLight::softByRays(const Frame& in) { return in.settings.direct.soft == SoftLightBy::Rays; }

bool DirectLight::hasSkyOrSuns(const Frame& in) {
  return !in.world.lights.sky.black() || std::ranges::any_of(in.world.lights.punctual, hasDisk);
}

bool DirectLight::skyByMaps(const Frame& in) { return in.plan.on(EffectId::Sky) && !softByRays(in); }

void DirectLight::lightByMaps(const Frame& in, FrameStats& stats) {
  const bool allowed = in.settings.shadow.rays;
  const std::vector<LightBlock> blocks = shadowed(in, allowed, stats);
  const bool rays = allowed && !blocks.empty();
  const Area whole{.width = in.surfaces.width, .height = in.surfaces.height};
  mapped_.fit(in.surfaces);
  {
    const gl::PassScope scope = context_.scope(StageId::Direct);
    if (rays) doubts_.begin();
    mapped_.clear();
    for (const LightBlock& block : blocks) drawBlock(in.surfaces, block, whole, rays ? Noting::AlsoLight : Noting::Off);
  }
  if (!rays || answer(in, blocks, stats)) return;

  // There are more doubts than the list holds: block by block, and in parts of the frame so small that it does.
  for (const LightBlock& block : blocks) {
    std::vector<Area> areas{whole};
    while (!areas.empty()) {
      const Area area = areas.back();
      areas.pop_back();
      {
        const gl::PassScope scope = context_.scope(StageId::Direct);
        doubts_.begin();
        mapped_.bind();
        drawBlock(in.surfaces, block, area, Noting::Only);
      }
      if (!answer(in, blocks, stats))
        for (const Area& half : halves(area)) areas.push_back(half);
    }
  }
}

/// Asks rays about what was noted, and adds the light that they let through. False where the list had not room enough.
bool DirectLight::answer(const Frame& in, std::span<const LightBlock> blocks, FrameStats& stats) {
  {
    if (!doubts_.collect()) return false; // waits for the GPU
    const CpuScope scope(stats.stages, key(StageId::ShadowRays));
    const RayQuery& rays = in.world.rays;
    const auto towards = [&](const ShadowDoubt& doubt) -> Ray {
      const auto after = std::upper_bound(blocks.begin(), blocks.end(), doubt.light,
                                          [](uint32_t light, const LightBlock& b) { return light < b.first; });
      const LightBlock& block = *(after - 1);
      const LightRecord& light = block.held[doubt.light - block.first];
      const vec3 origin = offsetPoint(doubt.position, doubt.normal, rays.rayEpsilon());
      const vec3 position(light.positionRange), direction(light.directionTexel);
      switch (block.kind) {
      case MapKind::Sun:
      case MapKind::Sky:
        return {origin, -direction};
      case MapKind::Emitter:
        return segment(origin, offsetPoint(position, direction, rays.rayEpsilon()));
      default: { // not to what is nearer to the lamp than its map shows
        Ray ray = segment(origin, position);
        ray.tMax = std::min(ray.tMax, 1 - light.coneNear.z / glm::length(ray.direction));
        return ray;
      }
      }
    };
    doubts_.trace(rays, towards, stats.raysShadows);
  }
  drawLit(in.surfaces, blocks);
  return true;
}

/// All lights, with maps that are up to date. Without `rays` those of suns cover all that is seen.
std::vector<LightBlock> DirectLight::shadowed(const Frame& in, bool rays, FrameStats& stats) {
  const World& world = in.world;
  const ShadowSettings shadow = resolved(in.settings.shadow, world.view.camera.width);
  sharp_.clear();
  for (const LightView& light : world.view.lights)
    if (!softByRays(in) || !hasDisk(light)) sharp_.push_back(light);
  fitReceivers(in, stats);
  if (stale_) emitters_.forget();
  std::vector<LightBlock> blocks =
      shadows_.run({world.gpu, sharp_, skyByMaps(in), world.lights.sky, receivers_, rays ? mostReceivers_ : receivers_,
                    world.view.boundsWorld, world.view.changes.first || stale_, world.moved.boxes(), shadow});
  stats.lightMapsDrawn = shadows_.mapsDrawn();
  stats.of(EffectId::Sky) += shadows_.skyMapsDrawn();
  if (emittersBy(in) == Emitters::Maps) {
    const bool soft = in.plan.on(EffectId::SoftShadows);
    const uint32_t before = stats.mapsDrawn;
    for (const LightBlock& block : emitters_.run(world, shadow, soft ? shadow.emitterSamples : 1, stats))
      blocks.push_back(block);
    stats.of(EffectId::Emissive) += stats.mapsDrawn - before;
    stats.of(EffectId::SoftShadows) = soft ? emitters_.samples() : 0;
  } else {
    emitters_.forget();
  }
  for (size_t i = 1; i < blocks.size(); ++i)
    blocks[i].first = blocks[i - 1].first + uint32_t(blocks[i - 1].held.size());
  return blocks;
}

const gl::Program& DirectLight::programFor(const GBuffer& surfaces, const LightBlock& block, const char* vertex,
                                           const char* variant) const {
  std::vector<std::string> defines = bindSurfaces(surfaces);
  defines.push_back(defineOf(block.kind));
  if (block.kind == MapKind::Sky) defines.push_back("SKY");
  if (variant) defines.push_back(variant);
  const gl::Program& program =
      context_.programs.get({.vertex = vertex, .fragment = "direct.frag", .defines = std::move(defines)});
  program.use();
  program.set("spread", GatherSettings{}.spread); // that of virtual lights is tuned to their gaps
  block.lights->bindUniform(1);
  return program;
}

void DirectLight::drawBlock(const GBuffer& surfaces, const LightBlock& block, const Area& area, Noting noting) const {
  const gl::Program& program =
      programFor(surfaces, block, "fullscreen.vert", noting == Noting::Off ? nullptr : "DOUBTS");
  gl::PipelineState{.add = true,
                    .colors = noting != Noting::Only,
                    .x = area.x,
                    .y = area.y,
                    .width = area.width,
                    .height = area.height}
      .apply();
  program.set("lightCount", int(block.held.size()));
  program.set("firstLight", int(block.first));
  block.maps->bind(2);
  block.maps->bind(4);
  gl::bindSampler(2, block.kind == MapKind::Emitter ? smoothDistances_.name() : 0);
  gl::bindSampler(4, depths_.name());
  gl::drawFullscreen();
  gl::bindSampler(2, 0);
  gl::bindSampler(4, 0);
}

/// Adds the light of pairs that rays found to see one another.
void DirectLight::drawLit(const GBuffer& surfaces, std::span<const LightBlock> blocks) {
  if (doubts_.lit().empty()) return;
  const gl::PassScope scope = context_.scope(StageId::Direct);
  mapped_.bind();
  gl::PipelineState{.add = true, .width = surfaces.width, .height = surfaces.height}.apply();
  doubts_.bindLit(3);
  size_t pair = 0;
  for (const LightBlock& block : blocks) {
    const size_t first = pair;
    const uint32_t end = block.first + uint32_t(block.held.size());
    while (pair < doubts_.lit().size() && ShadowRayPass::lightOf(doubts_.lit()[pair]) < end) ++pair;
    if (pair == first) continue;
    const gl::Program& program = programFor(surfaces, block, "direct_lit.vert", "LIT");
    program.set("firstLight", int(block.first));
    program.set("firstPair", int(first));
    program.set("frameSize", vec2(surfaces.width, surfaces.height));
    gl::drawPoints(int(pair - first));
  }
}

/// Nothing needs the boxes where no map is fitted to them.
void DirectLight::fitReceivers(const Frame& in, FrameStats& stats) {
  const SceneView& view = in.world.view;
  if (!skyByMaps(in) && sharp_.empty()) {
    receivers_ = mostReceivers_ = {};
    return;
  }
  if (receivers_.empty() || stale_ || view.changes.camera || view.changes.geometry || view.changes.instances) {
    const std::vector<vec3> places = visiblePlaces(in.world, stats.raysPoints);
    receivers_ = boxOf(places, view.boundsWorld);
    mostReceivers_ = boxOf(withoutOutliers(places), view.boundsWorld);
  }
}

} // namespace lambent

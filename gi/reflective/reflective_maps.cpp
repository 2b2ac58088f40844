// Reflective shadow maps: each light's view is drawn as a G-buffer (the same programs as the camera's), then turned
// into positions and reflected flux. What did not change is not drawn again.
#include "gi/reflective/reflective_maps.h"

#include "engine/view/scene_view.h"
#include "gi/contract/light_views.h"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <bit>
#include <cmath>

namespace lambent {

namespace {

mat4 worldFromLight(const vec3& position, const vec3& direction) {
  return glm::translate(mat4(1), position) * glm::mat4_cast(rotationTowards(direction));
}

std::vector<ReflectiveMap> mapsOf(const ReflectiveMapInputs& in) {
  std::vector<ReflectiveMap> maps;
  if (in.bounds.empty()) return maps;
  const vec3 centre = 0.5f * (in.bounds.lo + in.bounds.hi);
  const float diameter = std::max(1e-20f, in.bounds.diameter());
  for (const LightView& light : in.lights) {
    if (!shines(light)) continue;
    const LightKind kind = kindOf(light);
    ReflectiveMap map;
    map.light = light;
    map.view.near = nearPlane(in.bounds);
    if (kind == LightKind::Sun) { // a sphere around the scene, whichever way the light comes
      map.parallel = true;
      map.view.orthoHalfHeight = 0.5f * diameter;
      map.view.worldFromView =
          worldFromLight(centre - (0.5f * diameter + map.view.near) * light.direction, light.direction);
      maps.push_back(map);
    } else if (kind == LightKind::Spot) {
      map.view.fovY = 2 * std::acos(std::min(0.9999f, light.outerConeCos));
      map.view.worldFromView = worldFromLight(light.position, light.direction);
      maps.push_back(map);
    } else {
      map.view.fovY = 0.5f * kPi;
      for (int face = 0; face < 6; ++face) {
        vec3 axis(0);
        axis[face / 2] = face % 2 ? -1.0f : 1.0f;
        map.view.worldFromView = worldFromLight(light.position, axis);
        maps.push_back(map);
      }
    }
  }
  // Parallel maps last: the pyramid of patches treats them differently.
  std::stable_partition(maps.begin(), maps.end(), [](const ReflectiveMap& m) { return !m.parallel; });
  return maps;
}

/// How the light and the map's resolution share out what goes into it.
void complete(ReflectiveMap& map, int resolution, const Aabb& bounds) {
  map.view.width = map.view.height = resolution;
  const float far = bounds.diameter() + 2 * map.view.near;
  map.clipFromWorld = clipFromView(map.view, far) * glm::inverse(map.view.worldFromView);
  const float texels = float(resolution) * float(resolution);
  if (map.parallel) {
    map.patchArea = bounds.diameter() * bounds.diameter() / texels;
    map.power = luminance(map.light.intensity) * map.patchArea * texels;
  } else {
    const float t = std::tan(0.5f * map.view.fovY);
    const float solidAngle = 4 * std::asin(t * t / (1 + t * t)); // of the whole square
    map.patchArea = solidAngle / texels;
    map.power = luminance(map.light.intensity) * solidAngle;
  }
}

bool sameLight(const LightView& a, const LightView& b) {
  return a.type == b.type && a.position == b.position && a.direction == b.direction && a.intensity == b.intensity &&
         a.range == b.range && a.innerConeCos == b.innerConeCos && a.outerConeCos == b.outerConeCos;
}

} // namespace

int ReflectiveMaps::levelOf(int patchesPerSide) const {
  return std::clamp(int(std::bit_width(unsigned(resolution / std::max(1, patchesPerSide)))) - 1, 0, levels - 1);
}

ReflectiveMaps ReflectiveMapPass::run(const ReflectiveMapInputs& in) {
  std::vector<ReflectiveMap> maps = mapsOf(in);
  // Depth, albedo, position, normal, flux, and a third more for the clusters.
  constexpr uint64_t kTexelBytes = 4 + 8 + (16 + 16 + 16) * 4 / 3;
  int resolution = int(std::bit_floor(unsigned(in.rsm.resolution)));
  while (resolution > 16 && uint64_t(resolution) * resolution * kTexelBytes * maps.size() > kReflectiveMapBudget)
    resolution /= 2;
  const int columns = std::max(1, int(std::ceil(std::sqrt(double(maps.size()))))),
            rows = std::max(1, (int(maps.size()) + columns - 1) / columns);
  const bool clustered = in.needs.clusters;
  const int coarsest = std::min(resolution, int(std::bit_floor(unsigned(in.rsm.coarsest))));
  const int levels = clustered ? int(std::bit_width(unsigned(resolution / coarsest))) : 1;
  for (ReflectiveMap& m : maps) complete(m, resolution, in.bounds);

  const gl::PassScope scope = context_.scope(StageId::ReflectiveMaps);
  const bool fresh = !position_ || resolution != resolution_ || columns != columns_ ||
                     position_.height() != rows * resolution || position_.desc().levels != levels ||
                     maps.size() != maps_.size() || in.allChanged;
  if (fresh) allocate(resolution, columns, rows, levels);
  bool changed = fresh || settings_ != in.rsm || needs_ != in.needs;
  mapsDrawn_ = 0;
  cameras_.reserve(maps.size() * sizeof(CameraBlock));
  for (size_t i = 0; i < maps.size(); ++i) {
    const Frustum frustum = Frustum::ofClip(maps[i].clipFromWorld);
    const bool surfaces =
        fresh || maps[i].clipFromWorld != maps_[i].clipFromWorld ||
        std::any_of(in.moved.begin(), in.moved.end(), [&](const Aabb& box) { return frustum.mayShow(box); });
    const bool flux = surfaces || settings_.exact != in.rsm.exact || !sameLight(maps[i].light, maps_[i].light);
    if (i >= maps_.size()) maps_.push_back(maps[i]);
    maps_[i] = maps[i];
    if (!flux) continue;
    changed = true;
    const CameraBlock camera = cameraBlock(maps[i].view, in.bounds.diameter() + 2 * maps[i].view.near);
    cameras_.write(sizeof camera, &camera).bindUniform(0);
    if (surfaces) {
      drawSurfaces(in, i);
      ++mapsDrawn_;
    }
    drawFlux(in, i);
  }
  settings_ = in.rsm;
  needs_ = in.needs;
  if (changed && levels > 1) drawPyramid();
  if (changed && in.needs.patches) {
    const auto firstParallel =
        std::find_if(maps_.begin(), maps_.end(), [](const ReflectiveMap& m) { return m.parallel; });
    patches_ = patchPass_.run({.depth = depth_,
                               .normal = normal_,
                               .size = {columns * resolution, rows * resolution},
                               .cell = {resolution, resolution},
                               .levels = levels - 1,
                               .orthoScale = 2, // of a sphere's box: depth range over half the width
                               .orthoFrom = int(firstParallel - maps_.begin()),
                               .depthThreshold = in.rsm.depth,
                               .normalThreshold = in.rsm.normal,
                               .balance = false, // nothing is interpolated between clusters
                               .edges = false});
  }
  return {.maps = maps_,
          .position = &position_,
          .normal = &normal_,
          .flux = &flux_,
          .depth = &depth_,
          .resolution = resolution,
          .columns = columns,
          .levels = levels,
          .patches = in.needs.patches ? patches_ : PatchPyramid{},
          .changed = changed};
}

void ReflectiveMapPass::allocate(int resolution, int columns, int rows, int levels) {
  maps_.clear();
  resolution_ = resolution;
  columns_ = columns;
  const auto make = [&](const char* what, GLenum format, int mips) {
    return gl::Texture(std::string("reflective maps/") + what,
                       {.format = format, .width = columns * resolution, .height = rows * resolution, .levels = mips});
  };
  depth_ = make("depth", GL_DEPTH_COMPONENT32F, 1);
  albedo_ = make("albedo", GL_RGBA16F, 1);
  position_ = make("position", GL_RGBA32F, levels);
  normal_ = make("normal", GL_RGBA32F, levels);
  flux_ = make("flux", GL_RGBA32F, levels);
  for (const gl::Texture* t : {&position_, &normal_, &flux_}) t->clear(); // cells without a map
  surfaces_ = gl::Framebuffer("reflective maps", {&normal_, &albedo_}, &depth_);
  fluxes_ = gl::Framebuffer("reflective maps flux", {&position_, &flux_});
  levels_.clear();
  for (int level = 1; level < levels; ++level)
    levels_.emplace_back("reflective maps level",
                         std::initializer_list<const gl::Texture*>{&position_, &normal_, &flux_}, nullptr, level);
}

void ReflectiveMapPass::drawSurfaces(const ReflectiveMapInputs& in, size_t index) {
  const ReflectiveMap& map = maps_[index];
  const glm::ivec2 origin = resolution_ * glm::ivec2(int(index) % columns_, int(index) / columns_);
  surfaces_.bind();
  gl::PipelineState{
      .depthTest = true, .depthWrite = true, .x = origin.x, .y = origin.y, .width = resolution_, .height = resolution_}
      .apply();
  const float zero[4] = {};
  for (int i = 0; i < 2; ++i) glClearNamedFramebufferfv(surfaces_.name(), GL_COLOR, i, zero);
  glClearNamedFramebufferfv(surfaces_.name(), GL_DEPTH, 0, zero);
  in.scene.draw(DrawKind::GBuffer, map.clipFromWorld, map.view.position());
}

void ReflectiveMapPass::drawFlux(const ReflectiveMapInputs& in, size_t index) {
  const ReflectiveMap& map = maps_[index];
  const glm::ivec2 origin = resolution_ * glm::ivec2(int(index) % columns_, int(index) / columns_);
  const LightView& light = map.light;
  const gl::Program& program = context_.programs.get({.fragment = "rsm.frag"});
  program.use();
  program.set("origin", origin);
  program.set("intensity", light.intensity);
  program.set("lightPosition", light.position);
  program.set("lightDirection", light.direction);
  program.set("range4", inverseRange4(light));
  program.set("cone", coneFactors(light));
  program.set("texelMean", map.patchArea);
  program.set("exact", in.rsm.exact ? 1 : 0);
  depth_.bind(0);
  normal_.bind(1);
  albedo_.bind(2);
  fluxes_.bind();
  gl::PipelineState{.x = origin.x, .y = origin.y, .width = resolution_, .height = resolution_}.apply();
  gl::drawFullscreen();
}

void ReflectiveMapPass::drawPyramid() {
  const gl::Program& program = context_.programs.get({.fragment = "rsm_pyramid.frag"});
  program.use();
  const auto sampled = {&position_, &normal_, &flux_};
  for (size_t i = 0; i < levels_.size(); ++i) {
    int unit = 0;
    for (const gl::Texture* t : sampled) {
      t->limitLevels(int(i), int(i));
      t->bind(unit++);
    }
    levels_[i].bind();
    gl::PipelineState{.width = position_.width() >> (i + 1), .height = position_.height() >> (i + 1)}.apply();
    gl::drawFullscreen();
  }
  for (const gl::Texture* t : sampled) t->limitLevels(0, int(levels_.size()));
}

} // namespace lambent

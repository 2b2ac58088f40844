// VPLs of reflective shadow maps, made on the GPU: nothing is read back but their number.
#include "gi/reflective/reflective_maps.h"

#include "engine/core/error.h"
#include "gi/sources/packed_lights.h"

#include <algorithm>

#include <cmath>
#include <utility>

namespace lambent {

namespace {

const std::vector<std::string> kLightFields{"positionArea", "powerNormalX", "tangentNormalY", "bitangentNormalZ"};
constexpr int kMostMaps = 1024; // of a uniform block of 16 KiB
/// Bounds the buffer of clusters (64 MiB): with very many maps the finest clusters are larger.
constexpr uint64_t kMostClusters = uint64_t(1) << 20;

/// While points are captured. Ends even where something is thrown, for what captures may not be deleted meanwhile.
struct Capturing {
  explicit Capturing(const gl::TransformFeedback& feedback) {
    feedback.bind();
    glBeginTransformFeedback(GL_POINTS);
  }
  ~Capturing() {
    glEndTransformFeedback();
    gl::TransformFeedback::unbind();
  }
};

/// Runs the program over `vertices` points into `target`.
void capture(const gl::Program& program, const gl::Buffer& target, uint32_t vertices) {
  const gl::VertexArray empty("points");
  const gl::TransformFeedback feedback("captured", target); // of its own: the default one may be in use
  const gl::Framebuffer nowhere = gl::Framebuffer::empty("captured");
  nowhere.bind();
  program.use();
  glBindVertexArray(empty.name());
  glEnable(GL_RASTERIZER_DISCARD);
  {
    const Capturing capturing(feedback);
    gl::drawArrays(GL_POINTS, int(vertices));
  }
  glDisable(GL_RASTERIZER_DISCARD);
  glBindVertexArray(0);
}

/// The same where the program decides how many it writes: returns it, for which it waits until the GPU is there.
uint32_t captureCounted(const gl::Program& program, const gl::Buffer& target, uint32_t vertices) {
  const gl::Query written(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN);
  glBeginQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN, written.name());
  capture(program, target, vertices);
  glEndQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN);
  return uint32_t(written.result());
}

uint32_t mapsUsed(const ReflectiveMaps& maps) { return uint32_t(std::min<size_t>(maps.maps.size(), kMostMaps)); }

void bindClusters(const ReflectiveMaps& maps) {
  maps.position->bind(0);
  maps.normal->bind(1);
  maps.flux->bind(2);
}

} // namespace

LightGrid lightGrid(int vpls, int maps) {
  if (maps == 0) return {};
  const int side = std::max(1, int(std::sqrt(double(vpls) / maps) + 1e-9));
  LightGrid best;
  for (const int columns : {side, side + 1}) {
    const int rows = std::max(maps, vpls / columns); // of all maps
    const LightGrid grid{columns, rows / maps, rows % maps, maps};
    if (best.maps == 0 || (grid.count() > best.count() && grid.count() <= vpls)) best = grid;
  }
  return best;
}

void ReflectiveLightPass::reserve(uint32_t slots) {
  const uint64_t bytes =
      uint64_t(std::max(1u, (slots + kLightsPerChunk - 1) / kLightsPerChunk)) * kLightsPerChunk * sizeof(VplLight);
  if (!lights_ || lights_.bytes() < bytes) lights_ = gl::Buffer("reflective lights/lights", bytes, nullptr);
}

PackedLights ReflectiveLightPass::runGrid(const ReflectiveMaps& maps, const RsmSettings& rsm) {
  if (!maps.changed && lights_ && grid_) return {&lights_, count_};
  const gl::PassScope scope = context_.scope(StageId::ReflectiveLights);
  grid_ = true;
  const uint32_t mapCount = mapsUsed(maps);
  const LightGrid grid = lightGrid(rsm.vpls, int(mapCount));
  count_ = uint32_t(grid.count());
  reserve(count_);
  std::vector<vec4> lenses(kMostMaps, vec4(0));
  for (uint32_t i = 0; i < mapCount; ++i)
    if (!maps.maps[i].parallel) lenses[i].x = std::tan(0.5f * maps.maps[i].view.fovY);
  lenses_.write(lenses.size() * sizeof(vec4), lenses.data()).bindUniform(3);
  const gl::Program& program =
      context_.programs.get({.vertex = "rsm_light.vert", .defines = {"GRID"}, .captured = kLightFields});
  program.set("count", int(count_));
  program.set("resolution", maps.resolution);
  program.set("columns", maps.columns);
  program.set("gridColumns", grid.columns);
  program.set("gridRows", grid.rows);
  program.set("mapsWithOneMore", grid.mapsWithOneMore);
  program.set("exact", rsm.exact ? 1 : 0);
  bindClusters(maps);
  capture(program, lights_, std::max(1u, (count_ + kLightsPerChunk - 1) / kLightsPerChunk) * kLightsPerChunk);
  return {&lights_, count_};
}

PackedLights ReflectiveLightPass::runClusters(const ReflectiveMaps& maps, const RsmSettings& rsm) {
  if (!maps.changed && lights_ && !grid_) return {&lights_, count_};
  const gl::PassScope scope = context_.scope(StageId::ReflectiveLights);
  grid_ = false;
  const uint32_t mapCount = mapsUsed(maps);
  const int coarsest = maps.levels - 1;
  int finest = std::min(maps.levelOf(rsm.finest), coarsest);
  const auto clusters = [&](int level) {
    return uint64_t(mapCount) * uint64_t(maps.resolution >> level) * uint64_t(maps.resolution >> level);
  };
  while (finest < coarsest && clusters(finest) > kMostClusters) ++finest;
  const int side = maps.resolution >> finest;
  const uint32_t most = mapCount * uint32_t(side * side);
  const uint64_t bytes = std::max<uint64_t>(1, most) * sizeof(VplLight);
  if (!compact_ || compact_.bytes() < bytes) {
    compact_ = gl::Buffer("reflective lights/clusters", bytes, nullptr);
    compactView_ = gl::Texture::ofBuffer("reflective lights/view", GL_RGBA32F, compact_);
  }
  const gl::Program& compact = context_.programs.get(
      {.vertex = "rsm_cluster.vert", .fragment = "", .geometry = "rsm_cluster.geom", .captured = kLightFields});
  compact.set("side", side);
  compact.set("columns", maps.columns);
  compact.set("finest", finest);
  compact.set("coarsest", coarsest);
  bindClusters(maps);
  if (maps.patches.normalLo) maps.patches.normalLo->bind(3);
  count_ = most > 0 ? captureCounted(compact, compact_, most) : 0;
  reserve(count_);
  const gl::Program& order = context_.programs.get({.vertex = "rsm_light.vert", .captured = kLightFields});
  order.set("count", int(count_));
  compactView_.bind(0);
  capture(order, lights_, std::max(1u, (count_ + kLightsPerChunk - 1) / kLightsPerChunk) * kLightsPerChunk);
  return {&lights_, count_};
}

std::vector<VplLight> ReflectiveLightPass::read() const {
  const uint32_t chunks = std::max(1u, (count_ + kLightsPerChunk - 1) / kLightsPerChunk);
  std::vector<VplLight> ordered(size_t(chunks) * kLightsPerChunk), slots(count_);
  lights_.read(0, std::span(ordered));
  for (uint32_t slot = 0; slot < count_; ++slot) slots[slot] = ordered[lightOrder(slot)];
  return slots;
}

} // namespace lambent

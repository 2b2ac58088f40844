// Shadow maps of punctual lights and of the sky. A map, or a face of a cube, is drawn when what it shows may differ
// from what is stored: its view changed, or something moved within it.
#include "gi/direct/light_shadows.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace lambent {

namespace {

/// Bytes that the maps of one kind may take; their resolution is halved until they fit (hundreds of point lights).
constexpr uint64_t kBudgetBytes = uint64_t(512) << 20;

/// A light with the views that its map needs: one, or six for a cube.
struct LitMap {
  LightRecord light;
  std::vector<mat4> clipFromWorld;
};

mat4 viewFromWorld(const vec3& position, const vec3& right, const vec3& up, const vec3& forward) {
  mat4 m = glm::transpose(mat4(vec4(right, 0), vec4(up, 0), vec4(forward, 0), vec4(0, 0, 0, 1)));
  m[3] = m * vec4(-position, 1);
  return m; // z along forward
}

/// Reversed, infinite: depth = near / z, looking along +z of view space.
mat4 clipFromForwardView(float tanHalf, float near) {
  mat4 m(0);
  m[0][0] = m[1][1] = 1 / tanHalf;
  m[3][2] = near;
  m[2][3] = 1;
  return m;
}

/// From clip space to [0,1]² map coordinates; depth stays.
mat4 mapFromClip() {
  mat4 m(1);
  m[0][0] = m[1][1] = 0.5f;
  m[3][0] = m[3][1] = 0.5f;
  return m;
}

LitMap punctual(const LightView& light, float near) {
  LitMap out;
  out.light.positionRange = vec4(light.position, inverseRange4(light));
  out.light.directionTexel = vec4(light.direction, 0);
  out.light.intensityLayer = vec4(light.intensity, 0);
  out.light.coneNear = vec4(coneFactors(light), near, 0);
  out.light.mapFromWorld = mat4(0);
  return out;
}

LitMap cubeMap(const LightView& light, int resolution, float near) {
  LitMap out = punctual(light, near);
  out.light.directionTexel.w = 2.0f / float(resolution);
  // OpenGL's faces: +x −x +y −y +z −z with these axes for s, t.
  const vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  const vec3 axes[6][3] = {{-z, -y, x}, {z, -y, -x}, {x, z, y}, {x, -z, -y}, {x, -y, z}, {-x, -y, -z}};
  for (const vec3(&a)[3] : axes)
    out.clipFromWorld.push_back(clipFromForwardView(1, near) * viewFromWorld(light.position, a[0], a[1], a[2]));
  return out;
}

/// What the map of a lamp looks at where that is small from there: a sphere around all that is seen. Radius 0: it looks
/// all around, or over its cone.
struct LampAim {
  vec3 position{0}, centre{0}; // of the lamp; of the sphere
  float radius = 0;

  explicit operator bool() const { return radius > 0; }
  vec3 direction() const { return glm::normalize(centre - position); }
  float tanHalf() const { // no less than the map's matrix holds in single precision
    const float ratio = radius / glm::distance(centre, position);
    return std::max(1e-4f, ratio / std::sqrt(1 - ratio * ratio));
  }
};

/// Aims where the lamp is three radii off, twelve within its scene, and keeps that down to two. Keeps `previous` while
/// it covers the receivers and is not more than twice as large as needed, so that a slow camera redraws nothing. (All
/// around, a texel of 320×240 is 4 m wide at 300 m: what is smaller threw no shadow.)
LampAim aimAt(const LightView& light, const Aabb& receivers, const Aabb& casters, const LampAim& previous) {
  constexpr float kBegins = 3, kBeginsWithin = 12, kEnds = 2, kSpare = 1.1f, kLoosest = 2;
  const bool same = previous && previous.position == light.position;
  if (receivers.empty()) return same ? previous : LampAim{};
  const vec3 centre = receivers.centre();
  const float needed = std::max({0.5f * receivers.diameter(), 1e-5f * casters.diameter(), 1e-20f});
  if (same && glm::distance(previous.centre, centre) + needed <= previous.radius &&
      previous.radius <= kLoosest * needed)
    return previous;
  const float radius = kSpare * needed;
  const bool within =
      glm::distance(light.position, glm::clamp(light.position, casters.lo, casters.hi)) < 0.1f * casters.diameter();
  if (glm::distance(light.position, centre) < (previous ? kEnds : within ? kBeginsWithin : kBegins) * radius) return {};
  return {light.position, centre, radius};
}

float tanHalfOfCone(const LightView& light) {
  const float sine = std::sqrt(std::max(0.0f, 1 - light.outerConeCos * light.outerConeCos));
  return std::max(1e-3f, sine / light.outerConeCos);
}

/// One perspective of a spot's cone, or of what a lamp aims at.
LitMap spotMap(const LightView& light, const LampAim& aim, int resolution, float near) {
  LitMap out = punctual(light, near);
  // One texel and a half beyond the cone on each side, for the 3×3 comparison.
  const float tanHalf = (aim ? aim.tanHalf() : tanHalfOfCone(light)) * (1 + 3.0f / float(resolution));
  out.light.directionTexel.w = 2 * tanHalf / float(resolution);
  mat3 frame;
  frame[2] = aim ? aim.direction() : light.direction;
  const vec3 helper = std::abs(frame[2].y) < 0.9f ? vec3(0, 1, 0) : vec3(1, 0, 0);
  frame[0] = glm::normalize(glm::cross(helper, frame[2]));
  frame[1] = glm::cross(frame[2], frame[0]);
  out.clipFromWorld.push_back(clipFromForwardView(tanHalf, near) *
                              viewFromWorld(light.position, frame[0], frame[1], frame[2]));
  out.light.mapFromWorld = mapFromClip() * out.clipFromWorld[0];
  return out;
}

LitMap sunMap(const SunFit& fit, const vec3& irradiance, int resolution) {
  LitMap out;
  out.light.positionRange = vec4(0);
  out.light.directionTexel = vec4(fit.direction, std::max(fit.size().x, fit.size().y) / float(resolution));
  out.light.intensityLayer = vec4(irradiance, 0);
  out.light.coneNear = vec4(0);
  out.clipFromWorld.push_back(fit.clipFromWorld());
  out.light.mapFromWorld = mapFromClip() * out.clipFromWorld[0];
  return out;
}

int affordableResolution(int wanted, size_t maps) {
  int resolution = wanted;
  while (resolution > 32 && uint64_t(resolution) * resolution * 4 * maps > kBudgetBytes) resolution /= 2;
  return resolution;
}

/// A block with its maps.
struct KeptBlock {
  MapKind kind = MapKind::Sun;
  DrawKind depth = DrawKind::Depth; // what its maps are drawn with
  gl::Texture maps;
  LightRecords lights;
  std::vector<mat4> drawn; // clipFromWorld of each layer's map (a cube's first face); zero: not drawn
  /// The maps without what moves, once something does: it is drawn over a copy. By layer and face.
  gl::Texture still;
  struct StillMap {
    mat4 clipFromWorld{0};
    uint64_t version = 0; // GpuScene::stillVersion
    bool operator==(const StillMap&) const = default;
  };
  std::vector<StillMap> stillDrawn;
};

} // namespace

void LightRecords::hold(std::vector<LightRecord> lights, gl::Ring& uploads) {
  const size_t bytes = lights.size() * sizeof(LightRecord);
  if (lights.size() == held_.size() && std::memcmp(lights.data(), held_.data(), bytes) == 0) return;
  if (!buffer_) buffer_ = gl::Buffer("light maps/lights", sizeof(LightRecord) * kLightsPerBlock, nullptr);
  uploads.upload(buffer_, 0, bytes, lights.data());
  held_ = std::move(lights);
}

struct LightShadowState {
  explicit LightShadowState(PassContext c) : context(c), framebuffer("light maps") {}

  PassContext context;
  gl::Framebuffer framebuffer;
  gl::Ring changedLights{"light maps/changed lights"};
  std::vector<KeptBlock> blocks;
  std::vector<SunFit> sunFits, skyFits;
  std::vector<LampAim> aims; // of lamps and spots that shine
  uint32_t mapsDrawn = 0, skyMapsDrawn = 0;

  void fill(size_t& block, MapKind kind, int resolution, const std::vector<LitMap>& maps, const LightShadowInputs& in);
  void drawMaps(KeptBlock& block, const std::vector<LitMap>& maps, size_t first, const LightShadowInputs& in);
  void drawMoved(KeptBlock& block, int layer, const mat4& clipFromWorld, const GpuScene& scene);
  void drawInto(const gl::Texture& maps, int layer, DrawKind kind, const mat4& clipFromWorld, const GpuScene& scene,
                Instances which);
};

/// Puts `maps` into blocks from number `block` on; the block's texture is kept when its shape is right.
void LightShadowState::fill(size_t& block, MapKind kind, int resolution, const std::vector<LitMap>& maps,
                            const LightShadowInputs& in) {
  for (size_t first = 0; first < maps.size(); first += kLightsPerBlock, ++block) {
    const int count = int(std::min<size_t>(kLightsPerBlock, maps.size() - first));
    if (blocks.size() <= block) blocks.emplace_back();
    KeptBlock& target = blocks[block];
    const gl::TextureKind shape = kind == MapKind::Cube ? gl::TextureKind::CubeArray : gl::TextureKind::Array;
    if (!target.maps || target.maps.desc().kind != shape || target.maps.desc().layers != count ||
        target.maps.width() != resolution) {
      target.maps = gl::Texture("light maps/block " + std::to_string(block), {.kind = shape,
                                                                              .format = GL_DEPTH_COMPONENT32F,
                                                                              .width = resolution,
                                                                              .height = resolution,
                                                                              .layers = count,
                                                                              .linear = true,
                                                                              .depthCompare = true,
                                                                              .compareGreater = true});
      target.drawn.assign(size_t(count), mat4(0));
      target.still = {};
    }
    target.kind = kind;
    const bool checkered = in.scene.blends() && in.shadow.rays && kind != MapKind::Sky;
    const DrawKind depth = checkered ? DrawKind::CheckeredDepth : DrawKind::Depth;
    if (std::exchange(target.depth, depth) != depth) {
      std::ranges::fill(target.drawn, mat4(0));
      target.stillDrawn.assign(target.stillDrawn.size(), {});
    }
    std::vector<LightRecord> lights;
    for (int i = 0; i < count; ++i) {
      lights.push_back(maps[first + i].light);
      lights.back().intensityLayer.w = float(i);
    }
    target.lights.hold(std::move(lights), changedLights);
    drawMaps(target, maps, first, in);
  }
}

void LightShadowState::drawMaps(KeptBlock& block, const std::vector<LitMap>& maps, size_t first,
                                const LightShadowInputs& in) {
  for (int layer = 0; layer < int(block.lights.held().size()); ++layer) {
    const LitMap& map = maps[first + layer];
    const bool whole = in.allChanged || block.drawn[layer] != map.clipFromWorld[0];
    block.drawn[layer] = map.clipFromWorld[0];
    const int faces = int(map.clipFromWorld.size());
    bool drawn = false;
    for (int face = 0; face < faces; ++face) {
      const Frustum frustum = Frustum::ofClip(map.clipFromWorld[face]);
      const auto shows = [&](const Aabb& box) { return frustum.mayShow(box); };
      if (whole)
        drawInto(block.maps, layer * faces + face, block.depth, map.clipFromWorld[face], in.scene, Instances::All);
      else if (std::any_of(in.moved.begin(), in.moved.end(), shows))
        drawMoved(block, layer * faces + face, map.clipFromWorld[face], in.scene);
      else
        continue;
      drawn = true;
    }
    mapsDrawn += drawn;
  }
}

/// A map, or a cube's face, whose view is as before: what stands still is not drawn again.
void LightShadowState::drawMoved(KeptBlock& block, int layer, const mat4& clipFromWorld, const GpuScene& scene) {
  const int size = block.maps.width();
  if (!block.still) {
    block.still = gl::Texture("light maps/still", block.maps.desc());
    block.stillDrawn.assign(size_t(block.maps.desc().layers) * (block.kind == MapKind::Cube ? 6 : 1), {});
  }
  const KeptBlock::StillMap wanted{clipFromWorld, scene.stillVersion()};
  if (KeptBlock::StillMap& has = block.stillDrawn[size_t(layer)]; !(has == wanted)) {
    drawInto(block.still, layer, block.depth, clipFromWorld, scene, Instances::Still);
    has = wanted;
  }
  const GLenum target = block.kind == MapKind::Cube ? GL_TEXTURE_CUBE_MAP_ARRAY : GL_TEXTURE_2D_ARRAY;
  glCopyImageSubData(block.still.name(), target, 0, 0, 0, layer, block.maps.name(), target, 0, 0, 0, layer, size, size,
                     1);
  drawInto(block.maps, layer, block.depth, clipFromWorld, scene, Instances::Moving);
}

/// Draws a map; where only moving objects are drawn, over what the map shows already.
void LightShadowState::drawInto(const gl::Texture& maps, int layer, DrawKind kind, const mat4& clipFromWorld,
                                const GpuScene& scene, Instances which) {
  framebuffer.bind();
  gl::PipelineState{.depthTest = true, .depthWrite = true, .width = maps.width(), .height = maps.width()}.apply();
  framebuffer.attachDepthLayer(maps, layer);
  const float nothing = 0;
  if (which != Instances::Moving) glClearNamedFramebufferfv(framebuffer.name(), GL_DEPTH, 0, &nothing);
  scene.draw(kind, clipFromWorld, vec3(0), which);
}

LightShadowPass::LightShadowPass(PassContext context) : state_(std::make_unique<LightShadowState>(context)) {}
LightShadowPass::~LightShadowPass() = default;
uint32_t LightShadowPass::mapsDrawn() const { return state_->mapsDrawn; }
uint32_t LightShadowPass::skyMapsDrawn() const { return state_->skyMapsDrawn; }

std::vector<LightBlock> LightShadowPass::run(const LightShadowInputs& in) {
  LightShadowState& s = *state_;
  const gl::PassScope scope = s.context.scope(StageId::LightMaps);
  s.mapsDrawn = 0;
  s.changedLights.reserve((in.lights.size() + size_t(in.shadow.skyMaps)) * sizeof(LightRecord));
  const float near = nearPlane(in.casters);

  struct Lamp {
    const LightView* light;
    LampAim aim;
  };
  std::vector<Lamp> cubes, spots;
  std::vector<const LightView*> suns;
  std::vector<LampAim> lampAims;
  for (const LightView& light : in.lights) {
    if (!shines(light)) continue;
    const LightKind kind = kindOf(light);
    if (kind == LightKind::Sun) {
      suns.push_back(&light);
      continue;
    }
    const LampAim before = lampAims.size() < s.aims.size() ? s.aims[lampAims.size()] : LampAim{};
    LampAim& aim = lampAims.emplace_back(aimAt(light, in.sunReceivers, in.casters, before));
    if (kind == LightKind::Spot && aim && aim.tanHalf() >= tanHalfOfCone(light)) aim = {};
    (kind == LightKind::Spot || aim ? spots : cubes).push_back({&light, aim});
  }
  s.aims = std::move(lampAims);
  std::vector<LitMap> maps;
  size_t block = 0;
  int resolution = affordableResolution(in.shadow.pointResolution, cubes.size() * 6);
  for (const Lamp& lamp : cubes) maps.push_back(cubeMap(*lamp.light, resolution, near));
  s.fill(block, MapKind::Cube, resolution, maps, in);

  maps.clear();
  resolution = affordableResolution(in.shadow.spotResolution, spots.size());
  for (const Lamp& lamp : spots) maps.push_back(spotMap(*lamp.light, lamp.aim, resolution, near));
  s.fill(block, MapKind::Spot, resolution, maps, in);

  // Directions of suns and sky are fitted to the receivers; nothing to fit or light in an empty scene.
  const auto fitted = [&](std::vector<SunFit>& fits, const std::vector<vec3>& directions,
                          const std::vector<vec3>& irradiances, int wanted, MapKind kind, const Aabb& receivers) {
    maps.clear();
    fits.resize(directions.size());
    resolution = affordableResolution(wanted, directions.size());
    for (size_t i = 0; i < directions.size() && !in.casters.empty(); ++i) {
      fits[i] = fitSun(directions[i], receivers, in.casters, fits[i]);
      maps.push_back(sunMap(fits[i], irradiances[i], resolution));
    }
    s.fill(block, kind, resolution, maps, in);
  };
  std::vector<vec3> directions, irradiances;
  for (const LightView* light : suns) {
    directions.push_back(light->direction);
    irradiances.push_back(light->intensity);
  }
  fitted(s.sunFits, directions, irradiances, in.shadow.sunResolution, MapKind::Sun, in.sunReceivers);
  const uint32_t punctualMaps = s.mapsDrawn;
  if (in.drawSky) {
    directions.clear();
    irradiances.clear();
    for (const SkyDirection& d : skyDirections(in.sky, in.shadow.skyMaps)) {
      directions.push_back(d.direction);
      irradiances.push_back(d.irradiance);
    }
    fitted(s.skyFits, directions, irradiances, in.shadow.skyResolution, MapKind::Sky, in.receivers);
  }
  s.skyMapsDrawn = s.mapsDrawn - punctualMaps;
  s.blocks.resize(block);
  std::vector<LightBlock> blocks;
  for (const KeptBlock& b : s.blocks) blocks.push_back({b.kind, &b.maps, &b.lights.buffer(), b.lights.held()});
  return blocks;
}

} // namespace lambent

// Gathers at patches, and which patches these were.
#pragma once

#include "gl_fixture.h"
#include "shaders/shared/patches.h"

#include <random>

namespace lambent::test {

/// A panel before a wall, over the left half of the image unless it is wider, and a lamp between them that lights the
/// wall alone.
struct Panels {
  HandScene scene;
  std::vector<VirtualLight> lamp{lightAt(vec3(0, 0, -1), vec3(0, 0, -1), vec3(1), 0.1f)};

  explicit Panels(float width = 9, int pixelsX = 128, int pixelsY = 64) {
    const uint32_t grey = scene.material(vec3(0.5f));
    scene.quad(vec3(-9, -9, -2), vec3(18, 0, 0), vec3(0, 18, 0), grey);
    scene.quad(vec3(-9, -9, 0), vec3(width, 0, 0), vec3(0, 18, 0), grey);
    scene.camera = cameraAt(vec3(0, 0, 4), vec3(0), 1.0f, pixelsX, pixelsY);
  }
};

inline std::vector<VirtualLight> lightsIn(const vec3& lo, const vec3& hi, int count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> u(0, 1);
  std::vector<VirtualLight> lights;
  for (int i = 0; i < count; ++i) {
    const auto any = [&] {
      const float x = u(random), y = u(random);
      return vec3(x, y, u(random));
    };
    const vec3 position = lo + any() * (hi - lo), normal = glm::normalize(any() - 0.5f);
    lights.push_back(lightAt(position, normal, any(), 0.05f));
  }
  return lights;
}

inline std::vector<VirtualLight> roomLights() { return lightsIn(vec3(-0.9f), vec3(0.9f), 40); }

class MultiresTest : public GatherTest {
 protected:
  Room room;
  GBuffer roomSurfaces(int width = 64, int height = 48, bool glossy = false) {
    room.scene.size(width, height);
    return surfaces(room.scene, glossy);
  }
  /// As when surfaces reflect half of the light in lobes.
  GBuffer glossyRoomSurfaces() {
    for (Material& m : room.scene.assets.materials) m.roughness = m.metalness = 0.5f;
    return roomSurfaces(64, 48, true);
  }
  Image gathered(const GBuffer& gbuffer, const std::vector<VirtualLight>& lights, GatherMode mode) {
    return read(Buffer::Unfiltered, gbuffer, GatherTest::gathered(gbuffer, lights, with(mode)));
  }
  Image multires(const GBuffer& gbuffer, const std::vector<VirtualLight>& lights, const MultiresSettings& settings,
                 GatherMode mode = GatherMode::Multires) {
    Settings all = with(mode);
    all.multires = settings;
    return read(Buffer::Unfiltered, gbuffer, GatherTest::gathered(gbuffer, lights, all));
  }
  /// Glossy light as it was gathered; nothing where there is none.
  std::vector<vec4> glossyTexels(const GBuffer& gbuffer, GatherMode mode, const MultiresSettings& settings) {
    Settings all = with(mode);
    all.gather.glossy = true;
    all.multires = settings;
    const gl::Texture* texture = GatherTest::gathered(gbuffer, roomLights(), all).glossy;
    return texture ? readTexture(*texture) : std::vector<vec4>();
  }
  /// Inverse ones, from the bottom.
  static std::vector<float> depths(const GBuffer& gbuffer) {
    std::vector<float> depth(size_t(gbuffer.width) * gbuffer.height);
    gbuffer.depth->read(std::span(depth), GL_DEPTH_COMPONENT, GL_FLOAT);
    return depth;
  }
  /// Patches that the stencil marked in a gather with these settings.
  uint64_t patchesMarked(const GBuffer& gbuffer, const MultiresSettings& settings,
                         GatherMode mode = GatherMode::Multires) {
    for (int frame = 0; frame < 2; ++frame) { // the count comes late
      multires(gbuffer, {lightAt(vec3(0), vec3(0, 1, 0), vec3(1), 1)}, settings, mode);
      glFinish();
    }
    return stats.patches;
  }
  /// Level of the patch that each pixel belongs to, from the top; −1 on background.
  std::vector<int> patchLevels(const GBuffer& gbuffer) {
    const PatchPyramid& p = *patches;
    std::vector<int> levels(size_t(gbuffer.width) * gbuffer.height, 0);
    for (int level = 1; level <= p.levels; ++level) {
      const glm::ivec2 size = p.padded / (1 << level);
      std::vector<vec4> lo(size_t(size.x) * size.y);
      glGetTextureImage(p.normalLo->name(), level - 1, GL_RGBA, GL_FLOAT, GLsizei(lo.size() * sizeof(vec4)), lo.data());
      for (const auto [x, y] : Pixels(gbuffer))
        if (lo[size_t(y >> level) * size.x + (x >> level)].a < 0.5f) levels[size_t(y) * gbuffer.width + x] = level;
    }
    const std::vector<float> depth = depths(gbuffer);
    for (size_t i = 0; i < depth.size(); ++i)
      if (depth[i] == 0) levels[i] = -1;
    return levels;
  }
  /// Where a patch was gathered.
  struct GatheredPatch {
    glm::ivec2 pixel; // from the bottom
    int level;
  };
  std::vector<GatheredPatch> gatheredPatches(const GBuffer& gbuffer) {
    const std::vector<int> levels = patchLevels(gbuffer);
    std::vector<GatheredPatch> patches;
    for (const auto [x, y] : Pixels(gbuffer)) {
      const int level = levels[size_t(y) * gbuffer.width + x];
      if (level < 0 || x % (1 << level) || y % (1 << level)) continue;
      const glm::ivec2 size(gbuffer.width, gbuffer.height);
      patches.push_back({patchPixel(glm::ivec2(x >> level, y >> level), level, 1, glm::ivec2(0), size), level});
    }
    return patches;
  }
  static uint64_t patchesOf(const std::vector<int>& levels, int width, int height) {
    uint64_t count = 0;
    for (const auto [x, y] : Pixels(width, height)) {
      const int level = levels[size_t(y) * width + x];
      count += level >= 0 && x % (1 << level) == 0 && y % (1 << level) == 0;
    }
    return count;
  }
};

} // namespace lambent::test

// Direct light of emissive surfaces by patches (paper 4), and a thousand rays per pixel to hold it to.
#pragma once

#include "frames.h"
#include "gi/direct/area_light_pass.h"

namespace lambent::test::area_light_test {

class AreaLightTest : public GlTest {
 protected:
  AreaLightTest() { settings.shadow.emitters = EmitterShadows::Patches; }

  /// Direct irradiance with every emissive surface of the scene as a light.
  Image irradianceOf(const HandScene& scene) {
    return directOf(passes, scene, collectLights(scene.view()), settings, stats, ShadowRayPass::kMost, &levels);
  }

  /// The same with side² rays per triangle of a lamp at every pixel: a grid of them, or `scattered`, others at each
  /// pixel, which know edges along the grid better and what is near worse.
  Image tracedOf(const HandScene& scene, int side = 32, bool scattered = false) const {
    const CameraView& camera = scene.camera;
    const TracedScene traced(scene);
    const EmbreeQuery& rays = traced.rays;
    Image image(camera.width, camera.height);
    for (const auto [x, y] : Pixels(camera)) {
      const CameraRay ray = pixelRay(camera, x, y);
      const SurfaceHit hit = rays.closest(Ray{ray.origin, ray.direction});
      if (!hit.valid()) continue;
      const vec3 origin = offsetPoint(hit.position, hit.geometricNormal, rays.rayEpsilon());
      vec3 sum(0);
      const vec3 shift = Rng(1, Stream::Test, uint64_t(y) << 32 | uint64_t(x)).next3();
      for (const EmitterTriangle& t : traced.lights.triangles)
        for (int i = 0; i < side * side; ++i) {
          vec2 u = (vec2(i % side, i / side) + 0.5f) / float(side);
          if (scattered) u = vec2(additiveRecurrence3(uint32_t(i), shift));
          if (u.x + u.y > 1) u = 1.0f - u;
          const vec3 at = t.p0 + t.e1 * u.x + t.e2 * u.y, way = at - hit.position;
          const float cosine = glm::dot(hit.normal, way), cosineLight = -glm::dot(t.normal, way);
          if (cosine <= 0 || cosineLight <= 0) continue;
          if (rays.occluded(segment(origin, offsetPoint(at, t.normal, rays.rayEpsilon())))) continue;
          const float r2 = glm::dot(way, way);
          sum += t.radiance * (cosine * cosineLight / (r2 * r2) * t.area / float(side * side));
        }
      image.at(x, y) = sum;
    }
    return image;
  }

  Image radianceOf(const HandScene& scene) {
    settings.gather.glossy = true;
    settings.effects[EffectId::Emissive] = EffectMode::On;
    return irradianceOf(scene);
  }

  Settings settings;
  FrameStats stats;        // of the last image
  std::vector<int> levels; // of its fragments, by pixel
};

/// A floor, and a lamp of 0.8 × 0.6 m above it that faces down.
struct LampScene : HandScene {
  explicit LampScene(const vec3& radiance = vec3(5, 4, 3)) {
    quad(vec3(-10, 0, 10), vec3(20, 0, 0), vec3(0, 0, -20), material(vec3(0.5f)));
    quad(vec3(-0.4f, 2, -0.3f), vec3(0.8f, 0, 0), vec3(0, 0, 0.6f), material(vec3(0), radiance));
    camera = cameraAt(vec3(0, 1.8f, 3), vec3(0, 0.2f, 0), 1.0f, 96, 64);
  }
};

} // namespace lambent::test::area_light_test

// The path-traced reference of a scene made by hand.
#pragma once

#include "gi/reference/path_tracer.h"
#include "tests/support/hand_scene.h"

namespace lambent::test {

inline ReferenceImage trace(const ReferenceInputs& in, uint32_t samples, ReferenceBuffer buffer) {
  ReferenceSums sums(in.camera.width, in.camera.height);
  RayCounts counts;
  addSamples(sums, in, samples, counts);
  return readReference(sums, in, buffer);
}

/// Of one channel over all pixels, with the error that their scatter tells (they are independent).
inline Mean meanOf(const Image& image, const vec3& channel = {0.2126f, 0.7152f, 0.0722f}) {
  std::vector<double> values;
  for (const vec3& p : image.pixels) values.push_back(double(glm::dot(channel, p)));
  return meanOf(values);
}

/// Of many pixels that all look at one point, close by.
inline CameraView probeAt(const vec3& eye, const vec3& target) {
  CameraView camera = cameraAt(eye, target, 1e-4f, 32, 32);
  camera.near = 1e-3f;
  return camera;
}

/// An empty box of 2 × 1 × 3 m seen along +Z from near its end, with a lamp in the far corner.
struct ReferenceBox {
  HandScene scene;
  vec3 size{2, 1, 3}, albedo{0.6f, 0.5f, 0.4f};

  explicit ReferenceBox(float roughness = 1, float metalness = 0) {
    scene.box(vec3(0), size, scene.glossyMaterial(albedo, roughness, metalness), true);
    scene.lamp({1.6f, 0.4f, 2.5f});
    scene.camera = cameraAt({1, 0.5f, 0.1f}, {1, 0.5f, 3}, 1, 24, 16);
  }
};

} // namespace lambent::test
